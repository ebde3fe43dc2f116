"""Reading characters and motions from glTF 2.0: .glb, .gltf with its files, or .vrm."""

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.gltf.animations import read_clips
from cubeling.characters.formats.gltf.document import DamagedFileError
from cubeling.characters.formats.gltf.draco import with_unpacked_meshes
from cubeling.characters.formats.gltf.file import GltfFile, open_gltf
from cubeling.characters.formats.gltf.followers import EXTRA, with_followers
from cubeling.characters.formats.gltf.meshes import read_meshes
from cubeling.characters.formats.gltf.morphs import read_morph_table
from cubeling.characters.formats.gltf.nodes import NodeTree, read_node_tree
from cubeling.characters.formats.gltf.vrm.constraints import read_constraints
from cubeling.characters.formats.gltf.vrm.humanoid import (
    VrmHumanoid,
    mixed_expressions,
    read_humanoid,
)
from cubeling.characters.formats.gltf.vrm.look_at import read_look_at
from cubeling.characters.formats.gltf.vrm.springs import read_springs
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton


def load_character(path: Path, content: bytes | None = None) -> Character:
    """Read a character: a skinned one, or one of animated rigid parts.

    `content` is what a file of another format was converted to.
    """
    with _open(path, content) as file:
        springs, constraints = read_springs(file), read_constraints(file)
        tree, humanoid = _read_joints(file, springs.nodes | constraints.nodes)
        table = read_morph_table(file, tree)
        parts = read_meshes(file, tree, table)
        if not parts:
            raise DamagedFileError(
                "its skeleton moves no mesh; export the model with its skin, or use it as a motion"
            )
        names, stated = tree.skeleton.names, file.scene_extra("semantics")
        semantics = stated.items() if isinstance(stated, dict) else _head_of(file, tree).items()
        character = Character(
            name=file.path.stem,
            skeleton=_with_rest_morphs(tree.skeleton, table.rest),
            clips=read_clips(file, tree, table),
            meshes=tuple(mesh for _, mesh in parts),
            morphs=table.names,
            semantics={part: joint for part, joint in semantics if joint in ("", *names)},
            springs=springs.bones(tree),
            constraints=constraints.of_joints(file, tree),
            look_at=read_look_at(file),
        )
        extra = file.scene_extra(EXTRA)
        if extra is not None:
            character = with_followers(character, extra)
        return (
            character if humanoid is None else _as_humanoid(file, character, humanoid, parts, tree)
        )


def load_motion(path: Path, options: MotionOptions, content: bytes | None = None) -> RecordedMotion:
    """Read one clip of a file and its skeleton; the file need not have a mesh."""
    with _open(path, content) as file:
        tree, humanoid = _read_joints(file)
        table = read_morph_table(file, tree)
        skeleton = _with_rest_morphs(tree.skeleton, table.rest)
        clips = read_clips(file, tree, table)
    name = options.clip
    if name is None and len(clips) == 1:
        name = next(iter(clips))
    if name not in clips:
        known = ", ".join(clips) or "no clips at all"
        raise CharacterError(f"{path}: has {known}; say which one: {path.name}#CLIP")
    bones = {} if humanoid is None else humanoid.bones
    semantics = {bone: skeleton.names[tree.joint_of_node[node]] for bone, node in bones.items()}
    return RecordedMotion(skeleton, clips[name], semantics=semantics)


@contextmanager
def _open(path: Path, content: bytes | None) -> Iterator[GltfFile]:
    """Open a file; errors while it is read name it in one line."""
    try:
        file = with_unpacked_meshes(open_gltf(path, content))
        if path.suffix.lower() == ".vrm" and read_humanoid(file) is None:
            file.warn("contains no VRM; read as plain glTF")
        yield file
    except DamagedFileError as error:
        # Names from the file may contain line breaks; the message is one line.
        reason = " ".join(str(error).split())
        advice = "" if ";" in reason else "; repair it or export it again"
        raise CharacterError(f"{path}: {reason}{advice}") from error


def _read_joints(
    file: GltfFile, extra_joints: Collection[int] = ()
) -> tuple[NodeTree, VrmHumanoid | None]:
    """Return the skeleton, and its VRM data if there are any."""
    humanoid = read_humanoid(file)
    joints = set(extra_joints) | set(() if humanoid is None else humanoid.bones.values())
    if not any(skin["joints"] for skin in file.all("skins")):
        # Rigid parts, or motions exported without a model: animated nodes are joints.
        joints |= {
            channel["target"]["node"]
            for animation in file.all("animations")
            for channel in animation["channels"]
            if "node" in channel["target"]
        } | _faces(file)
        if not joints:
            raise DamagedFileError(
                "has no skin and no animation, so nothing in it can move; "
                "export the model with its armature"
            )
    return read_node_tree(file, joints), humanoid


def _faces(file: GltfFile) -> set[int]:
    """Return the nodes with meshes of a file whose face moves by morphs, though it has no skin."""
    meshes = file.all("meshes")
    has_targets = any(each.get("targets") for mesh in meshes for each in mesh["primitives"])
    return {n for n, node in enumerate(file.all("nodes")) if has_targets and "mesh" in node}


def _head_of(file: GltfFile, tree: NodeTree) -> dict[str, str]:
    """Return the head of a file that is one: it has a face, no skin, and no joint of that name."""
    anatomy, skeleton = Anatomy.guess(tree.skeleton), tree.skeleton
    if file.all("skins") or not _faces(file) or {"head", "hips"} & set(anatomy.joints):
        return {}
    # Eyes and teeth may lie beside the face: what carries them all is turned.
    lines = [set(skeleton.with_ancestors([tree.joint_of_node[n]])) for n in tree.mesh_nodes]
    shared = set.intersection(*lines)
    return {"head": skeleton.names[max(shared)]} if shared else {}


def _with_rest_morphs(skeleton: Skeleton, morphs: Array | None) -> Skeleton:
    """Return a skeleton with these morph weights in its rest pose."""
    return replace(skeleton, rest=replace(skeleton.rest, morphs=morphs))


def _as_humanoid(
    file: GltfFile,
    character: Character,
    humanoid: VrmHumanoid,
    parts: list[tuple[int, Mesh]],
    tree: NodeTree,
) -> Character:
    """Return a character with the body parts and expressions that VRM states."""
    names = character.skeleton.names
    semantics = {bone: names[tree.joint_of_node[node]] for bone, node in humanoid.bones.items()}
    if not humanoid.expressions:
        return replace(character, semantics=semantics)
    meshes, morphs = mixed_expressions(file, parts, humanoid)
    # Animated weights belong to morph targets, which the expressions replace.
    clips = {
        name: replace(clip, poses=replace(clip.poses, morphs=None))
        for name, clip in character.clips.items()
    }
    return replace(
        character,
        skeleton=_with_rest_morphs(character.skeleton, None),
        clips=clips,
        meshes=meshes,
        morphs=morphs,
        semantics=semantics,
    )
