"""What is in the character's way, as far as the cube tells."""

from dataclasses import replace

import numpy as np

from cubeling.app.pipeline.table.obstacles import (
    KEPT_S,
    LETS_GO_S,
    Obstacles,
    is_leftmost,
    view_of,
)
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.tracking import CubeControls, CubeState, Intrinsics

EDGE = 0.06
TABLE = np.eye(4)
TABLE[:3, :3] = np.diag([1.0, -1.0, -1.0])  # a camera that looks along −z of the table
TABLE[2, 3] = 0.5


def frame(time, *, visible=True, moving=False, resting=True):
    velocity = np.zeros(6)
    velocity[0] = 0.1 * moving
    pose = TABLE @ np.eye(4)
    state = CubeState(
        visible, pose if visible else None, velocity, np.eye(6), "markers", (), 0.1, time
    )
    controls = CubeControls(
        visible, "top", 0.0, 0.0, 0.0, resting, False, False, np.zeros(2), time, TABLE
    )
    return state, controls


def test_a_cube_that_is_let_go_of_is_there_without_an_arm():
    obstacles = Obstacles(EDGE)
    assert len(obstacles.update(*frame(0.0, moving=True))) == 2
    assert len(obstacles.update(*frame(0.5 * LETS_GO_S))) == 2
    (cube,) = obstacles.update(*frame(LETS_GO_S + 0.1))
    np.testing.assert_allclose(cube.table_from_box, np.eye(4), atol=1e-12)
    assert len(obstacles.update(*frame(LETS_GO_S + 0.2, resting=False))) == 2


def test_velocities_are_those_over_the_table():
    cube, arm = Obstacles(EDGE).update(*frame(0.0, moving=True))
    np.testing.assert_allclose(cube.velocity, [0.1, 0.0, 0.0])
    np.testing.assert_array_equal(arm.velocity, cube.velocity)
    assert not arm.holds(cube.corners[[0, 4]])  # of the bottom


def test_a_cube_that_is_hidden_for_a_moment_is_still_there():
    obstacles = Obstacles(EDGE)
    obstacles.update(*frame(0.0))
    assert obstacles.update(*frame(0.5 * KEPT_S, visible=False))
    assert not obstacles.update(*frame(KEPT_S + 0.1, visible=False))


def test_the_view_has_the_edges_of_the_picture():
    camera = Intrinsics.guess((640, 480))
    _, controls = frame(0.0)
    view = view_of(controls, camera)
    assert view is not None
    np.testing.assert_allclose(view.eye, [0.0, 0.0, 0.5], atol=1e-12)
    beyond = 0.5 * 321 / camera.matrix[0, 0]
    points = np.array([[0.0, 0, 0], [beyond, 0, 0], [0.99 * beyond, 0, 0], [0, 0, 0.6]])
    assert view.misses(points, ()).tolist() == [False, True, False, True]
    assert view_of(replace(controls, camera_from_table=None), camera) is None


def test_two_players_hold_their_cubes_from_the_outer_sides():
    cubes = []
    for place in ([-0.1, 0.0], [0.1, 0.0], None):
        state, controls = frame(0.0, moving=True)
        position = None if place is None else np.array(place)
        cubes.append(SeenCube(state, replace(controls, position=position)))
    left, right, unplaced = cubes
    assert [is_leftmost(each, cubes) for each in cubes] == [True, False, False]
    assert not is_leftmost(left, [left]), "who plays alone is right-handed"
    assert not is_leftmost(left, [left, unplaced])
    for cube, side in ((left, -1.0), (right, 1.0)):
        leftmost = is_leftmost(cube, cubes)
        _, arm = Obstacles(EDGE).update(cube.state, cube.controls, from_left=leftmost)
        assert np.sign(arm.table_from_box[0, 3]) == side
        assert not arm.holds(np.zeros((1, 3))), "it leaves the cube free"
