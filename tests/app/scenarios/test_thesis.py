"""What the thesis says the cube does, on pictures of a cube: recorded, and drawn for the test."""

import itertools
from typing import NamedTuple

import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.step import Step
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.scenarios.speed import SPEED_MAPS
from cubeling.app.session import messages
from cubeling.app.session.encoding import decode
from cubeling.characters import CharacterCommand
from cubeling.tracking.synthetic import open_synthetic
from tests.app.scripted import play_script
from tests.examples import some

SMALL = "width=480&height=270&rate=12&clutter=0&shadow=0&hand=0"


@pytest.fixture(scope="module")
def whole_turn():
    """One turn clockwise and back, tracked: angle of the camera, for every frame."""
    with open_synthetic(f"turn?{SMALL}") as source:
        playground = Playground("follow", intrinsics_for(source.intrinsics, source.size))
        return [
            (playground.players[0].gesture(playground.tracked.track(frame)), frame.timestamp)
            for frame in source
        ]


@pytest.mark.full
@pytest.mark.parametrize("name", SPEED_MAPS)
def test_speed_over_a_whole_turn_goes_idle_walk_run_walk_idle(whole_turn, name):
    speeds = [SPEED_MAPS[name](controls.camera_angle) for controls, _ in whole_turn]
    gaits = ["idle" if s <= 0.5 else "walk" if s <= 3 else "run" for s in speeds]
    passed = [gait for gait, _ in itertools.groupby(gaits)]
    once = ["idle", "walk", "run", "walk"]
    assert passed == [*once, *once, "idle"]
    assert max(speeds) == pytest.approx({"corrected": 5.0, "legacy": 5.55}[name], abs=0.02)


def test_speed_is_the_same_either_way_round(whole_turn):
    angles = np.array([controls.camera_angle for controls, _ in whole_turn])
    turns = np.array([controls.turns for controls, _ in whole_turn])
    for angle, turn in zip(angles, turns, strict=True):
        assert angle == pytest.approx(np.pi * abs((2 * turn + 1) % 2 - 1), abs=0.02)


def from_script():
    """Return the steps with the true pose of the cube in every frame."""
    steps: list[Step] = []
    play_script("companion", script="turns", progress=steps.append)
    return steps


def from_pictures():
    """Return the steps with the cube tracked."""
    with open_synthetic(f"turns?{SMALL}") as source:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        return [playground.step(frame) for frame in source]


@pytest.fixture(scope="module", params=some([from_script, from_pictures]))
def two_turns(request):
    """A kiss face put down, two turns up, four down, two up: the commands of every frame."""
    steps = request.param()
    return [(step.command, step.controls) for step in steps if step.command.activity == "kiss"]


def test_a_new_face_starts_at_zero_and_two_turns_span_the_intensity(two_turns):
    weights = np.array([command.weight for command, _ in two_turns])
    assert weights[0] == 0.0
    assert weights.max() == 1.0
    assert weights.min() == -1.0
    # Two turns up saturate after one; the two turns down lead from one end to the other.
    first = int(np.argmax(weights == 1.0))
    top = first + int(np.argmax(weights[first:] < 1.0)) - 1
    bottom = top + int(np.argmax(weights[top:] == -1.0))
    turned = two_turns[top][1].turns - two_turns[bottom][1].turns
    assert turned == pytest.approx(2.0, abs=0.05)


@pytest.fixture(scope="module", params=some(["scripted_session", "computed_session"]))
def companion_session(request):
    """Commands and emotions of the bundled recording, or of the script that it was drawn from."""
    path = request.getfixturevalue(request.param)("companion")
    commands = (data for _, _, data in messages(path, "/character/command"))
    emotions = (data for _, _, data in messages(path, "/robot/emotion"))
    return [
        Felt(decode(CharacterCommand, command), decode(EmotionTarget, emotion))
        for command, emotion in zip(commands, emotions, strict=True)
    ]


class Felt(NamedTuple):
    """What is asked of the character in a frame, and what it feels."""

    command: CharacterCommand
    emotion: EmotionTarget


def test_kisses_make_happy_and_shouts_angry_never_skipping_neutral(companion_session):
    told = [(step.emotion.emotion.label, step.command.activity) for step in companion_session]
    labels = [label for label, _ in itertools.groupby(told, key=lambda one: one[0])]
    assert labels == ["neutral", "happy", "neutral", "angry", "neutral"]
    by_action = {
        action: [
            s.emotion.emotion.valence for s in companion_session if s.command.activity == action
        ]
        for action in ("kiss", "shout", "idle")
    }
    assert all(b >= a for a, b in itertools.pairwise(_runs(companion_session, "kiss")))
    assert all(b <= a for a, b in itertools.pairwise(by_action["shout"]))


def _runs(steps, action):
    """Valences of the first stretch of frames with an action."""
    first = next(i for i, step in enumerate(steps) if step.command.activity == action)
    stretch = itertools.takewhile(lambda step: step.command.activity == action, steps[first:])
    return [step.emotion.emotion.valence for step in stretch]


def test_idle_leaves_the_mood(companion_session):
    start = list(
        itertools.takewhile(lambda step: step.command.activity == "idle", companion_session)
    )
    assert {step.emotion.emotion.valence for step in start} == {0.0}


def test_a_tipped_cube_resets_the_intensity(companion_session):
    changes = [
        after
        for before, after in itertools.pairwise(companion_session)
        if before.command.activity != after.command.activity
    ]
    assert len(changes) == 4
    assert all(step.command.weight == 0.0 for step in changes)
