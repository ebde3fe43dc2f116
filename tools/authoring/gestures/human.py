"""The gestures of the bundled explorer."""

from collections.abc import Iterator

import numpy as np

from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.characters.synthesis.gestures.learning import stroke_strength
from cubeling.characters.synthesis.gestures.library import (
    GestureLibrary,
    GesturePhrase,
    GestureRecording,
    Hand,
    gesture_joints,
)
from tools.authoring.gestures.timeline import (
    RATE_HZ,
    UnitBeat,
    UnitCurves,
    unit_curves,
)
from tools.authoring.human.acting import GAZE_PITCH_DEG
from tools.authoring.human.limbs import (
    SIDES as ARMS,
    HandTarget,
    elbow_rotation,
    hang_arm,
    reach_target,
    rotation_deg,
)
from tools.authoring.human.rig import along_forearm
from tools.authoring.modelling.rig import PosedRig
from tools.authoring.modelling.shapes import Array

REST_BEND_DEG = 18.0
"""Bend of the fingers of hanging hands [degrees]."""

FINGERS = ("Thumb", "Index", "Middle", "Pinky")
"""The fingers, in the order of `HandShape.bends`."""


def human_gestures(character: Character) -> GestureLibrary:
    """Return the library; the result is always the same."""
    skeleton, anatomy = character.skeleton, character.anatomy
    joints = gesture_joints(skeleton, anatomy)
    recordings, phrases = [], []
    for number, (name, beats) in enumerate(units()):
        curves = unit_curves(beats, seed=number)
        poses = unit_poses(skeleton, curves)
        turns = rotations.continuous(poses.rotations)
        recordings.append(GestureRecording(name, turns[:, list(joints)]))
        for span in curves.spans:
            stroke = turns[span.bounds[2] : span.bounds[3] + 1]
            strength = stroke_strength(stroke, span.hand, anatomy)
            phrases.append(GesturePhrase(number, span.hand, span.bounds, span.apex, strength))
    rest = np.mean([each.turns[0] for each in recordings], axis=0)
    rest /= np.linalg.norm(rest, axis=-1, keepdims=True)
    return GestureLibrary(
        skeleton, anatomy, joints, RATE_HZ, rest, tuple(recordings), tuple(phrases)
    )


def units() -> Iterator[tuple[str, list[UnitBeat]]]:
    """Yield name and beats of each unit."""
    hands: dict[str, Hand] = {"L": "left", "R": "right", "B": "both"}
    for strength, texts in UNITS.items():
        for text in texts:
            pairs = [each.strip().split(" ", 1) for each in text.split(",")]
            beats = [UnitBeat(shape, strength, hands[hand]) for hand, shape in pairs]
            yield f"{strength}: {', '.join(beat.shape for beat in beats)}", beats


UNITS = {
    "weak": (
        "R chop, R precision, R flick",
        "B palm up, L weigh, R weigh",
        "L precision, L precision, L flick",
        "B offer, B palm up, B open",
        "L circle, L flick, L palm up",
        "R self, R palm up, R flick",
        "R wag, R wag, R toss",
        "B press, B press, B sweep",
    ),
    "neutral": (
        "L chop, L chop, L sweep",
        "B palm up, B offer, B open",
        "R precision, R precision, R flick",
        "R fist, B press, B palm up",
        "L weigh, R weigh, B palm up",
        "R circle, R toss, R offer",
        "L self, L toss, B open",
        "L wag, R chop, B chop",
    ),
    "strong": (
        "R chop, R chop, R sweep",
        "B palm up, B offer, B open",
        "L fist, L fist, L toss",
        "R fist, B press, B fist",
        "B chop, B chop, B sweep",
        "R self, R toss, B open",
        "R wag, R wag, R sweep",
        "L weigh, R weigh, B press",
    ),
}
"""Units by strength: for each beat the hand, left, right or both, and the shape."""


def unit_poses(skeleton: Skeleton, curves: UnitCurves) -> Pose:
    """Return the poses of a unit, (frames, joints, …), on a body that stands still."""
    frames = len(curves.lean)
    rig = PosedRig(skeleton, frames)
    for name, upright, part in (("spine1", 0.0, 0.3), ("spine2", 1.0, 0.35), ("chest", 1.5, 0.35)):
        rig.turn(name, rotation_deg(upright + part * curves.lean, part * curves.twist))
    gaze = rotation_deg(GAZE_PITCH_DEG + curves.nod, 0.15 * curves.twist)
    above = rotations.multiply(rotations.conjugate(rig.facing("chest")), gaze)
    rig.turn("neck", rotations.slerp(rotations.IDENTITY, above, 0.4))
    rig.face("head", gaze)
    still = np.zeros(frames)
    for number, (side, sign) in enumerate(ARMS):
        share, rows = curves.share[side], curves.hands[side]
        rig.turn(f"{side}Shoulder", rotation_deg(still, 0, sign * (1.0 + curves.shrug[side])))
        swing, bend = curves.hanging[number]
        hang_arm(rig, side, sign, swing + 0.5 * curves.lean, 24.0)
        flexed = bend + 1.5 * curves.lean  # a hand that rests moves along a little
        rig.turn(f"{side}ForeArm", elbow_rotation(rig, side, sign, flexed, 12.0 + still))
        rig.turn(f"{side}Hand", rotation_deg(-4.0 + still, 0, -sign * 3.0))
        wrist, fingers, thumb, elbow = (rows[:, n : n + 3] for n in (0, 3, 6, 9))
        reach_target(rig, side, sign, HandTarget(wrist, fingers, thumb, elbow, share))
        _bend_fingers(rig, side, rows[:, 12:], share)
    return rig.pose


def _bend_fingers(rig: PosedRig, side: str, bends: Array, share: Array) -> None:
    """Bend each finger by its own angle, (frames, 4) [degrees], as far as the hand is raised."""
    away, front, inward = along_forearm()
    flip = np.array([1.0, -1.0, -1.0]) if side == "Right" else np.ones(3)
    raised = np.clip(share, 0.0, 1.0)
    for number, finger in enumerate(FINGERS):
        hanging = REST_BEND_DEG * (0.45 if finger == "Thumb" else 1.0)
        axis = np.cross(front if finger == "Thumb" else away, inward) * flip
        angle = hanging + (np.maximum(bends[:, number], 0.0) - hanging) * raised
        turn = rotations.about(axis, np.radians(angle))
        rig.turn(f"{side}Hand{finger}1", turn)
        rig.turn(f"{side}Hand{finger}2", turn)
