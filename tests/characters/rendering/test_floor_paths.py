"""Paths on the table: what is painted, and when."""

import time
from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.characters.rendering import FloorPath, Stage
from cubeling.characters.rendering.passes import floor_paths
from cubeling.characters.rendering.passes.floor_paths import MAX_SIDE_TEXELS
from cubeling.characters.rendering.passes.table_image import TableImage
from tests.characters.rendering.shapes import LOOP


def test_a_path_is_seen_from_where_the_camera_is_now(ctx, stage, view):
    moved = view.camera_from_table.copy()
    moved[:3, 3] += (0.02, -0.01, 0.05)
    changed = replace(LOOP, highlight=5)
    for camera_from_table, path in ((moved, LOOP), (view.camera_from_table, changed)):
        stage.draw(view, [], [LOOP])
        now = replace(view, camera_from_table=camera_from_table)
        fresh = Stage(ctx, (320, 180))
        assert np.array_equal(stage.draw(now, [], [path]), fresh.draw(now, [], [path]))
        fresh.release()


@pytest.fixture
def bent(monkeypatch):
    """What was asked for each time that an image on the table was bent."""
    calls, in_picture = [], TableImage.in_picture

    def noted(*given, **named):
        calls.append(given)
        return in_picture(*given, **named)

    monkeypatch.setattr(TableImage, "in_picture", noted)
    return calls


def test_a_path_is_bent_again_only_when_it_is_seen_to_move(stage, view, bent):
    path = FloorPath(np.array([(-0.05, 0.0), (0.05, 0.02)]))
    for right_m, times in ((0.0, 1), (1e-6, 1), (2e-6, 1), (1e-3, 2), (1e-3, 2)):
        moved = view.camera_from_table.copy()
        moved[0, 3] += right_m
        stage.draw(replace(view, camera_from_table=moved), [], [path])
        assert len(bent) == times


def test_a_still_path_that_begins_behind_the_camera_is_bent_once(stage, view, bent):
    path = FloorPath(np.array([(0.0, 0.0), (0.0, 2.0)]))
    for _ in range(3):
        stage.draw(view, [], [path])
    assert len(bent) == 1


def spot(number):
    """A path of one point."""
    return FloorPath(np.array([[0.02 * number - 0.1, 0.0]]))


@pytest.fixture
def painted(monkeypatch):
    """Sizes of the images of paths that are painted, (rows, columns)."""
    sizes = []

    def noted(pixels, *place):
        sizes.append(pixels.shape)
        return TableImage(pixels, *place)

    monkeypatch.setattr(floor_paths, "TableImage", noted)
    return sizes


def test_paths_are_painted_again_only_when_they_have_changed(stage, view, painted):
    paths = [spot(number) for number in range(12)]
    stage.draw(view, [], paths)
    stage.draw(view, [], [*paths[:-1], spot(20)])
    assert len(painted) == 12 + 1


def test_any_number_of_paths_is_painted(ctx, stage, view):
    spots = [spot(number) for number in range(12)]
    for paths in (spots[:1], spots, spots[3:5]):
        fresh = Stage(ctx, (320, 180))
        assert np.array_equal(stage.draw(view, [], paths), fresh.draw(view, [], paths))
        fresh.release()
    changed = (stage.draw(view, [], spots) != view.image).any(axis=2)
    assert cv2.connectedComponents(changed.astype(np.uint8))[0] - 1 == 12


def test_a_path_far_beyond_the_table_is_painted_in_no_time(stage, view):
    far = replace(LOOP, points=np.array([[0.0, 0.0], [1e9, -1e9], [0.05, 0.0]]))
    started = time.perf_counter()
    stage.draw(view, [], [far])
    assert time.perf_counter() - started < 1.0


@pytest.mark.parametrize("length_m", [7.94, 7.97, 1e9])
def test_the_image_of_a_path_has_a_longest_side(stage, view, painted, length_m):
    """The first length just fits at a power of two, the second needs the next one."""
    stage.draw(view, [], [replace(LOOP, points=np.array([[0.0, 0.0], [length_m, 0.0]]))])
    assert max(painted[0]) <= MAX_SIDE_TEXELS
