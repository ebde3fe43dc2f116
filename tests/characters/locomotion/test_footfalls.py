"""Footfalls: found in poses alone, and compared with the foot lock, which knows them."""

import dataclasses
import itertools

import numpy as np
import pytest

from cubeling.characters import Animator, Character, Footfalls, Skeleton
from cubeling.characters.control.layers import FootLockLayer
from tests.characters.commands import command

FRAME = 1 / 30
IN_STRIDE = 18  # frames after which the first step is over


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def walked(character, speeds):
    """Return the frames in which feet land, by footfalls and by the foot lock, and the poses."""
    animator = Animator(character)
    lock = next(x for x in animator._layers if isinstance(x, FootLockLayer)).lock
    assert lock is not None
    finder = Footfalls(character.skeleton, character.height)
    falls, held, poses = [], [], []
    for frame, speed in enumerate(speeds):
        ahead = np.array([0.0, 9.0])
        going = command(frame * FRAME, "move" if speed else "idle", speed, ahead, stop=False)
        posed = animator.update(going)
        poses.append(posed)
        found = finder.update(posed.pose, posed.table_from_character, posed.timestamp)
        falls += [(frame, fall.foot, fall.speed) for fall in found]
        held.append([foot.held for foot in lock.feet])
    down = np.array(held)
    landings = [(int(f) + 1, int(foot)) for f, foot in np.argwhere(down[1:] & ~down[:-1])]
    return falls, landings, poses


def test_feet_are_heard_within_a_frame_of_their_contact_and_faster_ones_as_such(human):
    swings = []
    for speed in (0.8, 2.0, 3.6, 5.0):
        falls, landings, _ = walked(human, [speed] * 100)
        steps = [fall for fall in falls if fall[0] >= IN_STRIDE]
        assert len(steps) >= 4
        for frame, foot, _ in steps:
            assert min(abs(frame - at) for at, other in landings if other == foot) <= 1
        feet = [foot for _, foot, _ in steps]
        assert all(a != b for a, b in itertools.pairwise(feet))  # left, right, left …
        swings.append(np.median([swing for *_, swing in steps]))
    assert swings == sorted(swings)


def test_a_character_that_stands_makes_no_steps(human):
    falls, _, _ = walked(human, [0.0] * 40)
    assert not falls


def test_a_hop_of_the_whole_body_is_a_fall_of_all_feet():
    vleo = Character.load("vleo")
    finder = Footfalls(vleo.skeleton, vleo.height)
    pose = vleo.skeleton.rest
    heights = [0, 0, 0.01, 0.02, 0.02, 0.01, 0, 0]
    fallen, clear = [], []
    for frame, height in enumerate(heights):
        placed = np.diag([0.5, 0.5, 0.5, 1.0])
        placed[1, 3] = height
        fallen.append(len(finder.update(pose, placed, frame * FRAME)))
        clear.append(finder.clearance)
    assert fallen == [0, 0, 0, 0, 0, 0, 4, 0]
    assert clear == pytest.approx([height / (0.5 * vleo.height) for height in heights], abs=1e-6)


def test_a_character_that_appears_elsewhere_after_a_gap_makes_no_steps(human):
    _, _, poses = walked(human, [2.0] * 40)
    finder = Footfalls(human.skeleton, human.height)
    for number, posed in enumerate(poses):
        late = dataclasses.replace(posed, timestamp=number * 1.0)
        assert not finder.update(late.pose, late.table_from_character, late.timestamp)


def test_a_body_without_feet_makes_no_steps(human):
    trunk = Skeleton(("hips", "head"), (-1, 0), human.skeleton.rest[np.array([0, 1])])
    finder = Footfalls(trunk, 1.0)
    assert (finder.count, finder.update(trunk.rest, np.eye(4), 0.0)) == (0, ())
