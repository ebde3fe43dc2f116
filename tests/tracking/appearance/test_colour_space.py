"""The quick CIELab is what CIELab is for."""

import cv2
import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB, lab
from tests.bench.hand_scenes import SKINS


def cielab(image: np.ndarray) -> np.ndarray:
    """OpenCV's L + 16 in bytes, a and b, without its rounding, (3, h, w)."""
    light, a, b = cv2.split(cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_BGR2LAB))
    return np.stack([(light + 16) * 2.55, a, b])


def test_grey_is_as_in_cielab():
    greys = np.repeat(np.arange(256, dtype=np.uint8)[:, None, None], 3, axis=2)
    assert np.abs(lab(greys) - cielab(greys)).max() < 0.6


@pytest.mark.parametrize("skin", SKINS.values())
def test_skin_is_nearly_as_in_cielab(skin):
    colour = np.array([int(skin[first : first + 2], 16) for first in (4, 2, 0)], np.uint8)
    assert np.abs(lab(colour[None, None]) - cielab(colour[None, None])).max() < 4.0


@given(
    colour=st.lists(st.integers(90, 255), min_size=3, max_size=3),
    light=st.floats(0.3, 1.0),
)
def test_light_scales_lightness_and_chroma_by_one_factor(colour, light):
    lit = np.array(colour, np.uint8)
    shaded = np.interp(light * LINEAR_FROM_SRGB[lit], LINEAR_FROM_SRGB, np.arange(256))
    expected = np.cbrt(light) * lab(lit[None, None])
    # Half a level of rounding is at most two units of chroma.
    rounded = np.rint(shaded).astype(np.uint8)[None, None]
    assert np.abs(lab(rounded) - expected).max() < 3.0
