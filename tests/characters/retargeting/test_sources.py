"""Recordings of many kinds are sources: other zero poses, files without a body, long loops."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Pose
from cubeling.characters.formats import is_motion_only
from cubeling.characters.formats.mocap.bvh_writing import save_bvh
from cubeling.characters.retargeting import Recording, load_recording, make_locomotion
from cubeling.characters.retargeting.locomotion import locomotion_clips
from cubeling.characters.retargeting.standing_rest import uprightness
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Skeleton
from tests.characters.retargeting.test_retarget_locomotion import exported

pytestmark = pytest.mark.usefixtures("straight_only")


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


@pytest.fixture(scope="module")
def walk(human):
    return exported(human, "Walk")


@pytest.fixture(scope="module")
def gait_of_walk(human, walk):
    """What is made of the walk as it was recorded."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(locomotion_clips, "WALK_CLIPS", {0.0: "Walk"})
        return found(human, walk)


def along_x(recording):
    """The same motion in frames that lie with +x along their bones, all angles zero at rest."""
    skeleton = recording.skeleton
    rest = skeleton.rest.globals(skeleton)
    places, stood = rest[:, :3, 3], rotations.from_matrix(rest[:, :3, :3])
    frames = np.empty((len(skeleton), 4))
    for joint in range(len(skeleton)):
        below = [child for child, parent in enumerate(skeleton.parents) if parent == joint]
        way = places[below[0]] - places[joint] if len(below) == 1 else np.array([0.0, 1.0, 0.0])
        frames[joint] = rotations.between(np.array([1.0, 0.0, 0.0]), way)
    moved = recording.clip.poses.globals(skeleton)
    turns = rotations.multiply(
        rotations.from_matrix(moved[..., :3, :3]), rotations.conjugate(stood)
    )
    turns = rotations.multiply(turns, frames)
    above = np.array(skeleton.parents)
    offsets = rotations.rotate(rotations.conjugate(frames[above]), places - places[above])
    translations, local = np.repeat(offsets[None], len(turns), 0), turns.copy()
    under = np.flatnonzero(above >= 0)
    local[:, under] = rotations.multiply(
        rotations.conjugate(turns[:, above[under]]), turns[:, under]
    )
    hips = recording.anatomy.joints["hips"]
    translations[:, hips] = moved[:, hips, :3, 3]
    if above[hips] >= 0:
        up = rotations.conjugate(turns[:, above[hips]])
        way = moved[:, hips, :3, 3] - moved[:, above[hips], :3, 3]
        translations[:, hips] = rotations.rotate(up, way)
    flat = Pose(offsets, np.tile(rotations.IDENTITY, (len(skeleton), 1)))
    lying = Skeleton(skeleton.names, skeleton.parents, flat)
    clip = replace(recording.clip, poses=Pose(translations, local))
    return Recording("lying", clip, lying, Anatomy.guess(lying))


def written(recording, path, start="hips"):
    anatomy = recording.anatomy
    if start != "hips":
        joint = recording.skeleton.names.index(start)
        anatomy = replace(anatomy, joints={**anatomy.joints, "hips": joint})
    save_bvh(recording.clip, recording.skeleton, anatomy, path)
    return path


def found(human, recording):
    """The gait that a bare human gets from a recording."""
    return make_locomotion(replace(human, clips={}), [recording])


@pytest.mark.slow(reason="a walk is written, read twice and retargeted")
def test_bones_that_lie_along_one_axis_rest_in_a_frame_that_stands(
    human, walk, gait_of_walk, tmp_path
):
    path = written(along_x(walk), tmp_path / "lying.bvh")
    lying = load_recording(str(path), rest="zero")
    stands = load_recording(str(path))
    for recording, upright in ((lying, False), (stands, True)):
        at_rest = recording.skeleton.rest.globals(recording.skeleton)[None]
        assert (uprightness(at_rest, recording.anatomy)[0] > 0.8) == upright
    made = found(human, stands)
    (ours,), (theirs,) = made.recordings, gait_of_walk.recordings
    assert (ours.duration, ours.speed) == pytest.approx((theirs.duration, theirs.speed), rel=0.05)
    assert ours.slide < 0.01
    poses = made.character.clips["Walk"].poses.globals(made.character.skeleton)
    joints = made.character.skeleton.names
    head, hips = (
        joints.index(human.skeleton.names[human.anatomy.joints[p]]) for p in ("head", "hips")
    )
    assert (poses[:, head, 1, 3] - poses[:, hips, 1, 3]).min() > 0.3


