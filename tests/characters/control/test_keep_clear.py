"""Characters step out of the way of obstacles, and to where they are seen."""

import numpy as np
import pytest

from cubeling.characters import (
    Animator,
    CharacterCommand,
    LocomotionIntent,
    Obstacle,
    RootDelta,
    TableView,
)
from cubeling.characters.model.character import skin
from tests.bundled_characters import bundled_character

RATE, EDGE = 30.0, 0.06
EVERYWHERE = np.zeros((0, 4))
EYE = np.array([0.0, 0.37, 0.53])


def cube(x, y=EDGE / 2, z=0.0, *, velocity=(0.0, 0.0, 0.0)):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return Obstacle(pose, np.full(3, EDGE), np.array(velocity, float))


class Play:
    """A character, and what is drawn of it in every frame."""

    def __init__(self, name="human", **place):
        self.character = bundled_character(name)
        self.animator = Animator(self.character, place=RootDelta(**place))
        self.frames = 0
        self.depths: list[float] = []
        self.places: list[np.ndarray] = []
        self.feet: list[np.ndarray] = []

    def frame(self, *obstacles, going=None, view=None):
        command = CharacterCommand(
            self.frames / RATE, going or LocomotionIntent(), obstacles=obstacles, view=view
        )
        posed = self.animator.update(command)
        self.frames += 1
        joints = posed.table_from_character @ posed.pose.globals(self.character.skeleton)
        self.places.append(joints[0, [0, 2], 3])
        names = [f"{side}Foot" for side in ("left", "right")]
        self.feet.append(joints[[self.character.anatomy.joints[each] for each in names], :3, 3])
        for each in obstacles:
            pose = each.table_from_box
            if np.linalg.norm(joints[:, :3, 3] - pose[:3, 3], axis=1).min() > 2 * EDGE:
                continue
            points = np.concatenate([skin(mesh, joints) for mesh in self.character.meshes])
            inside = np.abs((points - pose[:3, 3]) @ pose[:3, :3]).max(axis=1)
            self.depths.append(max(EDGE / 2 - float(inside.min()), 0.0))
        return posed


def slide(play, start, velocity, seconds):
    """Let a cube go past or through where the character stands."""
    start, velocity = np.array(start, float), np.array(velocity, float)
    for number in range(round(seconds * RATE)):
        play.frame(cube(*(start + velocity * number / RATE).tolist(), velocity=velocity))


@pytest.mark.slow(reason="all vertices are skinned in each frame")
@pytest.mark.parametrize(
    ("start", "velocity"),
    [
        ((0.25, 0.03, 0.0), (-0.15, 0.0, 0.0)),
        ((0.25, 0.03, 0.01), (-0.4, 0.0, 0.0)),
        ((0.0, 0.03, 0.3), (0.0, 0.0, -0.3)),
        ((0.0, 0.35, 0.0), (0.0, -0.25, 0.0)),
    ],
)
def test_a_cube_that_comes_touches_nobody(start, velocity):
    play = Play()
    slide(play, start, velocity, 1.3)
    assert max(play.depths) < 0.002
    steps = np.linalg.norm(np.diff(play.places, axis=0), axis=1)
    assert steps.max() < 0.035  # a leap, not a jump from place to place
    assert np.linalg.norm(play.places[-1]) > 0.03


def test_it_steps_aside_with_feet_that_do_not_slide():
    play = Play()
    slide(play, (0.2, 0.03, 0.0), (-0.08, 0.0, 0.0), 2.3)
    assert play.animator.character.gaits.legs is not None
    moved = np.linalg.norm(np.diff(play.feet, axis=0)[..., [0, 2]], axis=-1)
    lifted = np.array(play.feet)[1:, :, 1] - np.array(play.feet)[:, :, 1].min(axis=0)
    assert np.linalg.norm(play.places[-1] - play.places[0]) > 0.03
    assert moved[lifted < 0.0005].max() < 0.001


def test_it_lands_although_what_it_leaps_from_is_gone():
    play = Play()
    slide(play, (0.16, 0.03, 0.0), (-0.5, 0.0, 0.0), 0.1)
    in_the_air = [play.frame().table_from_character[1, 3] for _ in range(20)]
    assert max(in_the_air) > 0.0
    assert in_the_air[-1] == 0.0


def test_it_steps_out_of_the_shadow_of_what_hides_it():
    play = Play()
    screen = Obstacle(np.eye(4), np.array([0.12, 0.4, 0.01]), np.zeros(3))
    screen.table_from_box[2, 3] = 0.1
    view = TableView(EYE, EVERYWHERE)
    for _ in range(round(2.5 * RATE)):
        play.frame(going=LocomotionIntent())
    for _ in range(round(2.5 * RATE)):
        posed = play.animator.update(
            CharacterCommand(play.frames / RATE, LocomotionIntent(), obstacles=(screen,), view=view)
        )
        play.frames += 1
    joints = posed.table_from_character @ posed.pose.globals(play.character.skeleton)
    assert screen.hides(joints[:, :3, 3], EYE).mean() < 0.5


@pytest.mark.slow(reason="six seconds are played")
def test_it_walks_round_what_is_on_its_way():
    play = Play(x=-0.3)
    for _ in range(round(6 * RATE)):
        play.frame(cube(0.0), going=LocomotionIntent(2.5, np.array([0.3, 0.01])))
    assert max(play.depths) < 0.002
    assert play.places[-1][0] > 0.2


def test_a_place_to_reach_something_from_stays_what_it_is():
    """Hands are to touch the cube: so near it would step back by itself."""
    there = np.array([0.068, 0.0])
    one, other = Play(), Play()
    for _ in range(40):
        going = LocomotionIntent(facing=there, exact=True)
        a = one.frame(cube(*there[:1]), going=going)
        b = other.frame(going=going)
    np.testing.assert_array_equal(a.table_from_character, b.table_from_character)
    free = Play()
    for _ in range(40):
        c = free.frame(cube(*there[:1]), going=LocomotionIntent(facing=there))
    assert (a.table_from_character != c.table_from_character).any()


def test_what_is_far_away_changes_nothing():
    one, other = Play(), Play()
    going = LocomotionIntent(2.0, np.array([0.2, 0.1]))
    for _ in range(60):
        a, b = one.frame(cube(-1.0), going=going), other.frame(going=going)
    np.testing.assert_array_equal(a.pose.rotations, b.pose.rotations)
    np.testing.assert_array_equal(a.table_from_character, b.table_from_character)


def test_who_hops_leaps_away_too():
    play = Play("vleo")
    slide(play, (0.3, 0.03, 0.0), (-0.3, 0.0, 0.0), 1.2)
    assert max(play.depths, default=0.0) < 0.002
    assert np.linalg.norm(play.places[-1]) > 0.03
