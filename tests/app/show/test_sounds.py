"""Sounds of plays: when they are heard, how they fade, and that a replay needs no file."""

import math

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.running.opening import open_session
from cubeling.app.running.replay_check import check_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.show.scenario import show_scenario
from cubeling.app.show.script import OWN_SOUNDS
from cubeling.app.show.stage_state import MAX_WAIT_S
from cubeling.app.sound.bank import SoundBank, write_wave
from cubeling.app.sound.mixer import Mixer
from cubeling.app.sound.session_sound import SessionSound
from cubeling.app.sound.sounds import SOUNDS
from cubeling.app.sound.stage_sounds import STAGE_SOUNDS, open_clips
from cubeling.app.sound.synthesis import SAMPLE_RATE
from tests.app.show.test_show import CUBE, FRAME, show_of

ANN = '<character name="ann" body="human"/>'
RAIN = SoundClip(np.full(3 * SAMPLE_RATE, 0.5, np.float32), SAMPLE_RATE)


def play_of(folder, cues):
    return show_scenario(show_of(folder, cues, ANN))(CUBE, ScenarioSettings())


def outcomes_of(hand, scenario, seconds, clips):
    """Play a scenario whose sounds come as soon as they are asked for, as in a session."""
    outcomes: list[Outcome] = []
    asked: tuple[str, ...] = ()
    for _ in range(round(seconds / FRAME)):
        sounds = {name: clips[name] for name in asked if name in clips}
        outcome = scenario.update(hand.frame(), Situation(), Inputs(sounds=sounds))
        asked = outcome.asked_sounds
        outcomes.append(outcome)
    return outcomes


def test_a_sound_begins_and_is_awaited_with_an_offset(hand, tmp_path):
    scenario = play_of(
        tmp_path,
        '<sound id="r" play="rain.wav" volume="0.4"/><wait for="r" before="1"/>'
        '<do who="ann">wave</do>',
    )
    outcomes = outcomes_of(hand, scenario, 4.0, {"rain.wav": RAIN})
    played = [each.sounds for each in outcomes]
    assert not played[0], "it comes with the second frame"
    (sound,) = played[1]
    assert (sound.clip, sound.volume) == (RAIN, 0.4)
    assert sound.start == pytest.approx(FRAME)
    assert sum(map(bool, played)) == round(3.0 / FRAME)
    waves = [at * FRAME for at, each in enumerate(outcomes) if each.icon == "wave"]
    assert waves[0] == pytest.approx(FRAME + 2.0, abs=1.1 * FRAME)


def test_a_sound_is_cut_off_with_a_fade(hand, tmp_path):
    scenario = play_of(
        tmp_path,
        '<sound id="r" play="rain.wav"/><wait seconds="0.5"/><stop what="r" fade="1"/>'
        '<wait for="r"/>',
    )
    outcomes = outcomes_of(hand, scenario, 2.5, {"rain.wav": RAIN})
    fading = [sound for each in outcomes for sound in each.sounds if sound.silent_at < math.inf]
    assert fading[0].silent_at == pytest.approx(FRAME + 1.5, abs=1.1 * FRAME)
    assert not outcomes[-1].sounds


def test_a_sound_that_never_comes_stalls_nothing(hand, tmp_path):
    scenario = play_of(
        tmp_path, '<sound id="r" play="rain.wav"/><wait for="r"/><do who="ann">wave</do>'
    )
    outcomes = outcomes_of(hand, scenario, MAX_WAIT_S + 1.0, {})
    assert outcomes[-1].icon == "wave"
    assert not any(each.sounds for each in outcomes)


def test_every_sound_of_our_own_can_be_named():
    assert tuple(STAGE_SOUNDS) == OWN_SOUNDS


def test_a_replay_has_the_sounds_without_their_files(tmp_path, short_session):
    rain = 0.5 * np.sin(2 * np.pi * 440 * np.arange(SAMPLE_RATE // 2) / SAMPLE_RATE)
    write_wave(tmp_path / "rain.wav", rain)
    path = show_of(
        tmp_path,
        '<sound id="r" play="rain.wav"/><wait seconds="0.3"/><stop what="r" fade="0.2"/>',
        ANN,
    )
    options = SessionOptions(
        scenario=str(path),
        source=str(short_session),
        record=tmp_path / "s.mcap",
        pictures=False,
        robot="none",
        language="none",
    )
    heard = {}

    def hear(name, session):
        mixer = Mixer(SoundBank({name: [] for name in SOUNDS}))  # no steps, no cube
        sound = SessionSound(mixer, moods=(False,))
        blocks = []

        def add(step):
            sound.play(step, session.playground.character)
            blocks.append(mixer.render(SAMPLE_RATE // 30))

        run(session, add)
        heard[name] = np.concatenate(blocks)[:, 0]

    with open_session(options) as session:
        hear("live", session)
    (tmp_path / "rain.wav").unlink()
    with SessionFile(tmp_path / "s.mcap") as recorded:
        again = SessionOptions(
            scenario=str(path), source=str(recorded.path), pictures=False, robot="none"
        )
        with open_session(again, replayed=recorded) as session:
            hear("again", session)
        assert check_session(recorded, again).identical
    assert (heard["live"] == heard["again"]).all()
    begun = heard["live"][np.flatnonzero(heard["live"])[0] :]
    tenths = np.abs(begun[: SAMPLE_RATE // 2]).reshape(5, -1).max(axis=1)
    assert tenths[0] == pytest.approx(tenths[2], rel=0.01) == pytest.approx(0.35, abs=0.01)
    assert tenths[2] > tenths[3] > tenths[4]
    assert not begun[SAMPLE_RATE * 6 // 10 :].any()


def test_a_sound_file_that_is_missing_is_named_by_line(tmp_path):
    scenario = show_scenario(show_of(tmp_path, '\n<sound play="rain.ogg"/>', ANN))
    with pytest.raises(AppError, match=r"my.show:3: cannot read the sound '.*rain\.ogg'"):
        open_clips(scenario.sounds)
