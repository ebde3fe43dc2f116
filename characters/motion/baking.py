"""Sample motions at a fixed rate, and keep them as clips."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose


def bake(motion: Motion, rate: float, seconds: float, name: str) -> Clip:
    """Return the poses of a motion at a frame rate [Hz], as a clip of a length [s].

    They are sampled in the order of time.
    """
    times = [number / rate for number in range(round(seconds * rate) + 1)]
    places = [RootDelta()]
    for before, after in pairwise(times):
        places.append(places[-1].then(motion.travel(before, after)))
    return placed_clip(name, rate, stack([motion.sample(time) for time in times]), places)


def stack(frames: Sequence[Pose]) -> Pose:
    """Return single poses as the frames of one, with the scales and morphs that any of them has."""
    poses = Pose.of_frames(frames)
    if any(pose.scales is not None for pose in frames):
        poses = replace(poses, scales=np.stack([pose.scales_or_ones for pose in frames]))
    morphs = max(0 if pose.morphs is None else len(pose.morphs) for pose in frames)
    if morphs:
        none = np.zeros(morphs)
        shown = [none if pose.morphs is None else pose.morphs for pose in frames]
        poses = replace(poses, morphs=np.stack(shown))
    return poses


def placed_clip(
    name: str, rate: float, poses: Pose, places: Sequence[RootDelta], loop: bool = False
) -> Clip:
    """Return poses with the root at the origin, put at places on the ground, as a clip."""
    translations, turns = poses.translations.copy(), poses.rotations.copy()
    track = np.array([(place.x, place.z, place.yaw) for place in places])
    yaw = rotations.about("y", track[:, 2])
    translations[:, 0] = rotations.rotate(yaw, translations[:, 0])
    translations[:, 0, [0, 2]] += track[:, :2]
    turns[:, 0] = rotations.multiply(yaw, turns[:, 0])
    moved = Pose(translations, turns, poses.scales, poses.morphs)
    return Clip(name, rate, moved, loop, root_motion=True)
