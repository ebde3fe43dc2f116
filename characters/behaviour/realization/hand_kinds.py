"""The behaviours `gesture` and `pointing`: hands, and what else the gesticon finds for a name."""

from dataclasses import replace

from cubeling.characters.behaviour.bml import (
    CUBELING,
    GESTURE_SYNCS,
    Behaviour,
    CannotRealize,
    Scheduled,
    Timing,
    elastic,
)
from cubeling.characters.behaviour.gesticon import Gesticon, Meaning
from cubeling.characters.behaviour.intents import (
    ClipIntent,
    FaceIntent,
    GestureIntent,
    Hand,
    PostureIntent,
    ReachIntent,
)
from cubeling.characters.behaviour.realization.frame import (
    RealizationContext,
    RealizedFrame,
    number,
    stroke_times_of,
    tempo_of,
    times_of,
)
from cubeling.characters.behaviour.realization.head_kinds import HeadKind
from cubeling.characters.behaviour.symbolic_gesture import SymbolicGesture

HANDS: dict[str, Hand] = {
    "LEFT_HAND": "left",
    "RIGHT_HAND": "right",
    "BOTH_HANDS": "both",
}
"""Hand of an intent by BML's attribute `mode`."""

POINTING_SPANS_S = (0.6, 0.0, 0.1, 0.1, 0.7, 0.6)
"""Times between the sync points of pointing [s]; it lasts where the eye can follow it."""

SHOWN_SPANS_S = (0.4, 0.0, 0.2, 0.4, 0.4, 0.5)
"""Times between the sync points of a face or a posture that a gesture's name leads to [s]."""

CLIP_FADES_S = (0.25, 0.3)
"""How long a clip takes to join in, and to go [s]."""

HOLDS = frozenset({"ready", "strokeEnd"})
"""Sync points after which hands wait as long as they are to."""


class GestureKind:
    """Performs a gesture of the collection, or what else its name leads to."""

    channel = ""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the times that the gesture has by itself."""
        meaning = meaning_of(behaviour, who)
        match meaning.kind:
            case "head":
                return HEAD.timing(_with_lexeme(behaviour, meaning), who)
            case "clip":
                joining, going = CLIP_FADES_S
                middle = max(who.character.clips[meaning.name].duration - joining - going, 0.2) / 2
                spans = (joining, 0.0, middle, middle, 0.0, going)
                return elastic(GESTURE_SYNCS, spans, least=0.25, most=6.0)
            case "face" | "posture":
                return elastic(GESTURE_SYNCS, SHOWN_SPANS_S, holds=HOLDS)
        gesture = who.collection.get(meaning.name)
        if gesture.right or gesture.left:
            who.require_arms(behaviour.get("mode"))
        tempo = tempo_of(behaviour)
        stroke = gesture.stroke * gesture.repeats
        spans = (
            gesture.preparation,
            0.0,
            stroke * gesture.apex,
            stroke * (1.0 - gesture.apex),
            gesture.hold,
            gesture.retraction,
        )
        return elastic(GESTURE_SYNCS, tuple(span / tempo for span in spans), holds=HOLDS)

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add the gesture by the hand of its `mode`, or what else its name leads to."""
        behaviour, key = scheduled.behaviour, scheduled.key
        meaning = meaning_of(behaviour, who)
        match meaning.kind:
            case "head":
                called = replace(scheduled, behaviour=_with_lexeme(behaviour, meaning))
                HEAD.realize(called, who, frame)
            case "clip":
                frame.clips.append(ClipIntent(key, meaning.name, stroke_times_of(scheduled)))
            case "face":
                amount = number(behaviour, "amount", 1.0, 0.0, 1.0)
                times = times_of(scheduled)
                frame.faces.append(FaceIntent(key, (meaning.name,), (amount,), times))
            case "posture":
                frame.postures.append(PostureIntent(key, meaning.name, times_of(scheduled)))
            case _:
                gesture = who.collection.get(meaning.name)
                hand = HANDS.get(behaviour.get("mode").upper(), "right")
                times, how = stroke_times_of(scheduled), who.how(scheduled)
                frame.gestures.append(GestureIntent(key, gesture, times, hand, how))


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


def meaning_of(behaviour: Behaviour, who: RealizationContext) -> Meaning:
    """Return what the lexeme of a gesture leads to, as far as this body can do it.

    The gestures of the collection go first, then the gesticon, then clips and faces of that name.

    Raises
    ------
    CannotRealize
        If it leads to nothing.
    """
    lexeme, clip = behaviour.get("lexeme"), behaviour.get("clip", namespace=CUBELING)
    if clip in who.character.clips:
        return Meaning("clip", clip)
    if lexeme in who.collection:
        return Meaning("gesture", lexeme)
    meaning = Gesticon.bundled().meaning(lexeme)
    if meaning is not None and _can(meaning, who):
        return meaning
    if lexeme in who.character.clips:
        return Meaning("clip", lexeme)
    if lexeme and who.faces.weights(lexeme) is not None:
        return Meaning("face", lexeme)
    if meaning is not None:
        raise CannotRealize(f"{who.character.name} cannot show {lexeme} ({meaning.name})")
    raise CannotRealize(f'no gesture is called "{lexeme}"; `cubeling gesture list` names all')


def _can(meaning: Meaning, who: RealizationContext) -> bool:
    match meaning.kind:
        case "gesture":
            return meaning.name in who.collection
        case "head":
            return who.character.anatomy.joint("head") is not None
        case "face":
            return who.faces.weights(meaning.name) is not None
        case "posture":
            return who.stances.knows(meaning.name)
    return False


def _with_lexeme(behaviour: Behaviour, meaning: Meaning) -> Behaviour:
    return replace(behaviour, attributes={**behaviour.attributes, "lexeme": meaning.name})


HEAD = HeadKind()
"""Performs the movements of the head that gestures' names lead to."""
