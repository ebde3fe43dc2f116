"""The behaviours of hands: `gesture` and `pointing`."""

from dataclasses import replace

from cubeling.characters.behaviour.bml import (
    GESTURE_SYNCS,
    Behaviour,
    CannotRealize,
    Scheduled,
    Timing,
    elastic,
)
from cubeling.characters.behaviour.intents import GestureIntent, Hand, ReachIntent
from cubeling.characters.behaviour.realization.frame import (
    RealizationContext,
    RealizedFrame,
    stroke_times_of,
    times_of,
)
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture

HANDS: dict[str, Hand] = {
    "LEFT_HAND": "left",
    "RIGHT_HAND": "right",
    "BOTH_HANDS": "both",
}
"""Hand of an intent by BML's attribute `mode`."""

POINTING_SPANS_S = (0.6, 0.0, 0.1, 0.1, 0.7, 0.6)
"""Times between the sync points of pointing [s]; it lasts where the eye can follow it."""

HOLDS = frozenset({"ready", "strokeEnd"})
"""Sync points after which hands wait as long as they are to."""


class GestureKind:
    """Performs a gesture of the collection."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times that the gesture has by itself."""
        gesture = _gesture(behaviour, who)
        if gesture.right or gesture.left:
            who.require_arms(behaviour.get("mode"))
        stroke = gesture.stroke * gesture.repeats
        spans = (
            gesture.preparation,
            0.0,
            stroke * gesture.apex,
            stroke * (1.0 - gesture.apex),
            gesture.hold,
            gesture.retraction,
        )
        return elastic(GESTURE_SYNCS, spans, holds=HOLDS)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the gesture by the hand of its `mode`."""
        gesture = _gesture(scheduled.behaviour, who)
        hand = HANDS.get(scheduled.behaviour.get("mode").upper(), "right")
        times = stroke_times_of(scheduled)
        how = who.how(scheduled)
        frame.gestures.append(GestureIntent(scheduled.key, gesture, times, hand, how))


class PointingKind:
    """Points to a place with the index finger."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times of pointing."""
        who.require_arms(behaviour.get("mode"))
        who.surroundings.point(behaviour.get("target"))
        return elastic(GESTURE_SYNCS, POINTING_SPANS_S, holds=HOLDS)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the reach to where the target is now."""
        behaviour = scheduled.behaviour
        hand = HANDS.get(behaviour.get("mode").upper(), "nearest")
        point = who.surroundings.point(behaviour.get("target"))
        times, how = times_of(scheduled), who.how(scheduled)
        frame.reaches.append(ReachIntent(scheduled.key, point, times, "point", hand, how))


def hold(gesture: SymbolicGesture) -> SymbolicGesture:
    """Return a gesture that stays where its first key puts the hands."""
    return replace(gesture, right=gesture.right[:1], left=gesture.left[:1], repeats=1)


def _gesture(behaviour: Behaviour, who: RealizationContext) -> SymbolicGesture:
    lexeme = behaviour.get("lexeme")
    if lexeme not in who.collection:
        raise CannotRealize(f'no gesture is called "{lexeme}"; `cubeling gesture list` names all')
    return who.collection.get(lexeme)
