"""Scripts for tests."""

from pathlib import Path

from cubeling.characters.dialogue.kernel import Dialogue
from cubeling.characters.dialogue.reading import read_script


def dialogue(folder: Path, units: str, *, seed: int = 0, languages: str = "en") -> Dialogue:
    """Return a dialogue of some units."""
    path = folder / "script.xml"
    path.write_text(f'<dialogue languages="{languages}">\n{units}\n</dialogue>')
    return Dialogue(read_script(path), seed=seed)


def said(dialogue: Dialogue, text: str, now: float = 0.0, **given: object) -> str:
    """Return what a dialogue answers; "" for nothing."""
    dialogue.hear(text)
    turn = dialogue.update(now, **given)  # type: ignore[arg-type]
    return "" if turn is None else turn.text


def unit(name: str, pattern: str, text: str, **attributes: str) -> str:
    """Return a unit that answers a pattern, in the two steps of Egges' example."""
    given = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return (
        f'<unit name="{name}"{given}><state name="q0"><transition to="q1">'
        f'<condition type="input_match">{pattern}</condition></transition></state>'
        f'<state name="q1"><transition to="q2"><action type="say">{text}</action></transition>'
        '</state><state name="q2" accepting="yes"/></unit>'
    )
