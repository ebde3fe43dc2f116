"""The behaviours of the whole body: `posture`, `postureShift`, `locomotion` and `wait`."""

import math
from collections.abc import Iterator

from cubeling.characters.behaviour.bml import (
    HOLD_SYNCS,
    SHIFT_SYNCS,
    Behaviour,
    CannotRealize,
    Scheduled,
    Timing,
    elastic,
)
from cubeling.characters.behaviour.intents import GestureIntent, PostureIntent, StrokeTimes, Times
from cubeling.characters.behaviour.realization.frame import (
    Going,
    Manner,
    RealizationContext,
    RealizedFrame,
    number,
    shift_times_of,
    times_of,
)
from cubeling.characters.behaviour.realization.hand_kinds import hold
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture

POSTURE_SPANS_S = (0.9, 1.5, 0.9)
"""Times between the sync points of a posture [s]."""

SHIFT_S = 1.0
"""Time in which a body takes another posture [s]."""

WAIT_S = 1.0
"""Time of a wait that says nothing [s]."""

MAX_POSES = 8
"""Stances and poses of one posture: the arms perform each in every frame."""

UPRIGHT = ("STANDING", "NEUTRAL", "BALANCED")
"""Names of the posture that a body has by itself."""

ARM_POSTURES = {"ARMS_AKIMBO": "HANDS_ON_HIPS", "ARMS_CROSSED": "CROSS_ARMS"}
"""Gestures with which arms take postures that are named otherwise."""

RUNNING = ("run", "running", "fast", "hurry")
"""Manners of going that are running."""


class PostureKind:
    """Takes a posture for a while."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of a posture, which lasts as long as it is to."""
        _check_posture(behaviour, who)
        return elastic(HOLD_SYNCS, POSTURE_SPANS_S, holds=frozenset({"ready"}))

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the posture, and the arms' share of it as a held gesture."""
        take(scheduled, times_of(scheduled), who, frame)


class PostureShiftKind:
    """Takes a posture until further notice."""

    channel = "posture"

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of the change."""
        _check_posture(behaviour, who)
        return elastic(SHIFT_SYNCS, (SHIFT_S,), least=0.3, most=math.inf)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the posture, which stays when the behaviour is over."""
        take(scheduled, shift_times_of(scheduled), who, frame)


class LocomotionKind:
    """Walks, runs or hops to a place on the table."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the time that the way takes from where the character is."""
        target = who.surroundings.point(behaviour.get("target"))[[0, 2]]
        span = max(who.walk_time(target, _manner(behaviour)), 0.1)
        return elastic(SHIFT_SYNCS, (span,), least=0.3, most=math.inf)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Go to where the target is now."""
        target = who.surroundings.point(scheduled.behaviour.get("target"))[[0, 2]]
        frame.going = Going(scheduled.key, scheduled.end, target, _manner(scheduled.behaviour))


class WaitKind:
    """Does nothing for a while."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the time to wait."""
        span = number(behaviour, "duration", WAIT_S, 0.0, 3600.0)
        return elastic(SHIFT_SYNCS, (span,), holds=frozenset({"start"}))

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Do nothing: only its times count, for what is tied to them."""


def take(scheduled: Scheduled, times: Times, who: RealizationContext, frame: RealizedFrame) -> None:
    """Add a posture of trunk and legs, and one of the arms as a gesture that is held."""
    names = [*_names(scheduled.behaviour)]
    stance = "+".join(name for name in names if who.stances.knows(name)) or UPRIGHT[0]
    frame.postures.append(PostureIntent(scheduled.key, stance, times))
    for name in names:
        arms = _arms(name, who)
        if arms is not None:
            strokes = StrokeTimes(
                times.start, times.ready, times.relax, times.end, *(times.ready,) * 3
            )
            key = f"{scheduled.key}:{name}"
            frame.gestures.append(
                GestureIntent(key, hold(arms), strokes, "both", who.how(scheduled))
            )


def _check_posture(behaviour: Behaviour, who: RealizationContext) -> None:
    """Refuse a posture of which the body can do nothing."""
    names = [*_names(behaviour)]
    if len(names) > MAX_POSES:
        raise CannotRealize(f"a posture of more than {MAX_POSES} stances and poses")
    able = [
        name
        for name in names
        if name in UPRIGHT or who.stances.knows(name) or _arms(name, who) is not None
    ]
    if not able:
        asked = ", ".join(names) or "a posture without stance, pose or lexeme"
        raise CannotRealize(f"{who.character.name} cannot take {asked}")


def _arms(name: str, who: RealizationContext) -> SymbolicGesture | None:
    """Return the gesture with which arms take a posture; None if it is no posture of arms."""
    lexeme = ARM_POSTURES.get(name, name)
    if who.arms and not who.stances.knows(name) and lexeme in who.collection:
        return who.collection.get(lexeme)
    return None


def _names(behaviour: Behaviour) -> Iterator[str]:
    """Yield the stance and the poses of a behaviour."""
    if behaviour.get("lexeme"):
        yield behaviour.get("lexeme").upper()
    for child in behaviour.children:
        name = child.attributes.get("type") or child.attributes.get("lexeme")
        if name:
            yield name.upper()


def _manner(behaviour: Behaviour) -> Manner:
    return "run" if behaviour.get("manner").lower() in RUNNING else "walk"
