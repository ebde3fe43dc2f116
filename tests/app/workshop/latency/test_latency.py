"""The figures of a measurement, and the command that prints them."""

import json
import re
from functools import partial

import numpy as np
import pytest

from cubeling.app.commands.look import latency as command
from cubeling.app.session import SessionOptions
from cubeling.app.ui.screen import NullScreen
from cubeling.app.workshop.latency import program, window
from cubeling.app.workshop.latency.program import ProgramTimes, program_times
from cubeling.app.workshop.latency.result import LatencyResult, Spread, advice, motion_to_photon
from cubeling.app.workshop.latency.session import LatencySession
from cubeling.tracking import Health
from tests.app.workshop.latency.simulated import SimulatedCamera, SimulatedClock, SimulatedScreen


def session_of(stamps, seconds):
    stamps = np.array(stamps)
    return ProgramTimes(stamps, stamps + seconds, 1.0)


def test_a_movement_is_shown_by_the_next_picture_and_is_as_late_as_that():
    photons = motion_to_photon(session_of(np.arange(0, 10, 0.04), 0.02), age=0.07)
    assert photons.min() == pytest.approx(0.07 + 0.02, abs=0.001)
    assert photons.max() == pytest.approx(0.07 + 0.02 + 0.04, abs=0.001)
    assert np.median(photons) == pytest.approx(0.07 + 0.02 + 0.02, abs=0.001)


def test_pictures_that_are_left_out_make_movements_wait():
    """A program of 80 ms shows every third picture of a camera of 30 ms."""
    photons = motion_to_photon(session_of(np.arange(0, 10, 0.09), 0.08), age=0.05)
    assert np.median(photons) == pytest.approx(0.05 + 0.08 + 0.045, abs=0.002)


GOOD = LatencyResult("camera:0", 40, 0, 0.033, 0.07, Spread(0.09, 0.07, 0.1))
QUICK, SLOW = Spread(0.02, 0.015, 0.03), Spread(0.15, 0.1, 0.3)


@pytest.mark.parametrize(
    ("changes", "queue", "renderer", "words"),
    [
        ({"program": QUICK}, 0.0, "Mesa Intel(R) UHD", ""),
        ({"program": SLOW}, 0.0, "llvmpipe (LLVM 15)", "cubeling doctor"),
        ({"program": SLOW, "age": 0.2}, 0.0, "llvmpipe (LLVM 15)", "--quality reduced"),
        ({"program": SLOW, "age": 0.2}, 0.0, "llvmpipe (LLVM 15)", "vsync"),
        ({"program": QUICK, "age": 0.2}, 0.0, "llvmpipe (LLVM 15)", "vsync"),
        ({"program": SLOW}, 0.0, "Mesa Intel(R) UHD", "smaller camera picture"),
        ({"interval": 0.066}, 0.0, "", "only 15 pictures/s"),
        ({"age": 0.2}, 1.5, "", "buffers=1"),
        ({"age": 0.2, "source": "http://phone:8080/video"}, 0.0, "", "phone"),
        ({"age": 0.2}, 0.0, "", "vsync"),
    ],
)
def test_the_advice_names_what_takes_longest(changes, queue, renderer, words):
    health = Health("camera 0", "running", 0.0, mean_queue=queue)
    said = advice(LatencyResult(**{**vars(GOOD), **changes}), health, renderer)
    assert bool(said) == bool(words)
    assert words in said


def test_a_session_as_of_play_is_timed_and_ends_by_itself(monkeypatch):
    monkeypatch.setattr(program, "WARM_UP_S", 0.2)
    clock = SimulatedClock()
    source = SimulatedCamera(clock, SimulatedScreen(clock), blind=True)
    options = SessionOptions(scenario="companion", source="camera:0", robot="none", pictures=False)
    times, interrupted = program_times(options, source, 0.5, clock, NullScreen())
    assert not interrupted
    assert times is not None
    assert len(times.stamps) == pytest.approx(15, abs=1)
    assert times.tracked == 0.0
    assert source.health.state == "closed"


@pytest.fixture
def simulated(monkeypatch, cubeling):
    """Run the command with a simulated camera and screen; return its results and the screen."""
    clock = SimulatedClock()
    screen = SimulatedScreen(clock, lag=0.01)
    source = SimulatedCamera(clock, screen, delay=0.05)
    monkeypatch.setattr(command, "has_display", lambda: True)
    monkeypatch.setattr("cubeling.tracking.open_source", lambda uri: source)
    timed = partial(LatencySession, clock=clock)
    monkeypatch.setattr("cubeling.app.workshop.latency.session.LatencySession", timed)
    monkeypatch.setattr(window, "PatternWindow", lambda: screen)
    return partial(cubeling, "latency", "--scenario", "none"), screen, source


def test_the_command_prints_and_writes_what_it_measured(simulated, tmp_path):
    run, _, source = simulated
    code, out, err = run("--flips", 10, "--json", "latency.json")
    assert (code, err) == (0, "")
    assert "10 flips of the pattern" in out
    assert "motion to photon" not in out
    figures = json.loads((tmp_path / "latency.json").read_text())
    assert figures["age"] == pytest.approx(source.age(0.01), abs=0.003)
    assert figures["loop"]["low"] < figures["loop"]["median"] < figures["loop"]["high"]
    assert source.health.state == "closed"


def test_ctrl_c_keeps_what_was_measured(simulated):
    run, screen, _ = simulated
    screen.ends_after = 250
    code, out, _ = run("--flips", 1000)
    assert code == 130
    assert re.search(r"\b\d\d flips of the pattern", out)
    assert "screen to program" in out


def test_ctrl_c_at_once_says_nothing_false(simulated):
    run, screen, _ = simulated
    screen.ends_after = 3
    assert run() == (130, "", "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--scenario", "chess"], "no scenario is called 'chess'"),
        (["--json", "figures.txt"], "a result is written as .json"),
        (["--json", "there.json"], "the result 'there.json' exists already"),
        ([], "there is no display here"),
    ],
)
def test_bad_input_is_one_line(cubeling, tmp_path, arguments, words):
    (tmp_path / "there.json").write_text("{}", encoding="utf-8")
    code, out, err = cubeling("latency", *arguments)
    assert (code, out) == (2, "")
    assert words in err
    assert err.count("\n") == 1


def test_a_recording_does_not_show_the_screen(cubeling, monkeypatch, bundled_session):
    monkeypatch.setattr(command, "has_display", lambda: True)
    code, _, err = cubeling("latency", "--source", bundled_session)
    assert code == 2
    assert "is no live camera" in err
