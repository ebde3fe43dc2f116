"""Two players with a cube each: two cubes, two characters, two robots on one table."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import ROBOT_NAMES, checked_players, robots_of
from cubeling.app.pipeline.player import check_players, on_table_of
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import EmotionTarget, ScenarioSettings
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions, messages, session_info
from cubeling.app.session.encoding import decode, encode
from cubeling.characters import Character
from cubeling.tracking import CubeModel, Frame, Intrinsics, se3
from tests.app import session_parts
from tests.app.scripted import Blank
from tests.bench.keep_clear import TABLE
from tests.tracking.drawn import photograph, scene

CAMERA = Intrinsics(
    np.array([[450.0, 0, 319.5], [0, 450.0, 179.5], [0, 0, 1]]), np.zeros(5), (640, 360)
)
FRAMES = 30
WIRES = "/robot/wire", "/robots/tim/wire"


class TwoCubes(Blank):
    """Drawn pictures of two cubes that rest on a table; the second one is then slid."""

    def __init__(self):
        self.intrinsics, self.size, self.rate = CAMERA, CAMERA.size, 30.0
        self.count, self.duration = FRAMES, FRAMES / 30.0
        self.cubes = CubeModel.load("locomotion"), CubeModel.load("locomotion-2")

    def __iter__(self):
        picture = None
        for index in range(self.count):
            slid = 0.002 * max(index - 14, 0)
            if slid or picture is None:
                poses = [self.pose(-0.05, 0.0, 3.0), self.pose(0.12, 0.04 - slid, 2.8)]
                pairs = zip(self.cubes, poses, strict=True)
                picture = photograph(scene(*pairs, camera=CAMERA))
            yield Frame(picture, round(index / self.rate, 9), index)

    def pose(self, x, z, yaw):
        """Return `camera_from_cube` of a cube that stands on the table."""
        placed = np.eye(4)
        placed[:3, :3] = se3.rotation(np.array([0.0, yaw, 0.0]))
        placed[:3, 3] = x, 0.03, z
        return TABLE @ placed


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A recorded session of two players, its options and its steps."""
    path = tmp_path_factory.mktemp("two") / "two.mcap"
    options = SessionOptions(
        scenario="follow",
        source="two cubes",
        players=2,
        others=("human", "vleo"),
        robot="sim:pleo",
        second_robot="sim:pleo",
        robot_names=("robot", "tim"),
        record=path,
        pictures=False,
    )
    steps: list[Step] = []
    with open_session(options, source=TwoCubes()) as session:
        run(session, steps.append)
        first = session.robot_view()
        assert first.second is not None
        robots = first, first.second
    return path, steps, robots


def test_both_cubes_are_tracked_and_share_one_table(played):
    _, steps, _ = played
    last = steps[-1]
    (second,) = last.players
    assert last.state.visible
    assert second.state.visible
    assert second.name == "locomotion-2"
    assert np.array_equal(second.controls.camera_from_table, last.controls.camera_from_table)
    apart = second.state.camera_from_cube[:3, 3] - last.state.camera_from_cube[:3, 3]
    assert second.controls.position is not None
    moved = second.controls.position - last.controls.position
    assert np.linalg.norm(moved) == pytest.approx(np.linalg.norm(apart), abs=0.002)


def test_each_cube_leads_its_own_character(played):
    _, steps, _ = played
    last = steps[-1]
    assert [each.name for each in last.others] == ["human_2", "vleo"]
    targets = [each.command.locomotion.target for each in (last, *last.others[:1])]
    assert np.linalg.norm(targets[0] - targets[1]) > 0.05
    assert last.others[1].command.activity == "idle", "nobody leads the third"


def test_a_cube_keeps_everybody_out(played):
    """Two cubes, the arms that slid them, and the two others are in the way of the first."""
    _, steps, _ = played
    assert sum(not each.alive for each in steps[-1].command.obstacles) >= 2
    assert sum(each.alive for each in steps[-1].command.obstacles) == 2


def test_both_robots_feel(played):
    _, _, robots = played
    assert all(view.link == "ready" for view in robots)
    assert [view.name for view in robots] == ["robot", "tim"]


def test_the_wire_and_the_emotions_of_each_robot_are_recorded(played):
    path, steps, _ = played
    wires = [[data for _, _, data in messages(path, topic)] for topic in WIRES]
    assert all(len(wire) > 10 for wire in wires)
    felt = [decode(EmotionTarget, data) for _, _, data in messages(path, "/robots/tim/emotion")]
    assert felt == [step.others[0].emotion for step in steps]


