"""The page on which a participant reads and answers: a form for each question, without scripts."""

from collections.abc import Sequence
from html import escape

from cubeling.app.workshop.study.protocols.questionnaires import Item, Questionnaire

STYLE = """
* { box-sizing: border-box; }
body { font: 20px/1.5 system-ui, sans-serif; color: #1f2430; background: #fffaf0;
  max-width: 56rem; margin: 3rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.1rem; color: #667085; font-weight: 600; }
h2 { font-size: 1.5rem; line-height: 1.3; margin: 1rem 0 1.5rem; }
p.text { white-space: pre-line; }
.shown { display: flex; gap: 1rem; justify-content: center; margin: 1rem 0; }
.shown img, .shown video { max-width: 100%; max-height: 55vh; border-radius: 6px; }
.shown figure { margin: 0; text-align: center; color: #667085; }
.scale { display: flex; gap: .5rem; align-items: flex-end; justify-content: center; }
.scale label { flex: 1; text-align: center; cursor: pointer; font-size: .9rem;
  padding: .5rem .25rem; border-radius: 6px; }
.scale label:hover, .choice label:hover { background: #eef3fa; }
.scale input, .choice input { display: block; width: 1.6rem; height: 1.6rem; margin: .4rem auto; }
.scale img { display: block; max-width: 100%; height: 5rem; margin: 0 auto; }
.opposites { align-items: center; font-size: 1.2rem; }
.opposites span { flex: 3; } .opposites span:first-child { text-align: right; }
.choice label { display: flex; gap: .75rem; align-items: center; padding: .25rem .75rem; }
.choice input { margin: .25rem 0; }
.ends { display: flex; justify-content: space-between; color: #667085; font-size: .9rem; }
input[type=range] { width: 100%; height: 2.5rem; }
textarea { width: 100%; font: inherit; padding: .5rem; }
button { font: inherit; margin-top: 2rem; padding: .5rem 2.5rem; border: 0; border-radius: 6px;
  background: #2b5c9e; color: white; cursor: pointer; }
.problem { color: #a33; }
"""


def page_of(title: str, body: str, refresh_s: int = 0) -> str:
    """Return a page; it loads itself again after some seconds if it only waits."""
    again = f'<meta http-equiv="refresh" content="{refresh_s}">' if refresh_s else ""
    return (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">{again}'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{STYLE}</style></head><body>{body}</body></html>\n"
    )


def waiting_page(words: str) -> str:
    """Return the page while nothing is asked: a task is played, or all is done."""
    return page_of("Study", f"<h2>{escape(words)}</h2>", 1)


def text_page(number: int, title: str, text: str) -> str:
    """Return the page of an instruction; `number` says which answer it waits for."""
    body = f'<h1>{escape(title)}</h1><p class="text">{escape(text)}</p>'
    return page_of(title, _form(number, body, "Go on"))


def question_page(
    number: int,
    questionnaire: Questionnaire,
    item: Item,
    shown: Sequence[tuple[str, str, str]] = (),
    pictures: Sequence[str] = (),
    problem: str = "",
) -> str:
    """Return the page of a question.

    Parameters
    ----------
    number
        Which answer it waits for: one that comes twice, or from a page before, counts once.
    questionnaire, item
        What is asked.
    shown
        Address, media type and caption of each stimulus, from left to right.
    pictures
        Address of a picture for each answer; none for words alone.
    problem
        Why the last answer was none; "" for no reason.
    """
    title = questionnaire.title or questionnaire.name
    warning = f'<p class="problem">{escape(problem)}</p>' if problem else ""
    figures = "".join(_figure(*each) for each in shown)
    seen = f'<div class="shown">{figures}</div>' if shown else ""
    asked = f"<h2>{escape(item.text)}</h2>" if item.text else ""
    body = f"<h1>{escape(title)}</h1>{seen}{asked}{warning}{_field(item, pictures)}"
    return page_of(title, _form(number, body, "Go on"))


def _form(number: int, body: str, button: str) -> str:
    return (
        f'<form method="post"><input type="hidden" name="number" value="{number}">{body}'
        f"<button>{button}</button></form>"
    )


def _figure(address: str, kind: str, caption: str) -> str:
    place = escape(address, quote=True)
    words = f"<figcaption>{escape(caption)}</figcaption>" if caption else ""
    if kind.startswith("video/"):
        return f'<figure><video src="{place}" controls autoplay></video>{words}</figure>'
    return f'<figure><img src="{place}" alt="">{words}</figure>'


def _field(item: Item, pictures: Sequence[str]) -> str:
    if item.kind == "text":
        return '<textarea name="answer" rows="4"></textarea>'
    if item.kind == "choice":
        return (
            '<div class="choice">'
            + "".join(
                f'<label><input type="radio" name="answer" value="{n}">{escape(option)}</label>'
                for n, option in enumerate(item.options, 1)
            )
            + "</div>"
        )
    low, high = (item.anchors[0], item.anchors[-1]) if item.anchors else ("", "")
    ends = f'<div class="ends"><span>{escape(low)}</span><span>{escape(high)}</span></div>'
    if item.kind == "slider":
        step = (item.high - item.low) / 200.0
        return (
            f'<input type="range" name="answer" min="{item.low:g}" max="{item.high:g}" '
            f'step="{step:g}">{ends}'
        )
    named = len(item.anchors) == len(item.answers) > 2
    words = item.anchors if named else tuple(f"{point:g}" for point in item.answers)
    # Two opposites stand beside the circles; pictures are for those who do not read.
    if not item.text or (pictures and not named):
        words = ("",) * len(words)
    images = [f'<img src="{escape(place, quote=True)}" alt="">' for place in pictures]
    points = "".join(
        f'<label>{image}<input type="radio" name="answer" value="{point:g}">{escape(word)}</label>'
        for point, word, image in zip(
            item.answers, words, images or ("",) * len(words), strict=True
        )
    )
    if not item.text:
        left, right = f"<span>{escape(low)}</span>", f"<span>{escape(high)}</span>"
        return f'<div class="scale opposites">{left}{points}{right}</div>'
    return f'<div class="scale">{points}</div>{"" if named else ends}'
