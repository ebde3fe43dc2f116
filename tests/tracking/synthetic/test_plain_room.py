"""The room that is drawn where no picture was recorded, against the tracker."""

import numpy as np
import pytest

from cubeling.tracking import CubeModel, CubeTracker, Frame, PlainRoom
from cubeling.tracking.synthetic import open_synthetic


@pytest.fixture(scope="module")
def source():
    return open_synthetic("companion?width=640&height=360")


def test_the_cube_is_drawn_where_it_was(source):
    pose = source.truth(0)
    room = PlainRoom(source.intrinsics, [source.cube])
    image = room.draw(source.camera_from_table, [pose])
    assert image.shape == (360, 640, 3)
    found = CubeTracker(source.cube, source.intrinsics).update(Frame(image, 0.0, 0))
    assert found.visible
    assert found.camera_from_cube is not None
    away = np.abs(found.camera_from_cube[:3, 3] - pose[:3, 3])
    # A pixel there is 1.4 mm; depth is known less well than what lies across.
    assert (away < (0.0007, 0.0007, 0.006)).all()
    assert np.abs(found.camera_from_cube[:3, :3] - pose[:3, :3]).max() < 0.02


def test_the_ground_has_lines_once_the_table_is_known_and_none_that_the_lens_folds_back(source):
    room = PlainRoom(source.intrinsics, [source.cube])
    empty = room.draw(None, [None])
    assert empty.std() == 0.0
    lined = room.draw(source.camera_from_table, [None])
    assert lined.mean() > 0.95 * empty.mean()
    assert (lined < empty).any(axis=1).mean() > 0.5  # in most rows there is a line
    # The camera looks over the far end of the table at the wall: nothing is drawn there.
    level = source.camera_from_table.copy()
    level[:3, :3] = np.diag([1.0, -1.0, -1.0])  # it looks along the table
    level[:3, 3] = 0.0, 0.37, 0.53
    above = room.draw(level, [None])[:150]
    assert above.std() == 0.0


def test_a_picture_depends_on_its_poses_alone(source):
    one, other = PlainRoom(source.intrinsics, [source.cube]), None
    turned = source.camera_from_table.copy()
    turned[:3, 3] += 0.05
    for table in (None, turned, source.camera_from_table):
        other = one.draw(table, [source.truth(3)])
    fresh = PlainRoom(source.intrinsics, [source.cube])
    assert (fresh.draw(source.camera_from_table, [source.truth(3)]) == other).all()


def test_the_nearer_of_two_cubes_hides_the_other(source):
    cubes = [source.cube, CubeModel.load("locomotion")]
    near, far = np.eye(4), np.eye(4)
    near[2, 3], far[2, 3] = 0.4, 0.6
    room = PlainRoom(source.intrinsics, cubes)
    alone = PlainRoom(source.intrinsics, cubes[:1]).draw(None, [near])
    assert (room.draw(None, [near, far]) == alone).all()
