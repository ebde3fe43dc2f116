"""The character on other programs' models: sent by VMC, received by the published conventions."""

import asyncio
import socket
import subprocess
from contextlib import ExitStack
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.vmc import VRM0_NAMES, VmcBody, VmcOut, unity_name
from cubeling.app.errors import AppError
from cubeling.characters import Character, PosedCharacter
from cubeling.characters.model import PRESETS, TPoseBones, retarget
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from tests.app.bridges.vmc_receiver import VmcReceiver
from tests.bench.vmc import __main__ as stranger
from tests.bench.vmc.models import normalised_model, raw_model

UNITY_BONES = frozenset(
    [
        *("Hips", "Spine", "Chest", "UpperChest", "Neck", "Head", "Jaw"),
        *(
            f"{side}{bone}"
            for side in ("Left", "Right")
            for bone in (
                *("UpperLeg", "LowerLeg", "Foot", "Toes", "Shoulder", "UpperArm", "LowerArm"),
                *("Hand", "Eye"),
                *(
                    f"{finger}{joint}"
                    for finger in ("Thumb", "Index", "Middle", "Ring", "Little")
                    for joint in ("Proximal", "Intermediate", "Distal")
                ),
            )
        ),
    ]
)
"""Unity's HumanBodyBones."""


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def step_of(*cast: PosedCharacter) -> Any:
    """Return what is read of a step."""
    return SimpleNamespace(cast=[SimpleNamespace(posed=each) for each in cast])


def posed(character, pose, place=None):
    table = np.eye(4) if place is None else place
    return PosedCharacter(pose, table, True, "wave", 0.0, 0.0, 0.0, 0.0)


MODELS = {
    "the same body": lambda human: normalised_model(human),
    "long arms, short legs": lambda human: normalised_model(human, 1.4, 0.7),
    "bones with axes of their own": lambda human: raw_model(human, 0.8, 1.2),
}


