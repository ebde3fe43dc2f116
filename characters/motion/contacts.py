"""When feet stand on the ground: detected in a clip, not marked by hand.

A foot stands while a joint of it is both low and slow over the ground. What counts as slow grows
with the body's own speed; what counts as low, with its height. Thresholds have hysteresis, and
what is shorter than any real contact is dropped. A clip that walks in place stands on a ground
that runs backward under it, as on a treadmill; how fast, the standing feet themselves tell.

Source: Ikemoto, Arikan and Forsyth, "Knowing when to put your foot down", I3D 2006, for low and
slow.
"""

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from characters.motion.clip import Clip
from characters.motion.ground import NEAR, STEADY, above_lowest, find_ground, track
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton

Feet = Sequence[Sequence[int]]
"""The joints of each foot, from the ankle on; a paw may have one joint only."""

_LOW = (NEAR, 0.05)  # body heights above a joint's lowest: to begin and to end a contact
_SLOW = (0.10, 0.15)  # body heights a second, plus …
_SHARE = (0.16, 0.24)  # … parts of the body's own speed: likewise
_EASED = (0.6, 0.8)  # the same on a treadmill: animators let its speed rise and fall
_HASTE = 0.15  # what counts of being faster than a treadmill, which no swinging foot is
_ALOFT = 0.08  # body heights: a foot that stays so much above the lowest one is never down
_SHORTEST = 0.06  # [s]: shorter contacts and shorter gaps are flickers
_BREADTH = 0.4  # [s]: over which the body's speed is averaged, about half a cycle

_EXTREMITY = re.compile(r"(?i:foot|toe|paw|hoof|hand)")
_FINGER = re.compile(r"(?i:thumb|finger|index|middle|ring|pinky|palm)")


def find_contacts(clip: Clip, skeleton: Skeleton, feet: Feet) -> NDArray[np.bool_]:
    """Return when each foot stands on the ground, (frames, feet).

    Parameters
    ----------
    clip
        With or without root motion; a loop is taken as periodic.
    skeleton
        What it moves.
    feet
        The joints of each foot; see `feet_of`.
    """
    if len(clip) < 2 or not feet:
        return np.ones((len(clip), len(feet)), bool)
    tracked = track(clip, skeleton)
    joints = np.array([joint for foot in feet for joint in foot])
    owner = np.array([number for number, foot in enumerate(feet) for _ in foot])
    heights = tracked.places[:, joints, 1]
    above = above_lowest(heights)
    ground = find_ground(clip, tracked, joints)
    over = tracked.speeds - ground.under(tracked.places)
    body = _smoothed(np.linalg.norm(over.mean(1), axis=-1), clip)[:, None]
    speeds = _slips(over[:, joints], ground.under(tracked.places[:, joints]))
    shares = _SHARE if ground is STEADY else _EASED
    begin, stay = (
        (above < low * tracked.tall) & (speeds < slow * tracked.tall + share * body)
        for low, slow, share in zip(_LOW, _SLOW, shares, strict=True)
    )
    rest = skeleton.rest.globals(skeleton)[joints, 1, 3]
    grounded = _grounded(heights, rest, owner, _ALOFT * tracked.tall)
    contacts = np.zeros((len(clip), len(feet)), bool)
    for number in range(len(feet)):
        of_it = owner == number
        held = _held(_any(begin[:, of_it]), _any(stay[:, of_it]), clip.loop)
        contacts[:, number] = _steady(held, clip) & grounded[number]
    return contacts


def feet_of(skeleton: Skeleton) -> tuple[tuple[int, ...], ...]:
    """Return the joints of each foot and paw, each from its ankle on, in the skeleton's order.

    They are known by their names; hands are paws where they are as near to the ground as feet.
    Where names are silent, the shape of the skeleton tells.
    """
    named = [
        joint
        for joint, name in enumerate(skeleton.names)
        if _EXTREMITY.search(name) and not _FINGER.search(name)
    ]
    if not named:
        parts = Anatomy.guess(skeleton).joints
        named = sorted(joint for part, joint in parts.items() if _EXTREMITY.search(part))
    feet: dict[int, list[int]] = {}
    for joint in named:
        above = skeleton.parents[joint]
        first = next((first for first, foot in feet.items() if above in foot), joint)
        feet.setdefault(first, []).append(joint)
    heights = skeleton.rest.globals(skeleton)[:, 1, 3]
    reach = 0.15 * np.ptp(heights)
    floor = min((heights[foot].min() for foot in feet.values()), default=0.0)
    return tuple(tuple(foot) for foot in feet.values() if heights[foot].min() < floor + reach)


