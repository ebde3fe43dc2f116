"""The gestures of the bundled explorer."""

from collections.abc import Iterator

import numpy as np

from characters.model.character import Character
from characters.skeleton import rotations
from characters.skeleton.pose import Pose, Skeleton
from characters.synthesis.gestures.analysis import bimanual_strength, gesture_strength, masses
from characters.synthesis.gestures.library import (
    GestureLibrary,
    GesturePhrase,
    GestureRecording,
    Hand,
    gesture_joints,
)
from tools.authoring.gestures.timeline import (
    RATE_HZ,
    SIDES,
    BeatSpan,
    UnitBeat,
    UnitCurves,
    unit_curves,
)
from tools.authoring.human.acting import GAZE_PITCH_DEG
from tools.authoring.human.limbs import (
    SIDES as ARMS,
)
from tools.authoring.human.limbs import (
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
            strength = _strength(turns, span, character)
            phrases.append(GesturePhrase(number, span.hand, span.bounds, span.apex, strength))
    rest = recordings[0].turns[0]
    return GestureLibrary(
        skeleton, anatomy, joints, RATE_HZ, rest, tuple(recordings), tuple(phrases)
    )


def units() -> Iterator[tuple[str, list[UnitBeat]]]:
    """Yield name and beats of each unit: three beats of one strength, or rising to a strong one."""
    hands: tuple[Hand, ...]
    for family, shapes, hands in _FAMILIES:
        for strength in ("weak", "neutral", "strong"):
            beats = [
                UnitBeat(shape, strength, hand) for shape, hand in zip(shapes, hands, strict=True)
            ]
            yield f"{family} {strength}", beats


_FAMILIES: tuple[tuple[str, tuple[str, str, str], tuple[Hand, Hand, Hand]], ...] = (
    ("chop", ("chop", "chop", "sweep"), ("right", "right", "right")),
    ("open", ("palm up", "offer", "open"), ("both", "both", "both")),
    ("precise", ("precision", "precision", "flick"), ("left", "left", "left")),
    ("pound", ("fist", "press", "fist"), ("right", "both", "both")),
    ("weigh", ("weigh", "weigh", "palm up"), ("left", "right", "both")),
    ("self", ("self", "toss", "palm up"), ("right", "right", "right")),
    ("circle", ("circle", "wag", "toss"), ("left", "left", "left")),
)
"""Shapes and hands of the beats of each family of units."""


def unit_poses(skeleton: Skeleton, curves: UnitCurves) -> Pose:
    """Return the poses of a unit, (frames, joints, …), on a body that stands still."""
    frames = len(curves.lean)
    rig = PosedRig(skeleton, frames)
    for name, part in (("spine1", 0.3), ("spine2", 0.35), ("chest", 0.35)):
        own = {"spine1": 0.0, "spine2": 1.0, "chest": 1.5}[name]
        rig.turn(name, rotation_deg(own + part * curves.lean, part * curves.twist))
    gaze = rotation_deg(GAZE_PITCH_DEG + curves.nod, 0.15 * curves.twist)
    above = rotations.multiply(rotations.conjugate(rig.facing("chest")), gaze)
    rig.turn("neck", rotations.slerp(rotations.IDENTITY, above, 0.4))
    rig.face("head", gaze)
    still = np.zeros(frames)
    for side, sign in ARMS:
        share, rows = curves.share[side], curves.hands[side]
        rig.turn(f"{side}Shoulder", rotation_deg(still, 0, sign * (1.0 + curves.shrug[side])))
        hang_arm(rig, side, sign, 3.0 + still, 24.0)
        rig.turn(f"{side}ForeArm", elbow_rotation(rig, side, sign, 19.0 + still, 12.0 + still))
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


def _strength(turns: Array, span: BeatSpan, character: Character) -> float:
    """Return the GSI of a stroke."""
    stroke = turns[span.bounds[2] : span.bounds[3] + 1]
    found = [
        gesture_strength(stroke, masses(character.anatomy, side.lower()), RATE_HZ)
        for side in SIDES[span.hand]
    ]
    return found[0] if len(found) == 1 else bimanual_strength((found[0], found[1]), (0.0, 0.0))
