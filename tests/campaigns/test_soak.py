"""A soak ignores fluctuations, and detects growth."""

from collections import deque

import pytest

from tests.campaigns.soak import growth, soak, weight

pytestmark = pytest.mark.full


def test_fluctuations_are_not_growth():
    assert growth("objects held", [400, 415, 449, 402] * 6) == []


def test_slow_growth_is_detected():
    assert growth("objects held", [400 + 50 * hour for hour in range(24)]) != []
    assert growth("bytes held", [30_000 + 2_000 * hour for hour in range(24)]) != []


def test_nested_objects_are_counted():
    inner: deque[bytes] = deque([bytes(1000)], maxlen=5)
    assert weight({"a": [inner]})[1] > 1000
    assert weight({"a": [inner]}, logs=False)[1] < 1000


def test_a_short_soak_ends_with_the_last_request_acknowledged():
    assert soak("cubeling", hours=0.02).wrong == []
