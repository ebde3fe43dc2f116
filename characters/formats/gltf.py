"""Characters in glTF 2.0: .glb with everything inside, .gltf with files beside it, or .vrm."""

from dataclasses import replace
from pathlib import Path

from characters.character import Character
from characters.errors import CharacterError
from characters.formats import vrm
from characters.formats.gltf_clips import read_clips
from characters.formats.gltf_container import open_gltf
from characters.formats.gltf_document import DamagedFileError
from characters.formats.gltf_file import GltfFile
from characters.formats.gltf_meshes import read_meshes
from characters.formats.gltf_morphs import read_morph_table
from characters.formats.gltf_nodes import NodeTree, read_tree
from characters.formats.gltf_writing import pack
from characters.mesh import Mesh
from characters.pose import Array, Skeleton


def load(path: "str | Path") -> Character:
    """Read a skinned character.

    Raises
    ------
    CharacterError
        If the file is absent, damaged, not glTF 2.0, or has no skin.
    """
    path = Path(path)
    try:
        file = open_gltf(path)
        if path.suffix.lower() == ".vrm" and vrm.read_humanoid(file) is None:
            raise CharacterError(f"{path}: holds no VRM; call it .glb if it is glTF")
        return _character(file)
    except DamagedFileError as error:
        # Names out of the file may hold anything; the message is one line.
        reason = " ".join(str(error).split())
        advice = "" if ";" in reason else "; repair it or export it again"
        raise CharacterError(f"{path}: {reason}{advice}") from error


def _character(file: GltfFile) -> Character:
    if not any(skin["joints"] for skin in file.all("skins")):
        raise CharacterError(
            f"{file.path}: has no skin, so nothing in it can move; "
            "export the model with its armature"
        )
    if vrm.faces_backwards(file):
        file = vrm.turned_around(file)
    humanoid = vrm.read_humanoid(file)
    tree = read_tree(file, () if humanoid is None else humanoid.bones.values())
    table = read_morph_table(file, tree)
    parts = read_meshes(file, tree, table)
    if not parts:
        raise CharacterError(
            f"{file.path}: its skeleton moves no mesh; export the model with its skin"
        )
    clips = read_clips(file, tree, table)
    character = Character(
        name=file.path.stem,
        skeleton=_at_rest(tree.skeleton, table.rest),
        clips=clips,
        meshes=tuple(mesh for _, mesh in parts),
        morphs=table.names,
        semantics=_noted_semantics(file, tree.skeleton),
    )
    return character if humanoid is None else _human(character, humanoid, parts, tree)


def _at_rest(skeleton: Skeleton, morphs: Array | None) -> Skeleton:
    """Return a skeleton that rests with these weights of morphs."""
    return replace(skeleton, rest=replace(skeleton.rest, morphs=morphs))


def _noted_semantics(file: GltfFile, skeleton: Skeleton) -> dict[str, str]:
    """Return what our own writer noted of what joints are."""
    for scene in file.all("scenes"):
        extras = scene.get("extras")
        noted = extras.get("semantics") if isinstance(extras, dict) else None
        if isinstance(noted, dict):
            return {name: j for name, j in noted.items() if j in skeleton.names}
    return {}


def _human(
    character: Character, humanoid: vrm.Humanoid, parts: list[tuple[int, Mesh]], tree: NodeTree
) -> Character:
    """Return a character whose joints and expressions are those that VRM names."""
    names = character.skeleton.names
    semantics = {bone: names[tree.joint_of_node[node]] for bone, node in humanoid.bones.items()}
    if not humanoid.expressions:
        return replace(character, semantics=semantics)
    meshes, morphs = vrm.expressed(parts, humanoid)
    # Animated weights are of targets, of which only the mixes are left.
    clips = {
        name: replace(clip, poses=replace(clip.poses, morphs=None))
        for name, clip in character.clips.items()
    }
    return replace(
        character,
        skeleton=_at_rest(character.skeleton, None),
        clips=clips,
        meshes=meshes,
        morphs=morphs,
        semantics=semantics,
    )


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
