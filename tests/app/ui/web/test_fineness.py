"""How finely pictures are encoded, over lines that carry so much."""

import itertools

import cv2
import numpy as np
import pytest

from cubeling.app.ui.web.fineness import FINENESSES, FinenessControl
from cubeling.app.ui.web.picture import encoded

SIZES = 130_000, 90_000, 45_000, 18_000
"""Bytes of a picture of each fineness."""

RATE, IN_FLIGHT = 30, 2


def levels_over(
    megabits: float, seconds: float, rate: float = RATE, down: tuple[float, float] = (0.0, 0.0)
) -> list[int]:
    """Return the level at each picture over a line of a capacity, which may be down."""
    control, free, found = FinenessControl(), 0.0, []
    sent: list[tuple[float, float]] = []
    for number in range(round(seconds * rate)):
        now = number / rate
        while sent and sent[0][1] <= now:
            began, ended = sent.pop(0)
            control.shown(ended - began)
        control.offer(now)
        if len(sent) < IN_FLIGHT and not down[0] <= now < down[1]:
            free = max(free, now) + SIZES[control.level] / (megabits * 1e6 / 8)
            sent.append((now, free))
        found.append(control.level)
    return found


@pytest.mark.parametrize(
    ("megabits", "rate", "best"),
    [(60.0, 30, 0), (20.0, 30, 1), (14.0, 30, 2), (6.0, 30, 3), (1.0, 30, 3), (5.0, 5, 1)],
)
def test_a_line_gets_pictures_that_it_carries_and_seldom_others(megabits, rate, best):
    found = levels_over(megabits, 120.0, rate)[20 * rate :]
    changes = sum(a != b for a, b in itertools.pairwise(found))
    assert np.mean(np.array(found) == best) > 0.8
    assert changes <= 12


def test_a_line_that_stood_still_gets_fine_pictures_again():
    found = levels_over(60.0, 60.0, down=(10.0, 20.0))
    assert found[-1] == 0
    assert max(found) <= 1


def test_each_fineness_has_fewer_bytes_than_the_one_before():
    noise = np.random.default_rng(1).integers(0, 255, (120, 160, 3), np.uint8)
    image = np.asarray(cv2.GaussianBlur(noise, (0, 0), 2), np.uint8)
    sizes = [len(encoded(image, each)) for each in FINENESSES]
    assert all(a > 1.2 * b for a, b in itertools.pairwise(sizes))
    small = cv2.imdecode(np.frombuffer(encoded(image, FINENESSES[-1]), np.uint8), cv2.IMREAD_COLOR)
    assert small is not None
    assert small.shape == (60, 80, 3)
