"""Real cubes and the hand hide the table behind them."""

import cv2
import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.rendering import Box
from cubeling.characters.rendering.camera_picture.hand_cover import PictureCover, covered_area
from cubeling.characters.rendering.camera_picture.hidden_table import hidden_table
from cubeling.characters.rendering.camera_picture.occlusion import UNIT_CUBE, hidden_by_cube
from cubeling.characters.rendering.projection import Rectangle
from cubeling.tracking.appearance import HandMask

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


def mask(box):
    """Return what a box hides of the part, 0…1."""
    return hidden_by_cube(box, MATRIX, PART) / 255.0


coordinate = st.floats(-1.5, 1.5)


@given(st.tuples(coordinate, coordinate, coordinate), st.floats(0.35, 0.9))
def test_a_cube_hides_the_pixels_of_its_faces(turn, depth):
    box = box_at(turn, (0.0, 0.0, depth))
    corners = box.edge * UNIT_CUBE @ box.camera_from_box[:3, :3].T + box.camera_from_box[:3, 3]
    pixels = (corners / corners[:, 2:]) @ MATRIX[:2].T - [PART.x, PART.y]
    faces = np.zeros((PART.height, PART.width), np.uint8)
    for triangle in pixels.reshape(-1, 3, 2):
        cv2.fillConvexPoly(faces, np.rint(16 * triangle).astype(np.int32), 255, shift=4)
    hidden = mask(box)
    assert hidden[cv2.erode(faces, np.ones((5, 5))) > 0].min() == 1.0
    assert hidden[cv2.dilate(faces, np.ones((5, 5))) == 0].max() == 0.0


def test_the_edge_of_a_cube_is_soft_over_one_pixel():
    hidden = mask(box_at((0, 0, 0), (0.0, 0.0005, 0.5)))
    row = hidden[PART.height // 2]
    assert ((row > 0) & (row < 1)).sum() <= 2
    assert row.sum() == pytest.approx(0.06 * 300.0 / 0.47, abs=0.01)


def test_a_cube_behind_the_camera_is_clipped_at_the_near_plane():
    hidden = mask(box_at((0.3, 0.5, 0.1), (0.0, 0.0, 0.03)))
    assert hidden[60, 100] == 1.0


@pytest.mark.parametrize("scale", [1, 2, 5])
def test_a_hand_is_the_same_without_a_lens_and_with_one_that_bends_nothing(scale):
    share = np.random.default_rng(scale).integers(0, 256, (24, 31), np.uint8)
    cover = HandMask(35, 10, share, np.array([0.0, 0.0, 0.5]), scale, 2.0)
    rows, columns = np.mgrid[:180, :320].astype(np.float32)
    plain, bent = (
        PictureCover(covered_area(cover), cover, maps) for maps in (None, (columns, rows))
    )
    assert np.array_equal(plain.share_in(PART), bent.share_in(PART))


def test_a_cube_and_a_hand_hide_the_table_independently_of_each_other():
    box = box_at((0, 0, 0), (0.0, 0.0, 0.5))
    place = Rectangle(110, 60, 100, 60)
    cover = HandMask(155, 70, np.full((40, 90), 128, np.uint8), np.array([0.0, 0.0, 0.5]))
    cube = place, hidden_by_cube(box, MATRIX, place)
    hand = PictureCover(covered_area(cover), cover, None)
    hidden = hidden_table([cube], hand, PART)
    assert hidden is not None
    of_cube = mask(box)
    assert hidden[69, 110] == 255  # on the cube, beside the hand
    assert hidden[69, 125] == 255  # where both are
    only_hand = np.s_[50:90, 150:200]
    assert (of_cube[only_hand] == 0.0).all()
    assert (hidden[only_hand] == 128).all()
    assert hidden[5, 5] == 0
    assert hidden_table([], None, PART) is None
    assert hidden_table([cube], hand, Rectangle(0, 0, 20, 20)) is None
