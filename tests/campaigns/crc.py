"""Does the check of a frame let through what CRC-16 lets through, and no more?

`python -m tests.campaigns.crc` prints a table; the exit code is 1 if a figure is not as predicted.

**Within the guarantee** nothing may pass: one, two or three wrong bits anywhere between the edges,
and bursts of up to 16, as long as they make no edge; and any single wrong bit, edges included.

**Beyond it**, with a = 2^-16:

- *Noise in the form of a frame*: bytes without a zero, then three of the form 1110hhhh 10mmmmmm
  10llllll. Whatever the bytes are, exactly one of the 65536 checks fits: a.
- *Every bit wrong with the chance e*: an error pattern passes if it leaves the 8 fixed bits of the
  check alone, and is itself a word of the code, but not the zero word. By the identity of
  MacWilliams (1963) for a code of n bits whose dual has the words d,
  p = (1 - e)^8 (a sum over d of (1 - 2e)^weight(d) - (1 - e)^n), which is exact. Edges that such
  errors make, and the runs of COBS, are left out of it: they only refuse more.
- *A wrong bit that makes an edge*: what follows it still ends with the check of the whole frame. It
  fits if the register stood at its start value behind the new edge, which for an arbitrary head is
  one state of 65536: a. What precedes it ends with bytes that were never meant as a check: that
  they have its form, too, is much less likely.

An edge that is lost: between two frames there are two. If one goes, the frame next to it has one
byte more; if both go, two frames and two bytes become one. That neither ever passes, if one bit of
each edge is wrong, is seen by trying all cases.

Then still the header, the session, the length and the range of every field must fit.
"""

import argparse
import itertools
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.stats import binomtest

from robot.protocol import messages as m
from robot.protocol.schema import pack
from robot.protocol.wire import FrameError, FrameReader, check_bytes, decode_frame, encode_frame

Bytes = NDArray[np.uint8]

CHUNK = 1 << 19
"""Frames that are made at once."""

DOUBT = 1e-6
"""Chance of a false alarm of each comparison."""

CHANCE = 2**-16
"""Of an arbitrary check to fit."""

BODIES = (
    pack(m.Bye(), 7),
    pack(m.Express(70_000, 0.8, -0.25, 1), 0xABCD),
    pack(m.State(513, 4, 2, 0.8, 0.0, 0.5, 1, 255, 1, (0.0, -1.571, *[0.0] * 14)), 0xABCD),
    bytes(range(100, 220)),
)
"""Bodies of 3, 12, 51 and 120 bytes."""


@dataclass
class Figure:
    """One row of the table."""

    what: str
    """What was done to the frames."""

    trials: int
    """How often."""

    passed: int
    """How many of them were taken for whole."""

    chance: float
    """The predicted share of them."""

    edges: int = 0
    """Trials left out, for they made an edge."""

    @property
    def doubt(self) -> float:
        """Chance of a figure at least so far from the prediction, if that is right."""
        if self.chance == 0:
            return 0.0 if self.passed else 1.0
        return float(binomtest(self.passed, self.trials, self.chance).pvalue)

    @property
    def as_predicted(self) -> bool:
        """Whether the prediction may be right."""
        return self.doubt >= DOUBT


# --- Within the guarantee: the product's own reader ----------------------------------------------


def damaged(what: str, frames: list[bytes], patterns: Iterator[tuple[int, int]]) -> Figure:
    """Feed the reader frames with bits changed between their edges.

    `patterns` gives the number of a frame, and the bits to change in what is between its edges.
    """
    reader, figure = FrameReader(), Figure(what, 0, 0, 0.0)
    inner = [frame[1:-1] for frame in frames]
    numbers = [int.from_bytes(one, "big") for one in inner]
    sizes = [len(one) for one in inner]
    for which, pattern in patterns:
        wrong = (numbers[which] ^ pattern).to_bytes(sizes[which], "big")
        if 0 in wrong:
            figure.edges += 1
            continue
        figure.trials += 1
        figure.passed += len(reader.feed(b"\0" + wrong + b"\0"))
    return figure


