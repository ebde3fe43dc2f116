"""A layer of one's own, as the room's README shows it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.characters import Animator, Character, CharacterCommand, Pose, Skeleton
from cubeling.characters.control.layers import DEFAULT_LAYERS, FrameContext
from cubeling.characters.skeleton import rotations


class HeadTilt:
    """Tilts the head to the side while an emotion is pleasant."""

    def __init__(self, character: Character, seed: int) -> None:
        self._head = character.anatomy.joint("head")

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        if self._head is None or context.emotion is None:
            return pose
        angle = math.radians(12) * max(context.emotion.valence, 0.0)
        local = pose.rotations.copy()
        tilt = rotations.from_rotation_vector(np.array([0.0, 0.0, angle]))
        local[self._head] = rotations.multiply(local[self._head], tilt)
        return Pose(pose.translations, local, pose.scales, pose.morphs)


def test_a_layer_of_ones_own_is_applied_after_the_others():
    human = replace(Character.load("human"), springs=())  # hair swings after the head
    plain, tilted = Animator(human), Animator(human, layers=(*DEFAULT_LAYERS, HeadTilt))
    command = CharacterCommand(0.0, emotion=Emotion(1.0, 0.0))
    one, other = plain.update(command).pose.rotations, tilted.update(command).pose.rotations
    head = human.anatomy.joint("head")
    differing = np.flatnonzero(np.abs(one - other).max(axis=1) > 1e-9)
    assert differing.tolist() == [head]
    turn = rotations.multiply(rotations.conjugate(one[head]), other[head])
    assert np.linalg.norm(rotations.to_rotation_vector(turn)) == pytest.approx(math.radians(12))


def test_every_layer_leaves_a_body_without_joints_for_it_alone():
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    box = Character("box", Skeleton(("box",), (-1,), rest), {}, ())
    for layer in DEFAULT_LAYERS:
        animator = Animator(box, layers=(layer,))
        posed = animator.update(CharacterCommand(0.0, gaze=np.array([1.0, 1.0, 1.0])))
        assert np.array_equal(posed.pose.rotations, box.skeleton.rest.rotations)
