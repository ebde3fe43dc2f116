"""Text files of motion capture: read whole, refused with the number of the line at fault."""

from collections.abc import Iterable
from itertools import chain
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.model.files import read_given
from characters.skeleton.pose import Array

LARGEST_NUMBER = 1e9  # in no unit does a person reach further, and sums of such stay finite
MOST_POSES = 30_000_000  # joints × frames; two hours of 120 Hz on 35 joints


def refuse(path: Path, line: int, wrong: str, advice: str) -> CharacterError:
    """Return the error for a line of a file, counted from 1."""
    return CharacterError(f"{path}, line {line}: {wrong}; {advice}")


def read_text(path: Path) -> str:
    r"""Return the text of a file, its lines ended by ``\n`` alone."""
    data = read_given(path)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        byte = data[error.start]
        raise refuse(
            path, line, f"byte 0x{byte:02x} is not UTF-8 text", "save it as UTF-8, or export again"
        ) from None
    if "\0" in text:
        line = text.count("\n", 0, text.index("\0")) + 1
        raise refuse(path, line, "holds binary data, not text", "give the exported text file")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def number(path: Path, line: int, token: str) -> float:
    """Return one finite number, or refuse the line."""
    try:
        value = float(token)
    except ValueError:
        raise refuse(
            path, line, f"{shown(token)} stands where a number should", "export the file again"
        ) from None
    if not abs(value) <= LARGEST_NUMBER:
        raise refuse(path, line, f"{shown(token)} is no sound number", "export the file again")
    return value


def vector(path: Path, line: int, tokens: list[str], what: str) -> Array:
    """Return three finite numbers, or refuse the line."""
    if len(tokens) != 3:
        raise refuse(
            path, line, f"{what} has {len(tokens)} numbers", "give three, or export the file again"
        )
    return np.array([number(path, line, token) for token in tokens])


def numbers(tokens: Iterable[str]) -> Array | None:
    """Return numbers as an array, or None if one of them is none or is not sound."""
    try:
        values = np.fromiter(map(float, tokens), float)
    except ValueError:
        return None
    # A comparison with NaN is false, so this finds NaN too.
    return values if bool((np.abs(values) <= LARGEST_NUMBER).all()) else None


def number_rows(rows: list[list[str]]) -> Array | None:
    """Return rows of numbers, all of one length, as an array; None if one is not sound."""
    values = numbers(chain.from_iterable(rows))
    return None if values is None else values.reshape(len(rows), -1)


def check_size(path: Path, joints: int, frames: int) -> None:
    """Refuse what would not fit in memory once it is poses."""
    if joints * frames > MOST_POSES:
        raise CharacterError(
            f"{path}: {frames} frames of {joints} joints are more than fit in memory; "
            "cut the recording into pieces"
        )


def shown(token: str) -> str:
    """Return a word of a file as it may stand in a message of one line."""
    return repr(token if len(token) <= 40 else token[:37] + "...")
