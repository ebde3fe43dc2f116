"""Several characters on the table: names, places, glances, and room for one another."""

import math

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.cast.further_members import CLEARANCE_M, FURTHER_PLACES_M, waiting_places
from cubeling.app.pipeline.choices import MAX_CAST, cast_of, distinct_names
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.attention import Attention, Company
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.scenarios.reach.gifts import HOMES
from cubeling.app.session import SessionOptions, session_info
from cubeling.characters import Character, CharacterCommand
from cubeling.tracking import CubeModel, CubeState, Frame
from tests.app import session_parts
from tests.bench.keep_clear import drive

BLACK = np.zeros((90, 160, 3), np.uint8)


@pytest.fixture
def table():
    """Return a function that plays a random drive with others on the table, step by step."""

    def play(others, scenario="follow", frames=120):
        take = drive(0, scenario, CubeModel.load("locomotion").edge)
        loaded = [Character.load(name) for name in others]
        playground = Playground(scenario, take.intrinsics, others=loaded)
        for index, state in enumerate(take.states[:frames]):
            frame = Frame(BLACK, state.timestamp, index)
            yield playground, playground.step(frame, None, ReplayInputs(state=state), drawn=False)

    return play


@pytest.mark.parametrize(
    ("text", "character", "lead", "others"),
    [
        (None, None, None, ()),
        (None, "vleo", "vleo", ()),
        ("human", None, "human", ()),
        ("human, vleo,vleo", None, "human", ("vleo", "vleo")),
    ],
)
def test_a_cast_is_a_list_with_commas(text, character, lead, others):
    assert cast_of(text, character) == (lead, others)


@pytest.mark.parametrize(
    ("text", "character"), [("human", "vleo"), ("human,", None), ("", None), ("a,b,c,d,e,f", None)]
)
def test_a_cast_that_is_none_is_refused(text, character):
    with pytest.raises(AppError, match="--cast"):
        cast_of(text, character)


def test_each_name_is_there_once_and_fits_into_a_topic():
    names = distinct_names(["human", "human", "Zoë / 1", "human", "??"])
    assert names == ("human", "human_2", "Zoë-1", "human_3", "-")


@pytest.mark.parametrize("things", [(), tuple(HOMES.values())])
def test_there_is_a_place_for_everyone_that_no_thing_has(things):
    places = waiting_places(things)
    assert len(set(places)) == MAX_CAST - 1
    for place in places:
        assert all(math.dist(place, each) > CLEARANCE_M for each in things)
        assert all(math.dist(place, each) > 0.12 for each in places if each != place)
    assert waiting_places() == FURTHER_PLACES_M


def test_who_waits_stands_turned_as_it_stays(table):
    """Nobody turns at the beginning: all face the player from the first frame on."""
    steps = [step for _, step in table(("vleo", "vleo"), scenario="reach", frames=60)]
    for first, last in zip(steps[0].others, steps[-1].others, strict=True):
        assert last.command.activity == "idle"
        ahead = [each.posed.table_from_character[:3, 2] for each in (first, last)]
        cosine = ahead[0] @ ahead[1] / np.linalg.norm(ahead[0]) / np.linalg.norm(ahead[1])
        assert cosine > math.cos(math.radians(8.0))


def test_others_live_on_the_table_and_the_lead_is_as_it_is_alone(table):
    alone = [step for _, step in table((), frames=20)]
    both = [step for _, step in table(("vleo", "vleo"), frames=20)]
    last = both[-1]
    assert [each.name for each in last.others] == ["vleo", "vleo_2"]
    assert last.controls.top_face == alone[-1].controls.top_face
    assert last.posed.state == alone[-1].posed.state
    one, two = (each.posed.pose.rotations for each in last.others)
    assert not np.allclose(one, two), "two of one kind move differently"


def test_every_member_shows_a_mood_of_its_own(table):
    *_, (_, step) = table(("vleo",), scenario="companion", frames=20)
    assert step.others[0].emotion.emotion != step.emotion.emotion
    assert step.others[0].command.emotion == step.others[0].emotion.emotion


def test_a_checkpoint_holds_the_whole_cast(table):
    steps = table(("vleo",), frames=60)
    for _ in range(30):
        playground, _ = next(steps)
    kept = playground.checkpoint()
    once = [step.others[0].posed for _, step in steps]
    playground.restore(kept)
    take = drive(0, "follow", playground.cube.edge)
    for index, (state, before) in enumerate(zip(take.states[30:60], once, strict=True), start=30):
        frame = Frame(BLACK, state.timestamp, index)
        step = playground.step(frame, None, ReplayInputs(state=state), drawn=False)
        assert np.array_equal(step.others[0].posed.pose.rotations, before.pose.rotations)


@pytest.mark.slow(reason="a session is recorded and processed again")
def test_a_session_of_a_cast_is_recorded_and_replayed_with_no_difference(tmp_path, short_session):
    path = tmp_path / "cast.mcap"
    options = SessionOptions(
        scenario="companion",
        source=str(short_session),
        character="vleo",
        others=("human", "vleo"),
        robot="none",
        record=path,
        pictures=False,
    )
    with open_session(options) as session:
        run(session)
    recorded = session_info(path).options
    assert recorded.others == ("human", "vleo")
    result = session_parts.check(path, recorded)
    assert result.identical
    assert result.counts["/cast/human/pose"] == result.counts["/cast/vleo_2/emotion"] > 10


def state_and_controls(hand):
    """Return a cube that rests where the camera is 0.7 m before it, and its controls."""
    pose = np.eye(4)
    pose[2, 3] = 0.7
    still = np.zeros(6)
    controls = hand.frame(camera_from_table=pose)
    return CubeState(True, pose, still, np.eye(6), "markers", (), 0.1, controls.timestamp), controls


def test_who_speaks_is_looked_at(hand):
    attention, mouth = Attention("auto", 0.06), np.array([0.2, 0.1, 0.0])
    state, controls = state_and_controls(hand)
    company = Company((mouth,), mouth)
    looked = attention.update(state, controls, CharacterCommand(controls.timestamp), company)
    assert looked is mouth


def test_glances_go_to_the_others_while_the_cube_rests(hand):
    attention, face = Attention("auto", 0.06), np.array([0.2, 0.1, 0.0])
    seen = []
    for _ in range(900):
        state, controls = state_and_controls(hand)
        command = CharacterCommand(controls.timestamp)
        seen.append(attention.update(state, controls, command, Company((face,))) is face)
    assert 0.1 < np.mean(seen) < 0.4
