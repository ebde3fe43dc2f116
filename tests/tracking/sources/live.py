"""Pictures, a clock and a check that the tests of cameras and phones share."""

import itertools
import struct

import cv2
import numpy as np
import pytest

from cubeling.tracking import TrackingError

SIZE = (64, 48)


def picture(number):
    image = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    cv2.circle(image, (8 + number % 40, 24), 6, (40, 200, 250), -1)
    return image


def jpeg(number):
    return cv2.imencode(".jpg", picture(number))[1].tobytes()


def claims(data, size):
    """Return a JPEG whose header claims another width and height."""
    start = data.index(b"\xff\xc0") + 5
    return data[:start] + struct.pack(">HH", size[1], size[0]) + data[start + 4 :]


def fast_clock(step=0.25):
    """A clock that advances with every reading, so that seconds pass in milliseconds."""
    ticks = itertools.count()
    return lambda: next(ticks) * step


def fails(make, words):
    with pytest.raises(TrackingError) as caught:
        make()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
