"""Errors that the check of a frame may miss: measured and predicted rates."""

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cubeling.robot.protocol.wire import FrameError, check_bytes, decode_frame, encode_frame
from tests.campaigns.error_rate import BODIES, ErrorRate

Bytes = NDArray[np.uint8]

CHUNK_FRAMES = 1 << 19
"""Frames generated at once."""

PASS_PROBABILITY = 2**-16
"""Probability that a random check is right."""


def _table() -> NDArray[np.uint16]:
    register = np.arange(256, dtype=np.uint16) << np.uint16(8)
    for _ in range(8):
        carry = register >> np.uint16(15)
        register = (register << np.uint16(1)) ^ (carry * np.uint16(0x1021))
    return register


_TABLE = _table()


def crc_of(rows: Bytes, start: int = 0xFFFF) -> NDArray[np.uint16]:
    """Return CRC-16/CCITT-FALSE of every row; an implementation independent of the product's."""
    register = np.full(len(rows), start, np.uint16)
    for column in rows.T:
        register = (register << np.uint16(8)) ^ _TABLE[(register >> np.uint16(8)) ^ column]
    return register


def chunks(trials: int) -> Iterator[int]:
    """Divide the trials into chunks."""
    for begun in range(0, trials, CHUNK_FRAMES):
        yield min(CHUNK_FRAMES, trials - begun)


def noise(random: np.random.Generator, trials: int, size: int = 13) -> ErrorRate:
    """Measure noise in the form of a frame."""
    passed = 0
    for count in chunks(trials):
        rows = random.integers(1, 256, (count, size), dtype=np.uint8)
        checks = random.integers(0, 1 << 16, count, dtype=np.uint16)
        passed += int((crc_of(rows) == checks).sum())
    return ErrorRate("noise in the form of a frame", trials, passed, PASS_PROBABILITY)


def bits_wrong(
    random: np.random.Generator, trials: int, in_256: int, body: bytes = BODIES[1]
) -> ErrorRate:
    """Measure frames in which each bit is wrong with a probability in 1/256."""
    frame = np.frombuffer(encode_frame(body)[1:-1], np.uint8)
    passed = 0
    for count in chunks(trials):
        wrong = random.integers(0, 256, (count, 8 * len(frame)), dtype=np.uint8) < in_256
        rows = np.packbits(wrong, axis=1) ^ frame
        passed += int((fits(rows) & (rows != frame).any(axis=1)).sum())
    rate = in_256 / 256
    what = f"every bit wrong with chance {rate:.3f}"
    return ErrorRate(what, trials, passed, predicted(len(frame) - 3, rate))


def fits(rows: Bytes) -> NDArray[np.bool_]:
    """Return whether the check of every row is right, whatever its COBS runs."""
    crc = crc_of(rows[:, :-3]).astype(np.uint32)
    high, middle, low = rows[:, -3:].T
    matches = (high == (0xE0 | crc >> 12)) & (middle == (0x80 | crc >> 6 & 0x3F))
    return np.asarray(matches & (low == (0x80 | crc & 0x3F)))


def predicted(size: int, rate: float) -> float:
    """Return the probability that errors pass in a frame with `size` encoded bytes."""
    # Column j of the parity check matrix is the change of the CRC by a wrong bit j; it is linear.
    columns = crc_of(np.packbits(np.eye(8 * size, dtype=np.uint8), axis=1), start=0)
    columns = np.concatenate([columns, (1 << np.arange(16)).astype(np.uint16)])
    words = np.arange(1 << 16, dtype=np.uint16)  # every sum of the 16 rows: the dual code
    weights = np.zeros(1 << 16, int)
    for column in columns:
        weights += np.bitwise_count(words & column) & 1
    code = float(np.mean((1 - 2 * rate) ** weights) - (1 - rate) ** len(columns))
    return float((1 - rate) ** 8) * code


def edge_made(random: np.random.Generator, trials: int, size: int = 20) -> ErrorRate:
    """Measure wrong bits that make an edge: do the following bytes pass as a frame?"""
    passed = 0
    for count in chunks(trials):
        rows = random.integers(1, 256, (count, size), dtype=np.uint8)
        place = int(random.integers(3, size - 2))
        rows[:, place] = 1 << random.integers(0, 8, count)
        passed += int((crc_of(rows) == crc_of(rows[:, place + 1 :])).sum())
    return ErrorRate("an edge made: the rest passes", trials, passed, PASS_PROBABILITY)


def edges_lost() -> ErrorRate:
    """Measure pairs of frames that lose both edges between them, by one wrong bit each.

    The second frame's check is right if the register has its start value after the lost edges.
    That depends only on the check of the first frame: all 65536 are tried.
    """
    rate = ErrorRate("both edges between two frames lost, all", 0, 0, 0.0)
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
        rate.trials += len(crc)
        rate.passed += int((register == 0xFFFF).sum())
    return rate


def same_check(random: np.random.Generator, trials: int) -> ErrorRate:
    """Compare the implementation here with the product's."""
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
    return ErrorRate("this check and the product's differ", 2 * trials, differ, 0.0)
