"""The lines that may be sent to a board: one list, and the one gate that every byte passes.

OpenCat's tokens include ones that erase the joints' calibration, rewrite its memory, or make the
robot walk off a table. So nothing is forbidden here: what is not allowed cannot be sent.
"""

import re
from collections.abc import Iterable, Mapping

from robot.errors import RobotError

LINE_MAX = 30
"""Longest line, its end included [bytes]; older boards say that they take no more."""

ANGLE_MAX = 125
"""Largest angle either way in a line [deg]: boards keep them in a signed byte, and 126 is "~"."""

JOINTS = 16
"""Numbers of joints on a board; a robot has fewer."""

NOTE_MAX = 36
"""Highest note: three octaves from the lowest, 1; 0 is a pause."""

LENGTH_MAX = 64
"""Largest length of a note, the note's value: 4 is a quarter of a second, 8 an eighth."""

QUERY = b"?\n"
"""Asks for model and version."""

ANGLES = b"j\n"
"""Asks for the joints' angles, as the board commanded them."""

REST = b"d\n"
"""Lies down and takes the power from every servo."""

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

_WALKS_AT_END = frozenset("FBLRXD")
"""A skill that ends in one of these is a gait, and gaits go on until somebody stops them."""


def skill(name: str) -> bytes:
    r"""Return the line that plays a skill or takes a posture.

    >>> skill("sit")
    b'ksit\n'
    """
    return admitted(f"k{name}\n".encode("latin-1", "replace"))


def pose(angles: Mapping[int, int]) -> bytes:
    r"""Return the line that moves joints together: {number of the joint: angle [deg]}.

    >>> pose({0: 30, 8: -20})
    b'i0 30 8 -20\n'
    """
    return admitted(f"i{_pairs(angles.items())}\n".encode())


def melody(notes: Iterable[tuple[int, int]]) -> bytes:
    r"""Return the line that beeps: (note, its value) each.

    >>> melody([(14, 8), (16, 8)])
    b'b14 8 16 8\n'
    """
    return admitted(f"b{_pairs(notes)}\n".encode())


def _pairs(pairs: Iterable[tuple[int, int]]) -> str:
    return " ".join(f"{one} {other}" for one, other in pairs)


def admitted(line: bytes) -> bytes:
    """Return the line if it may be sent.

    Raises
    ------
    RobotError
        If it may not, and why.
    """
    reason = why_not(line)
    if reason is not None:
        raise RobotError(f"{line[:40]!r} is not sent to an OpenCat board: {reason}")
    return line


def why_not(line: bytes) -> str | None:
    """Say why a line may not be sent; None if it may."""
    if line in _FIXED:
        return None
    if len(line) > LINE_MAX:
        return f"it has more than {LINE_MAX} bytes"
    text = line.decode("latin-1")
    if text[:1] == "k" and text.endswith("\n"):
        return _why_not_skill(text[1:-1])
    if found := _POSE.fullmatch(text):
        numbers = [int(number) for number in found[1].split()]
        if max(numbers[::2]) >= JOINTS:
            return f"joints are numbered from 0 to {JOINTS - 1}"
        if max(abs(angle) for angle in numbers[1::2]) > ANGLE_MAX:
            return f"angles go from -{ANGLE_MAX} to {ANGLE_MAX} degrees"
        return None
    if found := _MELODY.fullmatch(text):  # in pairs: one number alone is stored as the volume
        numbers = [int(number) for number in found[1].split()]
        if max(numbers[::2]) > NOTE_MAX or not all(0 < n <= LENGTH_MAX for n in numbers[1::2]):
            return f"notes go from 0 to {NOTE_MAX} and their values from 1 to {LENGTH_MAX}"
        return None
    return "only skills, poses, melodies, rest and two questions are (k, i, b, d, ?, j)"


def _why_not_skill(name: str) -> str | None:
    if not _SKILL.fullmatch(name):
        return f"{name!r} is no name of a skill: 2 to 9 letters and digits, a small one first"
    if "calib".startswith(name):  # a board may take a skill by the beginning of its name
        return f"the skill {name!r} is for calibration"
    if name in _REFUSED_SKILLS:
        return f"the skill {name!r} {_REFUSED_SKILLS[name]}"
    if name[-1] in _WALKS_AT_END:
        return f"the skill {name!r} walks away"
    return None
