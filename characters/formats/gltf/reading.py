"""Characters in glTF 2.0: .glb with everything inside, .gltf with files beside it, or .vrm."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from characters.errors import CharacterError
from characters.formats.gltf import vrm
from characters.formats.gltf.clips import read_clips
from characters.formats.gltf.container import open_gltf
from characters.formats.gltf.document import DamagedFileError
from characters.formats.gltf.file import GltfFile
from characters.formats.gltf.meshes import read_meshes
from characters.formats.gltf.morphs import read_morph_table
from characters.formats.gltf.nodes import NodeTree, read_tree
from characters.formats.gltf.writing import pack
from characters.formats.loading import MotionOptions, Performance
from characters.model.character import Character
from characters.model.mesh import Mesh
from characters.skeleton.pose import Array, Skeleton


def load(path: "str | Path") -> Character:
    """Read a character: skinned, or of rigid parts that are animated.

    Raises
    ------
    CharacterError
        If the file is absent, damaged, not glTF 2.0, or nothing in it can move.
    """
    with _refusing(Path(path)) as file:
        tree, humanoid = _jointed(file)
        table = read_morph_table(file, tree)
        parts = read_meshes(file, tree, table)
        if not parts:
            raise DamagedFileError("its skeleton moves no mesh; export the model with its skin")
        character = Character(
            name=file.path.stem,
            skeleton=_at_rest(tree.skeleton, table.rest),
            clips=read_clips(file, tree, table),
            meshes=tuple(mesh for _, mesh in parts),
            morphs=table.names,
            semantics=_noted_semantics(file, tree.skeleton),
        )
        return character if humanoid is None else _human(character, humanoid, parts, tree)


def load_motion(path: Path, options: MotionOptions) -> Performance:
    """Read one clip of a file and its skeleton; the file need not have a mesh.

    Raises
    ------
    CharacterError
        If the file is absent, damaged, not glTF 2.0, or does not have exactly that clip.
    """
    with _refusing(path) as file:
        tree, _ = _jointed(file)
        table = read_morph_table(file, tree)
        skeleton, clips = _at_rest(tree.skeleton, table.rest), read_clips(file, tree, table)
    name = options.clip
    if name is None and len(clips) == 1:
        name = next(iter(clips))
    if name not in clips:
        known = ", ".join(clips) or "no clips at all"
        raise CharacterError(f"{path}: has {known}; say which one to load")
    return Performance(skeleton, clips[name])


@contextmanager
def _refusing(path: Path) -> Iterator[GltfFile]:
    """Open a file that faces +z, and refuse in one line whatever contradicts itself in it."""
    try:
        file = open_gltf(path)
        if path.suffix.lower() == ".vrm" and vrm.read_humanoid(file) is None:
            raise DamagedFileError("holds no VRM; call it .glb if it is glTF")
        yield vrm.turned_around(file) if vrm.faces_backwards(file) else file
    except DamagedFileError as error:
        # Names out of the file may hold anything; the message is one line.
        reason = " ".join(str(error).split())
        advice = "" if ";" in reason else "; repair it or export it again"
        raise CharacterError(f"{path}: {reason}{advice}") from error


def _jointed(file: GltfFile) -> tuple[NodeTree, vrm.Humanoid | None]:
    """Return the skeleton, and what VRM says of it."""
    humanoid = vrm.read_humanoid(file)
    joints = set(() if humanoid is None else humanoid.bones.values())
    if not any(skin["joints"] for skin in file.all("skins")):
        # Rigid parts, or motions exported without their model: what is animated is a joint.
        joints |= {
            channel["target"]["node"]
            for animation in file.all("animations")
            for channel in animation["channels"]
            if "node" in channel["target"]
        }
        if not joints:
            raise DamagedFileError(
                "has no skin and no animation, so nothing in it can move; "
                "export the model with its armature"
            )
    return read_tree(file, joints), humanoid


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