def single_bits(frames: list[bytes]) -> Figure:
    """Damage every bit of every frame, edges included, between two others."""
    figure = Figure("1 wrong bit, everywhere, edges too", 0, 0, 0.0)
    around = encode_frame(b"around")
    for frame in frames:
        stream = int.from_bytes(around + frame + around, "big")
        size = len(frame) + 2 * len(around)
        for place in range(8 * size):
            wrong = (stream ^ 1 << place).to_bytes(size, "big")
            arrived = FrameReader().feed(wrong)
            figure.trials += 1
            figure.passed += sum(encode_frame(body) not in (around, frame) for body in arrived)
    return figure


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
    """Any wrong bits within 16 that follow each other."""
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


# --- Beyond it: many at once ---------------------------------------------------------------------


def _table() -> NDArray[np.uint16]:
    register = np.arange(256, dtype=np.uint16) << np.uint16(8)
    for _ in range(8):
        carry = register >> np.uint16(15)
        register = (register << np.uint16(1)) ^ (carry * np.uint16(0x1021))
    return register


_TABLE = _table()


def crc_of(rows: Bytes, start: int = 0xFFFF) -> NDArray[np.uint16]:
    """CRC-16/CCITT-FALSE of every row, written again, bit by bit, and so a check of the other."""
    register = np.full(len(rows), start, np.uint16)
    for column in rows.T:
        register = (register << np.uint16(8)) ^ _TABLE[(register >> np.uint16(8)) ^ column]
    return register


def chunks(trials: int) -> Iterator[int]:
    """Divide the trials."""
    for begun in range(0, trials, CHUNK):
        yield min(CHUNK, trials - begun)


def noise(random: np.random.Generator, trials: int, size: int = 13) -> Figure:
    """Noise in the form of a frame."""
    passed = 0
    for count in chunks(trials):
        rows = random.integers(1, 256, (count, size), dtype=np.uint8)
        checks = random.integers(0, 1 << 16, count, dtype=np.uint16)
        passed += int((crc_of(rows) == checks).sum())
    return Figure("noise in the form of a frame", trials, passed, CHANCE)


def bits_wrong(
    random: np.random.Generator, trials: int, in_256: int, body: bytes = BODIES[1]
) -> Figure:
    """Every bit of a frame wrong with the same chance, in 1/256."""
    frame = np.frombuffer(encode_frame(body)[1:-1], np.uint8)
    passed = 0
    for count in chunks(trials):
        wrong = random.integers(0, 256, (count, 8 * len(frame)), dtype=np.uint8) < in_256
        rows = np.packbits(wrong, axis=1) ^ frame
        passed += int((fits(rows) & (rows != frame).any(axis=1)).sum())
    rate = in_256 / 256
    what = f"every bit wrong with chance {rate:.3f}"
    return Figure(what, trials, passed, predicted(len(frame) - 3, rate))


def fits(rows: Bytes) -> NDArray[np.bool_]:
    """Whether the check of every row fits its bytes; its runs and zeros are not looked at."""
    crc = crc_of(rows[:, :-3]).astype(np.uint32)
    high, middle, low = rows[:, -3:].T
    matches = (high == (0xE0 | crc >> 12)) & (middle == (0x80 | crc >> 6 & 0x3F))
    return np.asarray(matches & (low == (0x80 | crc & 0x3F)))


def predicted(size: int, rate: float) -> float:
    """Return the chance that errors pass, in a frame of so many encoded bytes."""
    # Column j of the parity check is what a wrong bit j adds to the check; linear, so from 0.
    columns = crc_of(np.packbits(np.eye(8 * size, dtype=np.uint8), axis=1), start=0)
    columns = np.concatenate([columns, (1 << np.arange(16)).astype(np.uint16)])
    words = np.arange(1 << 16, dtype=np.uint16)  # every sum of the 16 rows: the dual code
    weights = np.zeros(1 << 16, int)
    for column in columns:
        weights += np.bitwise_count(words & column) & 1
    code = float(np.mean((1 - 2 * rate) ** weights) - (1 - rate) ** len(columns))
    return float((1 - rate) ** 8) * code


def edge_made(random: np.random.Generator, trials: int, size: int = 20) -> Figure:
    """A wrong bit makes an edge, and what follows it is taken for a frame."""
    passed = 0
    for count in chunks(trials):
        rows = random.integers(1, 256, (count, size), dtype=np.uint8)
        place = int(random.integers(3, size - 2))
        rows[:, place] = 1 << random.integers(0, 8, count)
        passed += int((crc_of(rows) == crc_of(rows[:, place + 1 :])).sum())
    return Figure("an edge made: the rest passes", trials, passed, CHANCE)


