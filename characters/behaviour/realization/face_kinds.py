"""The behaviours of faces: `face`, `faceLexeme`, `faceFacs` and `faceShift`."""

import math
from collections.abc import Iterator, Mapping

from cubeling.characters.behaviour.bml import (
    FACE_SYNCS,
    SHIFT_SYNCS,
    Behaviour,
    BmlElement,
    CannotRealize,
    Scheduled,
    Timing,
    elastic,
)
from cubeling.characters.behaviour.intents import FaceIntent
from cubeling.characters.behaviour.realization.frame import (
    RealizationContext,
    RealizedFrame,
    shift_times_of,
    times_of,
)
from cubeling.characters.behaviour.realization.surroundings import numbers_of

FACE_SPANS_S = (0.4, 1.2, 0.5)
"""Times between the sync points of an expression [s]."""

SHIFT_S = 0.6
"""Time in which a face takes on another expression [s]."""


USUAL_AMOUNT = 0.5
"""How much of an expression is shown if a behaviour does not tell, as in the standard."""


class FaceKind:
    """Shows something on the face for a while."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of an expression, which lasts as long as it is to."""
        _face_weights(behaviour, who)
        return elastic(FACE_SYNCS, FACE_SPANS_S, holds=frozenset({"attackPeak"}))

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the expression, with its peak at "attackPeak"."""
        names, weights = _face_weights(scheduled.behaviour, who)
        times = times_of(scheduled, "attackPeak")
        frame.faces.append(FaceIntent(scheduled.key, names, weights, times))


class FaceShiftKind:
    """Shows something on the face until further notice."""

    channel = "face"

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times in which the face changes."""
        _face_weights(behaviour, who)
        return elastic(SHIFT_SYNCS, (SHIFT_S,), least=0.2, most=math.inf)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the expression, which stays when the behaviour is over."""
        names, weights = _face_weights(scheduled.behaviour, who)
        times = shift_times_of(scheduled)
        frame.faces.append(FaceIntent(scheduled.key, names, weights, times))


def _face_weights(
    behaviour: Behaviour, who: RealizationContext
) -> tuple[tuple[str, ...], tuple[float, ...]]:
    """Return the names and weights that a behaviour and its children give."""
    found = [*_names_and_weights(behaviour, USUAL_AMOUNT)]
    if not found:
        raise CannotRealize("an expression without a lexeme, au or name")
    unknown = [name for name, _ in found if who.faces.weights(name) is None]
    if len(unknown) == len(found):
        raise CannotRealize(f"the face of {who.character.name} cannot show {', '.join(unknown)}")
    names, weights = zip(*found, strict=True)
    return names, weights


def _names_and_weights(
    element: Behaviour | BmlElement, usual: float
) -> Iterator[tuple[str, float]]:
    given: Mapping[str, str] = element.attributes
    amount = _amount(given, usual)
    unit, side = given.get("au", "").strip(), given.get("side", "BOTH").upper()
    if unit:
        yield f"AU{unit}" + ("" if side == "BOTH" else f"_{side}"), amount
    for attribute in ("lexeme", "type", "name"):
        if given.get(attribute):
            yield given[attribute], amount
    for child in element.children:
        yield from _names_and_weights(child, amount)


def _amount(attributes: Mapping[str, str], usual: float) -> float:
    text = attributes.get("amount") or attributes.get("intensity") or ""
    found = numbers_of(text)
    return min(max(found[0], 0.0), 1.0) if len(found) == 1 else usual
