"""Damage that a frame's check may miss, many frames at once, and how seldom it should."""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from robot.protocol.wire import FrameError, check_bytes, decode_frame, encode_frame
from tests.campaigns.figure import BODIES, Figure

Bytes = NDArray[np.uint8]

CHUNK = 1 << 19
"""Frames that are made at once."""

CHANCE = 2**-16
"""Of an arbitrary check to fit."""


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
