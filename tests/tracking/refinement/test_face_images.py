"""The drawn faces are blurred as a lens blurs them: round in the picture, not on the paper."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.refinement.photometry.motion_blur_alignment import FaceTextures

Array = NDArray[np.float64]
Image = NDArray[np.float32]

CUBE = CubeModel.load("locomotion")
SIDE = 64
DRAWING = FaceTextures(CUBE, SIDE)

SQUARE = np.diag([1.5, 1.5])
LEANING = np.diag([1.5, 0.75])
"""How the picture [px] moves with the texels: square on, and leaning back by 60°."""

ROLLED = np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]]) @ LEANING
SHEARED = np.array([[1.2, 0.5], [-0.2, 0.8]])


def drawn(texels_to_pixels: Array, sigma: float, face: int = 0) -> tuple[Image, float]:
    """One face, (SIDE, SIDE, 3), and its widest blur [m]."""
    layers, widest = DRAWING.blur(np.array([face]), texels_to_pixels[None], sigma)
    return layers, float(widest[0])


def in_picture(texture: Image, texels_to_pixels: Array) -> Image:
    """See a texture through the affine map, its middle in the middle, (160, 160)."""
    middle = (SIDE - 1) / 2
    shift = np.array([79.5, 79.5]) - texels_to_pixels @ [middle, middle]
    affine = np.column_stack([texels_to_pixels, shift])
    border = cv2.BORDER_CONSTANT
    return np.asarray(cv2.warpAffine(texture, affine, (160, 160), None, cv2.INTER_CUBIC, border, 1))


def blurred(picture: Image, sigma: float) -> Image:
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), sigma), np.float32)


@pytest.mark.parametrize("seen", [SQUARE, LEANING, ROLLED, SHEARED])
@pytest.mark.parametrize("sigma", [1.5, 3.0])
def test_a_blurred_texture_looks_like_an_image_that_the_camera_blurs(
    seen: Array, sigma: float
) -> None:
    for face in range(len(CUBE.faces)):
        # Both are seen through the same map, whose own little blur is therefore in both.
        sharp = in_picture(drawn(seen, 0.3, face)[0][..., 0].copy(), seen)
        wanted = blurred(sharp, float(np.sqrt(sigma**2 - 0.3**2)))
        got = in_picture(drawn(seen, sigma, face)[0][..., 0].copy(), seen)
        assert np.abs(got - wanted).max() < 0.03
        on_paper = blurred(drawn(seen, 0.3, face)[0][..., 0].copy(), sigma / 1.5)
        if seen is not SQUARE:
            assert np.abs(in_picture(on_paper, seen) - wanted).max() > 0.08


def variances(texels_to_pixels: Array, sigma: float) -> Array:
    """Variance of the blur to the right and down, from how much each frequency loses, (2,) [px²].

    A Gaussian leaves exp(−(2π f s)²/2) of a frequency f [1/texel].
    """
    sharp, soft = (
        np.abs(np.fft.fft2(drawn(texels_to_pixels, width)[0][..., 0].astype(np.float64)))
        for width in (0.3, sigma)
    )
    spread = []
    for row in (sharp[0] / soft[0], sharp[:, 0] / soft[:, 0]):
        spread.append(2 * np.log(row[2]) / (2 * np.pi * 2 / SIDE) ** 2)
    return np.array(spread)


def test_a_face_tilted_by_sixty_degrees_is_blurred_twice_as_much_along_its_tilt() -> None:
    across, along = np.sqrt(variances(LEANING, 1.5))
    assert across == pytest.approx(1.0, rel=0.03)
    assert along == pytest.approx(2.0, rel=0.03)
    assert np.sqrt(variances(SQUARE, 1.5)) == pytest.approx([1.0, 1.0], rel=0.03)


def test_the_widest_blur_is_in_metres() -> None:
    texel = CUBE.edge / SIDE
    assert drawn(SQUARE, 1.5)[1] == pytest.approx(texel)
    assert drawn(LEANING, 1.5)[1] == pytest.approx(2 * texel)
    assert drawn(ROLLED, 1.5)[1] == pytest.approx(2 * texel)


@pytest.mark.parametrize("seen", [SQUARE, ROLLED])
def test_the_derivatives_are_those_of_the_texture(seen: Array) -> None:
    layers = drawn(seen, 2.5)[0].astype(np.float64)
    right = (layers[:, 2:, 0] - layers[:, :-2, 0]) / 2
    down = (layers[2:, :, 0] - layers[:-2, :, 0]) / 2
    assert np.abs(layers[:, 1:-1, 1] - right).max() < 0.02
    assert np.abs(layers[1:-1, :, 2] - down).max() < 0.02
    assert np.abs(layers[..., 1]).max() > 0.1


def test_blur_keeps_the_light_and_the_paper_white() -> None:
    sharp, soft = (drawn(ROLLED, sigma)[0][..., 0] for sigma in (0.3, 3.0))
    assert soft.mean() == pytest.approx(sharp.mean(), abs=1e-4)
    assert sharp[:5].min() > 0.97
    assert -0.01 < soft.min() < soft.max() < 1.01


def test_faces_are_stacked_each_blurred_by_its_own_tilt() -> None:
    seen = np.stack([SQUARE, LEANING, ROLLED])
    layers, widest = DRAWING.blur(np.array([4, 0, 2]), seen, 1.5)
    assert layers.shape == (3 * SIDE, SIDE, 3)
    for number, face in enumerate((4, 0, 2)):
        alone, spread = drawn(seen[number], 1.5, face)
        assert np.allclose(layers[number * SIDE : (number + 1) * SIDE], alone, atol=1e-6)
        assert widest[number] == pytest.approx(spread)
