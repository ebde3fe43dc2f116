"""FBX: what a hand-written file says, what Blender exports, and refusals."""

import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, load_motion
from cubeling.characters.formats import is_motion_only
from cubeling.characters.formats.fbx import reading
from cubeling.characters.skeleton import rotations
from tests.characters.formats.written_fbx import arm

needs_ufbx = pytest.mark.skipif(find_spec("ufbx") is None, reason="the extra [fbx] is not here")


def written(folder, text, name="arm.fbx"):
    (folder / name).write_text(text)
    return folder / name


@needs_ufbx
def test_joints_skin_and_clip_are_in_metres_with_y_up(tmp_path):
    character = Character.load(written(tmp_path, arm()))
    assert character.name == "arm"
    skeleton, clip = character.skeleton, character.clips["Take 001"]
    upper, lower = skeleton.index("Upper"), skeleton.index("Lower")
    rest = skeleton.rest.globals(skeleton)
    np.testing.assert_allclose(rest[lower, :3, 3], [0, 0.3, 0], atol=1e-6)
    (mesh,) = character.meshes
    np.testing.assert_allclose(character.bounds, np.array([[0, 0, 0], [0.1, 0.6, 0]]), atol=1e-6)
    assert len(mesh.triangles) == 2
    np.testing.assert_array_equal(np.unique(mesh.joints[mesh.weights > 0]), [upper, lower])
    # A quarter turn about z of the file, which is y of glTF.
    end = clip.poses[-1].globals(skeleton)[lower, :3, :3]
    turn = end @ rest[lower, :3, :3].T
    np.testing.assert_allclose(
        turn, rotations.to_matrix(rotations.about("y", np.pi / 2)), atol=1e-5
    )
    assert clip.duration == pytest.approx(1.0)
    halfway = clip.sample(0.5).globals(skeleton)[lower, :3, :3] @ rest[lower, :3, :3].T
    np.testing.assert_allclose(
        halfway, rotations.to_matrix(rotations.about("y", np.pi / 4)), atol=1e-3
    )


@needs_ufbx
def test_a_pre_rotation_turns_what_the_curves_turn(tmp_path):
    clip = load_motion(written(tmp_path, arm(pre_rotation=(90, 0, 0), bend=(0, 0, 90))))
    skeleton = clip.skeleton
    lower = skeleton.index("Lower")
    first, last = (clip.clip.poses[n].globals(skeleton)[lower, :3, :3] for n in (0, -1))
    np.testing.assert_allclose(
        first.T @ last, rotations.to_matrix(rotations.about("z", np.pi / 2)), atol=1e-5
    )


@needs_ufbx
def test_clips_have_the_names_that_their_authors_gave(tmp_path):
    assert list(Character.load(written(tmp_path, arm(name="Armature|Walk"))).clips) == ["Walk"]


@needs_ufbx
def test_a_file_without_a_mesh_is_a_motion(tmp_path):
    path = written(tmp_path, arm().replace('C: "OO",100,200\n', ""))
    assert not is_motion_only(path)
    bare = arm().partition("    Geometry:")[0] + "    Model: 201" + arm().partition("Model: 201")[2]
    path = written(tmp_path, bare)
    assert is_motion_only(path)
    assert load_motion(path).clip.duration == pytest.approx(1.0)


@needs_ufbx
@pytest.mark.parametrize(
    "text", ["", "; FBX 7.4.0 project file\n", "Kaydara FBX Binary  \0\x1a\0\x10", arm()[:900]]
)
def test_what_is_no_fbx_is_refused_in_one_line(tmp_path, text):
    with pytest.raises(CharacterError, match=r"arm\.fbx: ") as caught:
        Character.load(written(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_without_the_extra_the_line_names_it_and_the_command_of_blender(tmp_path, monkeypatch):
    monkeypatch.setattr(reading, "find_spec", lambda name: None)
    with pytest.raises(CharacterError, match=r"pip install ufbx .*blender --background") as caught:
        Character.load(written(tmp_path, arm()))
    assert "\n" not in str(caught.value)


EXPORT = """
import sys
import bpy, numpy
numpy.bool = bool  # the importer of Debian's Blender was written for an older numpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 30
source, target = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.import_scene.gltf(filepath=source)
bpy.ops.export_scene.fbx(filepath=target, add_leaf_bones=False, bake_anim_simplify_factor=0.0)
"""


@needs_ufbx
@pytest.mark.skipif(shutil.which("blender") is None, reason="Blender is not here")
@pytest.mark.slow("Blender exports the file")
@pytest.mark.full
def test_what_blender_exports_moves_as_the_original(tmp_path):
    original = Character.load("human")
    (tmp_path / "export.py").write_text(EXPORT)
    source = Path(reading.__file__).parents[2] / "assets" / "human.glb"
    target = tmp_path / "human.fbx"
    command = ["blender", "-b", "--python", tmp_path / "export.py", "--", source, target]
    subprocess.run(command, check=True, capture_output=True, timeout=300)
    exported = Character.load(target)
    assert exported.anatomy.kind == "humanoid"
    assert exported.anatomy.missing == ()
    assert exported.height == pytest.approx(original.height, rel=0.02)
    names = original.skeleton.names
    joints = [exported.skeleton.index(name) for name in names]
    for name in ("Walk", "wave", "jump"):
        one, other = original.clips[name], exported.clips[f"{name}_Armature"]
        assert other.duration == pytest.approx(one.duration, abs=1e-3)
        times = np.arange(int(one.duration * 30) + 1) / 30  # the frames that Blender wrote
        turns = []
        for clip, skeleton in ((one, original.skeleton), (other, exported.skeleton)):
            frames = (times * clip.rate).round().astype(int)
            frames = np.minimum(frames, len(clip) - 1)
            matrices = clip.in_place[frames].globals(skeleton)[..., :3, :3]
            matrices = matrices[:, joints] if clip is other else matrices
            matrices = matrices / np.linalg.norm(matrices, axis=-2, keepdims=True)
            turns.append(matrices @ np.swapaxes(matrices[:1], -1, -2))
        cosines = ((turns[0] * turns[1]).sum((-1, -2)) - 1.0) / 2.0
        assert np.degrees(np.arccos(cosines.clip(-1.0, 1.0))).max() < 1.0, name
