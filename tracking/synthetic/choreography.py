"""The motion of a cube in a hand: a sequence of smooth segments with perfect rest in between."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from tracking.cube.model import FACE_AXES
from tracking.geometry import se3
from tracking.geometry.arrays import Array

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
    path: Callable[[float], Array]
    turns: float
    turned: float


def minimum_jerk(share: float) -> float:
    """Return the minimum-jerk profile from 0 to 1 (Flash and Hogan, 1985).

    >>> minimum_jerk(0.5)
    0.5
    """
    share = min(1.0, max(0.0, share))
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)


@dataclass
class Choreography:
    """Builds a motion: each method appends a segment and returns the choreography.

    Parameters
    ----------
    edge
        Edge of the cube [m].
    """

    edge: float
    pose: Array = field(init=False)
    """Pose of the cube after the last segment, (4, 4)."""

    length: float = 0.0
    """End of the last segment [s]."""

    _segments: list[_Segment] = field(default_factory=list)
    _turns: float = 0.0

    def __post_init__(self) -> None:
        self.pose = np.eye(4)
        self.pose[1, 3] = self.edge / 2

    def stand(self, x: float, z: float, heading_deg: float = 0.0) -> Self:
        """Set the initial position and clockwise heading of the cube."""
        self.pose = np.eye(4)
        self.pose[:3, :3] = se3.rotation(-np.deg2rad(heading_deg) * UP)
        self.pose[:3, 3] = x, self.edge / 2, z
        return self

    def rest(self, seconds: float) -> Self:
        """Leave the cube untouched; the hand moves away if there is time."""
        pose = self.pose.copy()
        return self._append(seconds, lambda share: pose, held=False)

    def hold(self, seconds: float) -> Self:
        """Hold the cube without moving it."""
        pose = self.pose.copy()
        return self._append(seconds, lambda share: pose, held=True)

    def slide(self, x: float, z: float, seconds: float, bend: float = 0.0) -> Self:
        """Slide over the table to (x, z), along an arc that deviates by `bend` [m] from a line."""
        start, end = self.pose.copy(), self.pose.copy()
        end[0, 3], end[2, 3] = x, z
        aside = np.cross(UP, end[:3, 3] - start[:3, 3])
        aside /= max(float(np.linalg.norm(aside)), 1e-9)

        def path(share: float) -> Array:
            progress = minimum_jerk(share)
            pose = start.copy()
            pose[:3, 3] += progress * (end[:3, 3] - start[:3, 3])
            pose[:3, 3] += 4 * bend * progress * (1 - progress) * aside
            return pose

        return self._append(seconds, path)

    def turn(self, degrees: float, seconds: float) -> Self:
        """Turn in place, clockwise as seen from above."""
        start = self.pose.copy()

        def path(share: float) -> Array:
            pose = start.copy()
            turned = -np.deg2rad(degrees) * minimum_jerk(share) * UP
            pose[:3, :3] = se3.rotation(turned) @ start[:3, :3]
            return pose

        return self._append(seconds, path, turned=degrees / 360)

    def tip(self, normal: tuple[float, float, float], seconds: float = 1.2) -> Self:
        """Lift, turn the face with this normal (in the cube frame) to the top, and put down."""
        self._turns = 0.0
        start = self.pose.copy()
        outward = start[:3, :3] @ np.array(normal)
        axis = np.cross(outward, UP)
        size = float(np.linalg.norm(axis))
        angle = float(np.arctan2(size, outward @ UP))
        axis = axis / size if size > 1e-6 else np.array([1.0, 0.0, 0.0])

        def path(share: float) -> Array:
            pose = start.copy()
            pose[:3, :3] = (
                se3.rotation(axis * angle * minimum_jerk(1.25 * share - 0.125)) @ start[:3, :3]
            )
            pose[1, 3] += 0.75 * self.edge * np.sin(np.pi * minimum_jerk(share)) ** 2
            return pose

        return self._append(seconds, path)

    def carry(self, x: float, z: float, height: float, seconds: float) -> Self:
        """Lift the cube, carry it, and put it down at (x, z)."""
        self._turns = 0.0
        start = self.pose.copy()

        def path(share: float) -> Array:
            pose = start.copy()
            pose[[0, 2], 3] += minimum_jerk(1.6 * share - 0.3) * (
                np.array([x, z]) - start[[0, 2], 3]
            )
            pose[1, 3] += height * (minimum_jerk(3 * share) - minimum_jerk(3 * share - 2))
            return pose

        return self._append(seconds, path)

    def shake(self, seconds: float, reach: float = 0.05, rate: float = 4.0) -> Self:
        """Lift the cube and shake it sideways with a frequency of `rate` [Hz]."""
        self._turns = 0.0
        start = self.pose.copy()

        def path(share: float) -> Array:
            pose = start.copy()
            lifted = minimum_jerk(5 * share) - minimum_jerk(5 * share - 4)
            pose[1, 3] += 0.08 * lifted
            pose[0, 3] += reach * lifted * np.sin(2 * np.pi * rate * seconds * share)
            return pose

        return self._append(seconds, path)

    def at(self, time: float) -> SceneState:
        """Return cube and hand at a time [s]; before and after all segments they stand still."""
        if not self._segments:
            return SceneState(self.pose.copy(), 0.0)
        time = min(max(time, 0.0), self.length)
        segment = next(s for s in self._segments if time <= s.end)
        share = (time - segment.start) / max(segment.end - segment.start, 1e-9)
        pose = segment.path(share)
        grip = self._grip(time)
        if segment.held and grip > 0.99:
            pose = _with_tremor(pose, time, segment)
        turns = segment.turns + segment.turned * minimum_jerk(share)
        return SceneState(pose, grip, not segment.held, turns)

    def _append(
        self,
        seconds: float,
        path: Callable[[float], Array],
        held: bool = True,
        turned: float = 0.0,
    ) -> Self:
        end = self.length + seconds
        self._segments.append(_Segment(self.length, end, held, path, self._turns, turned))
        self._turns += turned
        self.length = end
        self.pose = path(1.0)
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
