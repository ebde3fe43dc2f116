"""The behaviours of head and eyes: `head`, `headDirectionShift`, `gaze` and `gazeShift`."""

import math
from dataclasses import replace
from typing import get_args

from cubeling.characters.behaviour.bml import (
    GESTURE_SYNCS,
    HOLD_SYNCS,
    SHIFT_SYNCS,
    Behaviour,
    CannotRealize,
    Scheduled,
    Timing,
    elastic,
)
from cubeling.characters.behaviour.intents import GazeIntent, HeadIntent, Influence, Times
from cubeling.characters.behaviour.realization.frame import (
    RealizationContext,
    RealizedFrame,
    number,
    shift_times_of,
    stroke_times_of,
    tempo_of,
    times_of,
)
from cubeling.characters.behaviour.realization.head_movements import HALF_AMOUNT, HEAD_MOVEMENTS
from cubeling.characters.behaviour.realization.surroundings import DIRECTIONS
from cubeling.characters.skeleton.pose import Array

SWING_S = 0.45
"""Time of one nod, or of one turn to and fro [s]."""

HEAD_SPANS_S = (0.2, 0.0, 0.2, 0.25, 0.0, 0.25)
"""Times between the sync points of a nod or shake, without its swings [s]."""

TURN_SPANS_S = (0.4, 0.0, 0.1, 0.1, 0.5, 0.5)
"""Times between the sync points of a head that stays turned [s]."""

GAZE_SPANS_S = (0.5, 1.0, 0.5)
"""Times between the sync points of a look [s]."""

SHIFT_S = 0.5
"""Time of a shift of gaze or head [s]."""

MAX_REPEATS = 20
"""Nods of one behaviour; more are a typing error."""

INFLUENCES: tuple[Influence, ...] = get_args(Influence)


class HeadKind:
    """Nods, shakes, tilts and turns the head."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of the movement, with all its swings."""
        who.require_head()
        lexeme = _movement(behaviour)
        if HEAD_MOVEMENTS[lexeme].held:
            turn = tuple(span / tempo_of(behaviour) for span in TURN_SPANS_S)
            return elastic(GESTURE_SYNCS, turn, holds=frozenset({"ready", "strokeEnd"}))
        swings = _repeats(behaviour)
        first = SWING_S / (4 if HEAD_MOVEMENTS[lexeme].to_and_fro else 2)
        spans = (HEAD_SPANS_S[0], 0.0, first, SWING_S * swings - first, 0.0, HEAD_SPANS_S[-1])
        tempo = tempo_of(behaviour)
        natural = elastic(GESTURE_SYNCS, tuple(span / tempo for span in spans))
        # A head that has more time goes on to nod; it does not wait.
        return replace(natural, longest=(*natural.longest[:3], math.inf, *natural.longest[4:]))

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the movement; one that takes longer has more swings unless their number is told."""
        behaviour, times = scheduled.behaviour, stroke_times_of(scheduled)
        repeats = _repeats(behaviour)
        if not behaviour.get("repetition"):
            lasting = times.stroke_end - times.stroke_start
            repeats = min(max(round(lasting / (1.6 * SWING_S)), 1), MAX_REPEATS)
        amount = number(behaviour, "amount", HALF_AMOUNT, 0.0, 1.0)
        frame.heads.append(HeadIntent(scheduled.key, _movement(behaviour), times, amount, repeats))


class GazeKind:
    """Looks at a place for a while."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of a look, which lasts as long as it is to."""
        who.require_head()
        _gaze_target(behaviour, who)
        return elastic(
            HOLD_SYNCS, GAZE_SPANS_S, holds=frozenset({"ready"}), occupies=frozenset({"gaze"})
        )

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the look to where the target is now."""
        look(scheduled, times_of(scheduled), who, frame)


class GazeShiftKind:
    """Looks at a place until further notice; the head alone turns so for `headDirectionShift`."""

    channel = "gaze"

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of a turn."""
        who.require_head()
        _gaze_target(behaviour, who)
        return elastic(SHIFT_SYNCS, (SHIFT_S,), least=0.2, most=math.inf)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the look to where the target is now."""
        look(scheduled, shift_times_of(scheduled), who, frame)


def look(scheduled: Scheduled, times: Times, who: RealizationContext, frame: RealizedFrame) -> None:
    """Add a look at the target of a behaviour; with WHOLE, the feet turn too."""
    point = _gaze_target(scheduled.behaviour, who)
    influence = _influence(scheduled.behaviour)
    frame.gazes.append(GazeIntent(scheduled.key, point, times, influence))
    released = times.relax is not None and frame.now >= times.relax
    if influence == "WHOLE" and not released:
        frame.facing = point


def _gaze_target(behaviour: Behaviour, who: RealizationContext) -> Array:
    point = who.surroundings.point(behaviour.get("target"))
    angle = math.radians(number(behaviour, "offsetAngle", 0.0, -180.0, 180.0))
    if not angle:
        return point
    direction = behaviour.get("offsetDirection", "RIGHT").upper()
    if direction not in DIRECTIONS:
        raise CannotRealize(f'offsetDirection="{direction}" is none of {", ".join(DIRECTIONS)}')
    left, up = DIRECTIONS[direction]
    return who.surroundings.point_aside(point, angle * left, angle * up)


def _influence(behaviour: Behaviour) -> Influence:
    given = behaviour.get("influence").upper()
    return next((each for each in INFLUENCES if each == given), "NECK")


def _movement(behaviour: Behaviour) -> str:
    lexeme = behaviour.get("lexeme").upper()
    if lexeme not in HEAD_MOVEMENTS:
        raise CannotRealize(f'a head cannot "{lexeme}"; choose one of {", ".join(HEAD_MOVEMENTS)}')
    return lexeme


def _repeats(behaviour: Behaviour) -> int:
    return round(number(behaviour, "repetition", 1.0, 1.0, MAX_REPEATS))
