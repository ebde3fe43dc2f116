"""Grey values between the pixels are what they should be, to a thousandth of a pixel."""

import numpy as np
import pytest

from cubeling.tracking.geometry.image_region import Patch


def test_grey_values_between_pixels_are_linear() -> None:
    """Bytes would be rounded to 1/32 px by `remap`, and so would 32 bit floats in OpenCV 4."""
    rows, columns = np.mgrid[0:20, 0:30]
    patch = Patch.crop((3 * columns + 2 * rows).astype(np.uint8))
    places = np.random.default_rng(0).uniform([0, 0], [28, 18], (50, 2))
    assert np.allclose(patch.sample(places[:, None])[:, 0], places @ [3, 2], atol=1e-4)


def test_a_cropped_patch_has_the_same_coordinates() -> None:
    image = np.random.default_rng(1).integers(0, 256, (40, 60, 3), dtype=np.uint8)
    whole, part = Patch.crop(image), Patch.crop(image, (10, 5, 50, 35))
    places = np.random.default_rng(2).uniform([12, 7], [47, 32], (9, 4, 2))
    assert np.allclose(whole.sample(places), part.sample(places), atol=1e-3)


def test_border_distance_is_that_to_the_nearest_border() -> None:
    patch = Patch(np.zeros((30, 40), np.float32), 10, 5)
    room = patch.border_distance(np.array([[12.0, 20.0], [30.0, 33.5], [9.0, 20.0]]))
    assert room == pytest.approx([2.0, 0.5, -1.0])
