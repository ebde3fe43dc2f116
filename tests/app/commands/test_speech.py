"""`cubeling speech`: a table, a plot, a TextGrid, and one line for what does not work."""

import struct
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from cubeling.app.commands.study.speech import app
from cubeling.app.errors import AppError
from cubeling.characters import CharacterError
from cubeling.characters.speech.speech import Phone, Speech, Word
from cubeling.characters.speech.textgrid import read_textgrid, textgrid_of, write_textgrid
from cubeling.characters.speech.voices.espeak import espeak_installed
from tests.examples import some

needs_espeak = pytest.mark.skipif(not espeak_installed(), reason="eSpeak NG is not installed")
RATE = 16_000


@pytest.fixture
def speech():
    t = np.arange(2 * RATE) / RATE
    pitch = 120 * 2 ** (0.5 * np.exp(-(((t - 1.3) / 0.1) ** 2)))
    phase = 2 * np.pi * np.cumsum(pitch) / RATE
    level = 0.1 + 0.4 * np.exp(-(((t - 1.3) / 0.1) ** 2))
    samples = level * sum(np.sin(k * phase) / k for k in range(1, 8)) * (t > 0.3)
    phones = (Phone("", 0.0, 0.3), Phone("a", 0.3, 1.0), Phone("m", 1.0, 1.1), Phone("a", 1.1, 2.0))
    words = (Word("ah", 0.3, 1.0, 0), Word("ma", 1.0, 2.0, 3))
    return Speech(samples.astype(np.float32), RATE, "ah ma", "en", words, phones)


@pytest.fixture
def recording(tmp_path, speech):
    path = tmp_path / "ma.wav"
    data = (speech.samples * 32767 / 2).astype("<i2").tobytes()
    head = struct.pack("<4sI4s4sIHHIIHH", b"RIFF", 36 + len(data), b"WAVE", b"fmt ", 16, 1, 1,
                       RATE, 2 * RATE, 2, 16)  # fmt: skip
    path.write_bytes(head + b"data" + struct.pack("<I", len(data)) + data)
    write_textgrid(path.with_suffix(".TextGrid"), textgrid_of(speech))
    return path


def run(*arguments):
    result = CliRunner().invoke(app, [str(each) for each in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.output


def test_accents_are_compared_with_those_of_people(recording, tmp_path):
    labels = tmp_path / "times.csv"
    labels.write_text("time\n1.3\n")
    grid = recording.with_suffix(".TextGrid")
    output = run("show", recording, "--textgrid", grid, "--labels", labels)
    assert "beside 1 label of people" in output
    (row,) = [line.split() for line in output.splitlines() if line.strip().startswith("0.6 ")]
    assert row == ["0.6", "1", "1.00", "1.00", "1.00", "1.00"]


def test_the_table_names_the_word_of_an_accent(recording):
    output = run("show", recording, "--textgrid", recording.with_suffix(".TextGrid"))
    assert "2.00 s, 16000 Hz" in output
    assert "1.2 syllables a second" in output
    (row,) = [
        line for line in output.splitlines() if "1.00" in line and " s " in line and "Hz" in line
    ]
    assert row.split()[0] == "1.30" or row.split()[0] in ("1.29", "1.31")
    assert row.split()[-1] == "ma"


@pytest.mark.parametrize("suffix", some([".svg", ".png", ".pdf"]))
def test_a_plot_is_written(recording, tmp_path, suffix):
    target = tmp_path / f"plot{suffix}"
    grid = recording.with_suffix(".TextGrid")
    assert "Plotted" in run("show", recording, "--textgrid", grid, "-o", target)
    assert target.stat().st_size > 5000
    with pytest.raises(AppError, match="exists"):
        run("show", recording, "-o", target)


@pytest.fixture
def plot():
    from cubeling.app.workshop import speech_plot  # matplotlib: not for who only collects the tests

    return speech_plot


def test_a_silent_recording_is_plotted(plot):
    silent = Speech(np.zeros(8000, np.float32), RATE)
    labels = [axes.get_ylabel() for axes in plot.draw(silent, "silence").axes]
    assert labels == ["sound", "pitch [Hz]\nand voicing", "intensity\n[dB]", "accents"]


def test_a_script_that_the_font_lacks_is_plotted(plot, tmp_path, speech):
    words = (Word("你好", 0.3, 1.0), Word("😀$x$", 1.0, 2.0))
    plot.save_plot(tmp_path / "plot.png", replace(speech, words=words), "你好 😀.wav")
    assert (tmp_path / "plot.png").stat().st_size > 5000


def test_gestures_that_overlap_have_lanes_of_their_own(plot, speech):
    phases = (("preparation", 0.2, 0.4), ("stroke", 0.4, 0.6), ("retraction", 0.6, 1.0))
    marks = [plot.GestureMark("left", 0.2, 0.5, 1.0, phases)]
    marks += [plot.GestureMark("right", 0.5, 0.8, 1.2), plot.GestureMark("both", 1.3, 1.5, 1.9)]
    figure = plot.draw(speech, "gestures", marks)
    names = [axes.get_ylabel() for axes in figure.axes]
    lanes = figure.axes[names.index("gestures")]
    assert lanes.get_ylim() == (0.0, 2.0)
    assert {text.get_text() for text in lanes.texts} == {"left", "right", "both"}
    apexes = [np.asarray(line.get_xdata())[0] for line in lanes.lines if line.get_marker() == "D"]
    assert apexes == [0.5, 1.5, 0.8]


@needs_espeak
def test_a_recording_is_aligned_with_the_text_of_a_file(recording, tmp_path):
    (tmp_path / "text.txt").write_text("Ah, ma!", "utf-8")
    target = tmp_path / "out.TextGrid"
    said = run("align", recording, "--text", f"@{tmp_path / 'text.txt'}", "-o", target)
    assert "2 words" in said
    assert [tier.name for tier in read_textgrid(target).tiers] == ["words", "phones"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("show", "missing.wav"), "cannot read the sound 'missing.wav'"),
        (("show", "{file}", "--text", "a", "--textgrid", "b"), "not both"),
        (("show", "{file}", "--textgrid", "missing.TextGrid"), "cannot read"),
        (("show", "{file}", "-o", "{folder}/plot.xyz"), "plot"),
        (("align", "{file}", "--text", "@missing.txt", "-o", "{folder}/a.TextGrid"), "cannot read"),
        (
            ("align", "{file}", "--text", "a", "--language", "ca", "--sphinx",
             "-o", "{folder}/a.TextGrid"),
            "English only",
        ),
    ],
)  # fmt: skip
def test_what_does_not_work_is_one_line(recording, tmp_path, arguments, said):
    with pytest.raises((AppError, CharacterError), match=said) as caught:
        run(*(each.format(file=recording, folder=tmp_path) for each in arguments))
    assert "\n" not in str(caught.value)
