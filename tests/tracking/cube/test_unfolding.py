"""The net folds to exactly the cube that the tracker looks for."""

import math
from itertools import combinations

import cv2
import numpy as np
import pytest

from cubeling.tracking.cube.model import FACE_AXES, CubeModel, bundled_cubes, face_corners
from cubeling.tracking.cube.printing.unfolding import Unfolding
from tests.tracking.cube.folding import cube_from_face, cube_from_tab

EDGE = 0.06


def carried(matrix, points):
    """Points (N, 2) in the plane of the paper, moved by a transform, (N, 3)."""
    flat = np.column_stack([points, np.zeros(len(points)), np.ones(len(points))])
    return (flat @ matrix.T)[:, :3]


@pytest.mark.parametrize("name", bundled_cubes())
def test_the_folded_net_has_every_marker_where_the_model_has_it(name):
    cube = CubeModel.load(name)
    net = Unfolding(cube.edge)
    assert {face.name for face in cube.faces} == set(FACE_AXES)
    for face in cube.faces:
        printed = face_corners("front", face.roll_deg, cube.marker_size, 0.0)[:, :2]
        folded = carried(cube_from_face(net, face.name), printed)
        np.testing.assert_allclose(folded, face.corners, rtol=0, atol=1e-12)


def test_the_flat_net_has_the_faces_where_the_paper_shows_them():
    net = Unfolding(EDGE)
    for face in FACE_AXES:
        flat = cube_from_face(net, face, angle=0.0)
        np.testing.assert_allclose(flat[:3, :3], np.eye(3), atol=1e-15)
        np.testing.assert_allclose(flat[:2, 3], net.centre(face), atol=1e-15)


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.0, math.pi / 2])
def test_faces_stay_joined_at_their_hinges_while_they_fold(angle):
    net = Unfolding(EDGE)
    for start, end in net.folds():
        middle = (start + end) / 2
        places = []
        for face in FACE_AXES:
            local = middle - net.centre(face)
            if np.abs(local).max() < EDGE / 2 + 1e-9:
                places.append(carried(cube_from_face(net, face, angle), local[None])[0])
        for one, other in combinations(places, 2):
            np.testing.assert_allclose(one, other, atol=1e-12)


def folded_tabs(net):
    for tab in net.tabs():
        across = {"right": (1, 0), "up": (0, 1), "left": (-1, 0), "down": (0, -1)}[tab.side]
        fold = net.centre(tab.face) + EDGE / 2 * np.array(across)
        yield tab, carried(cube_from_tab(net, tab), tab.corners - fold)


def test_every_tab_ends_under_the_face_it_is_glued_to():
    net = Unfolding(EDGE)
    for tab, corners in folded_tabs(net):
        inside = np.linalg.inv(cube_from_face(net, tab.under))
        local = corners @ inside[:3, :3].T + inside[:3, 3]
        np.testing.assert_allclose(local[:, 2], 0, atol=1e-12)
        assert np.abs(local[:, :2]).max() <= EDGE / 2 + 1e-12


def test_tabs_under_one_face_do_not_overlap():
    net = Unfolding(EDGE)
    under: dict[str, list[np.ndarray]] = {}
    for tab, corners in folded_tabs(net):
        inside = np.linalg.inv(cube_from_face(net, tab.under))
        local = (corners @ inside[:3, :3].T + inside[:3, 3])[:, :2]
        under.setdefault(tab.under, []).append((local * 1000).astype(np.float32))
    assert len(under["top"]) == len(under["bottom"]) == 3
    for tabs in under.values():
        for one, other in combinations(tabs, 2):
            area, _ = cv2.intersectConvexConvex(one, other)
            assert area < 1e-3


def test_every_edge_of_the_cube_is_either_folded_or_glued():
    net = Unfolding(EDGE)
    held: dict[tuple[int, ...], list[str]] = {}
    for start, end in net.folds():
        middle = (start + end) / 2
        face = min(FACE_AXES, key=lambda name: np.abs(middle - net.centre(name)).max())
        place = carried(cube_from_face(net, face), (middle - net.centre(face))[None])[0]
        held.setdefault(tuple(np.rint(place * 1e6).astype(int)), []).append(face)
    assert len(held) == 12
    assert all(len(faces) == 1 for faces in held.values())


def test_the_outline_encloses_the_faces_and_tabs_and_nothing_else():
    net = Unfolding(EDGE)
    x, y = net.outline().T
    area = np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2
    tabs = sum(
        (np.linalg.norm(t.corners[3] - t.corners[0]) + np.linalg.norm(t.corners[2] - t.corners[1]))
        / 2
        * 0.18
        * EDGE
        for t in net.tabs()
    )
    assert area == pytest.approx(6 * EDGE**2 + tabs, rel=1e-12)
