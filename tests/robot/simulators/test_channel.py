"""A faulty channel has the faults that it is given, at their rates, and no others."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.robot.simulators.channel import MAX_IN_FLIGHT_BYTES, SPLIT_GAP_S, FaultyChannel
from cubeling.robot.simulators.faults import Faults

FRAME = b"\0frame 12\0"


def channel(**faults) -> FaultyChannel:
    return FaultyChannel(Faults(**faults), b"\0", (3, 0))


@pytest.mark.parametrize("kind", ["drop", "dup", "split"])
def test_frame_faults_occur_at_their_rate(kind):
    struck = channel(**{kind: 0.1})
    for index in range(5000):
        struck.send(FRAME, 0.01 * index)
    assert struck.counts[kind] == pytest.approx(500, abs=5 * np.sqrt(450))


def test_bit_flips_occur_at_their_rate():
    wrong, sent = channel(flip=0.01), FRAME * 2000
    wrong.send(sent, 0.0)
    arrived = wrong.receive(1.0)
    bits = [(a ^ b).bit_count() for a, b in zip(sent, arrived, strict=True)]
    assert max(bits) == 1
    assert sum(bits) == wrong.counts["flip"] == pytest.approx(200, abs=5 * np.sqrt(200))


def test_a_dropped_frame_leaves_its_neighbours_intact():
    lossy = channel(drop=0.5)
    frames = [b"\0" + bytes([65 + index % 26]) * 9 + b"\0" for index in range(100)]
    lossy.send(b"".join(frames), 0.0)
    arrived = [piece for piece in lossy.receive(0.0).split(b"\0") if piece]
    assert 20 < len(arrived) < 80
    assert all(b"\0" + piece + b"\0" in frames for piece in arrived)


def test_a_duplicated_frame_arrives_twice_in_succession():
    double = channel(dup=1.0)
    double.send(b"\0a\0", 0.0)
    double.send(b"\0b\0", 0.0)
    assert double.receive(0.0) == b"\0a\0\0a\0\0b\0\0b\0"


def test_a_text_without_an_edge_does_not_wait():
    prompt = FaultyChannel(Faults(dup=1.0), b"\n", (1, 0))
    prompt.send(b"ok\n> ", 0.0)
    assert prompt.receive(0.0) == b"ok\nok\n> "


def test_delay_and_jitter_keep_the_order():
    late, now = channel(delay=0.020, jitter=0.005), 0.0
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


def test_a_split_frame_arrives_in_two_pieces():
    halves = channel(split=1.0)
    halves.send(FRAME, 0.0)
    first = halves.receive(0.0)
    assert 0 < len(first) < len(FRAME)
    assert first + halves.receive(SPLIT_GAP_S) == FRAME


def test_noise_has_its_rate():
    noisy = channel(babble=2000.0)
    count = sum(len(noisy.receive(0.01 * step)) for step in range(2001))
    assert count == pytest.approx(40_000, rel=0.1)


def test_the_bytes_in_flight_are_bounded():
    full = channel(delay=5.0, babble=1e5)
    for index in range(20_000):
        full.send(FRAME, 0.0001 * index)
        assert full.in_flight <= MAX_IN_FLIGHT_BYTES
    assert full.counts["lost"] > 0


harms = st.fixed_dictionaries(
    {"split": st.floats(0, 1), "delay": st.floats(0.02, 0.1), "jitter": st.floats(0, 0.02)}
)


@given(harms, st.lists(st.binary(max_size=40), max_size=20))
def test_delay_and_split_lose_nothing_and_keep_the_order(harm, written):
    slow = channel(**harm)
    for index, data in enumerate(written):
        slow.send(data, 0.001 * index)
    assert slow.receive(1e3) == b"".join(written)


@given(st.binary(max_size=200), st.lists(st.integers(0, 200), max_size=6))
def test_the_faults_do_not_depend_on_how_the_bytes_are_cut(data, places):
    whole, parts = channel(drop=0.3, flip=0.05), channel(drop=0.3, flip=0.05)
    whole.send(data, 0.0)
    edges = [0, *sorted(min(place, len(data)) for place in places), len(data)]
    for start, end in pairwise(edges):
        parts.send(data[start:end], 0.0)
    assert parts.receive(0.0) == whole.receive(0.0)