@pytest.mark.slow(reason="a session of two cubes is processed again")
def test_a_session_of_two_players_is_replayed_with_no_difference(played):
    path, steps, _ = played
    options = session_info(path).options
    assert options.players == 2
    assert options.cubes == ("locomotion", "locomotion-2")
    result = session_parts.check(path, options)
    assert result.identical
    assert result.counts["/cubes/locomotion-2/state"] == len(steps)
    assert result.counts["/robots/tim/emotion"] == len(steps)


@pytest.mark.slow(reason="a session of two cubes is processed again")
@pytest.mark.parametrize("stage", ["state", "pose"])
def test_a_session_of_two_players_is_replayed_from_a_later_stage(played, stage):
    """Each player and each of the cast takes what was recorded of it, even if nothing is seen."""
    path, steps, _ = played
    options = replace(session_info(path).options, stage=stage, pictures=False, robot="none")
    again: list[Step] = []
    with open_session(options) as session:
        blind = [replace(frame, image=np.zeros_like(frame.image)) for frame in session.source]
        for frame, recorded in zip(blind, session.replay_inputs or (), strict=True):
            again.append(session.playground.step(frame, None, recorded))
    for before, now in zip(steps, again, strict=True):
        for topic, message in before.messages().items():
            assert encode(now.messages()[topic]) == encode(message), topic


def test_a_setting_is_that_of_both_players_also_when_they_start_over():
    cubes = CubeModel.load("locomotion"), CubeModel.load("locomotion-2")
    others = [Character.load("vleo")]
    table = Playground("companion", CAMERA, cube=cubes[0], others=others, further_cubes=cubes[1:])
    table.adjust(ScenarioSettings(turns=4.5), "auto")
    assert [getattr(each.scenario, "_turns", None) for each in table.cast.members] == [4.5, 4.5]
    table.play(table.scenario, cubes[0])
    assert getattr(table.cast.members[1].scenario, "_turns", None) == 4.5


def test_cubes_that_share_a_marker_are_refused():
    cube = CubeModel.load("locomotion")
    with pytest.raises(AppError, match="cubeling cube locomotion-2"):
        check_players([cube, cube])
    check_players([cube, *map(CubeModel.load, ("locomotion-2", "companion", "companion-2"))])


def test_a_lost_cube_stays_where_it_was_on_the_table_of_the_first(hand):
    """Its own table lies elsewhere and is turned: its last place is told there."""
    shift = np.eye(4)
    shift[:3, :3] = se3.rotation(np.array([0.0, np.pi / 2, 0.0]))
    shift[:3, 3] = 0.3, 0.0, 0.1
    first = hand.frame(camera_from_table=TABLE)
    own = replace(first, camera_from_table=TABLE @ shift, position=np.array([0.02, 0.0]))
    seen, lost = (on_table_of(first, replace(own, visible=each)) for each in (True, False))
    assert lost.camera_from_table is first.camera_from_table
    assert lost.position == pytest.approx([0.3, 0.08])
    assert seen.position == pytest.approx([0.3, 0.08])
    unknown = on_table_of(first, replace(own, camera_from_table=None))
    assert unknown.position is None


@pytest.mark.parametrize("number", [0, 3, 1.5])
def test_one_or_two_can_play(number):
    with pytest.raises(AppError, match="can play at once"):
        checked_players(number)


def test_each_player_has_one_robot():
    assert robots_of((), 1) == (("sim", "none"), ROBOT_NAMES)
    assert robots_of(("none", "sim:pleo"), 2) == (("none", "sim:pleo"), ROBOT_NAMES)
    assert robots_of(("none", "tim=sim?seed=1"), 2) == (("none", "sim?seed=1"), ("robot", "tim"))
    with pytest.raises(AppError, match="two robots have the name 'rex'"):
        robots_of(("rex=sim", "rex=sim"), 2)
    with pytest.raises(AppError, match="--players 2"):
        robots_of(("sim", "sim"), 1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--players", "2", "--robot", "rex=sim", "--robot", "rex=sim"), "the name 'rex'"),
        (("--robot", "sim", "--robot", "sim"), "--players 2 has two"),
        (("--players", "2", "--robot", "sim", "--robot", "tim=sim:cat"), "sim:cat"),
    ],
)
def test_robots_that_cannot_play_are_refused_in_one_line(cubeling, arguments, said):
    code, _, err = cubeling("play", "follow", *arguments)
    assert code == 2
    assert said in err
    assert err.count("\n") == 1
