"""Arms that hang beside a body of any width, its skirts and sleeves included.

Arms of a motion hang beside the body that was recorded. On wider hips, in a coat or on shorter
shoulders the hands would be inside the other body: each arm is then held away from it by the
smallest angle at which its skin is outside, as far as the arm hangs.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import skin
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.transfer import (
    in_common_axes,
    turns_from_rest,
    with_turns_from_rest,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import smoothstep

MAX_ANGLE_RAD = np.radians(40.0)
"""An arm that is still inside at this angle is in wide clothes: it is raised no further."""

_STEP_RAD = np.radians(1.0)
_CELLS = 40  # of the body's outline, over its height and depth
_MAX_INSIDE = 0.01  # share of the vertices of an arm: creases touch
_HANGING = (0.3, 0.8)  # cosine to straight down from which on an arm hangs, and does fully


@dataclass(frozen=True)
class ArmClearance:
    """By how much hanging arms are held away from a body."""

    rig: Rig
    """Skeleton, anatomy and skin of the body."""

    angles: Mapping[str, float]
    """How far each arm is turned away, by its side [rad]; those that hang outside are left out."""

    @staticmethod
    def of(rig: Rig, standing: Pose) -> "ArmClearance":
        """Measure the arms of a body with a skin in a pose in which they hang."""
        arms = _ArmSkin.by_side(rig, standing.globals(rig.skeleton))
        angles = {side: arm.clear_angle() for side, arm in arms.items()}
        return ArmClearance(rig, {side: angle for side, angle in angles.items() if angle > 0.0})

    def hold(self, poses: Pose) -> Pose:
        """Return poses (frames, …) whose arms are held away from the body as far as they hang."""
        for side, angle in self.angles.items():
            upper, hand = _arm(self.rig, side)
            placed = self.rig.placements(poses, [hand])[..., :3, 3]
            arm = in_common_axes(self.rig, placed[:, hand] - placed[:, upper])
            down = -arm[:, 1] / np.maximum(np.linalg.norm(arm, axis=-1), 1e-9)
            low, high = _HANGING
            share = smoothstep(np.clip((down - low) / (high - low), 0.0, 1.0))
            away = rotations.about("z", _outwards(side) * angle * share)
            turns = turns_from_rest(poses, self.rig, [upper])
            turns = rotations.multiply(away[:, None], turns)
            poses = with_turns_from_rest(poses, self.rig, [upper], turns)
        return poses


def share_inside(rig: Rig, pose: Pose) -> float:
    """Return which share of the skin of forearms and hands is inside the body; of the worse arm."""
    arms = _ArmSkin.by_side(rig, pose.globals(rig.skeleton))
    return max((arm.share_inside(0.0) for arm in arms.values()), default=0.0)


def _arm(rig: Rig, side: str) -> tuple[int, int]:
    """Return the joints where an arm begins and where its hand, or what it has, begins."""
    joints = rig.anatomy.joints
    ends = (f"{side}{part}" for part in ("Hand", "LowerArm", "UpperArm"))
    return joints[f"{side}UpperArm"], joints[next(end for end in ends if end in joints)]


def _outwards(side: str) -> float:
    """Return the sign of a turn about +z that raises a hanging arm: the left one is at +x."""
    return 1.0 if side == "left" else -1.0


@dataclass(frozen=True)
class _ArmSkin:
    """The skin of a forearm with its hand beside a body: +x is away from it, +y up, +z ahead."""

    shoulder: Array
    """Where the arm begins, (3,) [m]."""

    points: Array
    """Vertices, (n, 3) [m]."""

    outline: "_Outline"
    """The body beside it."""

    @staticmethod
    def by_side(rig: Rig, placements: Array) -> "dict[str, _ArmSkin]":
        """Return those that a body has for joint placements (joints, 4, 4), by their sides."""
        sides = [side for side in SIDES if f"{side}UpperArm" in rig.anatomy.joints]
        if not sides or not rig.meshes:
            return {}
        points, movers = _placed_skin(rig, placements)
        body = points[np.isin(movers, _trunk_joints(rig))]
        arms: dict[str, _ArmSkin] = {}
        for side in sides:
            upper, hand = _arm(rig, side)
            fore = rig.anatomy.joint(f"{side}LowerArm")
            arm = points[np.isin(movers, subtree(rig.skeleton, hand if fore is None else fore))]
            if len(arm) and len(body):
                mirror = np.array([_outwards(side), 1.0, 1.0])
                shoulder = in_common_axes(rig, placements[upper, :3, 3])
                arms[side] = _ArmSkin(shoulder * mirror, arm * mirror, _Outline.of(body * mirror))
        return arms

    def clear_angle(self) -> float:
        """Return the smallest turn of the arm at which its skin is outside the body [rad]."""
        angles = np.arange(0.0, MAX_ANGLE_RAD, _STEP_RAD)
        clear = (float(angle) for angle in angles if self.share_inside(angle) <= _MAX_INSIDE)
        return next(clear, float(MAX_ANGLE_RAD))

    def share_inside(self, angle: float) -> float:
        """Return which share of the vertices is inside the body if the arm is turned away [rad]."""
        turn = rotations.about("z", np.asarray(angle))
        turned = self.shoulder + rotations.rotate(turn, self.points - self.shoulder)
        return float(self.outline.contains(turned).mean())


def _trunk_joints(rig: Rig) -> list[int]:
    """Return the joints of trunk and legs, and of what they wear; not of arms, neck and head."""
    joint = rig.anatomy.joint
    apart = {
        below
        for part in ("neck", "head", *(s + p for s in SIDES for p in ("Shoulder", "UpperArm")))
        if (top := joint(part)) is not None
        for below in subtree(rig.skeleton, top)
    }
    return [each for each in range(len(rig.skeleton)) if each not in apart]


def _placed_skin(rig: Rig, placements: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return the vertices in the common axes, (n, 3) [m], and the joint that moves each most."""
    points = np.concatenate([skin(mesh, placements) for mesh in rig.meshes])
    return in_common_axes(rig, points), np.concatenate([mesh.movers for mesh in rig.meshes])


@dataclass(frozen=True)
class _Outline:
    """How far a body reaches to one side, by height and depth."""

    low: Array
    """Lowest height and least depth, (2,) [m]."""

    size: Array
    """Of a cell, (2,) [m]."""

    reach: Array
    """Greatest distance to the side in each cell, (cells, cells) [m]; −inf where nothing is."""

    @staticmethod
    def of(points: Array) -> "_Outline":
        """Return the outline of points (n, 3): to the side, up, ahead."""
        low = points[:, 1:].min(0)
        size = np.maximum(np.ptp(points[:, 1:], axis=0) / _CELLS, 1e-9)
        reach = np.full((_CELLS + 1, _CELLS + 1), -np.inf)
        rows, columns = ((points[:, 1:] - low) / size).astype(int).T
        np.maximum.at(reach, (rows, columns), points[:, 0])
        return _Outline(low, size, reach)

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Return which points are nearer than the outline, (n,)."""
        cells = np.floor((points[:, 1:] - self.low) / self.size).astype(int)
        known = ((cells >= 0) & (cells <= _CELLS)).all(1)
        rows, columns = np.clip(cells, 0, _CELLS).T
        return np.asarray(known & (points[:, 0] < self.reach[rows, columns]))
