"""Errors that the check of a frame must always detect, tested on the product's reader."""

import itertools
from collections.abc import Iterator

import numpy as np

from cubeling.robot.protocol.wire import FrameReader, encode_frame
from tests.campaigns.error_rate import BODIES, ErrorRate


def damaged(what: str, frames: list[bytes], patterns: Iterator[tuple[int, int]]) -> ErrorRate:
    """Feed the reader frames with inverted bits between their edges.

    `patterns` has the index of a frame, and the bits to invert between its edges.
    """
    reader, rate = FrameReader(), ErrorRate(what, 0, 0, 0.0)
    inner = [frame[1:-1] for frame in frames]
    numbers = [int.from_bytes(one, "big") for one in inner]
    sizes = [len(one) for one in inner]
    for which, pattern in patterns:
        wrong = (numbers[which] ^ pattern).to_bytes(sizes[which], "big")
        if 0 in wrong:
            rate.edges += 1
            continue
        rate.trials += 1
        rate.passed += len(reader.feed(b"\0" + wrong + b"\0"))
    return rate


def single_bits(frames: list[bytes]) -> ErrorRate:
    """Invert every bit of every frame, edges included, between two others."""
    rate = ErrorRate("1 wrong bit, everywhere, edges too", 0, 0, 0.0)
    around = encode_frame(b"around")
    for frame in frames:
        stream = int.from_bytes(around + frame + around, "big")
        size = len(frame) + 2 * len(around)
        for place in range(8 * size):
            wrong = (stream ^ 1 << place).to_bytes(size, "big")
            arrived = FrameReader().feed(wrong)
            rate.trials += 1
            rate.passed += sum(encode_frame(body) not in (around, frame) for body in arrived)
    return rate


def pairs(frames: list[bytes]) -> Iterator[tuple[int, int]]:
    """Every two bits of every frame."""
    for which, frame in enumerate(frames):
        for one, other in itertools.combinations(range(8 * (len(frame) - 2)), 2):
            yield which, 1 << one | 1 << other


def triples(
    frames: list[bytes], random: np.random.Generator, count: int
) -> Iterator[tuple[int, int]]:
    """Three bits of any frame."""
    for which, places in drawn(frames, random, count, 3):
        a, b, c = places
        if a != b != c != a:
            yield which, 1 << a | 1 << b | 1 << c


def bursts(
    frames: list[bytes], random: np.random.Generator, count: int
) -> Iterator[tuple[int, int]]:
    """Any wrong bits within 16 consecutive ones."""
    patterns = random.integers(1, 1 << 16, count).tolist()
    for (which, (place,)), pattern in zip(drawn(frames, random, count, 1), patterns, strict=True):
        yield which, pattern << min(place, 8 * (len(frames[which]) - 2) - 16)


def drawn(
    frames: list[bytes], random: np.random.Generator, count: int, places: int
) -> Iterator[tuple[int, list[int]]]:
    """Draw a frame, and places between its edges [bits]."""
    which = random.integers(len(frames), size=count)
    bits = np.array([8 * (len(frame) - 2) for frame in frames])[which]
    where = (random.random((count, places)) * bits[:, None]).astype(int)
    return zip(which.tolist(), where.tolist(), strict=True)


def behind_garbage(random: np.random.Generator, trials: int) -> ErrorRate:
    """Count the whole frames that are lost because of garbage before them."""
    reader, lost = FrameReader(), 0
    frames = [(body, encode_frame(body)) for body in BODIES]
    sizes = random.integers(0, 200, trials).tolist()
    kinds = random.integers(0, 3, trials).tolist()
    for number, (size, kind) in enumerate(zip(sizes, kinds, strict=True)):
        body, frame = frames[number % len(frames)]
        if kind == 0:
            garbage = random.bytes(size)
        elif kind == 1:  # a frame that was cut off
            garbage = frame[: size % len(frame)]
        else:  # and one without an end
            garbage = bytes([size + 1]) * 3000
        lost += reader.feed(garbage + frame)[-1:] != [body]
    return ErrorRate("the first frame behind garbage is lost", trials, lost, 0.0)
