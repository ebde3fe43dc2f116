"""The undersides of feet, and the turn of a foot that keeps them above the ground.

A foot is longer or shorter than that of the motion's performer. So it cannot be turned just as far
without going through the ground, or its ankle would have to rise and the knee to bend. The ankle
keeps its height instead, and the foot turns as far as there is room: a shorter foot farther, as
long as it stands on its ball, and then onto the tips of its toes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

_UP = np.array([0.0, 1.0, 0.0])
_DIRECTIONS = 256  # in which the outermost points of a foot are kept
_HALVINGS = 14  # of the range of turns
_TOLERANCE_M = 1e-9
_MIN_WEIGHT = 0.5  # of a vertex that belongs to a foot
_RIGID_WEIGHT = 0.98  # of a vertex that moves with it alone
# Without a skin: lengths per distance ahead from the ankle to the toes.
_HEEL_LENGTH, _TOES_LENGTH = 0.35, 0.4
_BALL_PART = 0.7  # of the way from the ankle to the tip of a foot without toes


@dataclass(frozen=True)
class Sole:
    """Outermost points of a foot at rest, in the common axes."""

    foot: Array
    """Of what moves with the foot, from the ankle, (n, 3) [m]."""

    toes: Array
    """Of what moves with the toes, from their joint, (m, 3) [m]; none without toes."""

    ball: Array
    """From the ankle to the joint of the toes; without toes, to the ground below the ball, (3,)."""

    heel: Array
    """From the ankle to the ground below the heel, (3,) [m]."""

    @classmethod
    def of(cls, foot: Array, toes: Array, ball: Array | None, ahead: Array) -> "Sole":
        """Return the sole of a foot with a skin.

        Parameters
        ----------
        foot, toes
            Vertices of both, from their joints, (n, 3) and (m, 3) [m].
        ball
            From the ankle to the joint of the toes, (3,) [m], or None without toes.
        ahead
            Unit vector along the foot, level, (3,).
        """
        along, lowest = foot @ ahead, float(foot[:, 1].min())
        below = lowest * _UP
        if ball is None:
            ball = _BALL_PART * float(along.max()) * ahead + below
        return cls(_outermost(foot), _outermost(toes), ball, float(along.min()) * ahead + below)

    @classmethod
    def assume(cls, ball: Array | None, height: float, ahead: Array, length: float) -> "Sole":
        """Return the sole of a foot without a skin, whose ankle is at a height [m].

        `length` is the distance ahead to the ball of a foot without toes [m]; see `of`.
        """
        below = -height * _UP
        if ball is not None:
            length = float(ball @ ahead)
        heel, front = (part * length * ahead + below for part in (-_HEEL_LENGTH, 1.0))
        if ball is None:
            return cls(np.stack([heel, front]), np.zeros((0, 3)), front, heel)
        ground = (-height - ball[1]) * _UP
        tip = _TOES_LENGTH * length * ahead + ground
        return cls(np.stack([heel, front]), np.stack([ground, tip]), ball, heel)

    @property
    def lowest(self) -> float:
        """Height of the lowest point at rest from the ankle, not positive [m]."""
        toes = self.ball[1] + self.toes[:, 1].min() if len(self.toes) else 0.0
        return float(min(self.foot[:, 1].min(), toes, 0.0))

    @property
    def highest_tilt(self) -> float:
        """The tilt on the ball at which the ankle is highest [rad]."""
        return float(np.arctan2(np.hypot(self.ball[0], self.ball[2]), -self.ball[1]))

    def clearance(self, turns: Array, toes: Array | None = None) -> Array:
        """Return how high the ankle of a foot turned from rest (…, 4) is above the ground, (…) [m].

        `toes` are their turns from rest, (…, 4); left out, they are level.
        """
        down = rotations.rotate(rotations.conjugate(turns), -_UP)
        lowest = (down @ self.foot.T).max(-1)
        if len(self.toes):
            below = -self.toes[:, 1].min() if toes is None else self.toes_clearance(toes)
            lowest = np.maximum(lowest, down @ self.ball + below)
        return np.asarray(lowest)

    def toes_clearance(self, turns: Array) -> Array:
        """Return how high the joint of toes turned from rest (…, 4) is above ground, (…) [m]."""
        down = rotations.rotate(rotations.conjugate(turns), -_UP)
        return np.asarray((down @ self.toes.T).max(-1))


def tilts(turns: Array) -> Array:
    """Return how far turns from rest (frames, 4) are from level, (frames,) [rad]."""
    return np.asarray(np.arccos(np.clip(rotations.rotate(turns, _UP)[:, 1], -1.0, 1.0)))


def tilt_to_fit(
    turns: Array,
    heights: Array,
    clearance: Callable[[Array], Array],
    greatest: Array | float = 1.0,
) -> Array:
    """Return turns from rest (frames, 4) with as much of their tilt as there is room for.

    Parameters
    ----------
    turns
        Of a foot or of toes.
    heights
        Of their joint above the ground, (frames,) [m].
    clearance
        Gives the height at which a turned foot touches the ground.
    greatest
        Tilt with enough room, as a share of that in `turns`, (frames,).
    """
    tilt = rotations.between(_UP, rotations.rotate(turns, _UP))
    level = rotations.multiply(rotations.conjugate(tilt), turns)
    # A level foot stands, even if its joint is too low.
    return _farthest(level, turns, np.maximum(heights, clearance(level)), clearance, greatest)


def stretch_to_fit(
    toes: Array, foot: Array, heights: Array, clearance: Callable[[Array], Array], greatest: Array
) -> Array:
    """Return the turns of toes (frames, 4), straighter if that is needed to reach the ground.

    Parameters
    ----------
    toes, foot
        Turns from rest, (frames, 4).
    heights
        Of the joint of the toes above the ground, (frames,) [m].
    clearance
        Gives the height at which turned toes touch the ground.
    greatest
        How far they may straighten, (frames,), 0…1.
    """
    fitting = tilt_to_fit(toes, heights, clearance)
    room = np.maximum(heights, clearance(fitting))
    return _farthest(fitting, foot, room, clearance, greatest)


def _farthest(
    start: Array,
    end: Array,
    room: Array,
    clearance: Callable[[Array], Array],
    greatest: Array | float,
) -> Array:
    """Return the turns (frames, 4) farthest from start to end whose clearance is within the room.

    They go up to a share of the way, and less far if there is no room there.
    """
    least, most = np.zeros(len(start)), np.zeros(len(start)) + greatest
    fits = clearance(rotations.slerp(start, end, most)) <= room + _TOLERANCE_M
    least[fits] = most[fits]
    for _ in range(_HALVINGS):
        middle = (least + most) / 2
        fits = clearance(rotations.slerp(start, end, middle)) <= room + _TOLERANCE_M
        least, most = np.where(fits, middle, least), np.where(fits, most, middle)
    return rotations.slerp(start, end, least)


def skin_of_joints(
    meshes: Sequence[Mesh], placements: Array, joints: Sequence[int], others: Sequence[int] = ()
) -> Array:
    """Return the vertices that mostly follow these joints, and no more the others, (n, 3) [m].

    `placements` of all joints are (joints, 4, 4).
    """
    parts = parts_of_joints(meshes, joints, others)
    return np.concatenate([np.zeros((0, 3)), *(skin(part, placements) for part in parts)])


def parts_of_joints(
    meshes: Sequence[Mesh], joints: Sequence[int], others: Sequence[int] = ()
) -> list[Mesh]:
    """Return the parts of meshes, without triangles, that mostly follow these joints."""
    found = []
    for mesh in meshes:
        own, other = (
            np.where(np.isin(mesh.joints, each), mesh.weights, 0.0).sum(1)
            for each in (joints, others)
        )
        chosen = (own + other > _MIN_WEIGHT) & (own >= other)
        if chosen.any():
            found.append(_choose(mesh, chosen))
    return found


def shared_skin(meshes: Sequence[Mesh], joints: Sequence[int]) -> list[Mesh]:
    """Return the parts of meshes that mostly follow these joints, but others too."""
    parts = parts_of_joints(meshes, joints)
    own = [np.where(np.isin(part.joints, joints), part.weights, 0.0).sum(1) for part in parts]
    return [
        _choose(part, weights < _RIGID_WEIGHT)
        for part, weights in zip(parts, own, strict=True)
        if (weights < _RIGID_WEIGHT).any()
    ]


def _choose(mesh: Mesh, vertices: NDArray[np.bool_]) -> Mesh:
    """Return some vertices of a mesh, without triangles and morphs."""
    return replace(
        mesh,
        positions=mesh.positions[vertices],
        joints=mesh.joints[vertices],
        weights=mesh.weights[vertices],
        morphs=(),
    )


def _outermost(points: Array) -> Array:
    """Return the points of a set (n, 3) that are outermost in some direction."""
    if len(points) <= _DIRECTIONS:
        return points
    # Evenly spread over the sphere (González, "Measurement of areas on a sphere using Fibonacci
    # and latitude–longitude lattices", 2010).
    number = np.arange(_DIRECTIONS)
    y = (2 * number + 1) / _DIRECTIONS - 1
    around = np.pi * (1 + 5**0.5) * number
    ring = np.sqrt(1 - y**2)
    directions = np.stack([ring * np.cos(around), y, ring * np.sin(around)], axis=-1)
    lowest = points[:, 1].argmin()
    kept = np.unique([lowest, *(points @ directions.T).argmax(0)])
    return np.asarray(points[kept])
