"""The gesture space: 84 cells that scale, turn and mirror exactly (Huang 2013, section 8.7)."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.behaviour.gestures.place.space import REFERENCE_ARM_M, GestureSpace
from cubeling.characters.behaviour.symbolic_gesture import SECTORS_X, SECTORS_Y, SECTORS_Z, Place
from cubeling.characters.skeleton import rotations

CHEST = np.array([0.02, 1.1, 0.1])


def test_there_are_84_different_cells():
    cells = GestureSpace(CHEST, 0.6).cells(left=False)
    assert len(cells) == 84
    assert len(np.unique(np.round(list(cells.values()), 9), axis=0)) == 84


def test_cells_are_the_printed_centimetres_for_an_arm_of_that_length():
    space = GestureSpace(np.zeros(3), REFERENCE_ARM_M)
    place = space.point(Place("XEP", "YUpperEP", "ZFar"), left=True)
    assert place == pytest.approx([0.45, 0.5, 0.4])


@pytest.mark.parametrize("spatial", [-1.0, -0.5, 0.3, 1.0])
def test_spatial_scales_cells_about_the_chest_exactly(spatial):
    plain = GestureSpace(CHEST, 0.6).cells(left=True)
    scaled = GestureSpace(CHEST, 0.6, spatial).cells(left=True)
    for cell, centre in plain.items():
        assert scaled[cell] == pytest.approx(CHEST + (centre - CHEST) * (1.0 + spatial), abs=1e-12)


def test_longer_arms_have_a_larger_space():
    small, large = (GestureSpace(CHEST, arm).cells(left=True) for arm in (0.3, 0.6))
    for cell, centre in small.items():
        assert large[cell] - CHEST == pytest.approx(2.0 * (centre - CHEST))


def test_a_torso_that_turns_by_20_degrees_turns_all_cells_by_20_degrees():
    upright = GestureSpace(CHEST, 0.6)
    turn = rotations.to_matrix(rotations.about("y", math.radians(20.0)))
    turned = upright.turn_by(turn, CHEST)
    for cell, centre in upright.cells(left=False).items():
        moved = turned.cells(left=False)[cell]
        assert moved - CHEST == pytest.approx(turn @ (centre - CHEST), abs=1e-12)
        before, after = (math.atan2(*(each - CHEST)[[0, 2]]) for each in (centre, moved))
        assert math.degrees(rotations.wrap(after - before)) == pytest.approx(20.0)


def test_a_bent_torso_scales_its_space():
    upright = GestureSpace(CHEST, 0.6)
    bent = upright.turn_by(np.eye(3), CHEST, torso_scale=0.9)
    place = Place("XP", "YUpperP", "ZFar")
    assert bent.point(place, True) - CHEST == pytest.approx(
        0.9 * (upright.point(place, True) - CHEST)
    )


def test_hands_have_mirrored_cells():
    space = GestureSpace(np.zeros(3), 0.6)
    left, right = space.cells(left=True), space.cells(left=False)
    for cell, centre in left.items():
        assert right[cell] == pytest.approx(centre * [-1.0, 1.0, 1.0])


@given(
    st.sampled_from(SECTORS_X),
    st.sampled_from(SECTORS_Y),
    st.sampled_from(SECTORS_Z),
    st.floats(-0.9, 1.0),
    st.booleans(),
)
def test_the_centre_of_a_cell_is_in_that_cell(x, y, z, spatial, left):
    space = GestureSpace(CHEST, 0.6, spatial)
    found = space.nearest(space.point(Place(x, y, z), left), left)
    assert (found.x, found.y, found.z) == (x, y, z)
    assert found.offset == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
