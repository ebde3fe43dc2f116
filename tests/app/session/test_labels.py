"""Who played a session and which moments matter: recorded, and corrected beside the recording."""

import hashlib
import json
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import (
    Mark,
    SessionFile,
    SessionLabels,
    SessionOptions,
    check_participant,
    session_info,
    with_mark,
    write_labels,
)
from cubeling.app.session.labels import labels_path, read_labels
from tests.app.scripted import play_script


@pytest.fixture
def session(tmp_path):
    path = tmp_path / "anna.mcap"
    play_script("companion", record=path, seconds=0.5)
    return path


def test_a_session_says_what_the_scenario_chose_by_itself(session):
    info = session_info(session)
    asset = resources.files("cubeling.characters") / "assets" / "vleo.glb"
    assert (info.options.character, info.options.personality) == (None, None)
    played = info.played
    assert (played["character"], played["personality"]) == ("vleo", "thesis")
    assert played["character_sha256"] == hashlib.sha256(asset.read_bytes()).hexdigest()
    (folded,) = json.loads(played["cube_folded"])
    assert {face["role"] for face in folded["faces"]} == {"idle", "kiss", "shout"}
    assert (played["robot"], played["driver"]) == ("sim", "cubeling")
    assert f"numpy=={np.__version__}" in played["libraries"].split()
    assert json.loads(played["seeds"]) == {"vleo": 0}


def test_labels_are_corrected_beside_the_recording(cubeling, session):
    before = session.read_bytes()
    code, _, err = cubeling(
        *("label", session, "--participant", "P08", "--mark", "0.2 error: the cube fell"),
        *("--mark", "0.1 7"),
    )
    assert (code, err) == (0, "")
    assert session.read_bytes() == before
    with SessionFile(session) as file:
        assert file.info.labels.participant == file.info.options.participant == "P08"
        assert file.marks == (Mark(0.1, "7"), Mark(0.2, "error", "the cube fell"))
    assert cubeling("export", session, "-o", session.parent / "out")[0] == 0
    rows = (session.parent / "out" / "marks.csv").read_text("utf-8").splitlines()
    assert rows[0] == "session,participant,condition,time_s,at_s,kind,name"
    assert rows[1].startswith("anna,P08,,")
    assert rows[2].endswith(",0.2,error,the cube fell")
    robot = (session.parent / "out" / "robot.csv").read_text("utf-8")
    assert {"commanded", "acknowledged", "observed"} <= set(robot.replace("\n", ",").split(","))


def test_what_is_said_at_the_start_is_recorded(tmp_path, session):
    again = tmp_path / "again.mcap"
    options = SessionOptions(
        scenario="companion",
        source=str(session),
        record=again,
        pictures=False,
        participant="P07",
        condition="calm",
        notes="tired",
    )
    with open_session(options) as opened:
        run(opened)
    assert session_info(again).labels == SessionLabels("P07", "calm", "tired")


@pytest.mark.parametrize("text", ["a/b", "Anna\nB", "x" * 65, "=1+1", " P1"])
def test_a_label_that_is_no_code_is_refused(text):
    with pytest.raises(AppError, match="must be a short code"):
        check_participant(text)


@pytest.mark.parametrize("text", ["soon x", "nan x", "-1 x", "9 x", ""])
def test_a_mark_outside_the_session_is_refused(text):
    with pytest.raises(AppError):
        with_mark(SessionLabels(), text, 5.0)


def test_labels_are_read_as_they_were_written(tmp_path):
    said = 'a "quote"\nand \\ more'
    labels = SessionLabels("P 1", "é.ö", said, (Mark(0.5, "a", "b"), Mark(2.0)))
    path = write_labels(tmp_path / "x.mcap", labels)
    assert path == labels_path(Path(tmp_path / "x.mcap"))
    assert read_labels(path) == labels
