"""Points are drawn where OpenCV projects them, to a fraction of a pixel."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import SceneCharacter, Stage
from cubeling.characters.rendering.projection import (
    Rectangle,
    bounding_rectangle,
    clip_from_camera,
    is_invertible,
)

MATRIX = np.array([[310.0, 0.7, 158.2], [0.0, 305.0, 92.4], [0.0, 0.0, 1.0]])


@given(
    point=st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.1, 5)),
    corner=st.tuples(st.integers(-50, 200), st.integers(-50, 200)),
    size=st.tuples(st.integers(1, 400), st.integers(1, 400)),
)
def test_clip_space_matches_the_pinhole_with_integer_pixel_centres(point, corner, size):
    part = Rectangle(*corner, *size)
    clip = clip_from_camera(MATRIX, part) @ [*point, 1.0]
    window = (clip[:2] / clip[3] + 1.0) / 2.0 * np.array(size)
    pixel = MATRIX[:2] @ (np.array(point) / point[2])
    assert window == pytest.approx(pixel + 0.5 - np.array(corner), abs=1e-6)


@pytest.mark.parametrize("at", [(0.0, 0.0), (-0.1, 0.04), (0.11, -0.05)])
def test_a_square_is_drawn_where_opencv_projects_it(ctx, view, pawn, at):
    """The centre of mass of a small white square, coverage by coverage, is where OpenCV puts it."""
    square = np.array([[0, 0.5, 0], [2, 2.1, 0], [0.4, 4.5, 0], [-1.6, 2.9, 0]], np.float32)
    mesh = replace(
        pawn.meshes[0],
        positions=square,
        normals=np.tile(np.array([0, 0, 1], np.float32), (4, 1)),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.uint32),
        joints=np.zeros((4, 4), np.uint16),
        weights=np.tile(np.array([1, 0, 0, 0], np.float32), (4, 1)),
        material=Material(base_color=(99.0, 99.0, 99.0, 1.0), double_sided=True),
    )
    view = replace(view, image=np.zeros_like(view.image), matrix=MATRIX)
    actor = pawn.posed(at=at, height=0.008)
    stage = Stage(ctx, (320, 180))
    picture = stage.draw(view, [SceneCharacter(replace(pawn, meshes=(mesh,)), actor.posed)])
    stage.release()
    weight = picture.astype(float).sum(axis=2)
    total = weight.sum()
    drawn = [(weight.sum(axis=0) @ np.arange(320)), (weight.sum(axis=1) @ np.arange(180))] / total

    table, pose = actor.posed.table_from_character, view.camera_from_table
    corners = square @ table[:3, :3].T + table[:3, 3]
    rotation = cv2.Rodrigues(pose[:3, :3])[0]
    pixels, _ = cv2.projectPoints(corners, rotation, pose[:3, 3], MATRIX, None)
    outline = pixels.reshape(-1, 2)
    depths = corners @ pose[1:3, :3].T + pose[1:3, 3]
    outline[:, 0] += MATRIX[0, 1] * depths[:, 0] / depths[:, 1]  # OpenCV knows no skew here
    moments = cv2.moments(outline.astype(np.float32))
    centre = np.array([moments["m10"], moments["m01"]]) / moments["m00"]
    assert drawn == pytest.approx(centre, abs=0.05)


def test_a_point_behind_the_camera_needs_the_whole_picture():
    points = np.array([[0, 0, 1.0], [0, 0, -1.0]])
    assert bounding_rectangle(points, MATRIX, np.eye(4), (320, 180)) == Rectangle(0, 0, 320, 180)
    assert bounding_rectangle(points[1:], MATRIX, np.eye(4), (320, 180)) is None
    assert bounding_rectangle(points[:0], MATRIX, np.eye(4), (320, 180)) is None


@pytest.mark.parametrize("scale", [1e-7, 1e-4, 1.0, 1e5])
def test_a_small_scale_is_not_singular(scale):
    """A body of 1700 units, as one in millimetres is, comes to the table at a ten-thousandth."""
    assert is_invertible(np.diag([scale, scale, scale, 1.0]))
    assert not is_invertible(np.diag([scale, 0.0, scale, 1.0]))
    flat = np.eye(4)
    flat[:3, :3] = scale * np.array([[1, 0, 1], [0, 1, 1], [1, 1, 2]])
    assert not is_invertible(flat)
