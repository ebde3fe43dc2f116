"""Shapes of hands, for any skeleton with fingers."""

import numpy as np
import pytest

from cubeling.characters import Pose
from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching import HAND_SHAPES
from cubeling.characters.skeleton.pose import Array
from tests.characters.ik.reaching.bodies import Body, bundled

LONG = ("Index", "Middle", "Little")


def direction(body: Body, pose: Pose, finger: str, side: str) -> Array:
    """Return where the first segment of a finger points, along the axes of the hand at rest."""
    first, second = (
        body.place(pose, body.anatomy.joints[f"{side}{finger}{part}"])
        for part in ("Proximal", "Intermediate")
    )
    hand = body.upper.arms[side].hand
    return np.asarray(hand.axes @ (second - first) / np.linalg.norm(second - first))


@pytest.mark.parametrize("side", ["left", "right"])
def test_fingers_of_a_flat_hand_are_straight_and_parallel(side: str) -> None:
    body = bundled("human")
    pose = body.upper.shapes.shape(body.rest, side, "flat")
    for finger in LONG:
        assert direction(body, pose, finger, side) == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_fist_closes_towards_the_palm_and_a_pointing_finger_stays_out(side: str) -> None:
    body = bundled("human")
    fist = body.upper.shapes.shape(body.rest, side, "fist")
    assert all(direction(body, fist, finger, side)[2] > 0.9 for finger in LONG)
    point = body.upper.shapes.shape(body.rest, side, "point")
    assert direction(body, point, "Index", side)[0] > 0.99
    assert direction(body, point, "Middle", side)[2] > 0.9


def test_spread_fingers_go_apart_on_the_side_of_the_thumb() -> None:
    body = bundled("human")
    pose = body.upper.shapes.shape(body.rest, "left", "spread")
    across = [direction(body, pose, finger, "left")[1] for finger in LONG]
    assert across == pytest.approx(np.sin(np.radians([14.0, 0.0, -28.0])), abs=1e-6)


def test_a_shape_of_half_a_weight_is_on_the_way_and_moves_fingers_only() -> None:
    body, shapes = bundled("human"), bundled("human").upper.shapes
    posture = shapes.posture("left", "fist")
    whole, half = (shapes.shape(body.rest, "left", "fist", weight) for weight in (1.0, 0.5))
    assert whole.rotations[posture.joints] == pytest.approx(posture.rotations)
    moved = np.abs(half.rotations - body.rest.rotations).max(-1) > 1e-9
    assert set(np.flatnonzero(moved)) <= set(posture.joints.tolist())
    again = shapes.shape(half, "left", "fist", 1.0)
    assert again.rotations == pytest.approx(whole.rotations)


@pytest.mark.parametrize("name", ["vleo", "robot"])
def test_a_paw_has_no_shapes(name: str) -> None:
    body = bundled(name)
    for shape in HAND_SHAPES:
        assert body.upper.shapes.shape(body.rest, "left", shape) is body.rest


def test_an_unknown_shape_is_refused_by_its_name() -> None:
    with pytest.raises(CharacterError, match=r"no hand shape is named 'paw'; there are relaxed"):
        bundled("human").upper.shapes.posture("left", "paw")
