"""A bundled session's moods, and a short session with a robot that says a little."""

import itertools

import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session import Recorder
from cubeling.app.workshop.moods import read_history
from cubeling.robot.protocol.schema import pack
from cubeling.robot.protocol.wire import encode_frame
from cubeling.tracking import open_source
from tests.app.workshop.moods.talking import SAID

FRAME = 1 / 30


@pytest.fixture(scope="module")
def companion(scripted_session):
    """A whole session with every channel."""
    return scripted_session("companion")


@pytest.fixture(scope="module")
def history(companion):
    """The moods of a whole session."""
    return read_history(companion)


@pytest.fixture(scope="module")
def talking_session(tmp_path_factory, bundled_session):
    """A dozen frames, a robot that answers some of what it is told, and noise on its line."""
    path = tmp_path_factory.mktemp("moods") / "talking.mcap"
    about = {"scenario": "companion", "cube": "companion", "personality": "shy"}
    with open_source(str(bundled_session)) as source, Recorder(path, about) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        for frame in itertools.islice(source, 12):
            recorder.write(playground.step(frame))
        for time, direction, content in SAID:
            data = b"\x07noise" + encode_frame(pack(content, 9))
            recorder.wire(direction, data[:9], time)
            recorder.wire(direction, data[9:], time)
    return path
