"""Messages are the same after encoding and decoding."""

import dataclasses
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from affect import Emotion
from app.pipeline.scenario import EmotionTarget
from app.session.encoding import MESSAGE_TYPES, decode, encode, schema
from tracking import CubeState

NUMBERS = st.floats(-1e3, 1e3)


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


@pytest.mark.parametrize("topic", MESSAGE_TYPES)
def test_every_message_type_has_a_json_schema(topic):
    assert json.loads(schema(MESSAGE_TYPES[topic]))["type"] == "object"


@pytest.mark.parametrize("document", [b"", b"{", b"[]", b"3", b"{}"])
def test_another_document_is_refused(document):
    with pytest.raises(ValueError, match=r"EmotionTarget|Expecting"):
        decode(EmotionTarget, document)
