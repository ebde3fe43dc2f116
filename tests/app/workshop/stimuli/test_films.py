"""`cubeling stimuli`: what films show, which are left out, and what the manifest says."""

import csv
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.sound import write_wave
from cubeling.app.workshop.reproduction.gesturing.spoken import bundled_library
from cubeling.app.workshop.stimuli import gesture_films, idle_films
from cubeling.app.workshop.stimuli.film import FilmLook, write_film
from cubeling.app.workshop.stimuli.gesture_films import (
    CONDITIONS,
    LEAD_S,
    SETTINGS,
    captured_clip,
    film_clip,
    plan_film,
    write_gesture_films,
)
from cubeling.app.workshop.study.protocols.protocol_file import load_protocol
from cubeling.characters import Character
from cubeling.characters.motion import GesturePlanner, PostureVectors, StandingRecording, find_rests
from cubeling.characters.speech import Accent, Speech, Utterance


@pytest.fixture(scope="module")
def planner() -> GesturePlanner:
    return GesturePlanner(bundled_library(), SETTINGS)


def _utterance(times: tuple[float, ...], seconds: float) -> Utterance:
    accents = tuple(Accent(time, 0.3 + 0.1 * (n % 5)) for n, time in enumerate(times))
    return Utterance("", "", seconds, (), (), accents)


def test_a_film_has_no_gesture_that_costs_10(planner) -> None:
    spoken = _utterance((1.0, 2.3, 3.6, 4.9), 6.0)
    for condition in CONDITIONS:
        film = plan_film(planner, spoken, condition, 0, 3)
        assert film.plan is not None
        assert not film.plan.skipped
        assert not any(each.relaxed for each in film.plan.gestures)
        again = plan_film(planner, spoken, condition, 0, 3).plan
        assert again is not None
        assert film.plan.gestures == again.gestures
    followed = plan_film(planner, spoken, "time", 0, 3).plan
    assert followed is not None
    assert [each.accent.time for each in followed.gestures] == [1.0, 2.3, 3.6, 4.9]


def test_a_speech_that_no_gesture_suits_is_left_out(planner) -> None:
    film = plan_film(planner, _utterance((), 2.0), "intensity", 0, 0)
    assert film.plan is None
    assert film.left_out == "20 plans have a gesture that costs 10 or more"


def test_a_film_stands_still_but_for_the_gestures(planner) -> None:
    human = Character.load("human")
    plan = plan_film(planner, _utterance((1.0, 2.3), 3.0), "intensity", 0, 0).plan
    assert plan is not None
    clip = film_clip(human, plan, 12.5)
    library = planner.graph.library
    others = [joint for joint in range(len(human.skeleton)) if joint not in library.joints]
    turns = clip.poses.rotations
    assert np.array_equal(
        turns[:, others], np.broadcast_to(turns[0, others], turns[:, others].shape)
    )
    assert np.ptp(turns[:, list(library.joints)], axis=0).max() > 0.1
    # An apex is seen as long after the start as the speech begins after it.
    apex = plan.gestures[0].apex
    frame = round((LEAD_S + apex) * 12.5)
    wanted = plan.motion().turns(frame / 12.5 - LEAD_S)
    assert np.allclose(turns[frame][plan.motion().joints], wanted)


def test_captured_gestures_are_shown_as_the_others_are() -> None:
    human, library = Character.load("human"), bundled_library()
    walk = human.clips["Walk"]
    speech = Speech(np.zeros(8000, np.float32), 8000)
    clip = captured_clip(human, library, walk, speech, 10.0)
    others = [joint for joint in range(len(human.skeleton)) if joint not in library.joints]
    turns = clip.poses.rotations
    assert np.array_equal(turns[0, others], turns[-1, others])
    joints = list(library.joints)
    seen = round((LEAD_S + 0.4) * 10)
    assert np.allclose(turns[seen, joints], walk.sample(0.4).rotations[joints], atol=1e-6)


