"""A replay walks the same line: the same frames give the same channels."""

import itertools

import numpy as np
import pytest

from app.commands.replay import bundled
from app.opening import fitting
from app.playground import Playground
from app.scenarios import CUBES
from app.session import about, messages
from app.session.arrows import ARROWS, decode, encode
from tracking import open_source

SHORT = 240


def walk(name, count=None):
    """Every channel of a bundled recording as it comes out now."""
    with open_source(str(bundled(name))) as source:
        playground = Playground(name, fitting(source.intrinsics, source.size))
        for frame in itertools.islice(source, count):
            step = playground.step(frame)
            for topic, arrow in step.arrows().items():
                yield topic, step.frame.timestamp, encode(arrow)


@pytest.mark.parametrize("name", CUBES)
def test_a_recording_replayed_twice_gives_identical_channels(name):
    assert list(walk(name, SHORT)) == list(walk(name, SHORT))


@pytest.mark.parametrize("name", CUBES)
def test_a_replay_agrees_with_what_was_recorded(name):
    """Bit for bit on the machine that recorded; elsewhere to a hair, as processors round."""
    recorded = itertools.islice(messages(bundled(name), *ARROWS), SHORT * len(ARROWS))
    for (topic, time, old), (_, _, new) in zip(recorded, walk(name, SHORT), strict=True):
        if old != new:
            one, other = decode(ARROWS[topic], old), decode(ARROWS[topic], new)
            _agree(topic, time, one, other)


def _agree(topic, time, one, other):
    for field in one.__dataclass_fields__:
        a, b = getattr(one, field), getattr(other, field)
        if field in ("pose", "emotion"):
            _agree(topic, time, a, b)
        elif isinstance(a, np.ndarray) and field != "covariance":
            np.testing.assert_allclose(a, b, atol=1e-3, err_msg=f"{topic} {field} at {time}")
        elif isinstance(a, str | bool | tuple):
            assert a == b, f"{topic} {field} at {time}"


@pytest.mark.parametrize("name", CUBES)
def test_bundled_recordings_are_small_and_whole(name):
    told = about(bundled(name))
    assert bundled(name).stat().st_size < 6_000_000
    assert told.scenario == name
    assert told.frames > 600
    topics = {topic for topic, _, _ in messages(bundled(name))}
    assert {*ARROWS, "/camera/image", "/camera/calibration", "/robot/wire", "/events"} <= topics


@pytest.mark.parametrize("name", CUBES)
def test_the_cube_is_found_in_nearly_every_frame(name):
    states = [decode(ARROWS[t], data) for t, _, data in messages(bundled(name), "/cube/state")]
    assert np.mean([state.visible for state in states]) > 0.97
