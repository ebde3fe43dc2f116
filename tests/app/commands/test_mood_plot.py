"""Moods of a session: read, felt again, drawn and tabled as they were."""

import contextlib
import csv
import dataclasses
import io
import itertools
import json
import os
import sys
import xml.etree.ElementTree as ElementTree

import numpy as np
import pypdfium2
import pytest
from PIL import Image

from affect import LABEL_SETS, Personality
from app.errors import AppError
from app.moods import read_history, read_robot_traces, replay_with, robot_traces
from app.moods.plot import save_plot
from app.moods.regions import regions, runs
from app.pipeline.playground import Playground
from app.running.opening import intrinsics_for
from app.session import START_OVER_EVENT, Recorder
from characters import LocomotionIntent
from robot.protocol import messages as m
from robot.protocol.schema import pack
from robot.protocol.wire import encode_frame
from tracking import open_source

FRAME = 1 / 30


@pytest.fixture(scope="module")
def history(bundled_session):
    """The moods of a whole session."""
    return read_history(bundled_session)


def state(valence, arousal, mood=0):
    return m.State(0, 0, 0, valence, arousal, 1.0, mood, 0, m.NOTHING, (0.0,) * 16)


SAID = [
    (0.00, "tx", m.Hello(2, 7)),
    (0.01, "rx", m.Welcome(2, 0, 1, 0, 0, 0, 2, "dino", "test")),
    (0.02, "rx", m.Name(m.ITEM_MOOD, 1, "merry")),
    (0.05, "tx", m.Express(1, 0.5, 0.25)),
    (0.10, "rx", m.Ack(1, m.RESULT_TAKEN)),
    (0.11, "rx", m.Ack(1, m.RESULT_TAKEN)),
    (0.15, "rx", state(0.1, 0.05)),
    (0.16, "tx", m.Express(2, 0.6, 0.3)),  # its acknowledgement is lost
    (0.20, "rx", state(0.4, 0.2, 1)),
    (0.25, "tx", m.Express(3, 0.7, 0.4)),
    (0.26, "rx", m.Ack(3, m.RESULT_REFUSED)),
    (0.30, "rx", m.Gone()),
]


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


# --- What is read --------------------------------------------------------------------------------


def test_the_thesis_personality_feels_a_recorded_session_again_bit_for_bit(history):
    again = replay_with(history, Personality.load("thesis"))
    np.testing.assert_array_equal(again.emotion, history.recorded.emotion)
    assert again.labels == history.recorded.labels
    assert {"happy", "angry"} <= set(again.labels)


def test_other_personalities_feel_the_same_session_otherwise(history):
    felt = [replay_with(history, Personality.load(name)) for name in ("thesis", "grumpy", "lively")]
    for one, other in itertools.combinations(felt, 2):
        assert np.abs(one.emotion - other.emotion).max() > 0.3


def test_out_of_sight_nothing_is_done_that_could_be_felt(history):
    hidden = tuple(dataclasses.replace(each, visible=False) for each in history.commands)
    alone = dataclasses.replace(history, commands=hidden)
    assert set(replay_with(alone, Personality.load("thesis")).labels) == {"neutral"}
    assert set(alone.actions) == {""}


def test_who_starts_over_feels_anew(tmp_path, bundled_session):
    path = tmp_path / "over.mcap"
    about = {"scenario": "companion", "cube": "companion"}
    with open_source(str(bundled_session)) as source, Recorder(path, about) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        frames = list(itertools.islice(source, 8))
        recorder.event(START_OVER_EVENT, frames[5].timestamp)
        for frame in frames:
            recorder.write(playground.step(frame))
    lively = Personality.load("lively")
    history = read_history(path)
    assert history.start_over_times == {frames[5].timestamp}
    excited = Personality("w", temperament=lively.temperament, movement=2.0, arousal_half_life=0.1)
    commands = tuple(
        dataclasses.replace(
            each, visible=True, locomotion=LocomotionIntent(5.0 if index < 5 else 0.0)
        )
        for index, each in enumerate(history.commands)
    )
    felt = replay_with(dataclasses.replace(history, commands=commands), excited)
    assert felt.emotion[4, 1] > 0.3
    assert felt.emotion[5, 1] == lively.temperament.arousal


