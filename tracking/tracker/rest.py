"""A cube at rest: its poses of several frames are measurements of one pose."""

from dataclasses import dataclass

import numpy as np

from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

MAX_REST_FRAMES = 6
"""So many frames are averaged at most: the jitter falls to about 60 % (`test_rest`)."""

MAX_FRAME_GAP_S = 0.2
"""After a longer pause the cube counts as moved."""

MAX_MOTION_CHI2 = 12.59
"""95 % of chi-square with six degrees of freedom: more counts as motion, less as noise. The mean
then lags by 2.5 standard deviations of a pose's noise at most (`test_rest`)."""


@dataclass(frozen=True)
class Rest:
    """The last poses of a cube, as far as it has not moved since the first of them."""

    first: Array | None = None
    """Pose of the first of these frames, (4, 4) [m]; None before the first frame."""

    offsets: tuple[Array, ...] = ()
    """Pose delta from `first` to the pose of each frame, (6,) each."""

    noises: tuple[Array, ...] = ()
    """Covariance of each pose, without what all frames have in common, (6, 6) each."""

    timestamps: tuple[float, ...] = ()
    """Time of each frame [s]."""

    def add(self, camera_from_cube: Array, noise: Array, timestamp: float) -> "Rest":
        """Return the rest with one more pose, or one that begins with it if the cube has moved."""
        begun = Rest(camera_from_cube, (np.zeros(6),), (noise,), (timestamp,))
        if self.first is None or not 0 < timestamp - self.timestamps[-1] <= MAX_FRAME_GAP_S:
            return begun
        # `first` stays when its own offset falls out: it is only the origin of the others.
        kept = slice(-MAX_REST_FRAMES, None)
        longer = Rest(
            self.first,
            (*self.offsets, se3.delta(self.first, camera_from_cube))[kept],
            (*self.noises, noise)[kept],
            (*self.timestamps, timestamp)[kept],
        )
        return begun if longer._moves() else longer

    def pose(self) -> tuple[Array, Array]:
        """Return the mean of the poses, (4, 4), and its covariance, (6, 6)."""
        assert self.first is not None, "a pose was added"
        count = len(self.offsets)
        mean: Array = np.mean(self.offsets, axis=0)
        return se3.apply_delta(self.first, mean), np.asarray(np.mean(self.noises, axis=0) / count)

    def _moves(self) -> bool:
        """Whether the last pose leaves the others, or all have a slope, by more than noise."""
        offsets, noises = np.array(self.offsets), np.array(self.noises)
        others = len(offsets) - 1
        leap = offsets[-1] - offsets[:-1].sum(axis=0) / others
        leap_noise = noises[-1] + noises[:-1].sum(axis=0) / others**2
        if leap @ np.linalg.solve(leap_noise, leap) > MAX_MOTION_CHI2:
            return True
        times = np.array(self.timestamps)
        times -= times.mean()
        # A slow slide leaves no single pose apart from the others; only the slope over time shows
        # it.
        spread = float(times @ times)
        slope = times @ offsets / spread
        noise = noises.mean(axis=0) / spread
        return bool(slope @ np.linalg.solve(noise, slope) > MAX_MOTION_CHI2)
