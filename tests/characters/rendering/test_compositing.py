"""What is changed in the picture in memory: shadows on the table, blur and noise of characters."""

from types import SimpleNamespace

import numpy as np
import pytest

from cubeling.characters.rendering.passes.resolve import MAX_BLUR_PX, OWN_BLUR_PX, blur_picture
from cubeling.characters.rendering.passes.table_factors import darken
from cubeling.characters.rendering.passes.table_image import TableImage
from cubeling.characters.rendering.projection import Rectangle, project

MATRIX = np.array([[300.0, 0.0, 159.5], [0.0, 300.0, 89.5], [0.0, 0.0, 1.0]])
HEIGHT_M = 0.3
"""Of the camera above the table."""


def frame(pitch):
    """A white picture of a table, seen by a camera that looks down by `pitch` [rad]."""
    table = np.eye(4)
    table[1, 1:3] = -np.cos(pitch), np.sin(pitch)
    table[2, 1:3] = -np.sin(pitch), -np.cos(pitch)
    table[:3, 3] = table[:3, :3] @ [0.0, -HEIGHT_M, 0.0]
    return SimpleNamespace(
        haze=None,
        picture=np.full((180, 320, 3), 255, np.uint8),
        camera_matrix=MATRIX,
        camera_from_table=table,
        hidden_by_cubes=(),
        area_of=lambda points: Rectangle(0, 0, 320, 180),
    )


@pytest.mark.parametrize("pitch", [0.4, 0.8])
def test_each_texel_of_a_shadow_lies_where_the_camera_sees_its_place(pitch):
    seen = frame(pitch)
    bgr = np.full((9, 9, 3), 255, np.uint8)
    bgr[3, 6] = 0
    texel, corner = 0.02, (-0.05, -HEIGHT_M / np.tan(pitch) - 0.09)
    darken(seen, None, TableImage(bgr, corner, texel))
    place = np.array([corner[0] + 6.5 * texel, 0.0, corner[1] + 3.5 * texel, 1.0])
    expected = project((seen.camera_from_table @ place)[:3], MATRIX)
    dark = 255.0 - seen.picture[..., 0]
    rows, columns = np.mgrid[:180, :320]
    center = [(dark * columns).sum() / dark.sum(), (dark * rows).sum() / dark.sum()]
    assert center == pytest.approx(expected, abs=0.6)


def test_a_shadow_behind_the_camera_is_not_seen_in_the_sky():
    seen = frame(0.1)
    black = np.zeros((20, 20, 3), np.uint8)
    darken(seen, None, TableImage(black, (-5.0, 0.2), 0.5))  # +z is towards the viewer
    assert seen.picture[:40].min() == 255


@pytest.mark.parametrize("blur", [0.4, 0.64, 0.75, 1.0, MAX_BLUR_PX])
def test_what_is_drawn_gets_the_blur_of_the_picture(blur):
    line = np.zeros((41, 41, 4), np.uint8)
    line[:, 20] = 255
    across = blur_picture(line, blur)[20, :, 0].astype(float)
    places = np.arange(41) - 20
    variance = (across * places**2).sum() / across.sum()
    assert variance == pytest.approx(blur**2 - OWN_BLUR_PX**2, rel=0.06, abs=0.01)


def test_in_sharp_pictures_characters_stay_as_they_are():
    layer = np.random.default_rng(1).integers(0, 256, (20, 30, 4)).astype(np.uint8)
    assert np.array_equal(blur_picture(layer, 0.2), layer)
