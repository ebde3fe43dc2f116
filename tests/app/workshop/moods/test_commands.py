"""The commands that draw and table moods."""

import contextlib
import csv
import io
import os
import sys

import numpy as np
import pytest

from cubeling.affect import NEUTRAL, OCC_FACES, Personality
from cubeling.app.errors import AppError
from cubeling.app.workshop.moods import (
    appraise,
    read_history,
    read_robot_traces,
    without_emotions,
)
from cubeling.characters.face.affect_display import expression_weights
from cubeling.robot import SteppedRobot
from tests.app.workshop.moods.talking import words_of
from tests.examples import some


@pytest.mark.parametrize("suffix", some(["svg", "pdf", "png"]))
def test_plot_draws_a_session(cubeling, talking_session, tmp_path, suffix):
    code, out, _ = cubeling("mood", "plot", talking_session, "-o", f"m.{suffix}")
    assert (code, out) == (0, f"Plotted: m.{suffix}\n")
    assert (tmp_path / f"m.{suffix}").stat().st_size > 1000


def test_plot_takes_the_session_name_and_other_personalities(cubeling, talking_session, tmp_path):
    code, _, _ = cubeling("mood", "plot", talking_session, "--personality", "shy")
    assert code == 0
    words = words_of(tmp_path / "talking-mood.svg")
    assert any("recorded with shy" in each and "felt again by shy" in each for each in words)


def test_table_has_a_row_a_frame_and_nothing_where_nothing_is_known(
    cubeling, talking_session, tmp_path
):
    code, out, _ = cubeling("mood", "table", talking_session, "-o", "x.csv")
    assert (code, out) == (0, "x.csv has 12 rows\n")
    text = (tmp_path / "x.csv").read_bytes().decode()
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == 12
    assert rows[0]["acknowledged_valence"] == rows[0]["observed_mood"] == ""
    late = rows[7]
    assert (late["acknowledged_valence"], late["acknowledged_arousal"]) == ("0.5", "0.25")
    assert (late["observed_valence"], late["observed_mood"]) == ("0.4", "merry")
    assert (late["label"], late["action"], late["weight"]) == ("neutral", "idle", "0")


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("plot", "{session}", "-o", "m.gif"), "a plot is written as .svg, .pdf, .png, not as"),
        (("plot", "{session}", "-o", "no/m.svg"), "there is no folder 'no'"),
        (("table", "{session}", "-o", "no/m.csv"), "there is no folder 'no'"),
        (("table", "{session}", "-o", "{session}"), "a table is written as .csv"),
        (("plot", "nothing.mcap"), "cannot read the session 'nothing.mcap'"),
        (("plot", __file__), "is not a session"),
        (("plot", "{session}", "--personality", "rude"), "there is no personality 'rude'"),
        (("plot", "{session}", *["--personality", "shy"] * 5), "5 personalities are too many"),
        (("emotions", "rude"), "there is no personality 'rude': choose one of thesis"),
        (("emotions", "--robot", "sim:nobody"), "there is no simulated robot 'sim:nobody'"),
        (("personality", "rude"), "there is no personality 'rude': choose one of thesis"),
        (("plot", "{cut}"), "was cut off"),
        (("plot", "{cut}", "--salvage", "-o", "no/m.svg"), "there is no folder"),
    ],
)
def test_what_is_wrong_is_one_line_and_exit_code_2(
    cubeling, talking_session, tmp_path, arguments, says
):
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(talking_session.read_bytes()[:-300])
    places = {"session": talking_session, "cut": cut}
    code, out, told = cubeling("mood", *(each.format(**places) for each in arguments))
    assert code == 2
    assert out == ""
    assert says in told
    assert told.count("\n") == 1


def test_a_session_with_wrong_bits_is_read_as_far_as_it_goes_or_refused(talking_session, tmp_path):
    draws, whole = np.random.default_rng(5), talking_session.read_bytes()
    path = tmp_path / "wrong.mcap"
    for attempt in range(60):
        wrong = bytearray(whole)
        first = len(wrong) // 2 if attempt % 2 else 8  # every other one: at the end, in the index
        for place in draws.integers(first, len(wrong) - 8, 30):
            wrong[place] ^= 1 << int(draws.integers(8))
        path.write_bytes(wrong)
        with contextlib.suppress(AppError):
            read_history(path)
            read_robot_traces(path)


@pytest.mark.skipif(sys.platform == "win32", reason="there are no named pipes")
def test_a_pipe_is_refused_and_not_waited_for(cubeling, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    code, _, told = cubeling("mood", "plot", "pipe")
    assert code == 2
    assert "it is a folder, a pipe or a device" in told


def test_a_bundled_personality_is_printed_to_make_ones_own_from(cubeling, tmp_path):
    code, out, _ = cubeling("mood", "personality", "lively")
    assert code == 0
    assert "# " in out
    (tmp_path / "my.toml").write_text(out, encoding="utf-8")
    assert Personality.load(str(tmp_path / "my.toml")) == Personality.load("lively")
    code, out, _ = cubeling("mood", "personality")
    assert [line.split()[0] for line in out.splitlines()][:2] == ["thesis", "calm"]


def test_24_emotions_show_more_words_faces_and_labels_than_valence_and_arousal():
    who = Personality.load("heartfelt")
    with SteppedRobot("sim:opencat") as robot:
        moods = robot.catalogue.moods
    felt, plain = appraise(who, moods), appraise(without_emotions(who), moods)
    for row in felt:
        loudest, intensity = row.intensities[0]
        if row.emotion.word != "neutral":
            assert (row.emotion.word, row.emotion.intensity) == (loudest, intensity)
            assert row.face == OCC_FACES[loudest]
            assert expression_weights(row.emotion) != expression_weights(NEUTRAL)
    assert len({row.emotion.word for row in felt}) >= 12
    assert {row.face for row in felt} > {row.face for row in plain}
    assert {row.label for row in felt} > {row.label for row in plain}


def test_what_emotions_a_personality_has_is_printed(cubeling):
    code, out, _ = cubeling("mood", "emotions", "heartfelt")
    assert code == 0
    shaken = next(line for line in out.splitlines() if line.startswith("shaken"))
    assert shaken.split()[1:6:2] == ["fear", "surprise", "afraid"]
    assert "With: " in out
    assert "Without: " in out
