"""JPEG headers are read before the pixels: what claims too much is refused, and nothing raises."""

import struct

import cv2
import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.tracking.sources.device import (
    MAX_IMAGE_PX,
    decode_jpeg,
    is_cut_short,
    is_decodable,
    jpeg_size,
)
from cubeling.tracking.sources.webcam.camera_controls import brightness
from tests.tracking.sources.live import SIZE, claims, jpeg


@pytest.mark.parametrize(
    "flags", [(), (cv2.IMWRITE_JPEG_PROGRESSIVE, 1)], ids=["plain", "progressive"]
)
def test_the_size_is_read_from_the_header(flags):
    data = cv2.imencode(".jpg", np.zeros((48, 64, 3), np.uint8), flags)[1].tobytes()
    assert jpeg_size(data) == (64, 48)


def test_a_small_picture_within_the_exif_data_is_skipped():
    thumbnail = jpeg(0)
    segment = b"\xff\xe1" + struct.pack(">H", len(thumbnail) + 2) + thumbnail
    large = cv2.imencode(".jpg", np.zeros((480, 640, 3), np.uint8))[1].tobytes()
    assert jpeg_size(large[:2] + segment + large[2:]) == (640, 480)


@pytest.mark.parametrize("size", [(65000, 65000), (65535, 1100), (0, 48), (64, 0)])
def test_a_header_that_claims_too_much_or_nothing_is_refused(size):
    data = claims(jpeg(0), size)
    assert jpeg_size(data) == size
    assert not is_decodable(data)
    assert decode_jpeg(data) is None
    assert brightness(data) == 0.0


def test_the_largest_cameras_are_read():
    assert MAX_IMAGE_PX > 7680 * 4320
    assert is_decodable(claims(jpeg(0), (7680, 4320)))


@given(st.integers(0, len(jpeg(0)) - 1), st.binary(max_size=4), st.integers(0, 4))
def test_no_mutation_of_a_jpeg_raises(position, put, removed):
    data = jpeg(0)
    mutated = data[:position] + put + data[position + removed :]
    jpeg_size(mutated)
    if is_decodable(mutated) and jpeg_size(mutated) == SIZE:
        decode_jpeg(mutated)


@pytest.mark.parametrize("quality", [30, 95])
@pytest.mark.parametrize("grey", [0, 128])
def test_only_an_image_with_missing_data_is_cut_short(quality, grey):
    """One that is grey at its corners, as libjpeg fills what is missing, is whole all the same."""
    image = np.full((96, 128, 3), grey, np.uint8)
    image[20:60] = np.random.default_rng(0).integers(0, 255, (40, 128, 3))
    whole = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()
    decoded = decode_jpeg(whole)
    assert decoded is not None
    assert not is_cut_short(whole, decoded)
    for share in (0.7, 0.95):
        cut = whole[: int(share * len(whole))] + b"\xff\xd9"
        decoded = decode_jpeg(cut)
        assert decoded is not None
        assert is_cut_short(cut, decoded)
