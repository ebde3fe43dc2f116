"""The lines that may be sent to a board, and the only writer of lines.

Some of OpenCat's tokens erase the calibration of the joints, rewrite the memory, or make the robot
walk off a table. Therefore this is a list of what is allowed; nothing else can be sent.
"""

import math
import re
from collections.abc import Iterable, Mapping

from cubeling.robot.contract.port import SendBuffer
from cubeling.robot.errors import RobotError

MAX_LINE_BYTES = 30
"""Longest line with its end [bytes]; the limit that older boards report."""

MAX_ANGLE_DEG = 125
"""Largest absolute angle in a line [°]: boards keep it in a signed byte, and 126 is "~"."""

JOINTS = 16
"""Number of joints on a board; a robot has fewer."""

MAX_NOTE = 36
"""Highest note, three octaves above the lowest, 1; 0 is a pause."""

MAX_NOTE_VALUE = 64
"""Largest note value: 4 is a quarter of a second, 8 an eighth."""

QUERY = b"?\n"
"""Asks for model and version."""

ANGLES = b"j\n"
"""Asks for the commanded joint angles."""

REST = b"d\n"
"""Lies down and switches every servo off."""

_FIXED = frozenset({QUERY, ANGLES, REST})
_SKILL = re.compile(r"[a-z][A-Za-z0-9]{1,8}")
_NUMBER = r"(?:0|[1-9][0-9]{0,2})"
_POSE = re.compile(rf"i({_NUMBER} -?{_NUMBER}(?: {_NUMBER} -?{_NUMBER})*)\n")
_MELODY = re.compile(rf"b({_NUMBER} {_NUMBER}(?: {_NUMBER} {_NUMBER})*)\n")

_REFUSED_SKILLS = {
    "bk": "walks away",
    "bd": "walks away",
    "bf": "is a somersault",
    "ff": "is a somersault",
    "ts": "tests servos",
    "testServo": "tests servos",
    "climbCeil": "is for the ceiling",
}
"""Skills that are not for a desk, and why."""

_GAIT_SUFFIXES = frozenset("FBLRXD")
"""Last letters of gaits; a gait goes on until it is stopped."""


def skill(name: str) -> bytes:
    r"""Return the line that plays a skill or takes a posture.

    >>> skill("sit")
    b'ksit\n'
    """
    return check_line(f"k{name}\n".encode("latin-1", "replace"))


def pose(angles: Mapping[int, int]) -> bytes:
    r"""Return the line that moves joints together, {number of the joint: angle [°]}.

    >>> pose({0: 30, 8: -20})
    b'i0 30 8 -20\n'
    """
    return check_line(f"i{_pairs(angles.items())}\n".encode())


def melody(notes: Iterable[tuple[int, int]]) -> bytes:
    r"""Return the line that plays (note, value) pairs.

    >>> melody([(14, 8), (16, 8)])
    b'b14 8 16 8\n'
    """
    return check_line(f"b{_pairs(notes)}\n".encode())


def _pairs(pairs: Iterable[tuple[int, int]]) -> str:
    return " ".join(f"{first} {second}" for first, second in pairs)


def check_line(line: bytes) -> bytes:
    """Return the line if it may be sent; raises RobotError with the reason if it may not."""
    reason = why_not(line)
    if reason is not None:
        raise RobotError(f"{line[:40]!r} is not sent to an OpenCat board: {reason}")
    return line


def why_not(line: bytes) -> str | None:
    """Return why a line may not be sent; None if it may."""
    if line in _FIXED:
        return None
    if len(line) > MAX_LINE_BYTES:
        return f"it has more than {MAX_LINE_BYTES} bytes"
    text = line.decode("latin-1")
    if text[:1] == "k" and text.endswith("\n"):
        return _why_not_skill(text[1:-1])
    if found := _POSE.fullmatch(text):
        numbers = [int(number) for number in found[1].split()]
        if max(numbers[::2]) >= JOINTS:
            return f"joints are numbered from 0 to {JOINTS - 1}"
        if max(abs(angle) for angle in numbers[1::2]) > MAX_ANGLE_DEG:
            return f"angles go from -{MAX_ANGLE_DEG} to {MAX_ANGLE_DEG} degrees"
        return None
    if found := _MELODY.fullmatch(text):  # pairs only: a single number is stored as the volume
        numbers = [int(number) for number in found[1].split()]
        if max(numbers[::2]) > MAX_NOTE or not all(0 < n <= MAX_NOTE_VALUE for n in numbers[1::2]):
            return f"notes go from 0 to {MAX_NOTE} and their values from 1 to {MAX_NOTE_VALUE}"
        return None
    return "only skills, poses, melodies, rest and two questions are (k, i, b, d, ?, j)"


def _why_not_skill(name: str) -> str | None:
    if not _SKILL.fullmatch(name):
        return f"{name!r} is no name of a skill: 2 to 9 letters and digits, a small one first"
    if "calib".startswith(name):  # a board may accept the beginning of a name
        return f"the skill {name!r} is for calibration"
    if name in _REFUSED_SKILLS:
        return f"the skill {name!r} {_REFUSED_SKILLS[name]}"
    if name[-1] in _GAIT_SUFFIXES:
        return f"the skill {name!r} walks away"
    return None


class RateLimitedWriter(SendBuffer):
    """Collects allowed lines for the port, at most `per_second`."""

    def __init__(self, per_second: float) -> None:
        super().__init__()
        self.sent = 0
        """Number of lines sent."""
        self._interval = 1.0 / per_second
        self._last = -math.inf

    def is_free(self, now: float) -> bool:
        """Return whether a line may be sent at time `now` [s]."""
        return now - self._last >= self._interval

    def send(self, line: bytes, now: float) -> None:
        """Send a line at time `now` [s]; raises RobotError for one that may not be sent."""
        self._out += check_line(line)
        self._last = now
        self.sent += 1

    def clear(self) -> None:
        """Drop the lines that were not written."""
        self._out.clear()
