"""Moods of a session, drawn as they were."""

import dataclasses
import sys

import numpy as np
import pypdfium2
import pytest
from PIL import Image

from cubeling.affect import LABEL_SETS, Personality
from cubeling.app.workshop.moods import read_robot_traces, replay_with
from cubeling.app.workshop.moods.plot import save_plot
from cubeling.app.workshop.moods.regions import regions, runs
from tests.app.workshop.moods.talking import words_of
from tests.examples import some

THESIS = LABEL_SETS["thesis"]


@pytest.mark.slow(reason="the first plot loads fonts")
def test_the_plot_says_what_it_shows_and_in_which_units(history, companion, tmp_path):
    save_plot(tmp_path / "m.svg", history, (), read_robot_traces(companion), THESIS)
    words = words_of(tmp_path / "m.svg")
    for expected in ("valence [1]", "arousal [1]", "time [s]", "neutral", "happy", "angry"):
        assert expected in words
    for expected in ("kiss", "shout", "idle", "observed on the robot"):
        assert expected in words
    assert any(each.startswith("acknowledged") for each in words)  # and how much later
    assert f"Moods of {companion.name}" in words
    assert any("scenario companion" in each for each in words)


def test_the_plot_names_who_feels_again_and_in_whose_words(history, companion, tmp_path):
    names = ("lively", "calm")
    again = [replay_with(history, Personality.load(name)) for name in names]
    wire = read_robot_traces(companion)
    save_plot(tmp_path / "m.svg", history, again, wire, LABEL_SETS["circumplex"])
    words = words_of(tmp_path / "m.svg")
    assert any("felt again by lively and calm" in each for each in words)
    assert {"lively", "calm", "as recorded", "excited", "distressed"} <= set(words)
    assert "observed on the robot" not in words


@pytest.mark.full
@pytest.mark.parametrize("suffix", some(["svg", "pdf", "png"]))
def test_the_same_session_gives_the_same_plot_byte_for_byte(history, companion, tmp_path, suffix):
    paths = tmp_path / f"m.{suffix}", tmp_path / f"again.{suffix}"
    for path in paths:
        save_plot(path, history, (), read_robot_traces(companion), THESIS)
    assert paths[0].read_bytes() == paths[1].read_bytes()


@pytest.mark.full
@pytest.mark.slow(reason="a plot is written twice, and the page is drawn")
def test_the_same_plot_as_pdf_and_png(history, companion, tmp_path):
    for suffix in ("pdf", "png"):
        save_plot(tmp_path / f"m.{suffix}", history, (), read_robot_traces(companion), THESIS)
    page = pypdfium2.PdfDocument(tmp_path / "m.pdf")[0]
    assert "valence [1]" in page.get_textpage().get_text_range()
    printed = np.asarray(page.render(scale=1).to_pil().convert("L"), float)
    image = Image.open(tmp_path / "m.png")
    assert image.width == 2 * printed.shape[1]
    pixels = np.asarray(image.convert("L").resize(printed.shape[::-1]), float)
    assert np.abs(pixels - printed).mean() < 4
    assert pixels.std() > 10


@pytest.mark.full
def test_the_plot_of_a_long_session_is_a_small_file(history, companion, tmp_path):
    """Points that change no line are left out: half an hour takes about as much as a minute."""
    times = 44
    length = len(history.recorded.times)
    felt = dataclasses.replace(
        history.recorded,
        times=np.arange(times * length) / 30.0,
        emotion=np.repeat(history.recorded.emotion, times, axis=0),
        labels=tuple(np.repeat(history.recorded.labels, times)),
    )
    commands = tuple(each for each in history.commands for _ in range(times))
    long = dataclasses.replace(history, recorded=felt, commands=commands)
    save_plot(tmp_path / "long.svg", long, (), read_robot_traces(companion), THESIS)
    save_plot(tmp_path / "short.svg", history, (), read_robot_traces(companion), THESIS)
    sizes = [(tmp_path / f"{name}.svg").stat().st_size for name in ("long", "short")]
    assert sizes[0] < 2 * sizes[1]


def test_without_matplotlib_the_command_names_the_extra(cubeling, short_session, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "cubeling.app.workshop.moods.plot", raising=False)
    code, out, told = cubeling("mood", "plot", short_session)
    assert (code, out) == (2, "")
    assert "pip install matplotlib" in told
    assert told.count("\n") == 1
    assert cubeling("mood", "table", short_session)[0] == 0


@pytest.mark.parametrize("name", LABEL_SETS)
def test_the_regions_of_a_label_set_are_where_its_labels_win_and_fill_the_plane(name):
    labels = LABEL_SETS[name]
    cells = regions(labels)

    def area(cell):
        x, y = cell.T
        return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2

    assert sum(area(cell) for cell in cells.values()) == pytest.approx(4.0)
    assert len(cells) == (3 if labels.by_valence else len(set(labels.places.values())))
    for label, cell in cells.items():
        assert np.abs(cell).max() <= 1 + 1e-12
        if not labels.by_valence:
            middle = cell.mean(axis=0)
            distances = {word: np.hypot(*(middle - at)) for word, at in labels.places.items()}
            assert min(distances, key=distances.__getitem__) == label


def test_runs_of_the_same_name_have_no_gaps():
    times = np.arange(6.0)
    found = runs(("a", "a", "b", "b", "b", "a"), times)
    assert found == [("a", 0.0, 2.0), ("b", 2.0, 5.0), ("a", 5.0, 5.0)]


def test_odd_names_do_not_spoil_a_plot(history, short_session, tmp_path):
    options = dataclasses.replace(history.info.options, personality="a\x00\n<b>&\udcff")
    info = dataclasses.replace(history.info, options=options)
    odd = dataclasses.replace(history, name="\udcff\x1b$x$.mcap", info=info)
    for suffix in ("svg", "pdf"):
        save_plot(tmp_path / f"m.{suffix}", odd, (), read_robot_traces(short_session), THESIS)
    words = words_of(tmp_path / "m.svg")
    assert any("recorded with a??<b>&?" in each for each in words)
    assert "Moods of ??$x$.mcap" in words
