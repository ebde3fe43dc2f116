"""The way over the ground of a body whose clip has no root for it.

Hips sway with every step; a root does not. It follows the hips, smoothed over a stride.
"""

import numpy as np

from characters.motion.clip import Clip
from characters.retargeting.body import Body
from characters.skeleton import rotations
from characters.skeleton.pose import Array

_BREADTH = 0.3  # [s]: standard deviation of the smoothing, which a stride's sway does not survive


def root_way(clip: Clip, source: Body, ratio: float) -> Array:
    """Return where the root is, (frames, 3): x, z [m of the target] and yaw [rad].

    The clip's own root if it has one, else the hips' way over the ground, smoothed.
    """
    if clip.root_motion:
        return clip.track * [ratio, ratio, 1.0]
    joint = source.anatomy.joints["hips"]
    globals_ = clip.poses.globals(source.skeleton)[:, joint]
    places = rotations.rotate(source.upright, globals_[:, :3, 3]) * ratio
    yaw = np.unwrap(rotations.heading(hips_turns(clip, source)))
    way = np.stack([places[:, 0], places[:, 2], yaw], axis=-1)
    return smoothed(way, _BREADTH * clip.rate)


def hips_turns(clip: Clip, body: Body) -> Array:
    """Return how the hips are turned away from rest, (frames, 4), in the common axes."""
    joint = body.anatomy.joints["hips"]
    globals_ = clip.poses.globals(body.skeleton)[:, joint]
    lengths = np.linalg.norm(globals_[:, :3, :3], axis=-2, keepdims=True)
    now = rotations.multiply(
        body.upright, rotations.from_matrix(globals_[:, :3, :3] / np.where(lengths > 0, lengths, 1))
    )
    return rotations.multiply(now, rotations.conjugate(body.rest_turns[joint]))


def smoothed(way: Array, deviation: float) -> Array:
    """Return a way (frames, n) under a Gaussian of a standard deviation [frames].

    At the ends it goes on as it came, mirrored through the last point, so that a body that enters
    or leaves at full speed keeps it.
    """
    reach = min(int(3 * deviation), len(way) - 1)
    if reach < 1:
        return way.copy()
    before = 2 * way[0] - way[reach:0:-1]
    after = 2 * way[-1] - way[-2 : -2 - reach : -1]
    padded = np.concatenate([before, way, after])
    offsets = np.arange(-reach, reach + 1)
    kernel = np.exp(-0.5 * (offsets / deviation) ** 2)
    kernel /= kernel.sum()
    return np.stack([np.convolve(column, kernel, mode="valid") for column in padded.T], axis=-1)
