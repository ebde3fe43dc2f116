"""Feet for legs that end at the shin.

The feet of many models are a part of the shin. Their legs get one more joint, which moves nothing:
the middle of the sole, so that steps have a point that stands.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from characters.model.mesh import Mesh
from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.masks import subtree
from characters.skeleton.pose import Array, Pose, Skeleton

_LEGS = ("left", "right", "leftFront", "rightFront")
_SOLE_HEIGHT = 0.1  # of a shin's length above its lowest vertex


def with_ankles(
    skeleton: Skeleton, anatomy: Anatomy, meshes: Sequence[Mesh], clips: Mapping[str, Clip]
) -> tuple[Skeleton, tuple[Mesh, ...], dict[str, Clip]]:
    """Return a skeleton, meshes and clips with a joint at the end of each shin without a foot."""
    shins = {
        leg + "Foot": anatomy.joints[leg + "LowerLeg"]
        for leg in _LEGS
        if {leg + "UpperLeg", leg + "LowerLeg"} <= anatomy.joints.keys()
        and not {leg + "Foot", leg + "Toes"} & anatomy.joints.keys()
        and leg + "Foot" not in skeleton.names
    }
    rest = skeleton.rest.globals(skeleton)
    vertices = _vertices_of_joints(skeleton, meshes, rest) if shins else []
    places: dict[str, Array] = {}
    for foot, shin in shins.items():
        sole = _sole(vertices, subtree(skeleton, shin), rest[shin, :3, 3])
        if sole is not None:
            places[foot] = (np.linalg.inv(rest[shin]) @ [*sole, 1.0])[:3]
    if not places:
        return skeleton, tuple(meshes), dict(clips)
    offsets = np.array(list(places.values()))
    longer = Skeleton(
        (*skeleton.names, *places),
        (*skeleton.parents, *(shins[foot] for foot in places)),
        _with_joints(skeleton.rest, offsets),
    )
    unbound = np.tile(np.eye(4), (len(places), 1, 1))
    return (
        longer,
        tuple(
            replace(mesh, inverse_bind=np.concatenate([mesh.inverse_bind, unbound]))
            for mesh in meshes
        ),
        {
            name: replace(clip, poses=_with_joints(clip.poses, offsets))
            for name, clip in clips.items()
        },
    )


def _vertices_of_joints(
    skeleton: Skeleton, meshes: Sequence[Mesh], rest: Array
) -> list[list[Array]]:
    """Return by joint the vertices that it moves most, as lists of (n, 3) [m], at rest."""
    vertices: list[list[Array]] = [[] for _ in skeleton.names]
    for mesh in meshes:
        points = np.concatenate([mesh.positions, np.ones((len(mesh.positions), 1))], axis=1)
        strongest = np.argmax(mesh.weights, axis=1)
        mover = np.take_along_axis(mesh.joints, strongest[:, None], axis=1)[:, 0]
        for joint in np.unique(mover):
            of_joint = points[mover == joint] @ (rest[joint] @ mesh.inverse_bind[joint]).T
            vertices[joint].append(of_joint[:, :3])
    return vertices


def _sole(vertices: Sequence[Sequence[Array]], joints: Sequence[int], knee: Array) -> Array | None:
    """Return the middle of what is lowest of a shin, (3,) [m], or None if it has no vertices."""
    parts = [part for joint in joints for part in vertices[joint]]
    if not parts:
        return None
    points = np.concatenate(parts)
    lowest = float(points[:, 1].min())
    if lowest >= knee[1]:
        return None
    sole = points[points[:, 1] <= lowest + _SOLE_HEIGHT * (knee[1] - lowest)]
    middle = (sole.min(0) + sole.max(0)) / 2
    return np.array([middle[0], lowest, middle[2]])


def _with_joints(poses: Pose, offsets: Array) -> Pose:
    """Return poses (…, joints) with more joints at the end, at offsets (n, 3) [m]."""
    leading = poses.translations.shape[:-2]

    def extended(values: Array, more: Array) -> Array:
        tiled = np.broadcast_to(more, (*leading, *more.shape))
        return np.concatenate([values, tiled], axis=-2)

    scales = poses.scales
    return replace(
        poses,
        translations=extended(poses.translations, offsets),
        rotations=extended(poses.rotations, np.tile(rotations.IDENTITY, (len(offsets), 1))),
        scales=None if scales is None else extended(scales, np.ones((len(offsets), 3))),
    )
