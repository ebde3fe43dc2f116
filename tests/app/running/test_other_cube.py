"""Another cube than the one in play is named, and a key changes to its scenario."""

import itertools

import numpy as np
import pytest

from app.pipeline.other_cube import LOOK_AFTER_S
from app.pipeline.playground import Playground
from app.pipeline.scenario import Inputs
from app.running.opening import open_session
from app.running.runner import run
from app.session import SessionOptions
from app.ui.screen import NullScreen
from tracking import CubeModel, Frame, Intrinsics, open_source

ADVICE = "This is the companion cube: press 3 to play companion"


@pytest.fixture(scope="module")
def pictures(bundled_session):
    """Two seconds of the companion cube."""
    with open_source(str(bundled_session)) as source:
        return list(itertools.islice(source, 60))


def hints(playground, pictures):
    return [playground.step(frame).outcome.hint for frame in pictures]


def guessed(picture):
    height, width = picture.image.shape[:2]
    return Intrinsics.guess((width, height))


def test_the_wrong_cube_is_named_within_a_second_or_two(pictures):
    seen = hints(Playground("follow", guessed(pictures[0])), pictures)
    first = seen.index(ADVICE)
    assert pictures[first].timestamp - pictures[0].timestamp == pytest.approx(LOOK_AFTER_S, abs=0.1)
    assert set(seen[first:]) == {ADVICE}


def test_the_right_cube_is_not_named(pictures):
    cube = CubeModel.load("companion")
    seen = hints(Playground("follow", guessed(pictures[0]), cube=cube), pictures)
    assert ADVICE not in seen


def test_an_empty_picture_asks_for_the_cube(pictures):
    empty = [Frame(np.zeros_like(each.image), each.timestamp, each.index) for each in pictures]
    assert set(hints(Playground("follow", guessed(pictures[0])), empty)) == {"Show me the cube"}


class Presses(NullScreen):
    """Presses the key of a scenario after half a second, and keeps what happened then."""

    def __init__(self, scenario):
        self._scenario, self.steps = scenario, []

    def show(self, step, robot):
        self.steps.append(step)
        return Inputs(scenario=self._scenario if len(self.steps) == 15 else "")


@pytest.mark.parametrize("recorded", [False, True])
def test_a_key_changes_the_scenario_unless_it_is_recorded(short_session, tmp_path, recorded):
    path = tmp_path / "kept.mcap"
    options = SessionOptions(
        scenario="follow",
        source=str(short_session),
        robot="none",
        record=path if recorded else None,
        pictures=False,
    )
    screen = Presses("companion")
    with open_session(options, screen=screen) as session:
        run(session)
        played = session.playground.scenario.name
    assert played == ("follow" if recorded else "companion")
    assert not any(step.state.visible for step in screen.steps[:15])
    assert any(step.state.visible for step in screen.steps[16:]) != recorded
