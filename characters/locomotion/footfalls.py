"""When the feet of a posed character come down, whatever moved it: its clips, foot lock or a hop.

A foot has come down once one of its joints is low and no longer slides (Ikemoto, Arikan and
Forsyth, "Knowing when to put your foot down", I3D 2006). The limits have hysteresis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

# Heights are in body heights, speeds over the ground in body heights a second.
_LANDING_HEIGHT, _LIFTING_HEIGHT = 0.015, 0.02
_LANDING_SPEED, _LIFTING_SPEED = 0.4, 0.6
_LANDING_SPEED_SHARE = 0.3  # of the swing's greatest speed: a fast foot slows down as it lands
_MAX_GAP_S = 0.25  # a longer gap between frames resets the feet


@dataclass(frozen=True)
class Footfall:
    """A foot that has come down in this frame."""

    foot: int
    """Number of the foot, in the order of the skeleton's joints."""

    speed: float
    """Greatest speed of the foot since it was lifted [body heights/s]."""


class Footfalls:
    """Finds the footfalls of one character in its poses, frame by frame.

    Parameters
    ----------
    skeleton
        The joints; its rest pose stands on the ground.
    body_height
        Height of the character [m].
    """

    def __init__(self, skeleton: Skeleton, body_height: float) -> None:
        feet = find_feet(skeleton)
        self.count = len(feet)
        """Number of feet and paws."""
        self.clearance = 0.0
        """Height of the lowest foot above the ground [body heights]."""
        order = skeleton.with_ancestors(joint for foot in feet for joint in foot)
        number = {joint: index for index, joint in enumerate(order)} | {-1: -1}
        self._indices = np.array(order, np.intp)
        self._skeleton = Skeleton(
            tuple(skeleton.names[joint] for joint in order),
            tuple(number[skeleton.parents[joint]] for joint in order),
            skeleton.rest[self._indices],
        )
        self._joints = np.array([number[joint] for foot in feet for joint in foot], np.intp)
        # The first joint of each foot among all joints of feet.
        self._starts = np.cumsum([0, *map(len, feet)])[:-1]
        self._rest = self._skeleton.rest.globals(self._skeleton)[self._joints, 1, 3]
        self._body_height = body_height
        self._last: tuple[float, Array] | None = None
        self._down = [True] * self.count
        self._peaks = [0.0] * self.count

    def update(
        self, pose: Pose, table_from_character: NDArray[np.float64], timestamp: float
    ) -> tuple[Footfall, ...]:
        """Return the feet that have come down since the last pose; after a gap or at first, none.

        Parameters
        ----------
        pose
            The joints.
        table_from_character
            Where the character stands, (4, 4).
        timestamp
            Time of the pose [s].
        """
        if not self.count:
            return ()
        points = self._points(pose, table_from_character)
        heights = np.minimum.reduceat(points[:, 1], self._starts)
        self.clearance = float(heights.min())
        before, self._last = self._last, (timestamp, points)
        elapsed = 0.0 if before is None else timestamp - before[0]
        if before is None or not 0.0 < elapsed < _MAX_GAP_S:
            self._down = [True] * self.count
            return ()
        moved = points - before[1]
        slips = np.minimum.reduceat(np.hypot(moved[:, 0], moved[:, 2]), self._starts) / elapsed
        speeds = np.maximum.reduceat(np.sqrt((moved * moved).sum(1)), self._starts) / elapsed
        return tuple(
            Footfall(foot, self._peaks[foot])
            for foot, values in enumerate(
                zip(heights.tolist(), slips.tolist(), speeds.tolist(), strict=True)
            )
            if self._lands(foot, *values)
        )

    def _points(self, pose: Pose, table_from_character: NDArray[np.float64]) -> Array:
        """Return the joints of the feet over the table, raised by none at rest [body heights]."""
        part = Pose(
            pose.translations[self._indices],
            pose.rotations[self._indices],
            None if pose.scales is None else pose.scales[self._indices],
        )
        local = part.globals(self._skeleton)[self._joints, :3, 3]
        local[:, 1] -= self._rest
        points: Array = local @ table_from_character[:3, :3].T + table_from_character[:3, 3]
        return points / (float(table_from_character[1, 1]) * self._body_height)

    def _lands(self, foot: int, height: float, slip: float, speed: float) -> bool:
        """Advance one foot; return whether it has come down."""
        if self._down[foot] and (height > _LIFTING_HEIGHT or slip > _LIFTING_SPEED):
            self._down[foot], self._peaks[foot] = False, 0.0
        if self._down[foot]:
            return False
        self._peaks[foot] = max(self._peaks[foot], speed)
        limit = max(_LANDING_SPEED, _LANDING_SPEED_SHARE * self._peaks[foot])
        self._down[foot] = height < _LANDING_HEIGHT and slip < limit
        return self._down[foot]
