"""Characters in glTF 2.0 files: .glb with everything inside, or .gltf with files beside it."""

from dataclasses import replace
from pathlib import Path

from characters.character import Character
from characters.errors import CharacterError
from characters.formats.gltf_clips import read_clips
from characters.formats.gltf_document import DamagedFileError
from characters.formats.gltf_file import GltfFile, open_gltf
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
    try:
        return _character(open_gltf(path))
    except DamagedFileError as error:
        # Names out of the file may hold anything; the message is one line.
        reason = " ".join(str(error).split())
        raise CharacterError(f"{path}: {reason}; repair it or export it again") from error


def _character(file: GltfFile) -> Character:
    if not any(skin["joints"] for skin in file.all("skins")):
        raise CharacterError(
            f"{file.path}: has no skin, so nothing in it can move; "
            "export the model with its armature"
        )
    tree = read_tree(file)
    morphs = read_morph_table(file, tree)
    meshes = read_meshes(file, tree, morphs)
    if not meshes:
        raise CharacterError(
            f"{file.path}: its skeleton moves no mesh; export the model with its skin"
        )
    clips = read_clips(file, tree, morphs)
    skeleton = tree.skeleton
    if morphs.rest is not None:
        skeleton = replace(skeleton, rest=replace(skeleton.rest, morphs=morphs.rest))
    return Character(file.path.stem, skeleton, clips, meshes, morphs.names)


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
