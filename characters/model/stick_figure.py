"""A body for motions that have none: a capsule for each bone, so that any clip can be seen.

What is on the left is blue and what is on the right is red, and the head has a nose: in motion
capture these are the two things that are most often the wrong way round.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.model.character import Character
from characters.model.mesh import Material, Mesh
from characters.motion.clip import Clip
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton

LEFT, RIGHT, MIDDLE = (0.06, 0.2, 0.55), (0.6, 0.06, 0.04), (0.5, 0.46, 0.38)
"""Linear RGB of what is on a side."""

_SIDES = 14  # of a capsule
_RINGS = np.sin(np.linspace(-0.5, 0.5, 7) * np.pi)  # of both half balls, along the axis

_BREADTH = 0.11  # radius of a bone, as a share of its length …
_THIN, _THICK = 0.005, 0.022  # … but within these shares of the body's height
_SKULL = (0.06, 0.13)  # smallest and largest radius, as shares of the body's height
_NOSE = 0.28  # its radius, as a share of the skull's


@dataclass(frozen=True)
class _Capsules:
    """Capsules in the rest pose."""

    ends: Array
    """(n, 2, 3) [m]."""

    radii: Array
    """At both ends, (n, 2) [m]."""

    joints: NDArray[np.intp]
    """Which moves each, (n,)."""

    colors: Array
    """Linear RGB, (n, 3)."""


def stick_figure(name: str, skeleton: Skeleton, clips: Iterable[Clip] = ()) -> Character:
    """Return a character whose body is made of its bones.

    Parameters
    ----------
    name
        Of the character.
    skeleton
        Its joints; nothing is drawn for one that carries root motion.
    clips
        What it knows.
    """
    rest = skeleton.rest.globals(skeleton).astype(np.float64)
    anatomy = Anatomy.guess(skeleton)
    mesh = _mesh(_joined([*_bones(skeleton, anatomy, rest), *_head(anatomy, rest)]), rest)
    return Character(name, skeleton, {clip.name: clip for clip in clips}, (mesh,))


def _bones(skeleton: Skeleton, anatomy: Anatomy, rest: Array) -> list[_Capsules]:
    """Return a capsule from each joint to each of its children, and a ball at each tip."""
    inner, outer = _within(skeleton, anatomy)
    parents = np.array(skeleton.parents, np.intp)
    children = np.flatnonzero(outer & inner[parents] & (parents >= 0))
    parents = parents[children]
    places = rest[:, :3, 3]
    tall = _height(places)
    ends = np.stack([places[parents], places[children]], axis=1)
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    radii = np.clip(_BREADTH * lengths, _THIN * tall, _THICK * tall)
    shown = lengths > 1e-3 * tall
    sided = _colors(skeleton, anatomy)
    bones = _Capsules(ends, radii[:, None] * [1.0, 0.6], parents, sided[children])
    tips = np.setdiff1d(np.flatnonzero(outer), parents[shown])
    radius = np.full((len(tips), 2), 1.6 * _THIN * tall)
    balls = _Capsules(np.repeat(places[tips, None], 2, axis=1), radius, tips, sided[tips])
    return [_some(bones, shown), balls]


def _within(skeleton: Skeleton, anatomy: Anatomy) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return from which joints bones lead, and to which, (joints,) each.

    Above the hips lies what carries them over the ground, beside them what drives limbs, and in a
    skull what moves a face: none of it is a bone.
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


def _head(anatomy: Anatomy, rest: Array) -> list[_Capsules]:
    """Return a skull with a nose where the head of a person is."""
    head = anatomy.joint("head")
    if head is None or anatomy.kind != "humanoid":
        return []
    places = rest[:, :3, 3]
    tall = _height(places)
    rise = float(places[:, 1].max() - places[head, 1])  # of a joint that ends the head, if any
    radius = min(max(0.5 * rise, _SKULL[0] * tall), _SKULL[1] * tall)
    middle = places[head] + [0.0, radius, 0.0]
    nose = middle + [0.0, 0.0, radius]
    ends = np.stack([[middle, middle], [nose, nose]])
    radii = radius * np.array([[1.0, 1.0], [_NOSE, _NOSE]])
    return [_Capsules(ends, radii, np.full(2, head), np.tile(MIDDLE, (2, 1)))]


def _mesh(capsules: _Capsules, rest: Array) -> Mesh:
    """Return all capsules as one mesh that is bound to the rest pose."""
    starts, ends = capsules.ends[:, 0], capsules.ends[:, 1]
    axes = ends - starts
    lengths = np.linalg.norm(axes, axis=1, keepdims=True)
    axes = np.where(lengths > 1e-9, axes / np.maximum(lengths, 1e-9), [0.0, 1.0, 0.0])
    # The cross product with the world's axis that is least along it is never short.
    across = np.cross(axes, np.eye(3)[np.abs(axes).argmin(axis=1)])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    turns = np.linspace(0.0, 2.0 * np.pi, _SIDES + 1)[:-1]
    around = np.stack([across, np.cross(axes, across)], axis=1)
    spokes = np.einsum("sk,nkc->nsc", np.stack([np.cos(turns), np.sin(turns)], axis=1), around)
    # Rings of the first half ball, then of the second: (n, rings, sides, 3).
    rise = np.concatenate([_RINGS[_RINGS <= 0], _RINGS[_RINGS >= 0]])
    second = np.repeat([False, True], len(rise) // 2)
    normals = (
        np.sqrt(1.0 - rise**2)[None, :, None, None] * spokes[:, None]
        + rise[None, :, None, None] * axes[:, None, None]
    )
    centres = np.where(second[None, :, None], ends[:, None], starts[:, None])[:, :, None]
    radii = np.where(second[None], capsules.radii[:, 1:], capsules.radii[:, :1])[..., None, None]
    positions = centres + radii * normals
    count, each = len(starts), len(rise) * _SIDES
    joints = np.zeros((count * each, 4), np.uint16)
    joints[:, 0] = np.repeat(capsules.joints, each)
    colors = np.ones((count * each, 4), np.float32)
    colors[:, :3] = np.repeat(capsules.colors, each, axis=0)
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
    ring, side = (grid.ravel() for grid in np.mgrid[: rings - 1, :_SIDES])
    here, there = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
    quads = np.stack([here, there, there + _SIDES, here, there + _SIDES, here + _SIDES], axis=1)
    numbers = quads.reshape(1, -1, 3) + (np.arange(count) * rings * _SIDES)[:, None, None]
    return numbers.reshape(-1, 3).astype(np.uint32)


def _colors(skeleton: Skeleton, anatomy: Anatomy) -> Array:
    """Return the colour of each joint, (joints, 3): its side's, or that of the joint above it."""
    colors = np.empty((len(skeleton), 3))
    for joint, parent in enumerate(skeleton.parents):
        part = anatomy.parts.get(joint)
        if part is None:
            colors[joint] = MIDDLE if parent < 0 else colors[parent]
        else:
            sides = {"left": LEFT, "right": RIGHT}
            colors[joint] = next((c for s, c in sides.items() if part.startswith(s)), MIDDLE)
    return colors


def _height(places: Array) -> float:
    return max(float(np.ptp(places, axis=0).max()), 1e-6)


def _some(capsules: _Capsules, which: NDArray[np.bool_]) -> _Capsules:
    return _Capsules(*(values[which] for values in vars(capsules).values()))


def _joined(groups: list[_Capsules]) -> _Capsules:
    columns = zip(*(vars(group).values() for group in groups), strict=True)
    return _Capsules(*(np.concatenate(column) for column in columns))
