"""A soak says nothing of what fluctuates, and finds what grows."""

from collections import deque

from tests.campaigns.soak import growth, soak, weight


def test_what_fluctuates_has_not_grown():
    assert growth("objects held", [400, 415, 449, 402] * 6) == []


def test_what_grows_a_little_every_hour_is_found():
    assert growth("objects held", [400 + 50 * hour for hour in range(24)]) != []
    assert growth("bytes held", [30_000 + 2_000 * hour for hour in range(24)]) != []


def test_what_is_held_anywhere_is_weighed():
    inner: deque[bytes] = deque([bytes(1000)], maxlen=5)
    assert weight({"a": [inner]})[1] > 1000
    assert weight({"a": [inner]}, logs=False)[1] < 1000


def test_a_short_soak_ends_with_the_last_wish_fulfilled():
    assert soak("cubeling", hours=0.02).wrong == []
