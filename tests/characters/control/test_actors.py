"""Characters that act in place: intensities, changes of action, hops."""

import math

import numpy as np
import pytest

from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
)
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.skeleton import rotations
from tests.characters.control.played import RATE_HZ, heading, place, play, velocities
from tests.examples import some


@pytest.fixture(scope="module", params=some(["actor", "vleo"]))
def character(request, actor):
    return actor if request.param == "actor" else Character.load("vleo")


def test_an_action_plays_and_says_its_name(character):
    animator = Animator(character)
    frames = play(animator, 1.0, activity="kiss", weight=1.0)
    assert frames[-1].state == "kiss"
    assert frames[-1].weight == pytest.approx(1.0)
    assert play(animator, 1.0, 1.0, activity="idle")[-1].state == "idle"


@pytest.mark.parametrize(("weight", "ending"), [(-1.0, "head"), (0.0, "legs"), (1.0, "tail")])
def test_each_intensity_is_its_clip(character, weight, ending):
    frames = play(Animator(character, layers=FOOT_LAYERS), 1.0, activity="shout", weight=weight)
    clip = character.clips[f"shout_{ending}"]
    expected = clip.sample(29 / RATE_HZ)
    shown = rotations.align(frames[-1].pose.rotations, expected.rotations)
    assert np.allclose(shown, expected.rotations, atol=1e-3)


def test_more_weight_moves_more(character):
    def liveliness(weight):
        frames = play(Animator(character), 2.0, activity="kiss", weight=weight)
        return np.abs(velocities(frames[15:], RATE_HZ)).sum()

    effort = [liveliness(weight) for weight in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    assert (np.diff(effort) > 0).all()


def test_no_joint_jumps_between_actions(character):
    rng = np.random.default_rng(8)
    rate, animator, frames, time = 60, Animator(character), [], 0.0
    for _ in range(20):
        length, weight = rng.uniform(0.1, 1.2), rng.uniform(-1, 1)
        action = rng.choice(["idle", "kiss", "shout"])
        frames += play(animator, length, time, rate, activity=str(action), weight=weight)
        time += round(length * rate) / rate
    fastest = 0.0
    for clip in character.clips.values():
        turns = clip.in_place.rotations
        steps = rotations.multiply(turns[1:], rotations.conjugate(turns[:-1]))
        speed = np.linalg.norm(rotations.to_rotation_vector(steps), axis=-1).max() * clip.rate
        fastest = max(fastest, float(speed))
    assert np.linalg.norm(velocities(frames, rate), axis=-1).max() < 2.0 * fastest + 3.0


def test_it_starts_on_its_target_and_hops_to_another(character):
    animator = Animator(character)
    first = animator.update(CharacterCommand(0.0, LocomotionIntent(target=np.array([0.2, 0.1]))))
    assert np.allclose(place(first), [0.2, 0.1])
    frames = play(animator, 3.0, 0.1, target=np.array([0.0, 0.0]))
    ways = np.array([place(frame) for frame in frames])
    heights = np.array([frame.table_from_character[1, 3] for frame in frames])
    assert np.linalg.norm(ways[-1]) < 0.016
    assert heights.max() > 0.005
    assert heights[-1] == 0.0
    assert (heights >= 0).all()
    assert {frame.state for frame in frames if frame.table_from_character[1, 3] > 0} == {"hop"}
    assert frames[-1].state == "idle"
    assert np.linalg.norm(np.diff(ways, axis=0), axis=1).max() < 0.02


def test_it_turns_to_what_it_is_to_look_at(character):
    frames = play(Animator(character), 5.0, facing=np.array([1.0, 0.0]))
    assert heading(frames[-1]) == pytest.approx(math.pi / 2, abs=0.05)


def test_an_action_that_it_does_not_know_is_refused(character):
    with pytest.raises(CharacterError, match="does not know 'sing'; it knows idle, kiss, shout"):
        Animator(character).update(CharacterCommand(0.0, action=ActionIntent("sing")))
