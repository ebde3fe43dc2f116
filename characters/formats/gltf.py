"""Characters in glTF 2.0 files: .glb with everything inside, or .gltf with files beside it."""

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np

from characters.character import Character
from characters.errors import CharacterError
from characters.formats.gltf_clips import read_clips
from characters.formats.gltf_file import open_gltf
from characters.formats.gltf_meshes import read_meshes
from characters.formats.gltf_morphs import read_morph_table
from characters.formats.gltf_nodes import read_tree
from characters.formats.gltf_writing import pack


def load(path: "str | Path") -> Character:
    """Read a skinned character.

    Raises
    ------
    CharacterError
        If the file is absent, damaged, not glTF 2.0, or has no skin.
    """
    path = Path(path)
    file = open_gltf(path)
    if not file.document.skins:
        raise CharacterError(
            f"{path}: has no skin, so nothing in it can move; export the model with its armature"
        )
    try:
        tree = read_tree(file.document)
        morphs = read_morph_table(file, tree)
        meshes = read_meshes(file, tree, morphs)
        clips = read_clips(file, tree, morphs)
    except (LookupError, ValueError, TypeError, AttributeError, struct.error) as error:
        # Whatever contradicts itself in a file surfaces as one of these; the reader's own words
        # (DamagedFileError) say where.
        raise CharacterError(f"{path}: damaged glTF ({error}); export it again") from error
    except np.linalg.LinAlgError as error:
        raise CharacterError(f"{path}: a bind matrix is singular; export it again") from error
    if not meshes:
        raise CharacterError(f"{path}: its skeleton moves no mesh; export the model with its skin")
    skeleton = tree.skeleton
    if morphs.rest is not None:
        skeleton = replace(skeleton, rest=replace(skeleton.rest, morphs=morphs.rest))
    return Character(path.stem, skeleton, clips, meshes, morphs.names)


def save(character: Character, path: "str | Path") -> None:
    """Write a .glb; the same character gives the same bytes.

    Raises
    ------
    CharacterError
        If its arrays do not fit together or the file cannot be written.
    """
    path = Path(path)
    data = pack(character)
    unfinished = path.with_name(path.name + ".part")
    try:
        unfinished.write_bytes(data)
        unfinished.replace(path)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise CharacterError(
            f"{path}: cannot be written ({error.strerror}); check the folder"
        ) from None
