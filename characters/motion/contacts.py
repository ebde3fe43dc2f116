"""When feet stand on the ground: detected in a clip without manual marks.

A foot stands while one of its joints is both low and slow over the ground (Ikemoto, Arikan and
Forsyth, "Knowing when to put your foot down", I3D 2006). The limits have hysteresis and grow with
the body's height and speed; very short contacts and gaps are dropped.
"""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.ground import (
    FIXED_GROUND,
    MAX_CONTACT_HEIGHT,
    find_ground,
    height_above_lowest,
    joint_trajectories,
)
from cubeling.characters.skeleton.feet import Feet
from cubeling.characters.skeleton.pose import Array, Skeleton

# Limits to begin and to end a contact: lengths in body heights, speeds in body heights a second.
_HEIGHT_LIMITS = (MAX_CONTACT_HEIGHT, 0.05)  # above a joint's lowest position
_SPEED_LIMITS = (0.10, 0.15)
_SPEED_SHARES = (0.16, 0.24)  # added to the speed limits, as parts of the body's own speed
_TREADMILL_SPEED_SHARES = (0.6, 0.8)  # in animated loops the treadmill's speed varies
_BACKWARD_SLIP_WEIGHT = 0.15  # a swinging foot is never faster than the treadmill
_MAX_LOWEST_HEIGHT = 0.08  # a foot that stays higher above the lowest foot has no contacts
_MIN_CONTACT_S = 0.06  # shorter contacts and gaps are noise
_SPEED_WINDOW_S = 0.4  # the body's speed is averaged over about half a cycle


def find_contacts(clip: Clip, skeleton: Skeleton, feet: Feet) -> NDArray[np.bool_]:
    """Return when each foot stands on the ground, (frames, feet).

    `feet` are the joints of each foot; see `find_feet`. A loop is treated as periodic. Under a clip
    that walks in place the ground moves backward, as on a treadmill.
    """
    if len(clip) < 2 or not feet:
        return np.ones((len(clip), len(feet)), bool)
    tracks = joint_trajectories(clip, skeleton)
    joints = np.array([joint for foot in feet for joint in foot])
    owner = np.array([number for number, foot in enumerate(feet) for _ in foot])
    heights = tracks.positions[:, joints, 1]
    above = height_above_lowest(heights)
    ground = find_ground(clip, tracks, joints)
    relative = tracks.velocities - ground.velocity_at(tracks.positions)
    body = _running_mean(np.linalg.norm(relative.mean(1), axis=-1), clip)[:, None]
    slips = _slip_speeds(relative[:, joints], ground.velocity_at(tracks.positions[:, joints]))
    speeds = np.hypot(slips, _vertical_speeds(heights, clip))
    shares = _SPEED_SHARES if ground is FIXED_GROUND else _TREADMILL_SPEED_SHARES
    begin, stay = (
        (above < height * tracks.body_height) & (speeds < speed * tracks.body_height + share * body)
        for height, speed, share in zip(_HEIGHT_LIMITS, _SPEED_LIMITS, shares, strict=True)
    )
    rest = skeleton.rest.globals(skeleton)[joints, 1, 3]
    grounded = _touching_feet(heights, rest, owner, _MAX_LOWEST_HEIGHT * tracks.body_height)
    contacts = np.zeros((len(clip), len(feet)), bool)
    for number in range(len(feet)):
        own = owner == number
        held = _hysteresis(np.any(begin[:, own], axis=1), np.any(stay[:, own], axis=1), clip.loop)
        contacts[:, number] = _without_short_spans(held, clip) & grounded[number]
    return contacts


def spans(contacts: NDArray[np.bool_], loop: bool) -> list[tuple[int, int]]:
    """Return the first frame and the number of frames of each contact of one foot.

    In a loop, whose last frame equals its first, a contact may continue beyond the end.

    >>> spans(np.array([True, False, True, True, True]), loop=True)
    [(2, 3)]
    >>> spans(np.array([True, False, True, True, True]), loop=False)
    [(0, 1), (2, 3)]
    """
    cycle = contacts[:-1] if loop and len(contacts) > 1 else contacts
    if cycle.all() or not cycle.any():
        return [(0, len(cycle))] if cycle.any() else []
    start = int(np.argmin(cycle)) if loop else 0  # a frame in the air, so that no contact is split
    turned = np.concatenate([[False], np.roll(cycle, -start), [False]])
    edges = np.flatnonzero(turned[1:] != turned[:-1])
    return sorted(
        ((int(first) + start) % len(cycle), int(last - first))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    )


