"""A replay is exact: the same frames give the same messages."""

import itertools
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import (
    SessionOptions,
    messages,
    session_info,
)
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.session.encoding import APPEARANCE_TOPIC, MESSAGE_TYPES, decode, encode
from cubeling.app.session.options import START_STAGES
from cubeling.app.ui.screen import NullScreen
from cubeling.tracking import open_source
from cubeling.tracking.appearance import Appearance
from tests.app import session_parts
from tests.conftest import FIRST_S
from tests.examples import some

FRAMES = 120
"""After four seconds the cube has been lifted and put down, or has turned."""


@pytest.mark.full  # seconds of a recording are computed twice; the others here replay less
@pytest.mark.parametrize("name", some(sorted(RECORDED_SCENARIOS)))
def test_a_recording_replayed_twice_gives_identical_channels(computed_session, name):
    path = computed_session(name, FIRST_S)
    with open_source(str(bundled_session(name))) as source:
        playground = Playground(name, intrinsics_for(source.intrinsics, source.size))
        again = [
            (topic, step.frame.timestamp, encode(message))
            for frame in itertools.islice(source, FRAMES)
            for step in (playground.step(frame),)
            for topic, message in step.messages().items()
        ]
    once = messages(path, *MESSAGE_TYPES)
    assert again == list(itertools.islice(once, FRAMES * len(MESSAGE_TYPES)))


@pytest.mark.parametrize("start", [each for each in START_STAGES if each != "appearance"])
def test_a_replay_may_start_from_any_stage(short_session, start):
    """What comes after the start is computed again, and is the same."""
    with open_source(str(short_session)) as source:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorded = iter(session_parts.replay_inputs(short_session, start))
        made = [
            (topic, step.frame.timestamp, encode(message))
            for frame in source
            for step in (playground.step(frame, replay=next(recorded, None)),)
            for topic, message in step.messages().items()
        ]
    assert made == list(messages(short_session, *MESSAGE_TYPES))


@pytest.mark.slow(reason="pictures are measured and drawn, twice")
def test_what_the_pictures_told_is_recorded_and_replayed(tmp_path, short_session):
    path, video = tmp_path / "seen.mcap", tmp_path / "seen.mp4"
    options = SessionOptions(
        scenario="companion", source=str(short_session), robot="none", record=path, output=video
    )
    with open_session(replace(options, end_s=0.6)) as session:
        run(session)
    result = session_parts.check(path, session_info(path).options)
    assert result.identical
    assert result.counts[APPEARANCE_TOPIC] == result.counts["/cube/state"] > 10
    recorded = list(session_parts.replay_inputs(path, "appearance"))
    assert [type(each.appearance) for each in recorded] == [Appearance] * len(recorded)
    assert recorded[-1].command is None
    last = recorded[-1].appearance
    assert last is not None
    assert last.light is not None
    assert decode(Appearance, encode(last)).light is not None
    rooms = [each.appearance.room for each in recorded if each.appearance]
    assert rooms[-1] is not None
    news = sum(b'"room":{' in data for _, _, data in messages(path, APPEARANCE_TOPIC))
    assert 1 <= news == len({room.timestamp for room in rooms if room})


def test_a_session_without_pictures_cannot_start_from_what_they_told(short_session):
    with pytest.raises(AppError, match="no recorded channels to start from 'appearance'"):
        session_parts.replay_inputs(short_session, "appearance")


def test_an_unknown_start_is_refused(short_session):
    with pytest.raises(AppError, match="choose one of camera"):
        session_parts.replay_inputs(short_session, "middle")


@pytest.mark.full  # a session is played and checked; `test_inputs` does so with all inputs
def test_a_player_who_starts_over_does_so_in_the_replay(tmp_path, short_session):
    class Presses(NullScreen):
        """Presses C after 20 frames."""

        shown = 0

        def show(self, step, robot):
            self.shown += 1
            return Inputs(clear=self.shown == 20)

    path = tmp_path / "cleared.mcap"
    options = SessionOptions(
        scenario="companion", source=str(short_session), robot="none", record=path, pictures=False
    )
    with open_session(options, screen=Presses()) as session:
        run(session)
    assert len(session_parts.start_overs(path)) == 1
    assert session_parts.check(path, replace(options, source=str(path))).identical


@pytest.mark.slow(reason="a session is played and replayed")
def test_a_player_who_looks_into_the_cube_does_so_in_the_replay(tmp_path, lifting_session):
    class Looks(NullScreen):
        """Presses I after 10 and after 30 frames, and keeps what was seen."""

        def __init__(self, *presses):
            self.presses, self.openings = presses, []

        def show(self, step, robot):
            interior = step.interior
            self.openings.append(0.0 if interior is None else interior.box.opening)
            return Inputs(inside=len(self.openings) in self.presses)

    path = tmp_path / "inside.mcap"
    options = SessionOptions(
        scenario="companion", source=str(lifting_session), robot="none", record=path, pictures=False
    )
    player, nobody = Looks(10, 30), Looks()
    with open_session(options, screen=player) as session:
        run(session)
    assert max(player.openings) == 1.0
    assert player.openings[-1] == 0.0
    assert len(session_parts.openings(path)) == 2
    again = replace(session_info(path).options, robot="none", pictures=False)
    with open_session(again, screen=nobody) as session:
        run(session)
    assert nobody.openings == player.openings


STATED_ERRORS = ("covariance", "focal_shift")
"""What an older program stated otherwise of the same pose."""


NEW_FACTS = ("obstacles", "view")
"""What an older program did not tell the character."""


def assert_close(topic, time, one, other):
    for field in set(one.__dataclass_fields__) - {*NEW_FACTS}:
        a, b = getattr(one, field), getattr(other, field)
        if field in ("pose", "emotion"):
            assert_close(topic, time, a, b)
        elif isinstance(a, np.ndarray) and field not in STATED_ERRORS:
            np.testing.assert_allclose(a, b, atol=1e-3, err_msg=f"{topic} {field} at {time}")
        elif isinstance(a, str | bool | tuple):
            assert a == b, f"{topic} {field} at {time}"


@pytest.mark.parametrize("name", RECORDED_SCENARIOS)
def test_bundled_recordings_are_small_and_hold_what_came_in(name):
    info = session_info(bundled_session(name))
    assert info.options.scenario == name
    assert info.frames > 600
    sizes = Counter[str]()
    for topic, _, data in messages(bundled_session(name)):
        sizes[topic] += len(data)
    assert set(sizes) == {"/camera/image", "/camera/calibration", "/events"}
    assert bundled_session(name).stat().st_size < 1.02 * sizes["/camera/image"]


@pytest.mark.slow(reason="a session is recorded and checked")
def test_a_replay_takes_the_character_that_was_recorded(cubeling, short_session, tmp_path):
    code, _, err = cubeling(
        "replay", short_session, "--character", "human", "--no-pictures", "--record", "human.mcap"
    )
    assert (code, err) == (0, "")
    assert session_info(tmp_path / "human.mcap").options.character == "human"
    code, _, err = cubeling("replay", "human.mcap", "--check")
    assert (code, err) == (0, "")


def test_every_bundled_recording_is_listed():
    assert sorted(RECORDED_SCENARIOS) == sorted(
        file.stem for file in bundled_session("reach").parent.glob("*.mcap")
    )
