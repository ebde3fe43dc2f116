"""Choosing a balance shift between two postures, and fitting it to them.

Source: Egges 2006, section 3.3.2, with errata 1 and 2 (S7).
"""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.skeleton.pose import Array


def fit(clip: Array, keys: Sequence[tuple[int, Array]]) -> Array:
    """Return a clip (frames, size) that passes through postures (size,) at frames.

    The offsets of the keys are interpolated along the clip; before the first and after the last
    key they fade to nothing at the ends of the clip. It is linear, so it may be done on vectors or
    on coordinates of a posture space.

    >>> clip = np.array([[0.0], [1.0], [0.0], [0.0], [0.0]])
    >>> fit(clip, [(0, np.array([1.0])), (2, np.array([2.0]))]).ravel().tolist()
    [1.0, 2.5, 2.0, 1.0, 0.0]
    """
    last = len(clip) - 1
    frames = [frame for frame, _ in keys]
    offsets = [posture - clip[frame] for frame, posture in keys]
    none = np.zeros(clip.shape[1])
    if frames[0] > 0:
        frames, offsets = [0, *frames], [none, *offsets]
    if frames[-1] < last:
        frames, offsets = [*frames, last], [*offsets, none]
    at = np.arange(len(clip))
    moved: Array = np.stack(
        [np.interp(at, frames, column) for column in np.array(offsets).T], axis=1
    )
    return clip + moved


def nearest_clip(firsts: Array, lasts: Array, start: Array, end: Array) -> int:
    """Return which clip is nearest to a start and an end: argmin of M = max(d(a_0, p), d(a_e, q)).

    `firsts` and `lasts` are the coordinates of the clips' first and last postures, (clips, count).
    """
    begins = np.linalg.norm(firsts - start, axis=1)
    ends = np.linalg.norm(lasts - end, axis=1)
    return int(np.maximum(begins, ends).argmin())