def test_asked_acknowledged_and_observed_are_told_apart(talking_session):
    wire = read_robot_traces(talking_session)
    assert wire
    np.testing.assert_allclose(wire.delays, [0.05])
    times = np.array([0.0, 0.03, 0.10, 0.17, 0.22, 0.28, 0.31])
    acknowledged, _ = wire.acknowledged.at(times)
    nothing = [np.nan, np.nan]
    np.testing.assert_allclose(
        acknowledged, [nothing, nothing, *[[0.5, 0.25]] * 4, nothing], atol=1e-4
    )
    observed, moods = wire.observed.at(times)
    np.testing.assert_allclose(
        observed, [*[nothing] * 3, [0.1, 0.05], *[[0.4, 0.2]] * 3], atol=1e-4
    )
    assert moods == ["", "", "", "", "merry", "merry", "merry"]


def test_a_robot_that_was_away_still_has_what_it_had_taken(tmp_path, talking_session):
    path = tmp_path / "away.mcap"
    said = [*SAID[:5], (0.2, "rx", m.Welcome(2, 1, 1, 0, 0, 0, 2, "dino", "test"))]
    said += [(0.25, "tx", m.Stop(2)), (0.3, "rx", m.Ack(2, m.RESULT_TAKEN))]
    with open_source(str(talking_session)) as source, Recorder(path, {"scenario": "x"}) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorder.write(playground.step(next(iter(source))))
        for time, direction, content in said:
            recorder.wire(direction, encode_frame(pack(content, 9)), time)
    acknowledged, _ = read_robot_traces(path).acknowledged.at(np.array([0.22, 0.4]))
    np.testing.assert_allclose(acknowledged, [[0.5, 0.25], [np.nan, np.nan]], atol=1e-4)


def test_a_robot_that_is_silent_shows_nothing_that_is_known(tmp_path, talking_session):
    path = tmp_path / "silent.mcap"
    said = [*SAID[:7], (0.9, "rx", state(0.0, 0.0))]
    with open_source(str(talking_session)) as source, Recorder(path, {"scenario": "x"}) as recorder:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        recorder.write(playground.step(next(iter(source))))
        for time, direction, content in said:
            recorder.wire(direction, encode_frame(pack(content, 9)), time)
    wire = read_robot_traces(path)
    times = np.array([0.6, 0.7, 0.95])
    assert np.isnan(wire.acknowledged.at(times)[0][:, 0]).tolist() == [False, True, True]
    assert np.isnan(wire.observed.at(times)[0][:, 0]).tolist() == [False, True, False]


def test_what_a_robot_showed_is_told_at_the_times_of_its_own_clock(monkeypatch, short_session):
    """STATEs that arrive up to 80 ms late, from a clock that is 200 ppm fast."""
    random = np.random.default_rng(1)
    welcome = m.Welcome(3, 0, 1, 0, 0, 0, 2, "dino", "test")
    made: list[float] = []
    lines: list[tuple[float, str, object]] = [(0.0, "rx", welcome)]
    for count in range(1, 400):
        sent = 0.05 * count
        made.append(sent + 0.001 + random.exponential(0.001))
        late = random.choice([0.0, 0.01, 0.08], p=[0.3, 0.6, 0.1])
        arrives = max(made[-1] + 0.001 + late, lines[-1][0])  # none overtakes another
        own = int(1000 * made[-1] * 1.0002) + 77
        beat = dataclasses.replace(state(0.1, 0.1), beat=count, time=own)
        lines += [(sent, "tx", m.Beat(count)), (arrives, "rx", beat)]
    recorded = []
    for time, direction, content in sorted(lines, key=lambda line: line[0]):
        line = {"direction": direction, "hex": encode_frame(pack(content, 9)).hex()}
        recorded.append(("/robot/wire", time, json.dumps(line).encode()))
    monkeypatch.setattr(robot_traces, "messages", lambda *_: iter(recorded))
    told = read_robot_traces(short_session).observed.times
    errors = np.abs(told - made)
    assert (np.diff(told) >= 0).all()
    assert errors[20:].max() < 0.006  # once a STATE has come without delay
    assert np.median(errors[200:]) < 0.002


@pytest.mark.parametrize("line", [b"{", b"{}", b"[]", b'{"direction": "tx", "hex": "0g"}'])
def test_a_wire_that_no_recorder_wrote_is_refused_in_one_line(monkeypatch, short_session, line):
    monkeypatch.setattr(robot_traces, "messages", lambda *_: iter([("/robot/wire", 0.0, line)]))
    with pytest.raises(AppError, match=r"cannot read the session .* /robot/wire") as refusal:
        read_robot_traces(short_session)
    assert "\n" not in str(refusal.value)


