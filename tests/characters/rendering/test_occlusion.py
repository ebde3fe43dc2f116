"""Outlines of real cubes, which hide the table behind them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from characters.rendering import Box
from characters.rendering.occlusion import MAX_CUBES, MAX_SIDES, UNIT_CUBE, CubeOutlines
from characters.rendering.projection import Rectangle

MATRIX = np.array([[300.0, 0, 159.5], [0, 300.0, 89.5], [0, 0, 1]])
PART = Rectangle(40, 20, 200, 120)


def box_at(turn, place):
    axis = np.asarray(turn, float) / max(float(np.linalg.norm(turn)), 1e-9)
    angle = float(np.linalg.norm(turn))
    cross = np.cross(np.eye(3), axis)
    pose = np.eye(4)
    pose[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    pose[:3, 3] = place
    return Box(pose, 0.06)


def inside(outlines, places):
    """Return how far inside the first cube places (n, 2) of the part are [px]."""
    return (np.column_stack([places, np.ones(len(places))]) @ outlines.sides[0].T).min(axis=1)


def on_part(box, points):
    seen = points @ box.camera_from_box[:3, :3].T + box.camera_from_box[:3, 3]
    pixels = (seen / seen[:, 2:]) @ MATRIX[:2].T
    return pixels + 0.5 - [PART.x, PART.y]


coordinate = st.floats(-1.5, 1.5)


@given(st.tuples(coordinate, coordinate, coordinate), st.floats(0.2, 0.9))
def test_an_outline_bounds_the_cube_tightly(turn, depth):
    box = box_at(turn, (0.02, -0.01, depth))
    outlines = CubeOutlines.of([box], MATRIX, PART)
    corners = inside(outlines, on_part(box, box.edge * UNIT_CUBE))
    assert outlines.count == 1
    assert corners.min() > -1e-3  # all within it
    sides = outlines.sides[0][outlines.sides[0][:, 2] < 1e6]
    at = on_part(box, box.edge * UNIT_CUBE)
    nearest = (np.column_stack([at, np.ones(len(at))]) @ sides.T).min(axis=0)
    assert nearest.max() < 1e-3  # and each side touches it
    assert 4 <= len(sides) <= MAX_SIDES


def test_a_cube_behind_the_camera_is_clipped_at_the_near_plane():
    box = box_at((0.3, 0.5, 0.1), (0.0, 0.0, 0.03))
    outlines = CubeOutlines.of([box], MATRIX, PART)
    assert np.isfinite(outlines.sides).all()
    assert inside(outlines, np.array([[100.0, 60.0]]))[0] > 0.0


def test_the_nearest_of_many_cubes_are_kept():
    boxes = [box_at((0, 0, 0), (0, 0, 0.9 - 0.05 * number)) for number in range(MAX_CUBES + 2)]
    outlines = CubeOutlines.of(boxes, MATRIX, PART)
    assert outlines.count == MAX_CUBES
    np.testing.assert_array_equal(
        outlines.sides[0], CubeOutlines.of(boxes[-1:], MATRIX, PART).sides[0]
    )
