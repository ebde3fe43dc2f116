"""Feet that stand do not skid while one motion goes over into another."""

import numpy as np
import pytest

from cubeling.characters import Character, Pose
from cubeling.characters.control.controllers.feet_in_transition import FeetInTransition
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet
from tests.bench.cast import Soles, film
from tests.examples import some

LENGTH_S = 0.25


@pytest.mark.slow(reason="the soles of a body are measured in every frame of an action")
@pytest.mark.parametrize(
    ("name", "action", "suffix", "weight"),
    some(
        [
            ("vleo", "kiss", "head", -1.0),
            ("robot", "angry", "tail", 1.0),
            ("vleo", "kiss", "tail", 1.0),
            ("robot", "angry", "head", -1.0),
        ]
    ),
)
def test_paws_do_not_skid_when_an_action_begins_and_ends(
    name: str, action: str, suffix: str, weight: float
) -> None:
    character = Character.load(name)
    seconds = character.clips[f"{action}_{suffix}"].duration
    slides = Soles(character).slides(*film(character, action, weight, seconds))
    assert slides.max() < 10.0  # [mm/s]; 23 without


@pytest.fixture(scope="module")
def vleo() -> Character:
    return Character.load("vleo")


def raised(character: Character, height: float) -> Pose:
    """The rest pose with its first foot so far above the ground [body heights]."""
    rest = character.skeleton.rest
    moved = rest.translations.copy()
    moved[find_feet(character.skeleton)[0][0], 1] += height * character.height
    return Pose(moved, rest.rotations)


def bent(character: Character) -> Pose:
    """The rest pose with all legs turned a little, so that feet are beside their places."""
    rest, skeleton = character.skeleton.rest, character.skeleton
    turns = rest.rotations.copy()
    hips = [skeleton.parents[skeleton.parents[foot[0]]] for foot in find_feet(skeleton)]
    turns[hips] = rotations.multiply(turns[hips], rotations.about("x", np.array(0.05)))
    return Pose(rest.translations, turns)


def places(character: Character, pose: Pose) -> np.ndarray:
    feet = [foot[0] for foot in find_feet(character.skeleton)]
    return np.asarray(pose.globals(character.skeleton)[feet, :3, 3])


def test_standing_feet_stay_where_both_motions_have_them(vleo: Character) -> None:
    feet, own = FeetInTransition(vleo), vleo.skeleton.rest
    first = feet.hold(own, own, 1.0, 0.0, LENGTH_S)
    later = feet.hold(bent(vleo), own, 1.0, 0.1, LENGTH_S)
    assert np.abs(places(vleo, bent(vleo)) - places(vleo, own)).max() > 0.002
    assert np.allclose(places(vleo, later), places(vleo, first), atol=1e-9)


def test_a_foot_in_the_air_follows_the_transition(vleo: Character) -> None:
    feet, own = FeetInTransition(vleo), vleo.skeleton.rest
    feet.hold(raised(vleo, 0.1), own, 1.0, 0.0, LENGTH_S)
    shown = raised(vleo, 0.05)
    later = feet.hold(shown, own, 1.0, 0.1, LENGTH_S)
    assert np.allclose(places(vleo, later)[0], places(vleo, shown)[0], atol=1e-9)


def test_after_a_transition_poses_are_left_alone(vleo: Character) -> None:
    shown = bent(vleo)
    assert FeetInTransition(vleo).hold(shown, shown, 1.0, LENGTH_S, LENGTH_S) is shown


def test_held_feet_stay_at_the_ends_of_their_legs(vleo: Character) -> None:
    feet, own = FeetInTransition(vleo), vleo.skeleton.rest
    feet.hold(own, own, 1.0, 0.0, LENGTH_S)
    held = feet.hold(bent(vleo), own, 1.0, 0.1, LENGTH_S)
    assert not np.allclose(held.rotations, bent(vleo).rotations, atol=1e-4)
    assert np.allclose(held.translations, own.translations, atol=1e-12)
