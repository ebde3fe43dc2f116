"""Rotations of the bundled explorer's limbs, in degrees of anatomical movements."""

from typing import NamedTuple

import numpy as np

from cubeling.characters.skeleton import rotations
from tools.authoring.human.rig import FINGERS, along_forearm
from tools.authoring.modelling.gait import FootDimensions
from tools.authoring.modelling.ik import aim_rotation
from tools.authoring.modelling.rig import PosedRig
from tools.authoring.modelling.shapes import Array

FOOT = FootDimensions(ankle=0.095, heel=-0.05, ball=(0.03, 0.115), toes=0.09)
SIDES = (("Left", 1.0), ("Right", -1.0))


class HandTarget(NamedTuple):
    """Target of a hand, as curves in the rest axes of the chest; mirrored for the right hand."""

    wrist: Array
    """(frames, 3) or (3,) in the rest pose [m]."""

    fingers: Array
    """Direction of the fingers, (frames, 3) or (3,)."""

    thumb: Array
    """Direction of the thumb, (frames, 3) or (3,)."""

    elbow: Array
    """Direction of the elbow, (frames, 3) or (3,)."""

    share: Array
    """Weight of the target, (frames,), 0…1."""


def rotation_deg(x: Array | float = 0, y: Array | float = 0, z: Array | float = 0) -> Array:
    """Return the rotation about y, then x, then z of the body, in degrees."""
    x, y, z = np.broadcast_arrays(x, y, z)
    return rotations.from_euler("yxz", np.radians(np.stack([y, x, z], axis=-1)))


def hang_arm(rig: PosedRig, side: str, sign: float, swing: Array, lower: Array | float) -> None:
    """Lower an arm from the A-pose towards the body and swing it forward [degrees]."""
    lowered = rotation_deg(z=-sign * np.asarray(lower) + 0 * swing)
    rig.turn(f"{side}Arm", rotations.multiply(rotation_deg(x=-swing), lowered))


def elbow_rotation(rig: PosedRig, side: str, sign: float, bend: Array, inward: Array) -> Array:
    """Return the bend of an elbow about the axis across the upper arm [degrees]."""
    upper = rig.rest(f"{side}ForeArm") - rig.rest(f"{side}Arm")
    hinge = np.cross(upper, [0.0, 0.0, 1.0])  # bends the forearm forward
    hinge /= np.linalg.norm(hinge)
    flex = rotations.about(hinge, np.radians(bend))
    twist = rotations.about(upper / np.linalg.norm(upper), -sign * np.radians(inward) * 1.0)
    return rotations.multiply(twist, flex)


def curl_fingers(rig: PosedRig, side: str, bend: Array | float, thumb: Array | float = 0.0) -> None:
    """Bend the fingers towards the palm, and the thumb over it [degrees]."""
    away, front, inward = along_forearm()
    flip = np.array([1.0, -1.0, -1.0]) if side == "Right" else np.ones(3)
    across = np.cross(away, inward) * flip
    over = np.cross(front, inward) * flip
    for finger in FINGERS:
        axis, angle = (over, thumb) if finger == "Thumb" else (across, bend)
        turn = rotations.about(axis, np.radians(angle) * np.ones(1))
        rig.turn(f"{side}Hand{finger}1", turn)
        rig.turn(f"{side}Hand{finger}2", turn)


def reach_target(rig: PosedRig, side: str, sign: float, to: HandTarget) -> None:
    """Move a hand to its target, on an arc away from the body."""
    flip = np.array([sign, 1.0, 1.0])
    hand, elbow = rig.places(f"{side}Hand"), rig.places(f"{side}ForeArm")
    chest, turn = rig.places("chest"), rig.facing("chest")
    goal = chest + rotations.rotate(turn, to.wrist * flip - rig.rest("chest"))
    share = np.asarray(to.share)[:, None]
    inside = np.clip(share, 0.0, 1.0)
    bulge = 4 * inside * (1 - inside) * flip * [0.07, 0.0, 0.05]
    hanging = elbow - 0.5 * (rig.places(f"{side}Arm") + hand)
    hanging /= np.linalg.norm(hanging, axis=1, keepdims=True)
    out = rotations.rotate(turn, to.elbow * flip)
    fingers, thumb = (rotations.rotate(turn, v * flip) for v in (to.fingers, to.thumb))
    rest = rig.rest(f"{side}Hand") - rig.rest(f"{side}ForeArm")
    grip = aim_rotation(rest, [0.0, 0.0, 1.0], fingers, thumb)
    facing = rotations.slerp(rig.facing(f"{side}Hand"), grip, inside[:, 0])
    pole = hanging + (out - hanging) * inside
    rig.place_hand(side, hand + (goal - hand) * share + bulge, facing, pole)
