"""How the ground goes by under a clip, and how the clip repeats: what feet are held against.

A clip that walks in place stands on a treadmill. Carried along against it, its feet stand still;
so they are held there, and taken back.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.retargeting.body import Body, Leg
from characters.retargeting.transfer import upright_clip
from characters.skeleton import rotations
from characters.skeleton.pose import Array

_TREADMILL = 0.1  # leg lengths a second: standing feet that go faster stand on one,
_AWAY = 1.0  # leg lengths: unless the body itself goes so far

_T = TypeVar("_T", bound=np.generic)


@dataclass(frozen=True)
class Way:
    """Where a clip's own frame goes over the ground, and where its next cycle starts."""

    carried: Array
    """Of each frame, (frames, 3): x, z [m] and yaw [rad]."""

    cycle: Array | None
    """Of the next cycle seen from this one, (3,): x, z and yaw; None if the clip does not loop."""

    rate: float
    """Frames a second [Hz]."""

    def unrolled(self, places: Array) -> Array:
        """Return places (frames, 3) over the ground, for three cycles of a loop."""
        there = moved(self.carried, places)
        if self.cycle is None:
            return there
        once = there[:-1]
        before = moved(_inverse(self.cycle), once)
        return np.concatenate([before, once, moved(self.cycle, once)])

    def unrolled_directions(self, directions: Array) -> Array:
        """Return directions (frames, 3) over the ground, for three cycles of a loop."""
        still = np.array([0.0, 0.0, 1.0])
        cycle = None if self.cycle is None else self.cycle * still
        return Way(self.carried * still, cycle, self.rate).unrolled(directions)

    def again(self, values: NDArray[_T]) -> NDArray[_T]:
        """Return what does not depend on the place, (frames, …), for three cycles of a loop."""
        return values if self.cycle is None else np.concatenate([values[:-1]] * 3)

    def middle(self, values: Array) -> Array:
        """Return one clip, (frames, …), of what `again` repeats."""
        if self.cycle is None:
            return values
        count = len(self.carried) - 1
        return values[count : 2 * count + 1]

    def rolled(self, places: Array) -> Array:
        """Return the clip's own places (frames, 3) of those over the ground."""
        return moved(_inverse(self.carried), self.middle(places))


def way_of(
    clip: Clip, body: Body, legs: Sequence[Leg], down: NDArray[np.bool_], ratio: float
) -> Way:
    """Return the way of a clip over the ground, its lengths multiplied by a ratio.

    Parameters
    ----------
    clip, body, legs
        What moves.
    down
        When the end of each leg stands, (frames, legs): standing feet tell how the ground moves.
    ratio
        To the measures of another body.
    """
    clip = upright_clip(clip, body)
    times = np.arange(len(clip)) / clip.rate
    velocity = -_treadmill(clip, body, legs, down)
    carried = arc(ratio * velocity, 0.0, times)
    if not clip.loop or len(clip) < 2:
        return Way(carried, None, clip.rate)
    cycle = carried[-1]
    if clip.root_motion:
        first, last = (clip.track[frame] * [ratio, ratio, 1.0] for frame in (0, -1))
        # The treadmill, if any, goes by under where the root stands.
        cycle = _after(cycle, _after(last, _inverse(first)))
    return Way(carried, cycle, clip.rate)


def _treadmill(clip: Clip, body: Body, legs: Sequence[Leg], down: NDArray[np.bool_]) -> Array:
    """Return the velocity (2,) [m/s] of ground that runs under a clip; nought if it stands."""
    ends = clip.poses.globals(body.skeleton)[:, [leg.end for leg in legs]][..., [0, 2], 3]
    stands = down[1:] & down[:-1]
    if not stands.any():
        return np.zeros(2)
    hips = clip.poses.globals(body.skeleton)[:, body.anatomy.joints["hips"], [0, 2], 3]
    if np.ptp(hips, axis=0).max() > _AWAY * body.leg_length:
        return np.zeros(2)
    velocity = np.median(np.diff(ends, axis=0)[stands] * clip.rate, axis=0)
    moves = np.hypot(*velocity) > _TREADMILL * body.leg_length
    return np.asarray(velocity if moves else np.zeros(2), float)


def arc(velocity: Array, yaw_rate: float, times: Array) -> Array:
    """Return the way at constant velocity (2,) [m/s] and yaw rate [rad/s]: (n, 3), x, z and yaw.

    >>> arc(np.array([0.0, 1.0]), np.pi, np.array([1.0])).round(6).tolist()
    [[0.63662, 0.0, 3.141593]]
    """
    yaw = yaw_rate * times
    ahead = times * np.sinc(yaw / np.pi)
    aside = times * np.sinc(yaw / 2 / np.pi) * np.sin(yaw / 2)
    x, z = velocity
    return np.stack([ahead * x + aside * z, ahead * z - aside * x, yaw], axis=-1)


def moved(by: Array, places: Array) -> Array:
    """Return places (frames, 3) turned and shifted by ways (frames, 3) or (3,)."""
    turned = rotations.rotate(rotations.about("y", by[..., 2]), places)
    turned[..., [0, 2]] += by[..., :2]
    return turned


def _inverse(way: Array) -> Array:
    """Return the ways back, (…, 3)."""
    sine, cosine = np.sin(way[..., 2]), np.cos(way[..., 2])
    x, z = way[..., 0], way[..., 1]
    return np.stack([-cosine * x + sine * z, -sine * x - cosine * z, -way[..., 2]], axis=-1)


def _after(second: Array, first: Array) -> Array:
    """Return a way (3,) followed, on its left, by another: both in the world."""
    point = moved(second, np.array([first[0], 0.0, first[1]]))
    return np.array([point[0], point[2], first[2] + second[2]])