def test_the_rest_pose_may_be_stated_as_a_frame(walk, tmp_path):
    path = written(along_x(walk), tmp_path / "lying.bvh")
    first, other = (load_recording(str(path), rest=f"frame:{n}").skeleton.rest for n in (0, 20))
    assert not np.allclose(first.rotations, other.rotations)
    for wrong, why in (("frame:9999", "the last frame is"), ("first", "is not known; write zero")):
        with pytest.raises(CharacterError, match=rf"lying\.bvh: rest '{wrong}'.*{why}"):
            load_recording(str(path), rest=wrong)


def test_a_first_frame_of_calibration_is_left_out(human, walk, gait_of_walk, tmp_path):
    rest, poses = walk.skeleton.rest, walk.clip.poses
    translations = np.concatenate([rest.translations[None], poses.translations])
    turns = np.concatenate([rest.rotations[None], poses.rotations])
    calibrated = replace(walk.clip, poses=Pose(translations, turns))
    path = written(replace(walk, clip=calibrated), tmp_path / "calibrated.bvh")
    recording = load_recording(str(path))
    assert len(recording.clip) == len(walk.clip)
    (ours,), (theirs,) = found(human, recording).recordings, gait_of_walk.recordings
    assert (ours.duration, ours.seam) == pytest.approx((theirs.duration, theirs.seam), abs=1e-3)


def test_a_root_joint_fixed_above_the_hips_does_not_stop_a_walk(
    human, walk, gait_of_walk, tmp_path
):
    path = written(walk, tmp_path / "rooted.bvh", start="world")
    assert path.read_text().splitlines()[1] == "ROOT world"
    recording = load_recording(str(path))
    assert recording.skeleton.names[recording.anatomy.joints["hips"]].lower() == "hips"
    (ours,), (theirs,) = found(human, recording).recordings, gait_of_walk.recordings
    assert ours.speed == pytest.approx(theirs.speed, rel=0.02)


def without_mesh(character, path, bones=None):
    """Save the clips and joints of a character; with VRM bones as a .vrma, its names hidden."""
    character.save(path.with_suffix(".glb"))
    data = path.with_suffix(".glb").read_bytes()
    (size,) = struct.unpack_from("<I", data, 12)
    document, rest = json.loads(data[20 : 20 + size]), data[20 + size :]
    for key in ("meshes", "skins", "materials", "textures", "images"):
        document.pop(key, None)
    numbers = {node.get("name"): number for number, node in enumerate(document["nodes"])}
    for number, node in enumerate(document["nodes"]):
        node.pop("mesh", None), node.pop("skin", None)
        if bones:
            node["name"] = f"node {number}"
    for clip in document["animations"]:
        clip["channels"] = [c for c in clip["channels"] if c["target"]["path"] != "weights"]
    if bones:
        human_bones = {bone: {"node": numbers[name]} for bone, name in bones.items()}
        extension = {"specVersion": "1.0", "humanoid": {"humanBones": human_bones}}
        document["extensions"] = {"VRMC_vrm_animation": extension}
        document["extensionsUsed"] = ["VRMC_vrm_animation"]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    path.write_bytes(head + text + rest)
    return path


@pytest.mark.slow(reason="a walk is written, read and retargeted")
def test_a_motion_without_a_mesh_is_a_source(human, tmp_path):
    path = without_mesh(human, tmp_path / "library.glb")
    assert is_motion_only(path)
    (report,) = found(human, load_recording(f"{path}#Walk")).recordings
    assert report.slide < 0.01
    with pytest.raises(CharacterError, match=r"say which one: library\.glb#CLIP"):
        load_recording(str(path))
    with pytest.raises(CharacterError, match=r"no mesh.*use it as a motion"):
        Character.load(path)


def test_a_vrma_states_its_body_parts(human, tmp_path):
    walk = {"walk": human.clips["Walk"]}
    parts = {part: human.skeleton.names[joint] for part, joint in human.anatomy.joints.items()}
    bones = {part: name for part, name in parts.items() if not part.endswith("Eye")}
    path = without_mesh(replace(human, clips=walk), tmp_path / "walk.vrma", bones)
    recording = load_recording(str(path))
    assert recording.skeleton.names[recording.anatomy.joints["hips"]].startswith("node")
    (report,) = found(human, recording).recordings
    assert report.speed == pytest.approx(
        walk["walk"].cycle.length / walk["walk"].duration, rel=0.02
    )


def test_a_loop_of_several_cycles_gives_one(human):
    walk = human.clips["Walk"]
    times = np.arange(3 * (len(walk) - 1) + 1)
    steps = replace(walk, poses=walk.in_place[times % (len(walk) - 1)])
    triple = Recording("three cycles", steps, human.skeleton, human.anatomy)
    (report,) = found(human, triple).recordings
    assert report.duration == pytest.approx(walk.duration, rel=0.03)
