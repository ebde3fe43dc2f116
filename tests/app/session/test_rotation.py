"""Recordings in parts: each is whole, together they are the session, and only the first replays."""

import itertools
import shutil
from pathlib import Path

import pytest

from cubeling.app.output_path import part_path
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.recording.recording import SessionRecording
from cubeling.app.session import SessionFile, SessionOptions, messages, session_info
from cubeling.app.session.encoding import IMAGE_TOPIC
from cubeling.app.workshop.study.participants.live_task import judge
from cubeling.app.workshop.study.protocols.goals import Goal
from cubeling.app.workshop.study.protocols.protocol import StudyTask
from cubeling.tracking import Intrinsics, open_source
from tests.app.conftest import SHORT_FRAMES

MINUTES = 11.5 / 30.0 / 60.0  # twelve frames
PARTS = -(-SHORT_FRAMES // 12)


def parts_of(path):
    found = [part_path(path, number) for number in range(1, 41)]
    return [each for each in found if each.exists()]


def record(cubeling, session, path, *options):
    arguments = ["play", "companion", "--source", session, "--no-pictures", "--record", path]
    code, out, err = cubeling(*arguments, *options)
    assert code == 0, err
    return out


@pytest.fixture
def rotated(cubeling, short_session):
    out = record(
        cubeling, short_session, "all.mcap", "--codec", "jpeg", "--rotate-minutes", MINUTES
    )
    assert "cubeling replay all-002.mcap --from pose" in out
    return parts_of(Path("all.mcap"))


@pytest.mark.slow(reason="a session is recorded twice")
def test_the_parts_together_are_what_one_file_would_be(cubeling, short_session, rotated):
    assert len(rotated) == PARTS
    record(cubeling, short_session, "one.mcap", "--codec", "jpeg", "--rotate-mb", 1000)
    with SessionFile(Path("one.mcap")) as session:
        topics = (IMAGE_TOPIC, "/inputs", "/events", *session.channels)
    whole = list(messages(Path("one.mcap"), *topics))
    joined = list(itertools.chain.from_iterable(messages(path, *topics) for path in rotated))
    assert joined == whole
    for path in rotated:
        with SessionFile(path) as session:  # its index and every channel are there
            assert session.has_channels
            assert session.info.frames <= 12
    assert sum(session_info(path).frames for path in rotated) == SHORT_FRAMES


@pytest.mark.slow(reason="a session is recorded and replayed")
def test_the_first_part_replays_exactly_and_the_others_name_it(cubeling, rotated):
    assert cubeling("replay", "all.mcap", "--check")[0] == 0
    for arguments in (("--no-pictures",), ("--check",)):
        code, _, err = cubeling("replay", "all-002.mcap", *arguments)
        assert (code, err.count("\n")) == (2, 1)
        assert "goes on from 'all.mcap'" in err
    shown = ["all-002.mcap", "--from", "pose", "--no-pictures"]
    assert cubeling("replay", *shown)[0] == 0
    assert cubeling("export", "all-002.mcap", "-o", "out")[0] == 0


@pytest.mark.parametrize("command", ["play", "replay", "serve", "talk", "show", "study"])
def test_every_command_that_records_goes_on_in_parts(cubeling, short_session, command):
    code, out, _ = cubeling(command, *(["run"] if command == "study" else []), "--help")
    assert code == 0
    assert "--rotate-minutes" in out
    assert "--rotate-mb" in out


@pytest.mark.slow(reason="a session is recorded and replayed")
def test_joined_parts_replay_exactly(cubeling, short_session):
    record(cubeling, short_session, "all.mcap", "--codec", "h264", "--rotate-minutes", MINUTES)
    code, out, _ = cubeling("join", "all.mcap", "-o", "whole.mcap")
    assert (code, out) == (0, f"whole.mcap holds {PARTS} parts\n")
    assert session_info(Path("whole.mcap")).frames == SHORT_FRAMES
    assert cubeling("replay", "whole.mcap", "--check")[0] == 0
    shout = StudyTask("shout", "", "companion", Goal("action", "shout"))
    assert judge(Path("all.mcap"), shout) == judge(Path("whole.mcap"), shout)
    for cut, words in ((PARTS, "could be read"), (2, "could be read, and from there on")):
        part = Path(f"all-{cut:03}.mcap")
        kept = part.read_bytes()
        part.write_bytes(kept[: len(kept) // 2])
        code, out, _ = cubeling("join", "all.mcap", "-o", f"cut{cut}.mcap")
        part.write_bytes(kept)
        assert (code, out.count("\n")) == (0, 2)
        assert f"'{part}' was cut off: " in out
        assert words in out
        held = int(out.split("was cut off: ")[1].split()[0])
        lost = session_info(part).frames - held
        assert session_info(Path(f"cut{cut}.mcap")).frames == SHORT_FRAMES - lost
        assert held < session_info(part).frames
    Path("all-002.mcap").unlink()
    code, _, err = cubeling("join", "all.mcap", "-o", "less.mcap")
    assert (code, err.count("\n")) == (2, 1)
    assert "'all-002.mcap' is missing" in err
    assert not Path("less.mcap").exists()


def test_h264_parts_can_be_decoded_alone_and_are_cut_by_size(cubeling, short_session):
    size = 0.05
    record(cubeling, short_session, "s.mcap", "--codec", "h264", "--rotate-mb", size)
    parts = parts_of(Path("s.mcap"))
    assert len(parts) > 1
    count = 0
    for path in parts:
        with open_source(str(path)) as source:
            count += sum(1 for _ in source)
    assert count == SHORT_FRAMES


def test_a_recording_without_a_whole_frame_is_not_joined(cubeling, short_session):
    Path("cut.mcap").write_bytes(short_session.read_bytes()[:2000])
    code, _, err = cubeling("join", "cut.mcap", "-o", "joined.mcap")
    assert code == 2
    assert err.count("\n") == 1
    assert "cut.mcap' was cut off before its first frame was whole" in err
    assert not Path("joined.mcap").exists()


def test_a_kill_leaves_all_complete_parts_whole(short_session, tmp_path):
    copied = tmp_path / "killed"
    copied.mkdir()
    with open_source(str(short_session)) as source:
        path = tmp_path / "k.mcap"
        options = SessionOptions(
            scenario="companion",
            source=str(short_session),
            record=path,
            codec="jpeg",
            part_s=0.38,
        )
        playground = Playground("companion", source.intrinsics or Intrinsics.guess(source.size))
        recording = SessionRecording(path, options, playground, source, (), language="")
        for frame in itertools.islice(source, 30):
            recording.write(playground.step(recording.encode(frame)), Inputs())
        recording.flush()
        recording._wait_for_ended()
        for path in recording.paths:  # as the disk is when the program is killed now
            shutil.copy(path, copied)
        recording.close()
        playground.close()
    parts = parts_of(copied / "k.mcap")
    assert len(parts) == 3
    assert [session_info(path).frames for path in parts[:-1]] == [12, 12]
    assert session_info(parts[-1], salvage=True).frames == 6


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (("--rotate-minutes", "0"), "--rotate-minutes is greater than 0"),
        (("--rotate-mb", "nan"), "--rotate-mb is greater than 0"),
        (("--rotate-mb", "1"), "old-007.mcap' exists already"),
    ],
)
def test_bad_input_is_one_line(cubeling, short_session, options, says):
    Path("old-007.mcap").touch()
    code, _, err = cubeling(
        "play", "companion", "--source", short_session, "--record", "old.mcap", *options
    )
    assert (code, err.count("\n")) == (2, 1)
    assert says in err
    assert not Path("old.mcap").exists()
