"""Checks of a character before it is written."""

import numpy as np

from characters.errors import CharacterError
from characters.model.character import Character
from characters.model.mesh import Mesh


def check_character(character: Character) -> None:
    """Refuse a character whose arrays do not fit together.

    Raises
    ------
    CharacterError
        The message names the clip, mesh or morph.
    """
    joints, morphs = len(character.skeleton), len(character.morphs)
    for clip in character.clips.values():
        if clip.poses.rotations.shape[1] != joints:
            raise CharacterError(
                f"clip {clip.name!r} moves {clip.poses.rotations.shape[1]} joints, "
                f"the skeleton has {joints}"
            )
        if clip.poses.morphs is not None and clip.poses.morphs.shape != (len(clip), morphs):
            raise CharacterError(
                f"clip {clip.name!r} has morphs of shape {clip.poses.morphs.shape}, "
                f"not {(len(clip), morphs)}"
            )
    for mesh in character.meshes:
        _check_mesh(mesh, joints)
    _check_morphs(character)


def _check_mesh(mesh: Mesh, joints: int) -> None:
    count = len(mesh.positions)
    fits = (
        mesh.normals.shape == (count, 3)
        and mesh.joints.shape == mesh.weights.shape == (count, 4)
        and mesh.inverse_bind.shape == (joints, 4, 4)
        and (not mesh.triangles.size or int(mesh.triangles.max()) < count)
        and (not mesh.joints.size or int(mesh.joints.max()) < joints)
    )
    if not fits:
        raise CharacterError(f"mesh {mesh.name!r}: its arrays do not fit together")
    if count and np.abs(mesh.weights.sum(1) - 1).max() > 1e-3:
        raise CharacterError(f"mesh {mesh.name!r}: its skin weights do not sum to one")
    for morph in mesh.morphs:
        shape = (len(morph.vertices), 3)
        ascends = bool((np.diff(morph.vertices.astype(np.int64)) > 0).all())
        inside = not len(morph.vertices) or int(morph.vertices[-1]) < count
        normals_fit = (
            morph.normal_displacements is None or morph.normal_displacements.shape == shape
        )
        if not (ascends and inside and normals_fit and morph.displacements.shape == shape):
            raise CharacterError(
                f"mesh {mesh.name!r}: the arrays of its morph {morph.name!r} do not fit together"
            )


def _check_morphs(character: Character) -> None:
    """Refuse names that reading the file would not give back."""
    for mesh in character.meshes:
        names = [morph.name for morph in mesh.morphs]
        if len(set(names)) < len(names) or not set(names) <= set(character.morphs):
            raise CharacterError(
                f"mesh {mesh.name!r}: each of its morphs needs a name of its own out of "
                f"Character.morphs, which are {', '.join(character.morphs) or 'none'}"
            )
    used = {morph.name for mesh in character.meshes for morph in mesh.morphs}
    unused = [name for name in character.morphs if name not in used]
    if unused or len(set(character.morphs)) < len(character.morphs):
        raise CharacterError(
            f"Character.morphs {', '.join(unused or character.morphs)}: each must be named once, "
            "and be a morph of some mesh"
        )
