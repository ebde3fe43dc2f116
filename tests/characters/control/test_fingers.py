"""Fingers that live while nothing shapes the hand."""

from typing import Any

import numpy as np

from cubeling.characters import Animator, Character, CharacterCommand
from cubeling.characters.behaviour.intents import BehaviourIntent, ReachIntent, Times
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array


def finger_turns(animator: Animator, seconds: float, **asked: Any) -> Array:
    """Return how far each finger joint is from its first frame, (frames, joints) [degrees]."""
    hands = animator.character.upper_body.shapes.hands.values()
    joints = [j for hand in hands if hand for finger in hand.fingers.values() for j in finger]
    poses = [
        animator.update(CharacterCommand(number / 30, **asked)).pose.rotations[joints]
        for number in range(round(30 * seconds))
    ]
    turned = rotations.multiply(rotations.conjugate(poses[0]), np.array(poses))
    found: Array = np.degrees(np.linalg.norm(rotations.to_rotation_vector(turned), axis=-1))
    return found


def test_fingers_of_who_stands_move_a_little_and_slowly() -> None:
    turns = finger_turns(Animator(Character.load("human")), 12.0)
    assert (turns.max(axis=0) > 2.0).all()
    assert turns.max() < 20.0
    assert 30.0 * np.abs(np.diff(turns, axis=0)).max() < 15.0  # degrees a second


def test_characters_of_other_seeds_do_not_move_their_fingers_together() -> None:
    human = Character.load("human")
    one, other = (finger_turns(Animator(human, seed=seed), 6.0) for seed in (1, 2))
    assert np.abs(one - other).max() > 2.0


def test_a_hand_that_touches_keeps_its_shape() -> None:
    animator = Animator(Character.load("human"))
    place = animator.scale * animator.character.height * np.array([0.15, 0.6, 0.2])
    reach = ReachIntent("it", place, Times(0.0, 0.3), "touch", "left")
    turns = finger_turns(animator, 4.0, behaviour=BehaviourIntent(reaches=(reach,)))
    left = turns.shape[1] // 2
    assert np.ptp(turns[30:, :left], axis=0).max() < 0.1
