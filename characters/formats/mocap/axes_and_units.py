"""Which way is up in a recording, and how long its unit is: files of motion capture do not say.

Up is where the body is, seen from the feet, in most of the frames; where the rest pose has it
elsewhere, the one of the two that keeps the feet on one floor. The unit is the one that makes the
performer most nearly as tall as a grown person.
"""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.skeleton.pose import Array, Pose, Skeleton

ADULT = 1.7
"""What a recognised performer should be close to [m]."""

PLAUSIBLE = (0.5, 2.5)
"""Between these, a stated unit is believed [m]."""

UNITS = {"metre": 1.0, "foot": 0.3048, "decimetre": 0.1, "inch": 0.0254, "cm": 0.01, "mm": 0.001}
"""Units that recordings come in [m]."""

CMU_UNIT = 0.0254 / 0.45
"""Unit of the CMU database [m]: inches, times 0.45."""

_CMU_STATURES = (1.2, 2.0)  # its performers are grown people; nobody else uses that unit
_LOOKS = 32  # frames to look at, spread over the recording
_CLEAR = 0.7  # cosine from which on a direction is along an axis: 45°

# The turn that brings each axis up, by the shortest way: rows are what x, y, z become.
_TURNS = {
    "+y": np.eye(3),
    "-y": np.diag([-1.0, -1.0, 1.0]),
    "+z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "-z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "+x": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "-x": np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
_HEAD = re.compile(r"head|skull", re.IGNORECASE)
_NECK = re.compile(r"neck", re.IGNORECASE)
_FOOT = re.compile(r"foot|ankle|toe|paw|hoof", re.IGNORECASE)


@dataclass(frozen=True)
class Settled:
    """A recording in metres with +y up."""

    skeleton: Skeleton
    """The performer."""

    poses: Pose
    """(frames, joints, …)."""

    notes: tuple[str, ...]
    """What was guessed, for a person to check."""


def settle(
    path: Path,
    skeleton: Skeleton,
    poses: Pose,
    *,
    scale: float | None = None,
    up: str | None = None,
    stated: float | None = None,
) -> Settled:
    """Return a recording in metres with +y up.

    Parameters
    ----------
    path
        The file, for messages.
    skeleton, poses
        In the file's axes and units.
    scale
        Metres a unit; recognised where it is None.
    up
        "x", "y", "z", "-x", "-y" or "-z"; recognised where it is None.
    stated
        Metres a unit as the file says: believed if it makes a plausible performer.

    Raises
    ------
    CharacterError
        If `scale` or `up` is not one of these.
    """
    looks = poses[np.unique(np.linspace(0, len(poses.rotations) - 1, _LOOKS).round().astype(int))]
    places = looks.globals(skeleton)[..., :3, 3]
    axis, why_up = _known_up(path, up) if up is not None else _recognised_up(skeleton, places)
    tall = float(np.percentile(np.ptp(places[..., "xyz".index(axis[1])], axis=-1), 90))
    if scale is not None:
        if not 1e-6 <= scale <= 1e6:  # between a micrometre and what keeps positions finite
            raise CharacterError(f"{path}: scale {scale:g} is no length; give metres a unit")
        why_scale: tuple[str, ...] = ()
    else:
        scale, why_scale = _recognised_unit(tall, stated)
    turn = _TURNS[axis]
    rest = _moved(skeleton.rest, turn, scale)
    return Settled(
        Skeleton(skeleton.names, skeleton.parents, rest),
        _moved(poses, turn, scale),
        why_up + why_scale,
    )


def _moved(pose: Pose, turn: Array, scale: float) -> Pose:
    """Return a pose in other axes and units: every joint's frame turns along, none is tilted."""
    if np.array_equal(turn, np.eye(3)):
        return Pose(pose.translations * scale, pose.rotations)
    quaternions = pose.rotations.copy()
    quaternions[..., :3] = pose.rotations[..., :3] @ turn.T
    return Pose(pose.translations @ (turn.T * scale), quaternions)


def _known_up(path: Path, up: str) -> tuple[str, tuple[str, ...]]:
    axis = up.lower() if up[:1] in ("+", "-") else "+" + up.lower()
    if axis not in _TURNS:
        raise CharacterError(f"{path}: up {up!r} is no axis; give x, y, z, -x, -y or -z")
    return axis, ()


def _recognised_up(skeleton: Skeleton, places: Array) -> tuple[str, tuple[str, ...]]:
    """Return the axis from feet to body in the frames, else in the rest pose, else +y."""
    names = skeleton.names
    heads = [j for j, name in enumerate(names) if _HEAD.search(name)]
    heads = heads or [j for j, name in enumerate(names) if _NECK.search(name)] or [0]
    feet = [j for j, name in enumerate(names) if _FOOT.search(name)]
    if not feet:
        return "+y", ("no foot by name: +y is taken as up; give up= if it is not",)

    def upward(at: Array) -> str | None:
        # Half-way from hips to head, for those on four legs, whose head is far ahead.
        body = (at[:, heads].mean(1) + at[:, 0]) / 2
        return _along(body - at[:, feet].mean(1))

    moving = upward(places)
    resting = upward(skeleton.rest.globals(skeleton)[None, :, :3, 3])
    axis = moving or resting or "+y"
    if moving is None:
        return axis, (f"feet to head point no one way: {axis} is taken as up; give up= if not",)
    if resting not in (None, moving):
        # Somebody lies or crawls, or the rest pose is in other axes: the floor is where it was.
        axis = min((moving, resting), key=lambda axis: _unrest(places, axis))
        other = moving if axis == resting else resting
        return axis, (f"{axis} is taken as up, though it might be {other}: give up= if it is",)
    return axis, () if axis == "+y" else (f"up was {axis}, from feet to head",)


def _unrest(places: Array, axis: str) -> float:
    """Return how much the lowest point moves up and down if an axis is up."""
    heights = places[..., "xyz".index(axis[1])] * (1 if axis[0] == "+" else -1)
    return float(heights.min(axis=-1).std())


def _along(directions: Array) -> str | None:
    """Return the axis along which most of some directions point; nobody's up is x."""
    lengths = np.linalg.norm(directions, axis=-1, keepdims=True)
    mean = (directions / np.maximum(lengths, 1e-12)).mean(0)
    axis = int(np.abs(mean).argmax())
    if axis == 0 or abs(mean[axis]) < _CLEAR:
        return None
    return "-+"[int(mean[axis] > 0)] + "xyz"[axis]


def _recognised_unit(tall: float, stated: float | None) -> tuple[float, tuple[str, ...]]:
    """Return metres a unit for a performer so many units tall, and a note on the guess."""
    if stated is not None and PLAUSIBLE[0] <= tall * stated <= PLAUSIBLE[1]:
        return stated, ()
    if tall <= 0:
        return UNITS["cm"], ("nothing to tell the unit by: cm; give scale= if it is not",)
    units = dict(UNITS)
    if _CMU_STATURES[0] <= tall * CMU_UNIT <= _CMU_STATURES[1]:
        units["CMU's unit (0.0254 m / 0.45)"] = CMU_UNIT
    name = min(units, key=lambda unit: abs(np.log(tall * units[unit] / ADULT)))
    height = tall * units[name]
    note = f"1 unit is taken as 1 {name}, so from the lowest joint to the highest {height:.2f} m"
    return units[name], (note + "; give scale= if it is not",)
