"""The acts of a wizard in a session: what was done, after which cue, and what was an error."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from cubeling.app.pipeline.table.acts import Act
from cubeling.app.session.inputs import RecordedInputs


@dataclass(frozen=True)
class WizardAct:
    """Something that a wizard did."""

    number: int
    """In its session, from 1."""

    at_s: float
    """Time of the frame in which it began, from the first frame [s]."""

    kind: str
    """Its kind, as of `Act`."""

    name: str
    """What was done: the text, the gesture, the action, the emotion, the place in centimetres."""

    cue: str
    """The cue that it answers; "" for none."""

    delay_s: float | None
    """Time from the cue to the act at the desk [s]; None without a cue."""

    undone: bool = False
    """Whether the wizard took it back as an error."""


def wizard_acts(inputs: Mapping[float, RecordedInputs], first: float) -> tuple[WizardAct, ...]:
    """Return a wizard's acts in their order, without the cues.

    Parameters
    ----------
    inputs
        What came in with the frames, by their timestamps [s].
    first
        Timestamp of the first frame [s].
    """
    found: dict[int, WizardAct] = {}
    wrong_cues = set[int]()
    cue_numbers: dict[str, int] = {}
    answered: dict[int, int] = {}  # the number of the cue that an act answers
    for time in sorted(inputs):
        for act in inputs[time].acts:
            note = act.note
            if note is None:
                continue
            if act.kind == "undo":
                wrong_cues.add(note.number)
                if note.number in found:
                    found[note.number] = replace(found[note.number], undone=True)
            elif act.kind == "cue":
                cue_numbers[act.text] = note.number
            else:
                at = round(time - first, 6)
                name = act_words(act)
                found[note.number] = WizardAct(
                    note.number, at, act.kind, name, note.cue, note.delay_s
                )
                answered[note.number] = cue_numbers.get(note.cue, 0)
    return tuple(
        replace(act, cue="", delay_s=None) if answered[act.number] in wrong_cues else act
        for act in found.values()
    )


def act_words(act: Act) -> str:
    """Return what an act does, in words.

    >>> act_words(Act("go", place=(0.1, -0.05))), act_words(Act("emotion"))
    ('10, -5 cm', 'release')
    """
    if act.kind == "go":
        place = act.place
        return "release" if place is None else f"{100 * place[0]:.0f}, {100 * place[1]:.0f} cm"
    if act.kind == "emotion":
        return "release" if act.emotion is None else act.emotion.label
    return act.text
