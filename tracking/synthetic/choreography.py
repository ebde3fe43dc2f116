"""The motion of a cube in a hand: a sequence of smooth segments with perfect rest in between."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from cubeling.tracking.cube.model import FACE_AXES
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

Move = Callable[[Array, float], None]
"""Changes the initial pose of a segment, in place, to that at a share 0…1 of its time."""

UP = np.array([0.0, 1.0, 0.0])

HAND_APPROACH_S = 0.45
"""Time in which the hand approaches or leaves the cube."""

TREMOR_M, TREMOR_RAD = 0.0004, np.deg2rad(0.25)
"""Amplitude of the tremor of a hand that holds the cube."""


@dataclass(frozen=True)
class SceneState:
    """Cube and hand at one time."""

    table_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    grip: float
    """Position of the hand: 0 away, 1 holding the cube."""

    resting: bool = False
    """Whether the cube lies on the desk untouched."""

    turns: float = 0.0
    """Turns since the cube was last put down, clockwise as seen from above."""

    @property
    def top_face(self) -> str:
        """Name of the face that points most upwards."""
        upwards = {
            name: float(self.table_from_cube[1, :3] @ np.cross(right, up))
            for name, (right, up) in FACE_AXES.items()
        }
        return max(upwards, key=upwards.__getitem__)


@dataclass(frozen=True)
class _Segment:
    start: float
    end: float
    held: bool
    pose: Array
    move: Move
    turns: float
    turned: float

    def pose_at(self, share: float) -> Array:
        pose = self.pose.copy()
        self.move(pose, share)
        return pose


def minimum_jerk(share: float) -> float:
    """Return the minimum-jerk profile from 0 to 1 (Flash and Hogan, 1985).

    >>> minimum_jerk(0.5)
    0.5
    """
    share = min(1.0, max(0.0, share))
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


class Choreography:
    """Builds a motion: each method appends a segment and returns the choreography.

    At first the cube, with the given edge [m], stands at (x, z) with a clockwise heading.
    """

    def __init__(self, edge: float, x: float = 0.0, z: float = 0.0, heading_deg: float = 0.0):
        self.length = 0.0
        """End of the last segment [s]."""
        self._edge = edge
        turned = se3.rotation(-np.deg2rad(heading_deg) * UP)
        self._pose = se3.pose(turned, np.array([x, edge / 2, z]))
        self._segments: list[_Segment] = []
        self._turns = 0.0

    def rest(self, seconds: float) -> Self:
        """Leave the cube untouched; the hand moves away if there is time."""
        return self._append(seconds, lambda pose, share: None, held=False)

    def hold(self, seconds: float) -> Self:
        """Hold the cube without moving it."""
        return self._append(seconds, lambda pose, share: None)

    def slide(self, x: float, z: float, seconds: float, bend: float = 0.0) -> Self:
        """Slide over the table to (x, z), along an arc that deviates by `bend` [m] from a line."""
        way = np.array([x, self._pose[1, 3], z]) - self._pose[:3, 3]
        aside = np.cross(UP, way)
        aside /= max(float(np.linalg.norm(aside)), 1e-9)

        def move(pose: Array, share: float) -> None:
            progress = minimum_jerk(share)
            pose[:3, 3] += progress * way
            pose[:3, 3] += 4 * bend * progress * (1 - progress) * aside

        return self._append(seconds, move)

    def turn(self, degrees: float, seconds: float) -> Self:
        """Turn in place, clockwise as seen from above."""

        def move(pose: Array, share: float) -> None:
            turned = -np.deg2rad(degrees) * minimum_jerk(share) * UP
            pose[:3, :3] = se3.rotation(turned) @ pose[:3, :3]

        return self._append(seconds, move, turned=degrees / 360)

    def tip(self, normal: tuple[float, float, float]) -> Self:
        """Lift, turn the face with this normal (in the cube frame) to the top, and put down."""
        self._turns = 0.0
        outward = self._pose[:3, :3] @ np.array(normal)
        axis = np.cross(outward, UP)
        size = float(np.linalg.norm(axis))
        angle = float(np.arctan2(size, outward @ UP))
        axis = axis / size if size > 1e-6 else np.array([1.0, 0.0, 0.0])

        def move(pose: Array, share: float) -> None:
            turned = axis * angle * minimum_jerk(1.25 * share - 0.125)
            pose[:3, :3] = se3.rotation(turned) @ pose[:3, :3]
            pose[1, 3] += 0.75 * self._edge * np.sin(np.pi * minimum_jerk(share)) ** 2

        return self._append(1.2, move)

    def carry(self, x: float, z: float, height: float, seconds: float) -> Self:
        """Lift the cube, carry it, and put it down at (x, z)."""
        self._turns = 0.0
        way = np.array([x, z]) - self._pose[[0, 2], 3]

        def move(pose: Array, share: float) -> None:
            pose[[0, 2], 3] += minimum_jerk(1.6 * share - 0.3) * way
            pose[1, 3] += height * (minimum_jerk(3 * share) - minimum_jerk(3 * share - 2))

        return self._append(seconds, move)

    def shake(self, seconds: float) -> Self:
        """Lift the cube and shake it sideways by 5 cm, four times a second."""
        self._turns = 0.0

        def move(pose: Array, share: float) -> None:
            lifted = minimum_jerk(5 * share) - minimum_jerk(5 * share - 4)
            pose[1, 3] += 0.08 * lifted
            pose[0, 3] += 0.05 * lifted * np.sin(2 * np.pi * 4.0 * seconds * share)

        return self._append(seconds, move)

    def at(self, time: float) -> SceneState:
        """Return cube and hand at a time [s]; before and after all segments they stand still."""
        time = min(max(time, 0.0), self.length)
        segment = next(s for s in self._segments if time <= s.end)
        share = (time - segment.start) / max(segment.end - segment.start, 1e-9)
        pose = segment.pose_at(share)
        grip = self._grip(time)
        if segment.held and grip > 0.99:
            pose = _with_tremor(pose, time, segment)
        turns = segment.turns + segment.turned * minimum_jerk(share)
        return SceneState(pose, grip, not segment.held, turns)

    def _append(self, seconds: float, move: Move, held: bool = True, turned: float = 0.0) -> Self:
        end = self.length + seconds
        segment = _Segment(self.length, end, held, self._pose, move, self._turns, turned)
        self._segments.append(segment)
        self._turns += turned
        self.length = end
        self._pose = segment.pose_at(1.0)
        return self

    def _grip(self, time: float) -> float:
        """Return the position of the hand: it approaches before a segment that needs it."""
        away = min(
            (max(s.start - time, time - s.end, 0.0) for s in self._segments if s.held),
            default=np.inf,
        )
        return 1.0 - minimum_jerk(float(away) / HAND_APPROACH_S)


def _with_tremor(pose: Array, time: float, segment: _Segment) -> Array:
    """Add a hand's tremor of 7 to 11 Hz, faded in and out so that the pose is continuous."""
    fade = min(1.0, (time - segment.start) / 0.15, (segment.end - time) / 0.15)
    phases = 2 * np.pi * np.outer([7.3, 8.9, 10.7], [1.0, 1.13, 0.91]) * time
    waves = np.sin(phases + np.arange(9).reshape(3, 3)).sum(axis=0) / 3
    pose = pose.copy()
    pose[:3, 3] += TREMOR_M * fade * waves * (1.0, 0.3, 1.0)
    pose[:3, :3] = se3.rotation(TREMOR_RAD * fade * waves[::-1]) @ pose[:3, :3]
    return pose
