"""The pose in which the skin of a character was bound.

Files often rest in the first frame of a clip, in mid-stride, while their skins are bound to the
pose in which the body was modelled, upright on its feet. Only the turns of that pose are taken:
skins may be bound to bones of other lengths, in other units, and each in a frame of its own.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.masks import subtree_sizes
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_IDENTITY_TOLERANCE = 1e-5
_MAX_REST_DISTANCE = 0.01  # body sizes; a bind pose closer to the rest pose is the rest pose
_MIN_JOINTS = 3  # fewer do not show the axes of a skin


class SkinnedBody(Protocol):
    """A `Character`, as far as its bind pose is concerned."""

    @property
    def skeleton(self) -> Skeleton:
        """Joints, with the bind pose as their rest."""

    @property
    def meshes(self) -> Sequence[Mesh]:
        """Meshes with joints and weights for each vertex."""

    @property
    def anatomy(self) -> Anatomy:
        """Which joint is which body part."""


def bind_placements(character: SkinnedBody) -> tuple[Array, NDArray[np.bool_]]:
    """Return the placements that joints were bound in, (joints, 4, 4), and which joints were.

    Rigid meshes are bound in their joint's own frame, which says nothing about its placement:
    their joints are returned at rest, as those without a skin.
    """
    skeleton = character.skeleton
    placements, bound = skeleton.rest.globals(skeleton).copy(), np.zeros(len(skeleton), bool)
    for used, found in _skins(character.meshes):
        new = used[~bound[used]]
        placements[new], bound[new] = found[~bound[used]], True
    return placements, bound


def _skins(meshes: Sequence[Mesh]) -> Iterator[tuple[NDArray[np.intp], Array]]:
    """Yield the joints of each skin and the placements that they were bound in, largest first."""
    skins: dict[bytes, tuple[Array, set[int]]] = {}
    for mesh in meshes:
        used = np.unique(mesh.joints[mesh.weights > 0])
        rigid = np.abs(mesh.inverse_bind[used] - np.eye(4)).max((1, 2)) <= _IDENTITY_TOLERANCE
        key = mesh.inverse_bind.tobytes()
        skins.setdefault(key, (mesh.inverse_bind, set()))[1].update(used[~rigid].tolist())
    for inverse_bind, joints in sorted(skins.values(), key=lambda skin: -len(skin[1])):
        invertible = [j for j in sorted(joints) if abs(np.linalg.det(inverse_bind[j])) > 0]
        placements = np.linalg.inv(inverse_bind[invertible])
        yield np.array(invertible, np.intp), np.asarray(placements, np.float64)


def with_bind_pose(character: SkinnedBody) -> Skeleton:
    """Return the skeleton with the turns of the bind pose at rest; bones keep their lengths."""
    return _rest_from_bind_pose(character.skeleton, character.meshes, character.anatomy.joints)


def upright_bind_pose(skeleton: Skeleton, meshes: Sequence[Mesh]) -> Skeleton:
    """Return the same of a body whose parts are not known yet; feet may be elsewhere."""
    return _rest_from_bind_pose(skeleton, meshes, {})


def _rest_from_bind_pose(
    skeleton: Skeleton, meshes: Sequence[Mesh], parts: Mapping[str, int]
) -> Skeleton:
    rest = skeleton.rest.globals(skeleton)
    turns, bound = _bound_turns(meshes, rest, subtree_sizes(skeleton))
    if not bound.any():
        return skeleton
    pose = replace(skeleton.rest, rotations=_local_turns(turns, bound, skeleton))
    pose = _with_feet_at_shins(pose, skeleton, parts)
    size = float(np.ptp(rest[:, :3, 3], axis=0).max()) or 1.0
    distances = np.linalg.norm((pose.globals(skeleton) - rest)[:, :3, 3], axis=-1)
    if distances[bound].max() < _MAX_REST_DISTANCE * size:
        return skeleton
    feet = [joint for part, joint in parts.items() if part.endswith(("Foot", "Toes"))]
    return replace(
        skeleton, rest=_standing_pose(pose, skeleton, feet or np.flatnonzero(bound).tolist())
    )


def _bound_turns(
    meshes: Sequence[Mesh], rest: Array, subtrees: NDArray[np.int_]
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the turns (joints, 4) of the bind pose in the rest pose's axes, and which are known.

    A skin has axes of its own. Those of the largest one differ from the rest pose's by quarter
    turns; the others show theirs by a joint that they share with a larger one.
    """
    turns, bound = np.tile(rotations.IDENTITY, (len(rest), 1)), np.zeros(len(rest), bool)
    for used, placements in _skins(meshes):
        own, shared = _turns(placements), np.flatnonzero(bound[used])
        if shared.size:
            first = shared[0]
            axes = rotations.multiply(turns[used[first]], rotations.conjugate(own[first]))
        elif len(used) >= _MIN_JOINTS:
            axes = _axes(own, _turns(rest[used]), subtrees[used])
        else:
            continue
        new = ~bound[used]
        turns[used[new]], bound[used] = rotations.multiply(axes, own[new]), True
    return turns, bound


