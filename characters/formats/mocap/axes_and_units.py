"""The vertical axis and the unit of a recording, which motion capture files do not state.

Up points from the feet to the body in most of the frames. Where the rest pose disagrees, the axis
that keeps the feet on one floor wins. The unit is the one that brings the performer's height
closest to that of an adult.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

ADULT_HEIGHT_M = 1.7
PLAUSIBLE_HEIGHT_M = (0.5, 2.5)
"""A stated unit is trusted if it makes a performer of such a height."""

UNITS_M = {"metre": 1.0, "foot": 0.3048, "decimetre": 0.1, "inch": 0.0254, "cm": 0.01, "mm": 0.001}
"""Units of recordings [m]."""

CMU_UNIT_M = 0.0254 / 0.45
"""Unit of the CMU database [m]."""

_CMU_HEIGHT_M = (1.2, 2.0)  # only the CMU database uses its unit, and its performers are adults
_SCALE_RANGE_M = (1e-6, 1e6)  # between a micrometre and what keeps positions finite
_SAMPLED_FRAMES = 32  # spread over the recording
_MIN_AXIS_COSINE = 0.7  # of a direction along an axis: 45°
_MIN_AXIS_PART = 0.3  # of a mean direction along an axis that may be up

# The rotation that brings each axis up, by the shortest way: rows are what x, y, z become.
_Y_UP_FROM = {
    "+y": np.eye(3),
    "-y": np.diag([-1.0, -1.0, 1.0]),
    "+z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]),
    "-z": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "+x": np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "-x": np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
_HEAD_NAME = re.compile(r"head|skull", re.IGNORECASE)
_HIPS_NAME = re.compile(r"hips?$|pelvis|hip_?cent(er|re)", re.IGNORECASE)
_NECK_NAME = re.compile(r"neck", re.IGNORECASE)
_FOOT_NAME = re.compile(r"foot|ankle|toe|paw|hoof", re.IGNORECASE)


def metric_motion(
    path: Path,
    clip: Clip,
    skeleton: Skeleton,
    options: MotionOptions,
    notes: tuple[str, ...],
    stated_unit: float | None = None,
) -> RecordedMotion:
    """Return a recording in metres with +y up.

    Scale and vertical axis are recognised if the options leave them out; a unit stated by the
    file [m] is trusted if it makes a plausible performer.
    """
    poses = clip.poses
    frames = np.linspace(0, len(clip) - 1, _SAMPLED_FRAMES).round().astype(int)
    positions = poses[np.unique(frames)].globals(skeleton)[..., :3, 3]
    body = _body_joints(skeleton)
    if options.up is not None:
        axis = _check_up(path, options.up)
    else:
        axis, up_notes = _recognise_up(skeleton, positions, body)
        notes += up_notes
    heights = positions[:, body, "xyz".index(axis[1])]
    height = float(np.percentile(np.ptp(heights, axis=-1), 90))
    scale = options.scale
    if scale is None:
        scale, scale_notes = _recognise_unit(height, stated_unit)
        notes += scale_notes
    elif not _SCALE_RANGE_M[0] <= scale <= _SCALE_RANGE_M[1]:
        raise CharacterError(f"{path}: scale {scale:g} is not a length; give metres per unit")
    turn = _Y_UP_FROM[axis]
    rest = _transform(skeleton.rest, turn, scale)
    return RecordedMotion(
        Skeleton(skeleton.names, skeleton.parents, rest),
        replace(clip, poses=_transform(poses, turn, scale)),
        notes,
    )


def _transform(pose: Pose, turn: Array, scale: float) -> Pose:
    """Return a pose in other axes and units; the frames of joints turn with the axes."""
    if np.array_equal(turn, np.eye(3)):
        return Pose(pose.translations * scale, pose.rotations)
    quaternions = pose.rotations.copy()
    quaternions[..., :3] = pose.rotations[..., :3] @ turn.T
    return Pose(pose.translations @ (turn.T * scale), quaternions)


def _check_up(path: Path, up: str) -> str:
    axis = up.lower() if up[:1] in ("+", "-") else "+" + up.lower()
    if axis not in _Y_UP_FROM:
        raise CharacterError(f"{path}: up {up!r} is not an axis; give x, y, z, -x, -y or -z")
    return axis


def _body_joints(skeleton: Skeleton) -> list[int]:
    """Return the hips and all joints below them; joints above them may stay at the origin.

    Hips are found by their name, else as the last joint that carries both the feet and the head.
    """
    names = skeleton.names
    ends = [
        joint
        for joint, name in enumerate(names)
        if _FOOT_NAME.search(name) or _HEAD_NAME.search(name)
    ]
    above = [set(skeleton.with_ancestors([end])) - set(ends) for end in ends]
    shared = set.intersection(*above) if above else {0}
    named = [joint for joint in sorted(shared) if _HIPS_NAME.search(names[joint])]
    hips = named[0] if named else max(shared, default=0)
    return subtree(skeleton, hips)


def _recognise_up(
    skeleton: Skeleton, positions: Array, body_joints: list[int]
) -> tuple[str, tuple[str, ...]]:
    """Return the axis from feet to body in the frames, else in the rest pose, else +y.

    `body_joints` are the hips and what is below them.
    """
    names, hips = skeleton.names, body_joints[0]
    heads = [j for j, name in enumerate(names) if _HEAD_NAME.search(name)]
    heads = heads or [j for j, name in enumerate(names) if _NECK_NAME.search(name)] or [hips]
    feet = [j for j, name in enumerate(names) if _FOOT_NAME.search(name)]
    if not feet:
        return "+y", ("no foot found by name: +y is taken as up; give up= if it is not",)

    def upward(at: Array) -> Array:
        # The middle of hips and head, because the head of an animal is far in front of its feet.
        return _mean_direction((at[:, heads].mean(1) + at[:, hips]) / 2 - at[:, feet].mean(1))

    way = upward(positions)
    moving = _clear_axis(way)
    resting = _clear_axis(upward(skeleton.rest.globals(skeleton)[None, :, :3, 3]))
    possible = {axis for axis in (moving, resting) if axis is not None}
    if moving is None:
        possible |= _axes_along(way)
    # Somebody lies or crawls, or the rest pose has other axes: the floor decides.
    body = positions[:, body_joints]
    axis = min(sorted(possible), key=lambda axis: _floor_deviation(body, axis), default="+y")
    if moving is None:
        return axis, (f"no clear direction from feet to head: {axis} is taken as up; give up=",)
    others = possible - {axis}
    if others:
        return axis, (f"{axis} is taken as up, but {others.pop()} is possible: give up= if it is",)
    return axis, () if axis == "+y" else (f"up was {axis}, from feet to head",)


def _floor_deviation(positions: Array, axis: str) -> float:
    """Return how much the lowest point moves up and down if an axis is up."""
    heights = positions[..., "xyz".index(axis[1])] * (1 if axis[0] == "+" else -1)
    return float(heights.min(axis=-1).std())


def _mean_direction(ways: Array) -> Array:
    """Return the mean (3,) of the directions of ways (n, 3); short if they differ."""
    lengths = np.linalg.norm(ways, axis=-1, keepdims=True)
    return np.asarray((ways / np.maximum(lengths, 1e-12)).mean(0), np.float64)


def _clear_axis(direction: Array) -> str | None:
    """Return the axis of a mean direction, if it is clear; x is never up."""
    axis = int(np.abs(direction).argmax())
    if axis == 0 or abs(direction[axis]) < _MIN_AXIS_COSINE:
        return None
    return "-+"[int(direction[axis] > 0)] + "xyz"[axis]


def _axes_along(direction: Array) -> set[str]:
    """Return all axes that a mean direction has a part of."""
    parts = zip("xyz", direction, strict=True)
    return {"-+"[int(part > 0)] + name for name, part in parts if abs(part) > _MIN_AXIS_PART}


def _recognise_unit(height: float, stated: float | None) -> tuple[float, tuple[str, ...]]:
    """Return the unit [m] for a performer of this height in units, and a note on the guess."""
    if stated is not None and PLAUSIBLE_HEIGHT_M[0] <= height * stated <= PLAUSIBLE_HEIGHT_M[1]:
        return stated, ()
    if height <= 0:
        return UNITS_M["cm"], ("no size to recognise the unit by: cm is assumed; give scale=",)
    units = dict(UNITS_M)
    if _CMU_HEIGHT_M[0] <= height * CMU_UNIT_M <= _CMU_HEIGHT_M[1]:
        units["CMU's unit (0.0254 m / 0.45)"] = CMU_UNIT_M
    name = min(units, key=lambda unit: abs(np.log(height * units[unit] / ADULT_HEIGHT_M)))
    note = (
        f"1 unit is taken as 1 {name}, which makes {height * units[name]:.2f} m from the lowest "
        "joint to the highest; give scale= if it is not"
    )
    return units[name], (note,)