@pytest.mark.parametrize("model", MODELS)
def test_a_wave_puts_the_wrists_where_our_own_retargeting_does(human, model):
    """Seen from the hips, which each program places by its own rule."""
    clip, skeleton = human.clips["wave"], MODELS[model](human)
    anatomy = Anatomy("humanoid", {name: joint for joint, name in enumerate(skeleton.names)})
    ours = retarget(clip, human.skeleton, human.anatomy, skeleton, anatomy)
    with socket.socket(type=socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        listener.setblocking(False)
        with VmcOut(UdpAddress("127.0.0.1", listener.getsockname()[1])) as out:
            out.begin([human])
            apart = []
            for frame in range(0, len(clip), 3):
                out.follow(step_of(posed(human, clip.poses[frame])), [human], 0.0)
                receiver = VmcReceiver()
                while True:
                    try:
                        receiver.take(listener.recv(65536))
                    except BlockingIOError:
                        break
                theirs = receiver.pose(skeleton).globals(skeleton)[:, :3, 3]
                own = ours.poses[frame].globals(skeleton)[:, :3, 3]
                hands = [anatomy.joints["leftHand"], anatomy.joints["rightHand"]]
                hips = anatomy.joints["hips"]
                apart.append((theirs[hands] - theirs[hips]) - (own[hands] - own[hips]))
    assert np.linalg.norm(apart, axis=-1).max() < 0.02
    path = ours.poses.globals(skeleton)[:, anatomy.joints["rightHand"], :3, 3]
    assert np.ptp(path, axis=0).max() > 0.3, "a wave is no small thing"


@pytest.mark.parametrize("clip", ["wave", "cheer", "Walk"])
def test_in_unitys_axes_the_bones_end_where_ours_do_with_left_and_right_in_their_places(
    human, clip
):
    """Positions and rotations together, from the hips down each chain; +x is to the right there."""
    pose = human.clips[clip].poses[len(human.clips[clip]) // 2]
    receiver = VmcReceiver()
    for each in VmcBody(human).messages(posed(human, pose), 0.0):
        if each.address == "/VMC/Ext/Bone/Pos":
            receiver.bones[each.arguments[0]] = np.array(each.arguments[1:])
    bones = TPoseBones(human)
    places, turns = {}, {}
    for part, parent in zip(bones.parts, bones.parents, strict=True):
        numbers = receiver.bones[unity_name(part)]
        above = bones.parts[parent] if parent >= 0 else None
        places[part], turns[part] = numbers[:3], numbers[3:]
        if above is not None:
            places[part] = places[above] + rotations.rotate(turns[above], numbers[:3])
            turns[part] = rotations.multiply(turns[above], numbers[3:])
    own = pose.globals(human.skeleton)
    for part in ("leftHand", "rightHand", "leftFoot", "rightFoot", "head"):
        place = own[human.anatomy.joints[part], :3, 3] * [-1.0, 1.0, 1.0]
        # Our clips move some joints in their parents, by millimetres.
        np.testing.assert_allclose(places[part], place, atol=0.006, err_msg=part)


def test_every_bone_has_a_name_that_unity_knows_and_its_rest_offset(human):
    """Receivers that take positions would else put all bones into one point."""
    sent = VmcBody(human).messages(posed(human, human.skeleton.rest), 0.0)
    bones = {m.arguments[0]: m.arguments[1:] for m in sent if m.address == "/VMC/Ext/Bone/Pos"}
    assert UNITY_BONES >= bones.keys() >= {"Hips", "Spine", "Head", "LeftHand", "RightFoot"}
    assert all(np.linalg.norm(numbers[:3]) > 0.005 for numbers in bones.values())
    assert bones["Hips"][1] == pytest.approx(0.84, abs=0.02)
    assert all(np.linalg.norm(numbers[3:]) == pytest.approx(1.0) for numbers in bones.values())


def test_expressions_have_the_names_of_vrm_0_and_are_applied(human):
    weights = np.zeros(len(human.morphs))
    weights[human.morphs.index("happy")] = 0.75
    weights[human.morphs.index("viseme_O")] = 0.5
    weights[human.morphs.index("blinkLeft")] = 1.0
    pose = replace(human.skeleton.rest, morphs=weights)
    receiver = VmcReceiver()
    sent = list(VmcBody(human).messages(posed(human, pose), 0.0))
    for each in sent:
        if each.address == "/VMC/Ext/Blend/Val":
            receiver.blend[each.arguments[0]] = each.arguments[1]
    assert sent[-1].address == "/VMC/Ext/Blend/Apply"
    assert receiver.blend.keys() == {VRM0_NAMES[preset] for preset in PRESETS}
    shown = {name: value for name, value in receiver.blend.items() if value > 0.01}
    assert shown == pytest.approx({"Joy": 0.75, "O": 0.5, "Blink_L": 1.0}, abs=0.01)


def test_the_root_is_where_the_character_stands_in_its_own_metres(human):
    """A person of the height of a hand walks on the table by as many of its own lengths."""
    yaw, scale = 0.5, 0.1
    table = np.eye(4)
    table[:3, :3] = scale * rotations.to_matrix(rotations.about("y", yaw))
    table[:3, 3] = 0.2, 0.0, 0.1
    sent = VmcBody(human).messages(posed(human, human.skeleton.rest, table), 0.0)
    (root,) = [m.arguments for m in sent if m.address == "/VMC/Ext/Root/Pos"]
    assert root[0] == "root"
    assert root[1:4] == pytest.approx((-2.0, 0.0, 1.0))
    turned = np.array(root[4:]) * [1.0, -1.0, -1.0, 1.0]
    np.testing.assert_allclose(turned, rotations.about("y", yaw), atol=1e-12)


def test_what_is_no_person_is_refused_in_one_line():
    with (
        VmcOut(UdpAddress("127.0.0.1", 9)) as out,
        pytest.raises(AppError, match="--vmc: vleo is no person"),
    ):
        out.begin([Character.load("vleo")])


def test_another_character_in_play_is_followed_if_it_can_be(human):
    vleo = Character.load("vleo")
    with VmcOut(UdpAddress("127.0.0.1", 9)) as out:
        out.begin([human])
        for who in (vleo, human):
            out.follow(step_of(posed(who, who.skeleton.rest)), [who], 0.0)


def test_each_person_of_a_cast_is_sent_to_an_address_of_its_own(human):
    with ExitStack() as closing:
        listeners = [closing.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in "ab"]
        for each in listeners:
            each.bind(("127.0.0.1", 0))
            each.settimeout(5.0)
        first, second = (UdpAddress("127.0.0.1", each.getsockname()[1]) for each in listeners)
        # Vleo's address lies between those of the two people, and nothing is sent there.
        out = closing.enter_context(VmcOut(first, UdpAddress("127.0.0.1", 9), second))
        cast = [human, Character.load("vleo"), human]
        out.begin(cast)
        poses = human.clips["wave"].poses[0], cast[1].skeleton.rest, human.clips["cheer"].poses[9]
        step = step_of(*(posed(who, pose) for who, pose in zip(cast, poses, strict=True)))
        out.follow(step, cast, 0.0)
        for listener, pose in zip(listeners, (poses[0], poses[2]), strict=True):
            receiver, own = VmcReceiver(), VmcReceiver()
            while len(receiver.bones) < len(TPoseBones(human).parts):
                receiver.take(listener.recv(65536))
            for sent in VmcBody(human).messages(posed(human, pose), 0.0):
                if sent.address == "/VMC/Ext/Bone/Pos":
                    own.bones[sent.arguments[0]] = np.array(sent.arguments[1:])
            for name, numbers in own.bones.items():
                np.testing.assert_allclose(receiver.bones[name], numbers, atol=1e-6)


def test_further_characters_go_to_the_next_ports():
    with VmcOut(UdpAddress("127.0.0.1", 39539), UdpAddress("127.0.0.1", 65535)) as out:
        assert [out.address_of(place).port for place in range(2)] == [39539, 65535]
        with pytest.raises(AppError, match="no port 65536 for character 3"):
            out.address_of(2)
    with VmcOut(UdpAddress("127.0.0.1", 39539)) as out:
        assert out.address_of(2) == UdpAddress("127.0.0.1", 39541)


@pytest.mark.parametrize(
    "morphs",
    [
        ("happy", "angry", "sad", "surprised", "relaxed", "aa", "ih", "ou", "ee", "oh", "blink"),
        ("Fcl_ALL_Joy", "Fcl_MTH_A", "Fcl_MTH_I", "Fcl_MTH_U", "Fcl_MTH_E", "Fcl_MTH_O"),
    ],
)
def test_each_preset_of_a_face_that_has_it_is_read_alone(morphs):
    from cubeling.characters.model import PresetFace

    face = PresetFace(morphs)
    for number in range(len(morphs)):
        shown = face.read(np.eye(len(morphs))[number])
        assert sorted(shown.values())[-2:] == pytest.approx([0.0, 1.0], abs=0.02), morphs[number]


@pytest.mark.full
@pytest.mark.skipif(bool(stranger.missing()), reason=f"there is no {stranger.missing()}")
@pytest.mark.slow(reason="starts a browser; the first time, npm installs three-vrm")
def test_a_strangers_receiver_in_a_browser_puts_the_wrists_there_too():
    """three-vrm with node-osc, on models of VRM 0 and 1.0."""
    try:
        stranger.install()
    except subprocess.CalledProcessError:
        pytest.skip("npm cannot install three-vrm here")
    results = asyncio.run(stranger.measure())
    assert max(value for by_clip in results.values() for value in by_clip.values()) < 0.02