def _slip_speeds(relative: Array, ground: Array) -> Array:
    """Return how fast joints slip, (…) [m/s].

    `relative` are their velocities over the ground and `ground` the ground's own, (…, 3). A foot
    that goes backward faster than a treadmill slips less than one that goes forward.
    """
    along = ground / np.maximum(np.linalg.norm(ground, axis=-1, keepdims=True), 1e-9)
    ahead = np.einsum("...i,...i->...", relative, along)[..., None]
    backward = along * np.maximum(ahead, 0.0) * (1 - _BACKWARD_SLIP_WEIGHT)
    slips: Array = np.linalg.norm(relative - backward, axis=-1)
    return slips


def _vertical_speeds(heights: Array, clip: Clip) -> Array:
    """Return how fast joints rise or fall, (frames, n) [m/s], between the frames around each."""
    ends = (heights[-2:-1], heights[1:2]) if clip.loop else (heights[:1], heights[-1:])
    padded = np.concatenate([ends[0], heights, ends[1]])
    speeds: Array = np.abs(padded[2:] - padded[:-2]) * clip.rate / 2
    return speeds


def _touching_feet(
    heights: Array, rest: Array, owner: NDArray[np.intp], margin: float
) -> NDArray[np.bool_]:
    """Return which feet come down at all, (feet,): near the lowest foot, or as low as at rest.

    `heights` (frames, n) and `rest` (n,) are of joints, `owner` (n,) are the numbers of their feet.
    """
    count = int(owner.max()) + 1
    lowest, at_rest = np.full(count, np.inf), np.full(count, np.inf)
    np.minimum.at(lowest, owner, heights.min(0))
    np.minimum.at(at_rest, owner, rest)
    raised = lowest - at_rest
    down: NDArray[np.bool_] = (lowest < lowest.min() + margin) | (raised < raised.min() + margin)
    return down


def _running_mean(values: Array, clip: Clip) -> Array:
    """Return the running mean of values (frames,) over `_SPEED_WINDOW_S`."""
    cycle = values[:-1] if clip.loop else values
    width = min(max(round(_SPEED_WINDOW_S * clip.rate), 1), len(cycle)) | 1
    half = width // 2
    padded = np.pad(cycle, half, mode="wrap" if clip.loop else "edge")
    total = np.concatenate([[0.0], np.cumsum(padded)])
    mean = (total[width:] - total[:-width]) / width
    return np.append(mean, mean[0]) if clip.loop else mean


def _hysteresis(begin: NDArray[np.bool_], stay: NDArray[np.bool_], loop: bool) -> NDArray[np.bool_]:
    """Return the spans of `stay` (frames,) that contain a frame of `begin`."""
    held = np.zeros_like(begin)
    count = len(begin) - 1 if loop else len(begin)
    for first, length in spans(stay, loop):
        frames = np.arange(first, first + length) % count
        held[frames] = begin[frames].any()
    if loop:
        held[-1] = held[0]
    return held


def _without_short_spans(contacts: NDArray[np.bool_], clip: Clip) -> NDArray[np.bool_]:
    """Return contacts (frames,) with short gaps closed and then short contacts dropped."""
    steady = contacts.copy()
    count = len(contacts) - 1 if clip.loop else len(contacts)
    for down in (False, True):
        for first, length in spans(steady == down, clip.loop):
            at_an_end = not clip.loop and (first == 0 or first + length == count)
            if length < _MIN_CONTACT_S * clip.rate and not at_an_end and length < count:
                steady[np.arange(first, first + length) % count] = not down
    if clip.loop:
        steady[-1] = steady[0]
    return steady