def test_manifest_and_pairs_say_what_is_there(tmp_path, monkeypatch) -> None:
    sounds, films = tmp_path / "sounds", tmp_path / "films"
    sounds.mkdir()
    films.mkdir()
    for name in ("neutral 1", "neutral 2"):
        write_wave(sounds / f"{name}.wav", np.zeros(16000, np.float32))
    speech = Speech(np.zeros(16000, np.float32), 16000)
    spoken = {"neutral 1": (0.9, 2.1), "neutral 2": ()}
    monkeypatch.setattr(
        gesture_films,
        "speeches",
        lambda folder: ((name, speech, _utterance(each, 3.0)) for name, each in spoken.items()),
    )
    monkeypatch.setattr(gesture_films, "write_film", lambda path, *_: path.write_bytes(b"film"))
    human = Character.load("human")
    look = FilmLook("hands", (32, 32), 5.0)
    assert write_gesture_films(sounds, films, human, bundled_library(), look) == (3, 3)
    with (films / "manifest.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 4
    for row in rows:
        assert bool(row["file"]) != bool(row["left out"])
        assert not row["file"] or (films / row["file"]).is_file()
    with (films / "pairs.csv").open(encoding="utf-8", newline="") as file:
        pairs = list(csv.DictReader(file))
    # They are the pairs of the protocol, and the files are named as it names them.
    shown = load_protocol("gesture-and-speech")[0].stimuli["videos"]
    assert {row["pair"] for row in pairs} == {each["pair"] for each in shown.stimuli}
    name = shown.file.format(speech="neutral 1", member="time")
    assert Path(name).name in {row["file"] for row in rows}
    there = [row for row in pairs if not row["left out"]]
    assert {row["speech"] for row in there} == {"neutral 1"}


def test_both_films_of_a_person_have_the_same_joints() -> None:
    human = Character.load("human")
    kind = PostureVectors.of(human.skeleton, human.anatomy)
    times = np.arange(240) / 24.0
    vectors = np.zeros((240, kind.size))
    vectors[:, 0] = 0.05 * np.sin(times)
    vectors[:, -3] = 0.02 * np.sign(np.sin(times))
    balance = np.sign(np.sin(times))
    person = StandingRecording("her", 24.0, vectors, balance, find_rests(balance, 24.0))
    first, again = (idle_films.idle_clips(person, kind, 4.0, 12.0, 5) for _ in range(2))
    assert set(first) == set(idle_films.ORIGINS)
    for name, clip in first.items():
        assert len(clip) == 48
        assert np.array_equal(clip.poses.rotations, again[name].poses.rotations)
    still = [joint for joint in range(len(human.skeleton)) if joint not in kind.joints]
    both = [first[name].poses.rotations[:, still] for name in idle_films.ORIGINS]
    assert all(np.allclose(a, b) for a, b in pairwise(both))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("gestures", "nowhere"), "there is no folder 'nowhere'"),
        (("gestures", ".", "--captured", "nowhere"), "there is no folder 'nowhere'"),
        (("gestures", "."), "there is no .wav file in '.'"),
        (("gestures", ".", "--gestures", "no.gestures"), "no.gestures"),
        (("idle", "nowhere"), "there is no folder 'nowhere'"),
        (("idle", "."), "there are not two .bvh files in '.'"),
        (("idle", ".", "--size", "big"), "not as 'big'"),
    ],
)
def test_refuses_in_one_line(cubeling, arguments, message) -> None:
    code, _, error = cubeling("stimuli", *arguments, "-o", "films")
    assert code == 2
    assert message in error
    assert error.count("\n") == 1
    assert not Path("films").exists()


@pytest.mark.slow(reason="films are drawn")
def test_films_are_written(tmp_path, planner, monkeypatch) -> None:
    human = Character.load("human")
    plan = plan_film(planner, _utterance((1.0,), 1.5), "intensity", 0, 0).plan
    assert plan is not None
    clip = replace(film_clip(human, plan, 5.0), name="film")
    path = tmp_path / "film.mp4"
    write_film(path, human, clip, FilmLook("hands", (64, 64), 5.0))
    assert path.stat().st_size > 500
