"""Trunk, shoulders and head of a gesture, and how power makes them join in."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.gathering import PartKeys
from cubeling.characters.behaviour.symbolic_gesture import BodyKey
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

SHRUG_DEG = 24.0
"""Turn of raised shoulders [degrees]."""

BODY_EXTENT = 0.5
"""Part of the extent of a gesture, `spatial`, by which trunk, shoulders and head move more."""

LEAN, SIDE, TURN, SHRUG, NOD, TILT, SHAKE = range(7)
"""Columns of a body track: those of `BodyKey` [rad], but for the shrug, 0…1."""


def torso_controller(keys: Array, power: float) -> Array:
    """Return torso rotations (keys, 3) [rad] to which p (θ₁ − θ₀) is added at each key.

    θ₀ is that of the key before, and 0 before the first key (Huang 2013, section 8.7.1).

    >>> torso_controller(np.array([[0.1, 0, 0], [0.3, 0, 0]]), 0.5)[:, 0].round(6).tolist()
    [0.15, 0.4]
    """
    steps = np.diff(keys, axis=0, prepend=np.zeros((1, keys.shape[1])))
    moved: Array = keys + power * steps
    return moved


def body_track(
    keys: tuple[BodyKey, ...], mirrored: bool, expressivity: GestureExpressivity
) -> PartKeys:
    """Return trunk, shoulders and head at their keys, (n, 7)."""
    side = -1.0 if mirrored else 1.0
    rows = np.radians(
        [
            [
                key.lean_deg,
                side * key.side_deg,
                side * key.turn_deg,
                math.degrees(key.shrug),
                key.nod_deg,
                side * key.tilt_deg,
                side * key.shake_deg,
            ]
            for key in keys
        ]
    ).reshape(-1, 7)
    rows *= 1.0 + BODY_EXTENT * expressivity.spatial
    rows[:, : TURN + 1] = torso_controller(rows[:, : TURN + 1], expressivity.power)
    return PartKeys(np.array([key.at for key in keys]), rows)


@dataclass(frozen=True, eq=False)
class TrunkTurns:
    """What turns trunk, shoulders and head of one skeleton."""

    trunk: NDArray[np.intp]
    """Joints of the trunk above the hips, (n,)."""

    head: NDArray[np.intp]
    """Joints of neck and head."""

    shoulders: NDArray[np.intp]
    """Collarbones, left before right; empty without."""

    frames: Array
    """Rotations `character_from_joint` of all joints in the posture that is turned, (joints, 4)."""

    @staticmethod
    def of(skeleton: Skeleton, anatomy: Anatomy, posture: Pose) -> "TrunkTurns":
        """Return them for turns about the axes of the character, from a posture."""
        hips, chest, head = (anatomy.joint(part) for part in ("hips", chest_part(anatomy), "head"))
        shoulders = [anatomy.joint(f"{side}Shoulder") for side in ("left", "right")]
        matrices = posture.globals(skeleton)[:, :3, :3]
        sizes = np.linalg.norm(matrices, axis=1, keepdims=True)
        return TrunkTurns(
            _line(skeleton, chest, hips),
            _line(skeleton, head, chest),
            np.array([each for each in shoulders if each is not None], np.intp),
            rotations.from_matrix(matrices / np.where(sizes > 0.0, sizes, 1.0)),
        )

    @property
    def joints(self) -> NDArray[np.intp]:
        """All joints that are turned."""
        return np.concatenate([self.trunk, self.head, self.shoulders])

    def turn_by(self, pose: Pose, row: Array) -> Pose:
        """Return a pose with trunk, shoulders and head turned by a row of a body track, (7,)."""
        local = pose.rotations.copy()
        lean, side, turn, shrug, nod, tilt, shake = row.tolist()
        self._turn(local, self.trunk, np.array([lean, turn, -side]))
        self._turn(local, self.head, np.array([nod, shake, -tilt]))
        for number, joint in enumerate(self.shoulders):
            raised = math.radians(SHRUG_DEG) * shrug * (1.0 if number == 0 else -1.0)
            self._turn(local, np.array([joint]), np.array([0.0, 0.0, raised]))
        return replace(pose, rotations=local)

    def _turn(self, local: Array, joints: NDArray[np.intp], vector: Array) -> None:
        """Turn joints, each by its part of a rotation vector in the character frame [rad]."""
        if len(joints) and vector.any():
            own = rotations.rotate(rotations.conjugate(self.frames[joints]), vector / len(joints))
            local[joints] = rotations.multiply(local[joints], rotations.from_rotation_vector(own))


def chest_part(anatomy: Anatomy) -> str:
    """Return the name of the uppermost part of the trunk; that of the hips if there is none."""
    parts = ("upperChest", "chest", "spine")
    return next((part for part in parts if part in anatomy.joints), "hips")


def _line(skeleton: Skeleton, end: int | None, start: int | None) -> NDArray[np.intp]:
    """Return the joints from below one, up to and with another."""
    joints: list[int] = []
    while end is not None and end not in (start, -1):
        joints.append(end)
        end = skeleton.parents[end]
    return np.array(joints[::-1], np.intp)
