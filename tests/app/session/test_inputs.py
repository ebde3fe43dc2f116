"""What came in with the frames is recorded, and everything else follows from it."""

from pathlib import Path

import pytest

import tests.sessions
from cubeling.affect import Emotion
from cubeling.app.commands.play.complete import complete_session
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.pipeline.table.spoken_line import LEAD
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import (
    SessionOptions,
    messages,
    session_info,
)
from cubeling.app.session.copying import INPUT_TOPICS, copy_session, keep_inputs
from cubeling.app.session.encoding import INPUTS_TOPIC
from cubeling.app.speaking.recorded import RecordedSpeaker
from cubeling.app.ui.screen import NullScreen
from tests.app import session_parts
from tests.app.conftest import SHORT_FRAMES

SPOKEN = Path(tests.sessions.__path__[0]) / "spoken.mcap"

START_OVER, OPENED, CLOSED, MARK, HIDDEN, SHOWN, ACTED, FELT = 20, 10, 27, 26, 3, 25, 22, 28
"""The frames in which something comes in; one line is said before the character appears."""


class Presses(NullScreen):
    """Presses keys after some frames."""

    shown = 0

    def show(self, step, robot):
        self.shown += 1
        acts = {
            ACTED: (Act("gesture", "nod"), Act("action", "kiss", 0.5)),
            FELT: (Act("emotion", emotion=Emotion(-0.6, 0.7, "angry")), Act("say", "Hm.")),
        }
        return Inputs(
            clear=self.shown == START_OVER,
            inside=self.shown in (OPENED, CLOSED),
            acts=acts.get(self.shown, ()),
        )


@pytest.fixture(scope="module")
def full(tmp_path_factory, short_session):
    """A recorded session in which all comes in that can."""
    path = tmp_path_factory.mktemp("inputs") / "full.mcap"
    (line,) = session_parts.lines(SPOKEN).values()
    options = SessionOptions(
        scenario="companion", source=str(short_session), record=path, pictures=False
    )
    with open_session(options, screen=Presses()) as session:
        times = [time for _, time, _ in messages(short_session, "/camera/image")]
        session.speaker = RecordedSpeaker({times[at]: {LEAD: line} for at in (HIDDEN, SHOWN)})

        def mark(step):
            if step.frame.index == MARK and session.recording is not None:
                session.mark(step.frame.timestamp)

        run(session, mark)
    return path


@pytest.mark.slow(reason="a session is computed twice")
def test_a_session_with_inputs_of_every_kind_replays_bit_for_bit(full):
    times = [time for _, time, _ in messages(full, "/camera/image")]
    assert session_parts.start_overs(full) == {times[START_OVER]}
    assert session_parts.openings(full) == {times[OPENED], times[CLOSED]}
    assert list(session_parts.lines(full)) == [times[HIDDEN], times[SHOWN]]
    acted = {time: each.acts for time, each in session_parts.inputs(full).items() if each.acts}
    assert list(acted) == [times[ACTED], times[FELT]]
    assert [act.kind for acts in acted.values() for act in acts] == [
        "gesture",
        "action",
        "emotion",
        "say",
    ]
    result = session_parts.check(full, session_info(full).options)
    assert result.identical
    assert set(result.counts.values()) == {SHORT_FRAMES}


@pytest.mark.slow(reason="a session is computed again")
def test_from_what_came_in_the_same_session_is_computed(full, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("cubeling.app.commands.play.complete.SHORT_S", 0.0)
    bare = tmp_path / "full.mcap"
    keep_inputs(full, bare)
    assert {topic for topic, _, _ in messages(bare)} == set(INPUT_TOPICS)
    assert not session_parts.has_channels(bare)
    with complete_session(bare) as complete:
        assert complete.name == full.name
        assert list(messages(complete)) == list(messages(full))
    assert not complete.parent.exists()
    said = capsys.readouterr().err.splitlines()
    assert said[0].startswith("full.mcap holds only what came in: computing the rest")
    with complete_session(full) as complete:
        assert complete == full
    assert capsys.readouterr().err == ""


def test_inputs_are_read_from_where_an_older_session_has_them(tmp_path):
    bare = tmp_path / "bare.mcap"
    keep_inputs(SPOKEN, bare)
    assert not list(messages(SPOKEN, INPUTS_TOPIC))
    assert len(list(messages(bare, INPUTS_TOPIC))) == 3
    old, new = session_parts.inputs(SPOKEN), session_parts.inputs(bare)
    assert old == new
    assert [(each.inside, each.clear, each.speech is not None) for each in old.values()] == [
        (True, False, False),
        (False, False, True),
        (False, True, False),
    ]


def test_inputs_that_no_recorder_wrote_are_refused_in_one_line(tmp_path):
    bare, broken = tmp_path / "bare.mcap", tmp_path / "broken.mcap"
    keep_inputs(SPOKEN, bare)
    copy_session(bare, broken, lambda topic, _, data: b"[]" if topic == INPUTS_TOPIC else data)
    with pytest.raises(AppError, match=r"broken\.mcap': /inputs at") as caught:
        session_parts.inputs(broken)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "writes"),
    [
        (("export", "bare.mcap", "-o", "out"), "out/poses.csv"),
        (("mood", "table", "bare.mcap", "-o", "m.csv"), "m.csv"),
        (
            ("replay", "bare.mcap", "--no-pictures", "--from", "pose", "--record", "r.mcap"),
            "r.mcap",
        ),
        (("replay", "bare.mcap", "--check"), None),
        (("bridge", "--robot", "rex=sim", "--play", "ann=bare.mcap", "--seconds", "0"), None),
    ],
)
def test_a_command_computes_the_channels_that_it_reads(
    cubeling, short_session, tmp_path, arguments, writes, monkeypatch
):
    begin = tmp_path / "begin.mcap"
    copy_session(short_session, begin, lambda _, time, data: data if time < 0.45 else None)
    keep_inputs(begin, tmp_path / "bare.mcap")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    code, _, err = cubeling(*arguments)
    assert (code, err) == (0, "")
    if writes is not None and writes.endswith(".csv"):
        assert len((tmp_path / writes).read_text("utf-8").splitlines()) == 1 + 14
    elif writes is not None:
        assert session_parts.has_channels(tmp_path / writes)
    assert not list(tmp_path.glob("cubeling-*"))


def test_ctrl_c_while_channels_are_computed_leaves_nothing(
    cubeling, short_session, tmp_path, monkeypatch
):
    from cubeling.app.running.frame_loop import FrameLoop

    keep_inputs(short_session, tmp_path / "bare.mcap")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    step, count = FrameLoop.step, iter(range(100))

    def interrupted(self, frame, **settings):
        if next(count) == 5:
            raise KeyboardInterrupt
        return step(self, frame, **settings)

    monkeypatch.setattr(FrameLoop, "step", interrupted)
    code, out, _ = cubeling("export", "bare.mcap", "-o", "out")
    assert (code, out) == (130, "")
    assert [each.name for each in tmp_path.iterdir()] == ["bare.mcap"]


def test_a_stage_that_is_none_is_refused_before_anything_is_computed(cubeling, short_session):
    keep_inputs(short_session, Path("bare.mcap"))
    code, _, err = cubeling("replay", "bare.mcap", "--no-pictures", "--from", "middle")
    assert (code, err.count("\n")) == (2, 1)
    assert "choose one of camera" in err
