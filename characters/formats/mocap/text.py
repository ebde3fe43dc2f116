"""Text files of motion capture; errors name the file and the line."""

import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError, CharacterWarning
from cubeling.characters.skeleton.pose import Array
from cubeling.files import FileKind

MOTION_CAPTURE_FILE = FileKind(
    "motion capture",
    (".bvh", ".amc", ".asf", ".bap"),
    CharacterError,
    1 << 30,
    "cubeling.characters.formats.loading:load_motion",
)
"""A text file of motion capture: two hours at 120 Hz take 0.6 GB."""

MAX_ABS_NUMBER = 1e9  # beyond any recording in any unit, and sums of such numbers stay finite
MAX_RATE_HZ = 1e5
MAX_POSED_JOINTS = 30_000_000  # joints × frames; two hours at 120 Hz with 35 joints
EXPORT_AGAIN = "export the file again"
CUT_OFF = "the file is cut off: export it again"


@dataclass(frozen=True)
class TextFile:
    """A whole text file in memory."""

    path: Path
    """The file, for messages."""

    text: str
    r"""Its content; lines end with ``\n`` alone."""

    @classmethod
    def read(cls, path: Path) -> "TextFile":
        """Read a UTF-8 file, or refuse one that is not text."""
        data = MOTION_CAPTURE_FILE.read(path)
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = data.count(b"\n", 0, error.start) + 1
            problem = f"byte 0x{data[error.start]:02x} is not UTF-8 text"
            raise cls(path, "").error(line, problem, "save it as UTF-8, or export again") from None
        file = cls(path, text.replace("\r\n", "\n").replace("\r", "\n"))
        if text.endswith("\0"):
            text = text.rstrip("\0")
            file = cls(path, file.text.rstrip("\0"))
            file.warn("zero bytes follow the text; they are left out")
        if "\0" in text:
            line = text.count("\n", 0, text.index("\0")) + 1
            raise file.error(line, "holds binary data, not text", "give the exported text file")
        return file

    def error(self, line: int, problem: str, advice: str) -> CharacterError:
        """Return the error for a line, counted from 1."""
        return CharacterError(f"{self.path}, line {line}: {problem}; {advice}")

    def warn(self, repair: str) -> None:
        """Warn of what had to be repaired, or was not as it should be."""
        warnings.warn(f"{self.path}: {repair}", CharacterWarning, stacklevel=2)

    def checked_rate(self, rate: float) -> float:
        """Return a rate [Hz] that is one, or refuse it."""
        if not 0.0 < rate < MAX_RATE_HZ:
            raise CharacterError(
                f"{self.path}: invalid rate of {rate:g} frames a second; state it in Hz"
            )
        return rate

    def number(self, line: int, word: str) -> float:
        """Return one finite number, or refuse the line."""
        try:
            value = float(word)
        except ValueError:
            problem = f"expected a number, found {quote(word)}"
            raise self.error(line, problem, EXPORT_AGAIN) from None
        if not abs(value) <= MAX_ABS_NUMBER:
            raise self.error(line, f"{quote(word)} is out of range", EXPORT_AGAIN)
        return value

    def vector(self, line: int, words: list[str], name: str) -> Array:
        """Return three finite numbers, or refuse the line."""
        if len(words) != 3:
            problem = f"{name} has {numbers(len(words))}"
            raise self.error(line, problem, "give three, or export the file again")
        return np.array([self.number(line, word) for word in words])

    def check_size(self, joints: int, frames: int) -> None:
        """Refuse a motion that would not fit in memory as poses."""
        if joints * frames > MAX_POSED_JOINTS:
            raise CharacterError(
                f"{self.path}: {frames} frames of {joints} joints do not fit in memory; "
                "cut the recording into pieces"
            )


def parse_numbers(words: Iterable[str]) -> Array | None:
    """Return words as an array of numbers, or None if one is not a number or out of range."""
    try:
        values = np.fromiter(map(float, words), float)
    except ValueError:
        return None
    # A comparison with NaN is false, so this finds NaN too.
    return values if bool((np.abs(values) <= MAX_ABS_NUMBER).all()) else None


def quote(word: str) -> str:
    """Return a word of a file, shortened and quoted for a message of one line."""
    return repr(word if len(word) <= 40 else word[:37] + "...")


def numbers(count: int) -> str:
    """Return how many numbers there are, in words.

    >>> numbers(1), numbers(2)
    ('1 number', '2 numbers')
    """
    return "1 number" if count == 1 else f"{count} numbers"
