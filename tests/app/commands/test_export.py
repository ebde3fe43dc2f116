"""Sessions as tables: all of their messages, with labels and a dictionary of every column."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.acts import Act, ActNote
from cubeling.app.session import Recorder, frame_encoder, messages
from cubeling.app.session.encoding import MESSAGE_TYPES, decode
from cubeling.app.workshop.exporting import CONTEXT_COLUMNS, EXPORT_TABLES, dictionary_rows, writing
from cubeling.app.workshop.exporting.writing import DICTIONARY_FILE
from cubeling.characters.skeleton import rotations
from cubeling.tracking import Frame, Intrinsics
from cubeling.tracking.appearance import Appearance, HandMask, MeasuredLight
from tests.app.conftest import SHORT_FRAMES
from tools.export_dictionary import DOCUMENT, updated


def table(name):
    with Path("out", f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def lines(name):
    text = Path("out", f"{name}.jsonl").read_text("utf-8")
    return [json.loads(line) for line in text.splitlines()]


@pytest.fixture
def exported(cubeling, short_session):
    """Export a session twice, under two names and with labels, and return its messages."""
    Path("second.mcap").write_bytes(short_session.read_bytes())
    labels = ["--participant", "P1", "--participant", "P 2", "--condition", "happy, loud"]
    code, out, err = cubeling("export", short_session, "second.mcap", "-o", "out", *labels)
    assert (code, err) == (0, "")
    assert f"emotions         {2 * SHORT_FRAMES:3} rows" in out
    return {
        topic: [decode(kind, data) for _, _, data in messages(short_session, topic)]
        for topic, kind in MESSAGE_TYPES.items()
    }


@pytest.mark.slow(reason="two sessions are exported")
def test_every_message_is_a_row_with_its_session_and_labels(exported):
    for name, topic in (("poses", "/cube/state"), ("emotions", "/robot/emotion")):
        for rows in (table(name), lines(name)):
            assert len(rows) == 2 * len(exported[topic]) == 2 * SHORT_FRAMES
            assert [float(row["time_s"]) for row in rows[:SHORT_FRAMES]] == [
                message.timestamp for message in exported[topic]
            ]
            for row, session, participant in (
                (rows[0], "short", "P1"),
                (rows[SHORT_FRAMES], "second", "P 2"),
            ):
                assert row["session"] == session
                assert row["participant"] == participant
                assert row["condition"] == "happy, loud"
    assert [row["frames"] for row in table("sessions")] == [str(SHORT_FRAMES)] * 2
    assert [row["event"] for row in table("events")] == []


def test_the_values_are_those_of_the_messages(exported):
    for row, state in zip(table("poses")[:SHORT_FRAMES], exported["/cube/state"], strict=True):
        place = [float(row[f"{axis}_m"]) for axis in "xyz"]
        turn = [float(row[f"q{axis}"]) for axis in "xyzw"]
        np.testing.assert_array_equal(place, state.camera_from_cube[:3, 3])
        matrix = rotations.to_matrix(np.array(turn))
        np.testing.assert_allclose(matrix, state.camera_from_cube[:3, :3], atol=1e-6)
    first = exported["/cube/controls"][0]
    assert first.position is None
    assert table("controls")[0]["x_m"] == ""
    assert lines("controls")[0]["x_m"] is None
    assert table("controls")[-1]["resting"] == "1"
    assert lines("controls")[-1]["resting"] is True
    last = exported["/character/pose"][-1]
    row = lines("characters")[-1]
    np.testing.assert_array_equal(row["joint_rotations"], last.pose.rotations)
    assert row["x_m"] == last.table_from_character[0, 3]
    assert "joint_rotations" not in table("characters")[0]


def test_what_the_picture_tells_is_a_table_where_it_was_measured(cubeling):
    light = MeasuredLight(np.array([0.0, -0.6, -0.8]), np.full(3, 0.5), np.full(3, 0.25), 0.9)
    share = np.array([[0, 255], [255, 51]], np.uint8)
    hand = HandMask(16, 8, share, np.array([0.01, 0.02, 0.5]), scale=4)
    playground = Playground("companion", Intrinsics.guess((64, 48)))
    with Recorder(Path("seen.mcap"), {"scenario": "companion"}) as recorder:
        encode = frame_encoder("jpeg", (64, 48), 30.0)
        for index, seen in enumerate(
            (Appearance(None, None, None, 0.0), Appearance(hand, light, None, 0.1))
        ):
            frame = encode(Frame(np.zeros((48, 64, 3), np.uint8), 0.1 * index, index))
            recorder.write(replace(playground.step(frame), appearance=seen))
    playground.close()
    assert cubeling("export", "seen.mcap", "-o", "out")[0] == 0
    nothing, seen = table("appearances")
    assert (nothing["hand"], nothing["hand_x_px"], nothing["key_r"]) == ("0", "", "")
    sides = [float(seen[f"hand_{name}_px"]) for name in ("x", "y", "width", "height", "area")]
    assert sides == [16.0, 8.0, 8.0, 8.0, pytest.approx(2.2 * 16)]
    assert [float(seen[f"behind_{axis}_m"]) for axis in "xyz"] == [0.01, 0.02, 0.5]
    assert [float(seen[f"light_{axis}"]) for axis in "xyz"] == [0.0, -0.6, -0.8]
    assert (seen["ambient_g"], seen["light_certainty"], seen["blur_px"]) == ("0.25", "0.9", "")


def test_the_dictionary_names_every_column_of_every_file(exported):
    with Path("out", DICTIONARY_FILE).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    for name in ("sessions", *(each.name for each in EXPORT_TABLES)):
        of_table = [row for row in rows if row["table"] == name]
        header = Path("out", f"{name}.csv").read_text("utf-8").splitlines()[0].split(",")
        assert header == [row["column"] for row in of_table if "csv" in row["files"]]
        for document in lines(name)[:1]:
            assert list(document) == [row["column"] for row in of_table]
    assert all(row["meaning"] for row in rows)


@pytest.mark.parametrize("stopped", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_an_export_that_is_stopped_leaves_the_earlier_one_as_it_was(
    cubeling, short_session, monkeypatch, stopped
):
    cubeling("export", short_session, "-o", "out")
    earlier = {path.name: path.read_bytes() for path in Path("out").iterdir()}

    def stop(*_):
        raise stopped

    monkeypatch.setattr(writing, "_table_rows", stop)
    labels = ["--participant", "other", "--overwrite"]
    code, _, err = cubeling("export", short_session, "-o", "out", *labels)
    assert code == (2 if isinstance(stopped, OSError) else 130)
    assert ("cannot write 'out/data_dictionary.csv': No space left" in err) == isinstance(
        stopped, OSError
    )
    assert {path.name: path.read_bytes() for path in Path("out").iterdir()} == earlier


def test_an_export_that_fails_leaves_no_empty_folder(cubeling, short_session, monkeypatch):
    def stop(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(writing, "_table_rows", stop)
    assert cubeling("export", short_session, "-o", "new")[0] == 2
    assert not Path("new").exists()


def test_the_page_has_the_dictionary_of_the_code():
    text = DOCUMENT.read_text("utf-8")
    assert updated(text) == text, "run `python -m tools.export_dictionary`"
    assert len(list(dictionary_rows())) > len(EXPORT_TABLES) * len(CONTEXT_COLUMNS)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("absent.mcap", "-o", "out"), "absent.mcap"),
        (("SESSION", "-o", "no/out"), "there is no folder 'no'"),
        (("SESSION", "-o", "file"), "'file' is a file"),
        (("SESSION", "-o", "full"), "--overwrite"),
        (("SESSION", "SESSION", "-o", "out"), "two sessions are called 'short'"),
        (("SESSION", "-o", "out", *["--participant", "P"] * 2), "once for each session"),
        (("cut.mcap", "-o", "out"), "--salvage"),
        (("SESSION",), "--output"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(cubeling, short_session, arguments, says):
    Path("file").touch()
    Path("full").mkdir()
    Path("full", "emotions.csv").write_text("old")
    Path("cut.mcap").write_bytes(short_session.read_bytes()[:-300])
    before = sorted(Path().rglob("*"))
    words = [str(short_session) if word == "SESSION" else word for word in arguments]
    code, _, err = cubeling("export", *words)
    assert (code, err.count("\n")) == (2, 1)
    assert says in err
    assert sorted(Path().rglob("*")) == before
    assert Path("full", "emotions.csv").read_text() == "old"


def test_a_session_that_was_cut_off_can_be_salvaged_over_old_tables(cubeling, short_session):
    Path("cut.mcap").write_bytes(short_session.read_bytes()[: short_session.stat().st_size // 2])
    for options in ((), ("--overwrite",)):
        assert cubeling("export", "cut.mcap", "-o", "out", "--salvage", *options)[0] == 0
    assert 0 < len(table("emotions")) < 60


def test_what_a_wizard_and_a_program_did_is_a_table(cubeling):
    told = [
        (Act("cue", "asks", note=ActNote(1)),),
        (Act("say", "Hello", note=ActNote(2, "asks", 0.4)), Act("go", place=(0.1, -0.05))),
        (Act("action", "wave", 0.5, note=ActNote(3)),),
        (Act("undo", note=ActNote(2)),),
    ]
    playground = Playground("companion", Intrinsics.guess((64, 48)))
    with Recorder(Path("told.mcap"), {"scenario": "companion"}) as recorder:
        encode = frame_encoder("jpeg", (64, 48), 30.0)
        for index, acts in enumerate(told):
            frame = encode(Frame(np.zeros((48, 64, 3), np.uint8), 0.1 * index, index))
            recorder.write(playground.step(frame), Inputs(acts=acts))
    playground.close()
    assert cubeling("export", "told.mcap", "-o", "out")[0] == 0
    said, went, waved = table("acts")
    assert (said["by"], said["kind"], said["name"], said["number"]) == (
        "wizard",
        "say",
        "Hello",
        "2",
    )
    assert (said["time_s"], said["cue"], said["delay_s"]) == ("0.1", "asks", "0.4")
    assert [row["undone"] for row in (said, went, waved)] == ["1", "", "0"]
    assert (went["by"], went["name"], went["number"], went["cue"]) == (
        "program",
        "10, -5 cm",
        "",
        "",
    )
    assert (waved["name"], waved["weight"], waved["delay_s"]) == ("wave", "0.5", "")
