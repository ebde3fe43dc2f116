"""Another cube than the one in play is named, and a key changes to its scenario."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.pipeline.cubes.advice import FOLD_IT, FOLD_IT_SHOWN_S
from cubeling.app.pipeline.cubes.other_cube import LOOK_AFTER_S, advice, cube_for
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.scenarios import SCENARIOS
from cubeling.app.session import SessionOptions
from cubeling.app.ui.screen import NullScreen
from cubeling.tracking import CubeModel, CubeTracker, Frame, Intrinsics, open_source
from cubeling.tracking.cube.model import CUBES_FOLDER

COMPANION = CubeModel.load("companion")
PLAIN = replace(
    COMPANION, name="museum", faces=tuple(replace(face, role="") for face in COMPANION.faces)
)
"""A cube of the player's without roles, with the markers of the companion cube."""

ADVICE = "This is the companion cube: press 3 to play companion"


@pytest.fixture(scope="module")
def pictures(longer_session):
    """The companion cube, for a second and more."""
    with open_source(str(longer_session)) as source:
        return list(source)


def hints(playground, pictures):
    return [playground.step(frame).outcome.hint for frame in pictures]


def guessed(picture):
    height, width = picture.image.shape[:2]
    return Intrinsics.guess((width, height))


@pytest.mark.slow(reason="every frame is searched for every cube")
def test_the_wrong_cube_is_named_within_a_second_or_two(pictures):
    seen = hints(Playground("follow", guessed(pictures[0])), pictures)
    first = seen.index(ADVICE)
    assert pictures[first].timestamp - pictures[0].timestamp == pytest.approx(LOOK_AFTER_S, abs=0.1)
    assert set(seen[first:]) == {ADVICE}


def test_the_right_cube_is_not_named(pictures):
    cube = CubeModel.load("companion")
    seen = hints(Playground("follow", guessed(pictures[0]), cube=cube), pictures)
    assert ADVICE not in seen


def test_the_cube_of_another_player_is_not_named(pictures):
    cube = CubeModel.load("locomotion-2")  # shares no marker with that one
    alone = hints(Playground("follow", guessed(pictures[0]), cube=cube), pictures)
    assert ADVICE in alone
    beside = Playground("follow", guessed(pictures[0]), cube=cube, further_cubes=(COMPANION,))
    assert ADVICE not in hints(beside, pictures)


def test_a_cube_of_the_player_is_named_instead_of_a_bundled_one_with_its_markers(pictures):
    playground = Playground("follow", guessed(pictures[0]), known_cubes=(PLAIN,))
    assert hints(playground, pictures)[-1] == (
        "This is the museum cube: press 1 to play follow with it"
    )
    assert playground.tracked.other_cube is PLAIN


def test_the_name_of_a_cube_need_not_be_repeated():
    mine = replace(PLAIN, name="my old cube")
    assert advice(mine, "sketch", "locomotion", False) == (
        "This is the my old cube: press 2 to play sketch with it"
    )


def test_the_cube_in_view_is_played_with_if_it_can_be():
    other = replace(COMPANION, name="other")
    chosen = cube_for(SCENARIOS["follow"], COMPANION, (PLAIN,))
    assert chosen is COMPANION
    assert cube_for(SCENARIOS["follow"], None, (PLAIN,)) is PLAIN
    assert cube_for(SCENARIOS["companion"], PLAIN, (PLAIN, other)) is other
    assert cube_for(SCENARIOS["companion"], PLAIN, (PLAIN,)).name == "companion"


def test_an_empty_picture_asks_for_the_cube(pictures):
    empty = [Frame(np.zeros_like(each.image), each.timestamp, each.index) for each in pictures]
    assert set(hints(Playground("follow", guessed(pictures[0])), empty)) == {"Show me the cube"}


class Presses(NullScreen):
    """Presses the key of a scenario in one frame, and keeps what happened then."""

    def __init__(self, scenario, at=15):
        self._scenario, self._at, self.steps = scenario, at, []

    def show(self, step, robot):
        self.steps.append(step)
        return Inputs(scenario=self._scenario if len(self.steps) == self._at else "")


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


def test_the_present_scenario_goes_on_with_another_cube_in_view(longer_session, tmp_path):
    mine = tmp_path / "museum.toml"
    text = (CUBES_FOLDER / "companion.toml").read_text("utf-8")
    mine.write_text(text.replace('"companion"', '"museum"'), "utf-8")
    options = SessionOptions(
        scenario="companion",
        source=str(longer_session),
        cubes=(write_other_ids(tmp_path, text), str(mine)),
        robot="none",
    )
    screen = Presses("companion", at=35)
    with open_session(replace(options, pictures=False), screen=screen) as session:
        run(session)
        assert session.playground.cube.name == "museum"
    assert not any(step.state.visible for step in screen.steps[:35])
    assert screen.steps[-1].state.visible


def write_other_ids(folder, text):
    """Write the text of a cube's file with other marker ids, and return its path."""
    path = folder / "others.toml"
    text = text.replace("DICT_4X4_50", "DICT_4X4_250").replace("marker_id = ", "marker_id = 2")
    path.write_text(text, "utf-8")
    return str(path)


def test_two_cubes_with_the_same_markers_are_refused(cubeling, tmp_path):
    (tmp_path / "mine.toml").write_bytes((CUBES_FOLDER / "companion.toml").read_bytes())
    cubes = ["--cube", "companion", "--cube", "mine.toml"]
    code, _, err = cubeling("play", "companion", *cubes)
    assert code == 2
    assert err.startswith("cubeling: mine.toml has the markers of companion: ")
    assert err.count("\n") == 1


def test_who_shows_the_sheet_is_told_to_fold_it(pictures):
    playground = Playground("companion", guessed(pictures[0]))
    flat = replace(CubeTracker(COMPANION, playground.intrinsics).predict(0.0), refused="flat")
    later = [0.0, FOLD_IT_SHOWN_S / 2, FOLD_IT_SHOWN_S * 1.5]
    told = []
    for time in later:
        state = replace(flat, timestamp=time, refused="flat" if time == 0.0 else "")
        frame = Frame(pictures[0].image, time, 0)
        told.append(playground.step(frame, replay=ReplayInputs(state=state)).outcome.hint)
    assert told[:2] == [FOLD_IT] * 2
    assert told[2] != FOLD_IT
    assert FOLD_IT == "This is the sheet: fold it into a cube."
