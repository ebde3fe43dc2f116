"""Faults that the maker of a robot may make, planted in the source of the firmware.

The firmware `robot/firmware/dino` is a robot of its own: it shares no code with the suite. A fault
is an edit of its source; the edited copy is imported under another name and runs in virtual time.

The faults are in the text files beside this module, written as the hunks of a diff::

    GONE names session 0 [version 2 3] [should]
    @ session
    -    the lines of session.py that it replaces
    +    what it replaces them by
         lines that stay, so that the place is clear

Without "[version ...]" a robot of any version may have the fault; with "[should]" such a robot
conforms all the same. Lines that begin with # are comments.
"""

import importlib
import itertools
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import cubeling.robot.firmware.dino as dino
from cubeling.robot.conformance.check import Level
from tests.robot.firmware.conftest import VirtualBoard

SOURCE = Path(dino.__file__).parent
"""The firmware's source."""

VERSIONS = (1, 2, 3)
"""The versions of the protocol that a robot may speak at most."""

Edit = tuple[str, str, str]
"""A module of the firmware, a part of its text that it has once, and what replaces that."""

_NO_MOVE = '    0x13: ("<BHIHHH16h", 45, (),\n           ((2, 1, 4294967295),)),\n'
_NO_MOOD = "valence, arousal, mood = values[3], values[4], values[5]"
EARLIER_VERSIONS: dict[int, tuple[Edit, ...]] = {
    1: (
        ("messages", "VERSION = 3", "VERSION = 1"),
        ("messages", _NO_MOVE, ""),
        ("session", _NO_MOOD, _NO_MOOD.replace("values[5]", "m.NOTHING")),
    ),
    2: (("messages", "VERSION = 3", "VERSION = 2"), ("messages", _NO_MOVE, "")),
    3: (),
}
"""What makes the firmware a robot of a version."""

_HEAD = re.compile(r"(?P<name>.*?)( \[version (?P<versions>[\d ]+)\])?(?P<should> \[should\])?")

_copies = itertools.count()


@dataclass(frozen=True)
class PlantedFault:
    """A fault in a robot."""

    name: str
    """What the robot does wrong, in words; no two have the same."""

    edits: tuple[Edit, ...]
    """The fault."""

    versions: tuple[int, ...] = VERSIONS
    """The versions in which a robot can have it."""

    level: Level = "must"
    """Whether such a robot conforms all the same."""


def read_faults(file: Path) -> Iterator[PlantedFault]:
    """Yield the faults of a file.

    Raises
    ------
    ValueError
        If a line belongs to no fault.
    """
    text = "\n".join(line for line in file.read_text("utf-8").splitlines() if line[:1] != "#")
    for block in re.split(r"\n+(?=[^\s@+-])", "\n" + text.strip("\n")):
        if not block.strip():
            continue
        head, *hunks = re.split(r"\n@ ", block)
        found = _HEAD.fullmatch(head)
        if not hunks or found is None:
            raise ValueError(f"{file.name}: no fault: {head}")
        versions = tuple(map(int, (found["versions"] or "1 2 3").split()))
        level: Level = "should" if found["should"] else "must"
        yield PlantedFault(found["name"], tuple(map(_edit, hunks)), versions, level)


def _edit(hunk: str) -> Edit:
    module, *lines = hunk.rstrip("\n").split("\n")
    old = [line[1:] for line in lines if line[:1] != "+"]
    new = [line[1:] for line in lines if line[:1] != "-"]
    return module, "".join(f"{line}\n" for line in old), "".join(f"{line}\n" for line in new)


class PlantedRobot:
    """The firmware with a fault; a `Simulated`.

    It restarts after an exception, as the firmware's main loop does.
    """

    edge = b"\0"

    def __init__(self, package: str) -> None:
        self._robot = importlib.import_module(f"{package}.robot")
        self._table = self._robot.ServoTable(importlib.import_module(f"{package}.servos"))
        self.reboot()

    def reboot(self) -> None:
        """Restart."""
        self._board = VirtualBoard()
        log = self._robot.LogQueue()
        log.write(self._robot.SEVERITY_INFO, "started", 0)
        joints = self._robot.ServoJoints(self._table.servos, self._board)
        self.firmware = self._robot.Firmware(self._board, self._table, joints, log)
        self._start: float | None = None
        self._stepped = -self._robot.WAIT_MS

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        self._board.incoming += data
        self.advance(now)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        self._start = now if self._start is None else self._start
        self._board.now = round(1000 * (now - self._start))
        # As in its main loop, which waits for bytes. It is a robot whose clock may starve.
        if not self._board.incoming and self._board.now - self._stepped < self._robot.WAIT_MS:
            return
        self._stepped = self._board.now
        try:
            self.firmware.step(self._board.now)
            while self._board.incoming:
                self.firmware.step(self._board.now)
        except Exception:
            self.reboot()

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        data, self._board.outgoing = self._board.outgoing, b""
        return data

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, and its word."""
        body = self.firmware.body
        return body.valence / 10_000, body.moods[body.mood]


@contextmanager
def planted_robot(version: int = 3, edits: tuple[Edit, ...] = ()) -> Iterator[PlantedRobot]:
    """Make a robot of a version with a fault.

    Raises
    ------
    ValueError
        If the firmware does not have a part that an edit replaces, or has it more than once.
    """
    package = f"planted_dino_{next(_copies)}"
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / package
        shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__"))
        for module, old, new in (*EARLIER_VERSIONS[version], *edits):
            file = copy / f"{module}.py"
            text = file.read_text("utf-8")
            if text.count(old) != 1:
                raise ValueError(f"{module}.py has {text.count(old)} times, not once: {old}")
            file.write_text(text.replace(old, new), "utf-8")
        spec = spec_from_file_location(
            package, copy / "__init__.py", submodule_search_locations=[str(copy)]
        )
        assert spec is not None
        sys.modules[package] = module_from_spec(spec)
        try:
            yield PlantedRobot(package)
        finally:
            for name in [one for one in sys.modules if one.split(".")[0] == package]:
                del sys.modules[name]
