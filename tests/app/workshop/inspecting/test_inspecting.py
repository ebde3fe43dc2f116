"""What is in a session, and what differs between two: figures against what was planted."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.session import Recorder, frame_encoder
from cubeling.app.workshop.inspecting.figures import read_figures, spells
from cubeling.app.workshop.inspecting.summary import document_of, lines_of
from cubeling.app.workshop.pages.line_plot import line_plot
from cubeling.tracking import Frame, Intrinsics
from tests.examples import some

SIZE = 64, 48


def recorded(path, times, **metadata):
    """Record black frames at some times; the cube is "found" in the second half of them."""
    playground = Playground("companion", Intrinsics.guess(SIZE))
    encode = frame_encoder("jpeg", SIZE, 30.0)
    with Recorder(path, {"scenario": "companion", **metadata}) as recorder:
        for index, time in enumerate(times):
            step = playground.step(encode(Frame(np.zeros((48, 64, 3), np.uint8), time, index)))
            visible = index >= len(times) // 2
            state = replace(step.state, visible=visible, reprojection_error=0.25)
            recorder.write(replace(step, state=state))
        recorder.event("placed top", times[1])
    playground.close()
    return path


TIMES = [*(2.0 + 0.05 * n for n in range(10)), *(3.0 + 0.05 * n for n in range(10))]


@pytest.fixture
def session(tmp_path):
    return recorded(tmp_path / "a.mcap", TIMES)


def test_figures_are_those_of_what_was_recorded(session):
    figures = read_figures(session, session)
    assert (figures.info.frames, len(figures.intervals)) == (20, 19)
    (gap,) = figures.gaps
    assert (gap.at_s, gap.seconds) == (0.45, 0.55)
    assert figures.found_share == 0.5
    (lost,) = figures.lost
    assert (lost.at_s, lost.seconds) == (0.0, 1.0)
    assert set(figures.errors_px) == {0.25}
    document = document_of(figures)
    assert document["channels"]["/cube/state"]["messages"] == 20
    assert document["rate_hz"] == pytest.approx(19 / 1.45, abs=1e-5)
    assert document["events"] == {"placed top": 1}
    words = dict(lines_of(figures))
    assert words["gaps"] == "1 time, 0.6 s in all: 0.55 s at 0.5 s"
    assert words["cube found"] == "in 50.0 % of the frames"
    assert words["not found"] == "it was not in view in 10 frames"
    assert "link" not in words  # there was no robot


@pytest.mark.slow(reason="a scripted session is played and shown twice")
def test_a_session_is_shown_as_lines_as_json_and_as_a_page(cubeling, scripted_session):
    session = scripted_session("companion")
    code, out, err = cubeling("inspect", session, "-o", "a.html")
    assert (code, err) == (0, "")
    assert re.search(r"link +[\d,]+ commands, [\d,]+ acknowledged", out)
    assert re.search(r"played +companion, character vleo, personality thesis", out)
    page = Path("a.html").read_text("utf-8")
    assert page.count("data:image/jpeg;base64,") == 8
    assert not re.search(r'<script|href=|src="(?!data:)', page)
    code, out, _ = cubeling("inspect", session, "--json")
    document = json.loads(out)
    assert document["tracking"]["found_share"] == 1.0
    assert document["link"]["acknowledged"] > 0
    assert {"kiss", "shout", "idle"} == {each["what"] for each in document["states"]}


def test_a_difference_is_found_on_its_channel(cubeling, tmp_path, session):
    code, out, _ = cubeling("diff", session, session)
    assert (code, out) == (0, "a.mcap and a.mcap hold the same\n")
    other = recorded(tmp_path / "b.mcap", TIMES[:-1], participant="P02")
    code, out, _ = cubeling("diff", session, other)
    assert code == 1
    rows = [" ".join(line.split()) for line in out.splitlines()]
    assert any(re.match(r"duration 1\.[45] s, 20 .* 1\.4 s, 19", row) for row in rows)
    assert "by – P02" in rows
    assert "/cube/controls goes on ends before 1.450 s" in rows
    # The cube is found a frame earlier.
    assert "/cube/state at 0.450 s: visible: no at 0.450 s: visible: yes" in rows


def test_a_difference_fits_a_screen_and_names_long_files_whole(
    cubeling, tmp_path, session, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "80")
    name = "participant-07-in-the-second-condition-on-a-rainy-monday-morning-after-the-break.mcap"
    other = recorded(tmp_path / name, TIMES[1:], scenario="companion", personality="calm")
    code, out, _ = cubeling("diff", session, other)
    assert code == 1
    lines = out.splitlines()
    assert any(line.endswith(name) for line in lines)
    assert max(len(line) for line in lines[2:]) <= 80
    assert "[" not in out.replace(str(tmp_path), "")  # a path within a document is no word
    assert "played" in out
    assert "calm" in out


@pytest.mark.parametrize("command", some(["inspect", "diff", "label"]))
def test_damaged_and_foreign_files_are_refused_in_one_line(cubeling, session, command):
    cut = session.with_name("cut.mcap")
    cut.write_bytes(session.read_bytes()[: session.stat().st_size // 2])
    foreign = session.with_name("foreign.mcap")
    with Recorder(foreign, {}) as recorder:
        encode = frame_encoder("jpeg", SIZE, 30.0)
        playground = Playground("companion", Intrinsics.guess(SIZE))
        recorder.write(playground.step(encode(Frame(np.zeros((48, 64, 3), np.uint8), 0.0, 0))))
        playground.close()
    text = session.with_name("text.mcap")
    text.write_text("no session")
    for path in (cut, foreign, text, session.with_name("none.mcap"), session.parent):
        arguments = [path] if command != "diff" else [session, path]
        code, _, err = cubeling(command, *arguments)
        if path == session.parent and command == "inspect":
            continue  # taken for a character
        assert code == 2, path
        assert len(err.splitlines()) == 1


def test_a_cut_off_session_can_be_salvaged(cubeling, session):
    cut = session.with_name("cut.mcap")
    cut.write_bytes(session.read_bytes()[:-400])
    code, out, err = cubeling("inspect", cut, "--salvage")
    assert (code, err) == (0, "")
    assert "20 frames" in out


def test_a_character_is_inspected_by_the_same_command(cubeling):
    code, _, err = cubeling("inspect", "human", "--json")
    assert (code, len(err.splitlines())) == (2, 1)
    code, _, err = cubeling("inspect", "nobody")
    assert (code, len(err.splitlines())) == (2, 1)


def test_spells_add_up_to_the_whole():
    changes = [(0.1 * n, word) for n, word in enumerate("aabbbacc")]
    found = spells(changes)
    assert [each.what for each in found] == ["a", "b", "a", "c"]
    assert sum(each.seconds for each in found) == pytest.approx(0.7)
    assert spells([]) == ()


def test_a_long_curve_keeps_its_peaks():
    times = np.arange(50_000) / 100.0
    values = np.zeros(50_000)
    values[31_234] = 7.0
    values[40_000:41_000] = np.nan
    drawn = line_plot([("", times, values)], "x", (0.0, 8.0))
    heights = [float(y) for y in re.findall(r"[ML][\d.]+ ([\d.]+)", drawn)]
    assert len(heights) <= 1200
    assert len({*heights}) == 2
    assert drawn.count("M") >= 2  # it is broken where nothing is known


def test_what_was_played_is_said_although_the_file_says_only_what_came_in(session):
    figures = read_figures(session, session)
    words = dict(lines_of(figures))
    assert words["played"] == "companion, character vleo, personality thesis"
    assert document_of(figures)["played"]["character"] == "vleo"


def test_a_session_without_video_says_so(cubeling, tmp_path, session):
    blind = recorded(tmp_path / "blind.mcap", TIMES, video="no")
    code, out, _ = cubeling("inspect", blind, "-o", "blind.html")
    assert code == 0
    assert re.search(r"video +none", out)
    assert "<td>video</td><td>none" in re.sub(r"\s+class=\S+", "", Path("blind.html").read_text())
    assert json.loads(cubeling("inspect", blind, "--json")[1])["video"] is False
    _, out, _ = cubeling("diff", session, blind)
    assert re.search(r"video +– +none", out)


def test_sizes_are_those_of_the_disk_and_unpacked(session):
    figures = read_figures(session, session)
    unpacked = sum(each.unpacked_size for each in figures.channels)
    assert figures.size == session.stat().st_size
    assert unpacked > figures.size  # it is compressed
