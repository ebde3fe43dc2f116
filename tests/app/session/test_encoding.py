"""Messages are the same after encoding and decoding."""

import dataclasses
import json
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.session.encoding import (
    APPEARANCE_TOPIC,
    CHANNEL_TYPES,
    decode,
    encode,
    schema,
    upgrade,
)
from cubeling.characters import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    Pose,
    PosedCharacter,
)
from cubeling.tracking import CubeControls, CubeState
from cubeling.tracking.appearance import (
    ENVIRONMENT_PX,
    Appearance,
    EnvironmentMap,
    HandMask,
    PictureQuality,
)

NUMBERS = st.floats(-1e3, 1e3)

PLANES = np.full((18 * ENVIRONMENT_PX, ENVIRONMENT_PX), 90, np.uint8)


def assert_equal(one, other):
    for field in dataclasses.fields(one):
        a, b = getattr(one, field.name), getattr(other, field.name)
        if isinstance(a, np.ndarray):
            np.testing.assert_array_equal(a, b)
        elif isinstance(a, float) and math.isnan(a):
            assert math.isnan(b)
        else:
            assert a == b


@given(st.lists(NUMBERS, min_size=16, max_size=16), NUMBERS, st.booleans())
def test_a_cube_state_keeps_every_bit(numbers, timestamp, seen):
    state = CubeState(
        visible=seen,
        camera_from_cube=np.array(numbers).reshape(4, 4) if seen else None,
        velocity=np.array(numbers[:6]),
        covariance=np.outer(numbers[:6], numbers[:6]) if seen else np.full((6, 6), np.nan),
        source="markers",
        faces=("front", "top"),
        reprojection_error=float("nan"),
        timestamp=timestamp,
    )
    assert_equal(decode(CubeState, encode(state)), state)


def test_a_nested_emotion_is_decoded():
    target = EmotionTarget(Emotion(0.25, -0.5, "neutral"), 1.5)
    assert decode(EmotionTarget, encode(target)) == target


def test_controls_keep_every_bit(hand):
    controls = hand.frame(turns=1 / 3)
    assert_equal(decode(type(controls), encode(controls)), controls)


def posed(*rotation):
    pose = Pose(np.zeros((1, 3)), np.array([rotation]))
    return PosedCharacter(
        pose, np.eye(4), True, "idle", speed=0.0, angular=0.0, weight=0.0, timestamp=0.0
    )


def test_noise_of_rounding_in_a_pose_is_zero():
    noisy, clean = posed(3e-16, -2e-17, -0.0, 1.0), posed(0.0, 0.0, 0.0, 1.0)
    assert encode(noisy) == encode(clean)
    assert encode(posed(1e-7, 0.0, 0.0, 1.0)) != encode(clean)


def test_noise_of_rounding_in_an_older_pose_is_no_difference():
    now = encode(posed(0.0, 0.0, 0.0, 1.0))
    old = now.replace(b"[[0.0,0.0,0.0,1.0]]", b"[[3e-16,-2e-17,0.0,1.0]]")
    assert old != now
    assert upgrade("/character/pose", old) == now


def test_a_hand_is_the_same_after_decoding():
    share = np.arange(60, dtype=np.uint8).reshape(6, 10)
    hand = HandMask(3, 4, share, np.array([0.0, 0.1, 0.5]), 2, 1.5)
    seen = decode(Appearance, encode(Appearance(hand, None, PictureQuality(0.7, 2.0), 1.5)))
    assert seen.hand is not None
    assert seen.hand.share.dtype == np.uint8
    np.testing.assert_equal(dataclasses.astuple(seen.hand), dataclasses.astuple(hand))
    assert (seen.light, seen.softness, seen.timestamp) == (None, PictureQuality(0.7, 2.0), 1.5)


