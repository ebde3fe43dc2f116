"""A performer with fixed estimates, for tests in virtual time."""

from itertools import pairwise

from cubeling.characters.behaviour.bml import (
    BMLA,
    FACE_SYNCS,
    GESTURE_SYNCS,
    HOLD_SYNCS,
    SHIFT_SYNCS,
    Behaviour,
    Block,
    CannotRealize,
    Timing,
    elastic,
    rigid,
)

CHARACTERS_PER_SECOND = 15.0


class Estimates:
    """Times speech by its characters and everything else by its kind."""

    def timing(self, behaviour: Behaviour, block: Block) -> Timing:
        if behaviour.namespace == BMLA and behaviour.kind == "parametervaluechange":
            return self.parameter(behaviour)
        of_kind = getattr(self, f"of_{behaviour.kind}", None)
        if of_kind is None:
            raise CannotRealize(f"no {behaviour.kind} is known")
        timing: Timing = of_kind(behaviour)
        return timing

    def parameter(self, behaviour: Behaviour) -> Timing:
        if behaviour.get("paramId") != "volume":
            raise CannotRealize(f"no parameter {behaviour.get('paramId')}")
        return elastic(SHIFT_SYNCS, (0.5,), holds=frozenset({"start"}))

    def of_speech(self, behaviour: Behaviour) -> Timing:
        marks = [(mark.id, mark.at) for mark in behaviour.marks]
        places = [0, *(at for _, at in marks), len(behaviour.text)]
        names = ("start", *(name for name, _ in marks), "end")
        return rigid(names, tuple((b - a) / CHARACTERS_PER_SECOND for a, b in pairwise(places)))

    def of_gesture(self, behaviour: Behaviour) -> Timing:
        hands = behaviour.get("mode", "RIGHT_HAND")
        used = {"BOTH_HANDS": ("left", "right"), "LEFT_HAND": ("left",)}.get(hands, ("right",))
        return elastic(
            GESTURE_SYNCS,
            (0.4, 0.0, 0.3, 0.2, 0.2, 0.4),
            holds=frozenset({"ready", "strokeEnd"}),
            occupies=frozenset(f"{hand} hand" for hand in used),
        )

    of_pointing = of_gesture

    def of_head(self, behaviour: Behaviour) -> Timing:
        spans = (0.1, 0.0, 0.2, 0.2, 0.0, 0.2)
        return elastic(GESTURE_SYNCS, spans, holds=frozenset({"ready", "strokeEnd"}))

    def of_gaze(self, behaviour: Behaviour) -> Timing:
        holds, what = frozenset({"ready"}), frozenset({"gaze"})
        return elastic(HOLD_SYNCS, (0.2, 1.0, 0.2), holds=holds, occupies=what)

    def of_posture(self, behaviour: Behaviour) -> Timing:
        timing = elastic(HOLD_SYNCS, (0.5, 1.0, 0.5), holds=frozenset({"ready"}))
        return Timing(timing.syncs, timing.spans, timing.shortest, timing.longest, persistent=True)

    def of_face(self, behaviour: Behaviour) -> Timing:
        return elastic(FACE_SYNCS, (0.2, 0.6, 0.2), holds=frozenset({"attackPeak"}))

    of_faceLexeme = of_faceFacs = of_face  # noqa: N815

    def of_gazeShift(self, behaviour: Behaviour) -> Timing:  # noqa: N802
        return elastic(SHIFT_SYNCS, (0.4,), least=0.2, most=10.0)

    of_postureShift = of_headDirectionShift = of_faceShift = of_gazeShift  # noqa: N815

    def of_locomotion(self, behaviour: Behaviour) -> Timing:
        return elastic(SHIFT_SYNCS, (2.0,), occupies=frozenset({"legs"}))

    def of_wait(self, behaviour: Behaviour) -> Timing:
        return elastic(SHIFT_SYNCS, (1.0,), holds=frozenset({"start"}))
