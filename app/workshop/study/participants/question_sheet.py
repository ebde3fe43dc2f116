"""The sheets on which a participant reads and answers: a form in HTML for each question."""

from collections.abc import Sequence
from html import escape

from cubeling.app.workshop.study.protocols.questionnaires import Item, Questionnaire

MAX_TEXT_CHARS = 2000
"""Longest text that is answered: `WebLimits.text_bytes` holds it."""


WAITING_SHEET = '<h2 id="waiting"></h2>'
"""Shown while nothing is asked; the page writes into it what it is told of "waiting"."""


def text_sheet(title: str, text: str) -> str:
    """Return the sheet of an instruction."""
    return _form(f'{_heading(title)}<p class="text">{escape(text)}</p>')


def question_sheet(
    questionnaire: Questionnaire,
    item: Item,
    shown: Sequence[tuple[str, str, str]] = (),
    pictures: Sequence[str] = (),
    *,
    again: bool = False,
) -> str:
    """Return the sheet of a question.

    Parameters
    ----------
    questionnaire, item
        What is asked.
    shown
        Address, media type and caption of each stimulus, from left to right.
    pictures
        Address of a picture for each answer; none for words alone.
    again
        Whether the last answer was none: the page writes why, as it is told of "problem".
    """
    warning = '<p id="problem" role="alert"></p>' if again else ""
    figures = "".join(_figure(*each) for each in shown)
    seen = f'<div class="shown">{figures}</div>' if shown else ""
    asked = f"<h2>{escape(item.text)}</h2>" if item.text else ""
    head = _heading(questionnaire.title)
    return _form(f"{head}{seen}{asked}{warning}{_field(item, pictures)}")


def _heading(title: str) -> str:
    return f"<h1>{escape(title)}</h1>" if title else ""


def _form(body: str) -> str:
    """Return a form with the button to go on, which the page gives a name in its language."""
    arrow = '<svg viewBox="0 0 24 24" aria-hidden="true"><use href="#i-go"/></svg>'
    return f"<form>{body}<button>{arrow}</button></form>"


def _figure(address: str, kind: str, caption: str) -> str:
    words = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    if kind.startswith("video/"):
        return (
            f"<figure>{_loaded('video', address, ' controls autoplay playsinline')}{words}</figure>"
        )
    return f"<figure>{_loaded('img', address)}{words}</figure>"


def _loaded(tag: str, address: str, more: str = ' alt=""') -> str:
    """Return a picture or a film that the page's script loads, as it tells the token."""
    end = "</video>" if tag == "video" else ""
    return f'<{tag} data-from="{escape(address, quote=True)}"{more}>{end}'


def _field(item: Item, pictures: Sequence[str]) -> str:
    low, high = (item.anchors[0], item.anchors[-1]) if item.anchors else ("", "")
    asked = item.text or f"{low}, {high}"
    label = f' aria-label="{escape(asked, quote=True)}"'
    if item.kind == "text":
        return f'<textarea name="answer" rows="4" maxlength="{MAX_TEXT_CHARS}"{label}></textarea>'
    group = f' role="radiogroup"{label}>'
    if item.kind == "choice":
        options = (_point(f"{n}", option) for n, option in enumerate(item.options, 1))
        return f'<div class="choice"{group}{"".join(options)}</div>'
    ends = f'<div class="ends"><span>{escape(low)}</span><span>{escape(high)}</span></div>'
    if item.kind == "slider":
        step = (item.high - item.low) / 200.0
        # It gets its name when it is touched: the middle, where it is at first, is no answer.
        return (
            f'<input type="range" min="{item.low:g}" max="{item.high:g}" step="{step:g}"{label}>'
            f"{ends}"
        )
    values = [f"{point:g}" for point in item.answers]
    named = len(item.anchors) == len(values) > 2
    words: Sequence[str] = item.anchors if named else values
    # Two opposites stand beside the circles; pictures are for those who do not read.
    if not item.text or (pictures and not named):
        words = ("",) * len(values)
    images = [_loaded("img", place) for place in pictures] or [""] * len(values)
    points = "".join(map(_point, values, words, images))
    if not item.text:
        left, right = f"<span>{escape(low)}</span>", f"<span>{escape(high)}</span>"
        return f'<div class="scale opposites"{group}{left}{points}{right}</div>'
    kind = "scale named" if named else "scale"
    return f'<div class="{kind}"{group}{points}</div>{"" if named else ends}'


def _point(value: str, word: str, image: str = "") -> str:
    """Return one of the answers to choose; without a word, it is called by its value."""
    name = "" if word else f' aria-label="{value}"'
    circle = f'<input type="radio" name="answer" value="{value}"{name}>'
    return f"<label>{image}{circle}{escape(word)}</label>"
