"""Joints for limbs that have too few.

The feet of many models are a part of the shin, and some have one stiff piece for a whole leg or
arm. Such limbs get more joints, which move nothing that is drawn: the middle of the sole, so that
steps have a point that stands, and a knee or elbow half way.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_SOLE_HEIGHT = 0.1  # of the way from the lowest vertex of a leg up to its last joint
_TIP_PERCENTILE = 90.0  # percentile: what is farther from the shoulder is the tip of an arm


def with_limb_ends(
    skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh], clips: Mapping[str, Clip]
) -> tuple[Skeleton, tuple[Mesh, ...], dict[str, Clip]]:
    """Return a skeleton, meshes and clips with the joints that legs and arms lack.

    A leg has thigh, shin and foot, an arm at least an elbow. The new joints are the last ones, and
    have the names of their parts.
    """
    rest = skeleton.rest.globals(skeleton)
    names, parents = list(skeleton.names), list(skeleton.parents)
    offsets: list[Array] = []
    vertices: list[list[Array]] | None = None
    for last, parts in _short_limbs(anatomy):
        vertices = vertices or _vertices_of_joints(skeleton, meshes, rest)
        start = rest[last, :3, 3]
        points = [part for joint in subtree(skeleton, last) for part in vertices[joint]]
        end = _tip(points, start) if "Arm" in parts[0] else _sole(points, start)
        if end is None or set(parts) & set(names):
            continue
        joints = 2 if len(parts) == 2 or "Arm" in parts[0] else 1  # a knee is half way down
        step = np.linalg.inv(rest[last, :3, :3]) @ (end - start) / joints
        for part in parts:
            parents.append(last if part == parts[0] else len(names) - 1)
            names.append(part)
            offsets.append(step)
    if not offsets:
        return skeleton, tuple(meshes), dict(clips)
    more, count = np.array(offsets), len(skeleton)
    return (
        *with_more_joints(skeleton, meshes, names[count:], parents[count:], more),
        {n: replace(clip, poses=_with_joints(clip.poses, more)) for n, clip in clips.items()},
    )


def with_more_joints(
    skeleton: Skeleton,
    meshes: Sequence[Mesh],
    names: Sequence[str],
    parents: Sequence[int],
    offsets: Array,
) -> tuple[Skeleton, tuple[Mesh, ...]]:
    """Return a skeleton with more joints at the end, and meshes, of which they move nothing.

    `offsets` (n, 3) are those from their parents at rest [m].
    """
    unbound = np.tile(np.eye(4), (len(offsets), 1, 1))
    return (
        Skeleton(
            (*skeleton.names, *names),
            (*skeleton.parents, *parents),
            _with_joints(skeleton.rest, offsets),
        ),
        tuple(
            replace(mesh, inverse_bind=np.concatenate([mesh.inverse_bind, unbound]))
            for mesh in meshes
        ),
    )


def _short_limbs(anatomy: Anatomy) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Return the last joint of each limb that is too short, and the parts it lacks."""
    joints = anatomy.joints
    for limb in (side + row for side in SIDES for row in ("", "Front")):
        upper, lower, *ends = (limb + part for part in ("UpperLeg", "LowerLeg", "Foot", "Toes"))
        if upper in joints and not joints.keys() & set(ends):
            if lower in joints:
                yield joints[lower], (ends[0],)
            else:
                yield joints[upper], (lower, ends[0])
    for side in SIDES:
        upper, lower, hand = (side + part for part in ("UpperArm", "LowerArm", "Hand"))
        if upper in joints and not joints.keys() & {lower, hand}:
            yield joints[upper], (lower,)


def _vertices_of_joints(
    skeleton: Skeleton, meshes: Sequence[Mesh], rest: Array
) -> list[list[Array]]:
    """Return by joint the vertices that it moves most, as lists of (n, 3) [m], at rest."""
    vertices: list[list[Array]] = [[] for _ in skeleton.names]
    for mesh in meshes:
        points = np.concatenate([mesh.positions, np.ones((len(mesh.positions), 1))], axis=1)
        mover = mesh.movers
        for joint in np.unique(mover):
            of_joint = points[mover == joint] @ (rest[joint] @ mesh.inverse_bind[joint]).T
            vertices[joint].append(of_joint[:, :3])
    return vertices


def _sole(parts: Sequence[Array], joint: Array) -> Array | None:
    """Return the middle of what is lowest of a leg, (3,) [m], or None if nothing is lower."""
    points = np.concatenate([*parts, joint[None]])
    lowest = float(points[:, 1].min())
    if lowest >= joint[1]:
        return None
    sole = points[points[:, 1] <= lowest + _SOLE_HEIGHT * (joint[1] - lowest)]
    middle = (sole.min(0) + sole.max(0)) / 2
    return np.array([middle[0], lowest, middle[2]])


def _tip(parts: Sequence[Array], joint: Array) -> Array | None:
    """Return the middle of what is farthest of an arm, (3,) [m], or None if nothing is away."""
    points = np.concatenate([*parts, joint[None]])
    away = np.linalg.norm(points - joint, axis=-1)
    if away.max() < 1e-9:
        return None
    return np.asarray(points[away >= np.percentile(away, _TIP_PERCENTILE)].mean(0))


def _with_joints(poses: Pose, offsets: Array) -> Pose:
    """Return poses (…, joints) with more joints at the end, at offsets (n, 3) [m]."""
    leading = poses.translations.shape[:-2]

    def extend(values: Array, more: Array) -> Array:
        tiled = np.broadcast_to(more, (*leading, *more.shape))
        return np.concatenate([values, tiled], axis=-2)

    scales = poses.scales
    return replace(
        poses,
        translations=extend(poses.translations, offsets),
        rotations=extend(poses.rotations, np.tile(rotations.IDENTITY, (len(offsets), 1))),
        scales=None if scales is None else extend(scales, np.ones((len(offsets), 3))),
    )
