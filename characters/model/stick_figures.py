"""A body for motions without meshes: one capsule per bone.

The left side is blue, the right side is red, and the head has a nose: side and facing are what
motion capture most often gets wrong.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton

LEFT_RGB, RIGHT_RGB, MIDDLE_RGB = (0.06, 0.2, 0.55), (0.6, 0.06, 0.04), (0.5, 0.46, 0.38)
"""Linear colours of the sides."""

_CAPSULE_SIDES = 14
_RING_HEIGHTS = np.sin(np.linspace(-0.5, 0.5, 7) * np.pi)  # of both hemispheres, along the axis

_BONE_RADIUS = 0.11  # bone lengths …
_MIN_BONE_RADIUS, _MAX_BONE_RADIUS = 0.005, 0.022  # … within these limits in body heights
_MIN_HEAD_RADIUS, _MAX_HEAD_RADIUS = 0.06, 0.13  # body heights
_NOSE_RADIUS = 0.28  # head radii


class _Capsule(NamedTuple):
    """A capsule in the rest pose that one joint moves."""

    start: Array  # centre of the first hemisphere, (3,) [m]
    end: Array  # centre of the second one, (3,) [m]
    radii: tuple[float, float]  # at start and end [m]
    joint: int
    color: Array  # linear RGB, (3,)


def stick_figure(name: str, skeleton: Skeleton, clips: Iterable[Clip] = ()) -> Character:
    """Return a character with a body of capsules; a root joint on the ground is not drawn."""
    rest = skeleton.rest.globals(skeleton).astype(np.float64)
    anatomy = Anatomy.guess(skeleton)
    capsules = [*_bones(skeleton, anatomy, rest), *_head(anatomy, rest)]
    meshes = (_mesh(capsules, rest),) if capsules else ()
    return Character(name, skeleton, {clip.name: clip for clip in clips}, meshes)


def _bones(skeleton: Skeleton, anatomy: Anatomy, rest: Array) -> Iterator[_Capsule]:
    """Yield a capsule from each joint to each of its children, and a sphere at each tip."""
    starts, ends = _bone_joints(skeleton, anatomy)
    places, colors = rest[:, :3, 3], _colors(skeleton, anatomy)
    tall = _height(places)
    tips = dict.fromkeys(np.flatnonzero(ends).tolist())
    for joint, parent in enumerate(skeleton.parents):
        length = float(np.linalg.norm(places[joint] - places[parent]))
        if parent < 0 or not (ends[joint] and starts[parent]) or length <= 1e-3 * tall:
            continue
        tips.pop(parent, None)
        radius = min(max(_BONE_RADIUS * length, _MIN_BONE_RADIUS * tall), _MAX_BONE_RADIUS * tall)
        radii = (radius, 0.6 * radius)
        yield _Capsule(places[parent], places[joint], radii, parent, colors[joint])
    radius = 1.6 * _MIN_BONE_RADIUS * tall
    for tip in tips:
        yield _Capsule(places[tip], places[tip], (radius, radius), tip, colors[tip])


def _bone_joints(
    skeleton: Skeleton, anatomy: Anatomy
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return which joints start a bone and which end one, (joints,) each.

    Joints above the hips carry the body over the ground, joints next to them control limbs, and
    joints in the head move the face: none of them has a bone.
    """
    hips, head = anatomy.joint("hips"), anatomy.joint("head")
    outer = np.ones(len(skeleton), bool)
    inner = np.ones(len(skeleton), bool)
    if hips is None:
        inner[0] = not skeleton.has_root_motion
        return inner, inner
    outer[:] = False
    for joint, parent in enumerate(skeleton.parents):
        outer[joint] = joint == hips or (parent >= 0 and inner[parent] and outer[parent])
        inner[joint] = joint != head or anatomy.kind != "humanoid"
    return inner & outer, outer


def _head(anatomy: Anatomy, rest: Array) -> list[_Capsule]:
    """Return a sphere with a nose for the head of a person."""
    head = anatomy.joint("head")
    if head is None or anatomy.kind != "humanoid":
        return []
    places = rest[:, :3, 3]
    tall = _height(places)
    rise = float(places[:, 1].max() - places[head, 1])  # to the end of the head, if it has a joint
    radius = min(max(0.5 * rise, _MIN_HEAD_RADIUS * tall), _MAX_HEAD_RADIUS * tall)
    centre = places[head] + [0.0, radius, 0.0]
    nose, nose_radius = centre + [0.0, 0.0, radius], radius * _NOSE_RADIUS
    color = np.array(MIDDLE_RGB)
    return [
        _Capsule(centre, centre, (radius, radius), head, color),
        _Capsule(nose, nose, (nose_radius, nose_radius), head, color),
    ]


