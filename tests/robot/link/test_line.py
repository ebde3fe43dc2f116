"""A line does the harm that it is told to, so often, and none besides."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.simulators.faults import Faults
from robot.simulators.line import IN_FLIGHT_MAX, SPLIT_GAP, Line

FRAME = b"\0frame 12\0"


def line(**faults) -> Line:
    return Line(Faults(**faults), b"\0", (3, 0))


@pytest.mark.parametrize("kind", ["drop", "dup", "split"])
def test_so_many_frames_are_struck(kind):
    struck = line(**{kind: 0.1})
    for index in range(5000):
        struck.send(FRAME, 0.01 * index)
    assert struck.counts[kind] == pytest.approx(500, abs=5 * np.sqrt(450))


def test_so_many_bytes_have_one_wrong_bit():
    wrong, sent = line(flip=0.01), FRAME * 2000
    wrong.send(sent, 0.0)
    arrived = wrong.receive(1.0)
    bits = [(a ^ b).bit_count() for a, b in zip(sent, arrived, strict=True)]
    assert max(bits) == 1
    assert sum(bits) == wrong.counts["flip"] == pytest.approx(200, abs=5 * np.sqrt(200))


def test_a_frame_is_lost_whole_and_its_neighbours_are_not():
    lossy = line(drop=0.5)
    frames = [b"\0" + bytes([65 + index % 26]) * 9 + b"\0" for index in range(100)]
    lossy.send(b"".join(frames), 0.0)
    arrived = [piece for piece in lossy.receive(0.0).split(b"\0") if piece]
    assert 20 < len(arrived) < 80
    assert all(b"\0" + piece + b"\0" in frames for piece in arrived)


def test_a_frame_that_is_doubled_comes_straight_behind_itself():
    double = line(dup=1.0)
    double.send(b"\0a\0", 0.0)
    double.send(b"\0b\0", 0.0)
    assert double.receive(0.0) == b"\0a\0\0a\0\0b\0\0b\0"


def test_a_text_without_an_edge_does_not_wait_for_one():
    prompt = Line(Faults(dup=1.0), b"\n", (1, 0))
    prompt.send(b"ok\n> ", 0.0)
    assert prompt.receive(0.0) == b"ok\nok\n> "


def test_everything_is_late_and_in_order():
    late, now = line(delay=0.020, jitter=0.005), 0.0
    for index in range(200):
        late.send(b"\0%d\0" % index, 0.01 * index)
    arrived, when = b"", []
    while late.due < 99:
        now = late.due
        when.append(now)
        arrived += late.receive(now)
    assert arrived == b"".join(b"\0%d\0" % index for index in range(200))
    lateness = np.array(when) - 0.01 * np.arange(200)
    assert lateness.min() < 0.017
    assert lateness.max() > 0.023
    assert lateness.min() >= 0.0149
    assert lateness.max() <= 0.0251


def test_a_split_frame_comes_in_two_pieces():
    halves = line(split=1.0)
    halves.send(FRAME, 0.0)
    first = halves.receive(0.0)
    assert 0 < len(first) < len(FRAME)
    assert first + halves.receive(SPLIT_GAP) == FRAME


def test_a_line_that_babbles_says_so_many_bytes_a_second():
    noisy = line(babble=2000.0)
    count = sum(len(noisy.receive(0.01 * step)) for step in range(2001))
    assert count == pytest.approx(40_000, rel=0.1)


def test_what_nobody_takes_is_lost_in_the_end():
    full = line(delay=5.0, babble=1e5)
    for index in range(20_000):
        full.send(FRAME, 0.0001 * index)
        assert full.in_flight <= IN_FLIGHT_MAX
    assert full.counts["lost"] > 0


harms = st.fixed_dictionaries(
    {"split": st.floats(0, 1), "delay": st.floats(0.02, 0.1), "jitter": st.floats(0, 0.02)}
)


@given(harms, st.lists(st.binary(max_size=40), max_size=20))
def test_a_line_that_only_delays_and_splits_loses_nothing_and_keeps_the_order(harm, written):
    slow = line(**harm)
    for index, data in enumerate(written):
        slow.send(data, 0.001 * index)
    assert slow.receive(1e3) == b"".join(written)


@given(st.binary(max_size=200), st.lists(st.integers(0, 200), max_size=6))
def test_it_does_not_matter_how_the_bytes_are_cut(data, places):
    whole, parts = line(drop=0.3, flip=0.05), line(drop=0.3, flip=0.05)
    whole.send(data, 0.0)
    edges = [0, *sorted(min(place, len(data)) for place in places), len(data)]
    for start, end in pairwise(edges):
        parts.send(data[start:end], 0.0)
    assert parts.receive(0.0) == whole.receive(0.0)