def _axes(own: Array, rest: Array, subtrees: NDArray[np.int_]) -> Array:
    """Return the rotation (4,) by quarter turns from a skin's axes to those of the rest pose.

    Limbs are bent at rest; joints count by the number of joints that they carry.
    """
    turns = rotations.to_matrix(rotations.multiply(rest, rotations.conjugate(own)))
    turn = np.average(turns, axis=0, weights=subtrees)
    return rotations.from_matrix(rotations.nearest_quarter_turns(turn))


def _turns(placements: Array) -> Array:
    """Return the rotations (n, 4) of placements (n, 4, 4) without their scale."""
    sizes = np.linalg.norm(placements[:, :3, :3], axis=1, keepdims=True)
    return rotations.from_matrix(placements[:, :3, :3] / np.where(sizes > 0, sizes, 1.0))


def _local_turns(turns: Array, bound: NDArray[np.bool_], skeleton: Skeleton) -> Array:
    """Return local rotations (joints, 4) from global ones; unbound joints keep theirs."""
    local, world = skeleton.rest.rotations.copy(), turns.copy()
    for joint, parent in enumerate(skeleton.parents):
        above = world[parent] if parent >= 0 else rotations.IDENTITY
        if bound[joint]:
            local[joint] = rotations.multiply(rotations.conjugate(above), turns[joint])
        else:
            world[joint] = rotations.multiply(above, local[joint])
    return local


def _with_feet_at_shins(pose: Pose, skeleton: Skeleton, joints: Mapping[str, int]) -> Pose:
    """Return a pose whose feet are where shins end, if inverse kinematics has them elsewhere."""
    rest = skeleton.rest.globals(skeleton)
    pose = replace(pose, translations=pose.translations.copy())
    for side in (side + front for front in ("", "Front") for side in SIDES):
        shin, foot = joints.get(side + "LowerLeg"), joints.get(side + "Foot")
        if shin is None or foot is None or shin in skeleton.with_ancestors([foot]):
            continue
        placements, above = pose.globals(skeleton), skeleton.parents[foot]
        ankle = placements[shin] @ np.linalg.inv(rest[shin]) @ rest[foot, :, 3]
        local = np.linalg.inv(placements[above]) @ ankle if above >= 0 else ankle
        pose.translations[foot] = local[:3]
    return pose


def _standing_pose(pose: Pose, skeleton: Skeleton, feet: Sequence[int]) -> Pose:
    """Return a pose that stands on the ground of the rest pose, its middle at x = 0.

    `feet` are joints of the feet, or of the body if its feet are not known.
    """
    parents = np.array(skeleton.parents)
    rest, now = (each.globals(skeleton)[list(feet), :3, 3] for each in (skeleton.rest, pose))
    middle = (now[:, 0].min() + now[:, 0].max()) / 2
    shift = np.array([-middle, rest[:, 1].min() - now[:, 1].min(), 0.0])
    placements = pose.globals(skeleton)
    pose = replace(pose, translations=pose.translations.copy())
    # A root on the ground stays; what it carries moves.
    for joint in np.flatnonzero((parents == 0) if skeleton.has_root_motion else (parents < 0)):
        above = placements[parents[joint], :3, :3] if parents[joint] >= 0 else np.eye(3)
        pose.translations[joint] += np.linalg.solve(above, shift)
    return pose
