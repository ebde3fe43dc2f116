"""What a character that goes after the cube feels about, and where it stops."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tests.sessions
from cubeling.affect import Personality
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import make_scenario
from cubeling.app.scenarios.pursuit import IGNORED_S, Pursuit
from cubeling.characters import Animator, Character, RootDelta
from tests.bundled_characters import bundled_character
from tests.characters.commands import command

STOP = 0.06


VLEO = Animator(bundled_character("vleo")).update(command(0.0, "idle", 1.0))


def standing(x=0.0, z=0.0):
    """A character that a test puts where it wants."""
    place = np.eye(4)
    place[[0, 2], 3] = x, z
    return replace(VLEO, table_from_character=place)


def events(pursuit, controls, x=0.0, moving=True):
    return pursuit.update(controls, standing(x), STOP, moving)


def test_a_cube_is_reached_once_each_time_the_character_comes_to_it(hand):
    pursuit, seen = Pursuit(), []
    for x in (0.0, -0.5, -0.3, -0.1, -0.08, -0.5, -0.1):
        seen += events(pursuit, hand.frame(), x)
    assert seen == ["reached", "reached"]


def test_a_character_that_begins_beside_the_cube_has_not_reached_it(hand):
    pursuit = Pursuit()
    assert not any(events(pursuit, hand.frame()) for _ in range(30))


@pytest.mark.parametrize("moving", [True, False])
def test_a_cube_that_runs_away_is_chased_by_a_character_that_moves(hand, moving):
    pursuit, seen = Pursuit(), []
    for number in range(60):
        away = np.array([0.2 + 0.3 * number / 30, 0.0])
        seen += events(pursuit, hand.frame(position=away), moving=moving)
    assert seen == ["chased"] * moving


def test_a_cube_that_nobody_moves_is_ignored_again_and_again(hand):
    pursuit, at = Pursuit(), []
    for number in range(round(30 * IGNORED_S * 2.5)):
        if "ignored" in events(pursuit, hand.frame()):
            at.append(number / 30)
    assert at == pytest.approx([IGNORED_S, 2 * IGNORED_S], abs=0.1)


def test_a_cube_that_is_turned_is_not_ignored(hand):
    pursuit = Pursuit()
    for number in range(round(30 * IGNORED_S * 2)):
        heading = 0.5 * np.sin(number / 60)
        assert "ignored" not in events(pursuit, hand.frame(heading=heading))


def test_nothing_happens_with_a_cube_that_is_not_seen(hand):
    pursuit = Pursuit()
    for _ in range(round(30 * IGNORED_S * 1.5)):
        assert events(pursuit, hand.frame(visible=False, position=None)) == ()


@pytest.mark.parametrize("name", ["human", "vleo"])
def test_the_character_stops_before_it_stands_in_the_cube(hand, name):
    follow = make_scenario("follow")
    animator, posed = Animator(Character.load(name), place=RootDelta(-0.4, 0.0, 0.0)), None
    icons, moods = set(), []
    for _ in range(30 * 8):
        situation = Situation(posed, None, animator.actions, animator.walks, animator.length)
        outcome = follow.update(hand.frame(camera_angle=1.5), situation, Inputs())
        posed = animator.update(outcome.command)
        icons.add(outcome.icon)
        moods.append(outcome.emotion.emotion.valence)
    assert posed is not None
    place = posed.table_from_character[[0, 2], 3]
    assert 0.03 + animator.length / 2 - 0.02 < np.linalg.norm(place) < 0.2
    assert icons == ({"stand", "walk"} if animator.walks else {"stand", "hop"})
    assert max(moods) > moods[0] + 0.2  # it is glad to have come


def test_a_character_that_hops_is_told_with_the_command_that_gives_it_a_walk(cubeling):
    session = Path(tests.sessions.__path__[0]) / "intents.mcap"  # in which it goes all the time
    part = (session, "--from", "controls", "--no-pictures")
    code, out, _ = cubeling("replay", *part, "--character", "vleo")
    assert code == 0
    said = " ".join(out.split())
    assert said.count("vleo has no walk, so it hops: cubeling character locomotion vleo") == 1
    assert "cubeling character locomotion gives it a gait" in said


def test_a_lap_that_is_finished_pleases(hand):
    sketch = make_scenario("sketch")
    corners = [np.array(c, float) for c in ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))]
    for corner in corners:
        sketch.update(hand.frame(position=corner, resting=True), Situation(), Inputs())
    sketch.update(hand.frame(lifted=True, resting=False), Situation(), Inputs())
    moods = []
    for number in range(330):
        share = number / 300 * 4
        start, end = corners[int(share) % 4], corners[(int(share) + 1) % 4]
        walker = standing(*(start + (share % 1) * (end - start)))
        moods.append(
            sketch.update(hand.frame(lifted=False), Situation(walker), Inputs()).emotion.emotion
        )
    steps = np.diff([mood.valence for mood in moods])
    assert np.count_nonzero(steps > 0.1) == 1
    assert np.argmax(steps) == pytest.approx(300, abs=5)


@pytest.mark.parametrize("name", ["calm", "grumpy", "lively", "shy", "thesis"])
def test_only_the_personality_of_the_thesis_is_blind_to_what_the_thesis_does_not_have(name):
    known = set(Personality.load(name).events) & {"reached", "finished"}
    assert bool(known) == (name != "thesis")