def _mesh(capsules: Sequence[_Capsule], rest: Array) -> Mesh:
    """Return all capsules as one mesh bound to the rest pose."""
    starts, ends, end_radii, moving_joints, rgb = map(np.array, zip(*capsules, strict=True))
    axes = ends - starts
    lengths = np.linalg.norm(axes, axis=1, keepdims=True)
    axes = np.where(lengths > 1e-9, axes / np.maximum(lengths, 1e-9), [0.0, 1.0, 0.0])
    # The cross product with the most perpendicular world axis is never short.
    across = np.cross(axes, np.eye(3)[np.abs(axes).argmin(axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    turns = np.linspace(0.0, 2.0 * np.pi, _CAPSULE_SIDES + 1)[:-1]
    around = np.stack([across, np.cross(axes, across)], axis=1)
    spokes = np.einsum("sk,nkc->nsc", np.stack([np.cos(turns), np.sin(turns)], axis=1), around)
    # Rings of the first hemisphere, then of the second: (n, rings, sides, 3).
    rise = np.concatenate([_RING_HEIGHTS[_RING_HEIGHTS <= 0], _RING_HEIGHTS[_RING_HEIGHTS >= 0]])
    second = np.repeat([False, True], len(rise) // 2)
    normals = (
        np.sqrt(1.0 - rise**2)[None, :, None, None] * spokes[:, None]
        + rise[None, :, None, None] * axes[:, None, None]
    )
    centres = np.where(second[None, :, None], ends[:, None], starts[:, None])[:, :, None]
    radii = np.where(second[None], end_radii[:, 1:], end_radii[:, :1])[..., None, None]
    positions = centres + radii * normals
    count, each = len(starts), len(rise) * _CAPSULE_SIDES
    joints = np.zeros((count * each, 4), np.uint16)
    joints[:, 0] = np.repeat(moving_joints, each)
    colors = np.ones((count * each, 4), np.float32)
    colors[:, :3] = np.repeat(rgb, each, axis=0)
    return Mesh(
        name="bones",
        positions=positions.reshape(-1, 3).astype(np.float32),
        normals=normals.reshape(-1, 3).astype(np.float32),
        triangles=_triangles(len(rise), count),
        joints=joints,
        weights=np.tile([1.0, 0.0, 0.0, 0.0], (count * each, 1)).astype(np.float32),
        inverse_bind=np.asarray(np.linalg.inv(rest), np.float64),
        colors=colors,
        material=Material(roughness=0.6),
    )


def _triangles(rings: int, count: int) -> NDArray[np.uint32]:
    """Return the triangles between the rings of capsules, counter-clockwise from outside."""
    sides = _CAPSULE_SIDES
    ring, side = (grid.ravel() for grid in np.mgrid[: rings - 1, :sides])
    here, there = ring * sides + side, ring * sides + (side + 1) % sides
    quads = np.stack([here, there, there + sides, here, there + sides, here + sides], axis=1)
    numbers = quads.reshape(1, -1, 3) + (np.arange(count) * rings * sides)[:, None, None]
    return numbers.reshape(-1, 3).astype(np.uint32)


def _colors(skeleton: Skeleton, anatomy: Anatomy) -> Array:
    """Return the colours of joints, (joints, 3): by side, else that of the parent."""
    colors = np.empty((len(skeleton), 3))
    for joint, parent in enumerate(skeleton.parents):
        part = anatomy.parts.get(joint)
        if part is None:
            colors[joint] = MIDDLE_RGB if parent < 0 else colors[parent]
        else:
            sides = {"left": LEFT_RGB, "right": RIGHT_RGB}
            colors[joint] = next((c for s, c in sides.items() if part.startswith(s)), MIDDLE_RGB)
    return colors


def _height(places: Array) -> float:
    return max(float(np.ptp(places, axis=0).max()), 1e-6)