def test_a_map_of_the_room_is_recorded_once_and_meant_until_the_next():
    planes = np.arange(18 * 64 * 64, dtype=np.uint32).astype(np.uint8).reshape(-1, 64)
    maps = [EnvironmentMap(planes + each, np.zeros(3), 1.0, 0.1 * each) for each in (0, 2)]
    seen = [Appearance(None, None, None, 0.1 * time, maps[time // 2]) for time in range(4)]
    written = [encode(each.news()) for each in seen]
    assert [len(each) > 1000 for each in written] == [True, False, True, False]
    before = None
    for sent, document in zip(seen, written, strict=True):
        before = decode(Appearance, document).after(before)
        assert before.room is not None
        assert sent.room is not None
        np.testing.assert_array_equal(before.room.planes, sent.room.planes)
        assert before.room.timestamp == sent.room.timestamp


def test_a_damaged_map_of_the_room_is_refused():
    found = Appearance(None, None, None, 0.0, EnvironmentMap(PLANES, np.zeros(3), 1.0, 0.0))
    content = json.loads(encode(found))
    content["room"]["planes"] = json.loads(encode(HandMask(0, 0, PLANES[:3], np.zeros(3))))["share"]
    with pytest.raises(ValueError, match="texels"):
        decode(Appearance, json.dumps(content).encode())
    with pytest.raises(ValueError, match="place"):
        EnvironmentMap(PLANES, np.zeros(2), 1.0, 0.0)


def test_an_appearance_of_before_there_were_maps_has_none():
    content = json.loads(encode(Appearance(None, None, None, 0.5)))
    del content["room"]
    old = json.dumps(content).encode()
    assert upgrade(APPEARANCE_TOPIC, old) == encode(Appearance(None, None, None, 0.5))


@pytest.mark.parametrize("topic", CHANNEL_TYPES)
def test_every_message_type_has_a_json_schema(topic):
    assert json.loads(schema(CHANNEL_TYPES[topic]))["type"] == "object"


@pytest.mark.parametrize("document", [b"", b"{", b"[]", b"3", b"{}"])
def test_another_document_is_refused(document):
    with pytest.raises(ValueError, match=r"EmotionTarget|Expecting"):
        decode(EmotionTarget, document)


@pytest.mark.parametrize("damaged", [[[1.0], [2.0, 3.0]], {"a": 1}, ["one"]])
@pytest.mark.parametrize("name", ["velocity", "timestamp"])
def test_what_should_be_numbers_is_refused_in_plain_words(name, damaged):
    fields: dict[str, object] = {
        "visible": False,
        "camera_from_cube": None,
        "velocity": [0.0] * 6,
        "covariance": [],
        "source": "image",
        "faces": [],
        "reprojection_error": None,
        "timestamp": 1.5,
    }
    document = json.dumps({**fields, name: damaged}).encode()
    with pytest.raises(ValueError, match="is no number or array"):
        decode(CubeState, document)


OLD_COMMAND = {
    "timestamp": 1.5, "action": "kiss", "speed": 0.0, "target": [0.1, 0.2], "look_at": [0.0, 2.0],
    "gaze": None, "weight": 0.5, "feeling": [0.25, -0.5], "mood": "sad", "visible": True,
    "stop": True,
}  # fmt: skip
"""A command of a session before intents."""


def test_a_command_of_an_older_session_is_decoded_into_intents():
    command = decode(CharacterCommand, json.dumps(OLD_COMMAND).encode())
    assert command.action == ActionIntent("kiss", 0.5)
    assert command.emotion == Emotion(0.25, -0.5, "sad")
    target, facing = np.array([0.1, 0.2]), np.array([0.0, 2.0])
    assert_equal(command.locomotion, LocomotionIntent(0.0, target, True, facing))
    assert (command.timestamp, command.visible) == (1.5, True)


def test_a_command_of_the_oldest_sessions_is_decoded_with_what_it_has():
    """The first recordings had no stop, gaze, feeling or mood."""
    there = ("timestamp", "action", "speed", "target", "look_at", "weight", "visible")
    old = {key: OLD_COMMAND[key] for key in there} | {"action": "move", "speed": 2.0}
    command = decode(CharacterCommand, json.dumps(old).encode())
    assert command.activity == "move"
    target, facing = np.array([0.1, 0.2]), np.array([0.0, 2.0])
    assert_equal(command.locomotion, LocomotionIntent(2.0, target, True, facing))
    assert command.emotion is None
    assert command.gaze is None


def test_an_older_document_becomes_todays_and_todays_stays():
    old = json.dumps(
        {"emotion": {"valence": 0.5, "arousal": 0.1}, "label": "happy", "timestamp": 2}
    )
    today = encode(EmotionTarget(Emotion(0.5, 0.1, "happy"), 2.0))
    assert upgrade("/robot/emotion", old.encode()) == today
    assert upgrade("/robot/emotion", today) == today


@pytest.mark.parametrize(("shaken", "gestures"), [(True, ("shaken",)), (False, ())])
def test_a_shake_of_an_older_session_is_decoded_into_a_gesture(hand, shaken, gestures):
    today = encode(hand.frame(gestures=gestures))
    fields = json.loads(today)
    assert fields.pop("gestures") == list(gestures)
    old = json.dumps({**fields, "shaken": shaken}).encode()
    assert decode(CubeControls, old).shaken is shaken
    assert upgrade("/cube/controls", old) == today


@pytest.mark.parametrize("topic", ["/robot/emotion", "/character/command"])
@pytest.mark.parametrize("document", [b"{", b"[]", b"3", b'{"label":1}', b'{"action":""}'])
def test_a_document_that_no_version_wrote_is_compared_as_it_is(topic, document):
    assert upgrade(topic, document) == document