def edges_lost() -> Figure:
    """Both edges between two frames are lost, by one wrong bit each, and the two become one.

    The second frame's check fits if the register stands at its start value behind the lost edges.
    Where it stands depends on the first frame only by its check: all 65536 are tried.
    """
    figure = Figure("both edges between two frames lost, all", 0, 0, 0.0)
    crc = np.arange(1 << 16, dtype=np.uint32)
    for one, other in itertools.product(range(8), repeat=2):
        register = crc.astype(np.uint16)
        for byte in (
            0xE0 | crc >> 12,
            0x80 | crc >> 6 & 0x3F,
            0x80 | crc & 0x3F,
            1 << one,
            1 << other,
        ):
            column = np.broadcast_to(np.asarray(byte, np.uint16), crc.shape)
            register = (register << np.uint16(8)) ^ _TABLE[(register >> np.uint16(8)) ^ column]
        figure.trials += len(crc)
        figure.passed += int((register == 0xFFFF).sum())
    return figure


def behind_garbage(random: np.random.Generator, trials: int) -> Figure:
    """Count the whole frames that are not received because of what came before them."""
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
    return Figure("the first frame behind garbage is lost", trials, lost, 0.0)


def same_check(random: np.random.Generator, trials: int) -> Figure:
    """Compare the check written here with the product's; the doubt is not about chance."""
    differ = 0
    for row in random.integers(1, 256, (trials, 16), dtype=np.uint8):
        true = row[:-3].tobytes() + check_bytes(row[:-3].tobytes())
        for frame in (row.tobytes(), true):
            ours = bool(fits(np.frombuffer(frame, np.uint8)[None])[0])
            try:
                decode_frame(frame)
                theirs = True
            except FrameError as error:
                theirs = "COBS" in str(error)  # its check fits
            differ += ours != theirs
    return Figure("this check and the product's differ", 2 * trials, differ, 0.0)


def figures(random_count: int, trials: int, seed: int) -> Iterator[Figure]:
    """Measure everything."""
    random = np.random.default_rng(seed)
    frames = [encode_frame(body) for body in BODIES]
    yield single_bits(frames)
    yield damaged("2 wrong bits, every pair", frames, pairs(frames[:2]))
    yield damaged("3 wrong bits", frames, triples(frames, random, random_count // 2))
    yield damaged("bursts of up to 16 bits", frames, bursts(frames, random, random_count // 2))
    yield edges_lost()
    yield behind_garbage(random, random_count // 10)
    yield same_check(random, 2000)
    beyond: tuple[Callable[[], Figure], ...] = (
        lambda: noise(random, trials),
        lambda: bits_wrong(random, trials, 8),
        lambda: bits_wrong(random, trials, 26),
        lambda: edge_made(random, trials),
    )
    for measure in beyond:
        yield measure()


def main() -> int:
    """Print the table; return 1 if a figure is not as predicted."""
    parser = argparse.ArgumentParser(description="Hunt for damage that the check lets pass.")
    parser.add_argument("--random", type=float, default=1.2e6, help="errors within the guarantee")
    parser.add_argument("--trials", type=float, default=1e7, help="of each kind beyond it")
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    start, good = time.perf_counter(), True
    table = Table(title="What the check of a frame lets pass")
    for head in ("errors", "trials", "left out", "passed", "predicted", "doubt"):
        table.add_column(head, justify="left" if head == "errors" else "right")
    for one in figures(int(wanted.random), int(wanted.trials), wanted.seed):
        good &= one.as_predicted
        table.add_row(
            one.what, f"{one.trials:,}", f"{one.edges:,}", f"{one.passed:,}",
            f"{one.trials * one.chance:.1f}", "" if one.chance == 0 else f"{one.doubt:.3f}",
            style="" if one.as_predicted else "red",
        )  # fmt: skip
    console = Console(width=100)
    console.print(table)
    console.print(
        f"{time.perf_counter() - start:.0f} s, seed {wanted.seed}: "
        + ("all as predicted" if good else "not as predicted"),
        style="green" if good else "red",
    )
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