def test_odd_names_do_not_spoil_a_plot(history, short_session, tmp_path):
    options = dataclasses.replace(history.info.options, personality="a\x00\n<b>&\udcff")
    info = dataclasses.replace(history.info, options=options)
    odd = dataclasses.replace(history, name="\udcff\x1b$x$.mcap", info=info)
    for suffix in ("svg", "pdf"):
        save_plot(tmp_path / f"m.{suffix}", odd, (), read_robot_traces(short_session), THESIS)
    words = words_of(tmp_path / "m.svg")
    assert any("recorded with a??<b>&?" in each for each in words)
    assert "Moods of ??$x$.mcap" in words


def test_a_session_without_a_robot_has_nothing_to_acknowledge(short_session):
    wire = read_robot_traces(short_session)
    assert not wire
    emotion, words = wire.acknowledged.at(np.array([1.0]))
    assert np.isnan(emotion).all()
    assert words == [""]


# --- What is plotted -----------------------------------------------------------------------------

THESIS = LABEL_SETS["thesis"]


def words_of(path):
    """Return all text of an SVG."""
    return [each.text for each in ElementTree.parse(path).iter() if each.text]


def test_the_plot_says_what_it_shows_and_in_which_units(history, bundled_session, tmp_path):
    save_plot(tmp_path / "m.svg", history, (), read_robot_traces(bundled_session), THESIS)
    words = words_of(tmp_path / "m.svg")
    for expected in ("valence [1]", "arousal [1]", "time [s]", "neutral", "happy", "angry"):
        assert expected in words
    for expected in ("kiss", "shout", "idle", "observed on the robot"):
        assert expected in words
    assert any(each.startswith("acknowledged") for each in words)  # and how much later
    assert "Moods of companion.mcap" in words
    assert any("scenario companion" in each for each in words)


def test_the_plot_names_who_feels_again_and_in_whose_words(history, bundled_session, tmp_path):
    names = ("lively", "calm")
    again = [replay_with(history, Personality.load(name)) for name in names]
    wire = read_robot_traces(bundled_session)
    save_plot(tmp_path / "m.svg", history, again, wire, LABEL_SETS["circumplex"])
    words = words_of(tmp_path / "m.svg")
    assert any("felt again by lively and calm" in each for each in words)
    assert {"lively", "calm", "as recorded", "excited", "distressed"} <= set(words)
    assert "observed on the robot" not in words


def test_the_same_plot_as_svg_pdf_and_png(history, bundled_session, tmp_path):
    for suffix in ("svg", "pdf", "png"):
        paths = tmp_path / f"m.{suffix}", tmp_path / f"again.{suffix}"
        for path in paths:
            save_plot(path, history, (), read_robot_traces(bundled_session), THESIS)
        assert paths[0].read_bytes() == paths[1].read_bytes()
    page = pypdfium2.PdfDocument(tmp_path / "m.pdf")[0]
    assert "valence [1]" in page.get_textpage().get_text_range()
    printed = np.asarray(page.render(scale=1).to_pil().convert("L"), float)
    image = Image.open(tmp_path / "m.png")
    assert image.width == 2 * printed.shape[1]
    pixels = np.asarray(image.convert("L").resize(printed.shape[::-1]), float)
    assert np.abs(pixels - printed).mean() < 4
    assert pixels.std() > 10


def test_the_plot_of_a_long_session_is_a_small_file(history, bundled_session, tmp_path):
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
    save_plot(tmp_path / "long.svg", long, (), read_robot_traces(bundled_session), THESIS)
    save_plot(tmp_path / "short.svg", history, (), read_robot_traces(bundled_session), THESIS)
    sizes = [(tmp_path / f"{name}.svg").stat().st_size for name in ("long", "short")]
    assert sizes[0] < 2 * sizes[1]


def test_without_matplotlib_the_command_names_the_extra(cubeling, short_session, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.delitem(sys.modules, "app.moods.plot", raising=False)
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


# --- On the command line -------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["svg", "pdf", "png"])
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
    assert "it is a pipe, no file" in told


def test_a_bundled_personality_is_printed_to_make_ones_own_from(cubeling, tmp_path):
    code, out, _ = cubeling("mood", "personality", "lively")
    assert code == 0
    assert "# " in out
    (tmp_path / "my.toml").write_text(out, encoding="utf-8")
    assert Personality.load(str(tmp_path / "my.toml")) == Personality.load("lively")
    code, out, _ = cubeling("mood", "personality")
    assert [line.split()[0] for line in out.splitlines()][:2] == ["thesis", "calm"]
