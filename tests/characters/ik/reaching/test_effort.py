"""How hard a place is to reach."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from cubeling.characters.ik.reaching import UpperBody, reach_effort
from cubeling.characters.ik.reaching.whole_body import WholeBody
from cubeling.characters.skeleton.pose import Skeleton
from tests.characters.ik.reaching.bodies import bundled, stick


@dataclass(frozen=True)
class Reacher:
    """A character, as far as it reaches."""

    skeleton: Skeleton
    upper_body: UpperBody
    whole_body: WholeBody | None = None


def reacher(name: str) -> Reacher:
    """Return a bundled character."""
    body = bundled(name)
    return Reacher(body.skeleton, body.upper, WholeBody.of(body.upper))


@pytest.mark.parametrize("name", ["human", "vleo", "robot"])
def test_effort_rises_from_nothing_through_the_limit_without_a_step(name: str) -> None:
    body, character = bundled(name), reacher(name)
    efforts = []
    for far in np.linspace(0.4, 3.0, 400):
        place = body.shoulder("left") + body.reach_of("left") * np.array([0.05, -0.2, far])
        efforts.append(reach_effort(character, np.eye(4), place))
    assert efforts[0] == 0.0
    assert efforts[-1] > 2.0
    assert (np.diff(efforts) > -1e-3).all()
    assert np.diff(efforts).max() < 0.1


def test_effort_does_not_depend_on_where_and_how_large_a_character_stands() -> None:
    body, character = bundled("human"), reacher("human")
    place = body.shoulder("left") + [0.1, -0.1, 0.65]
    cosine, sine, scale = 0.6, 0.8, 0.1
    placed = np.eye(4)
    placed[:3, :3] = scale * np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    placed[:3, 3] = 0.4, 0.02, -1.0
    there = placed[:3, :3] @ place + placed[:3, 3]
    seen = reach_effort(character, placed, there)
    assert 0.0 < seen < 1.5
    assert seen == pytest.approx(reach_effort(character, np.eye(4), place), abs=1e-9)


def test_the_easier_hand_counts() -> None:
    character, shift = reacher("human"), np.array([0.35, 0.0, 0.0])
    middle = np.array([0.0, 1.1, 0.5])
    left, right = (reach_effort(character, np.eye(4), middle + s * shift) for s in (1.0, -1.0))
    assert left == pytest.approx(right, abs=0.05)


def test_nothing_is_in_reach_without_arms() -> None:
    body = stick(arms=())
    assert reach_effort(Reacher(body.skeleton, body.upper), np.eye(4), np.ones(3)) == math.inf