def spans(contacts: NDArray[np.bool_], loop: bool) -> list[tuple[int, int]]:
    """Return the first frame of each contact of one foot and how many frames it lasts.

    In a loop, whose last frame is its first, a contact may begin late and end early.

    >>> spans(np.array([True, False, True, True, True]), loop=True)
    [(2, 3)]
    >>> spans(np.array([True, False, True, True, True]), loop=False)
    [(0, 1), (2, 3)]
    """
    cycle = contacts[:-1] if loop and len(contacts) > 1 else contacts
    if cycle.all() or not cycle.any():
        return [(0, len(cycle))] if cycle.any() else []
    start = int(np.argmin(cycle)) if loop else 0  # a frame in the air, so that nothing is cut
    turned = np.concatenate([[False], np.roll(cycle, -start), [False]])
    edges = np.flatnonzero(turned[1:] != turned[:-1])
    return sorted(
        ((int(first) + start) % len(cycle), int(last - first))
        for first, last in zip(edges[::2], edges[1::2], strict=True)
    )


def _slips(over: Array, ground: Array) -> Array:
    """Return how fast joints slip, (…) [m/s], from velocities over the ground, and its own (…, 3).

    A foot that goes backward faster than a treadmill slips less than one that goes forward.
    """
    along = ground / np.maximum(np.linalg.norm(ground, axis=-1, keepdims=True), 1e-9)
    ahead = np.einsum("...i,...i->...", over, along)[..., None]
    slips: Array = np.linalg.norm(over - along * np.maximum(ahead, 0.0) * (1 - _HASTE), axis=-1)
    return slips


def _grounded(
    heights: Array, rest: Array, owner: NDArray[np.intp], near: float
) -> NDArray[np.bool_]:
    """Return which feet come down at all, (feet,): to the lowest foot's ground, or as at rest.

    `heights` (frames, n) and `rest` (n,) are of joints, `owner` (n,) says of which feet.
    """
    count = int(owner.max()) + 1
    lowest, at_rest = np.full(count, np.inf), np.full(count, np.inf)
    np.minimum.at(lowest, owner, heights.min(0))
    np.minimum.at(at_rest, owner, rest)
    risen = lowest - at_rest
    down: NDArray[np.bool_] = (lowest < lowest.min() + near) | (risen < risen.min() + near)
    return down


def _smoothed(values: Array, clip: Clip) -> Array:
    """Return the running mean of values (frames,) over the breadth of a step."""
    cycle = values[:-1] if clip.loop else values
    width = min(max(round(_BREADTH * clip.rate), 1), len(cycle)) | 1
    half = width // 2
    padded = np.pad(cycle, half, mode="wrap" if clip.loop else "edge")
    total = np.concatenate([[0.0], np.cumsum(padded)])
    mean = (total[width:] - total[:-width]) / width
    return np.append(mean, mean[0]) if clip.loop else mean


def _any(joints: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return whether any joint of a foot (frames, joints) does, (frames,)."""
    return np.asarray(joints.any(axis=1), np.bool_)


def _held(begin: NDArray[np.bool_], stay: NDArray[np.bool_], loop: bool) -> NDArray[np.bool_]:
    """Return stretches of `stay` (frames,) that hold a frame of `begin`: hysteresis."""
    held = np.zeros_like(begin)
    count = len(begin) - 1 if loop else len(begin)
    for first, length in spans(stay, loop):
        frames = np.arange(first, first + length) % count
        held[frames] = begin[frames].any()
    if loop:
        held[-1] = held[0]
    return held


def _steady(contacts: NDArray[np.bool_], clip: Clip) -> NDArray[np.bool_]:
    """Return contacts (frames,) with short gaps closed and then short contacts dropped."""
    steady = contacts.copy()
    count = len(contacts) - 1 if clip.loop else len(contacts)
    for down in (False, True):
        found = spans(steady == down, clip.loop)
        for first, length in found:
            at_an_end = not clip.loop and (first == 0 or first + length == count)
            if length < _SHORTEST * clip.rate and not at_an_end and length < count:
                steady[np.arange(first, first + length) % count] = not down
    if clip.loop:
        steady[-1] = steady[0]
    return steady
