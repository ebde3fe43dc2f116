"""Ports: what pySerial opens, and simulated robots that read and write like one."""

import re
import time
from collections.abc import Callable
from typing import cast

import serial

from robot.contract.port import READ_TIMEOUT, Clock, Opener, Port
from robot.errors import RobotError
from robot.link.plug import Identity, identity_of, name_of
from robot.protocol import timing

SCHEMES: dict[str, Callable[[str, Clock], Opener]] = {}
"""What opens URLs that pySerial does not know, by their scheme; `robot` registers "sim"."""

WRITE_TIMEOUT = 0.2
"""Longest wait in one write [s]; a robot that no longer reads makes its line fill up."""


_NO_PORT = "there is no such port; `cubeling robot list` shows those there are"
_NOT_SERIAL = "that is no serial port; `cubeling robot list` shows those there are"
_REASONS = {
    "FileNotFoundError": _NO_PORT,
    "No such file": _NO_PORT,
    "Inappropriate ioctl": _NOT_SERIAL,
    "Is a directory": _NOT_SERIAL,
    "exclusively lock": "another program is using it",
    "Permission": "no permission; on Linux join the group dialout, elsewhere close other programs",
    "Access is denied": "another program is using it",
    "refused": "nobody listens there",
    "timed out": "nobody answers there",
}
"""Signs in the systems' messages, and what they mean."""


def opener(url: str, clock: Clock = time.monotonic, baud: int = timing.BAUD) -> Opener:
    """Return what opens a port, now and after every unplugging.

    Parameters
    ----------
    url
        Whatever pySerial opens: "/dev/ttyACM0", "COM3", "socket://localhost:5000"; or a simulated
        robot, as `SimulatedWire` takes it: "sim:cubeling", "sim:pleo?drop=0.05&seed=7".
    clock
        The time by which a simulated robot lives.
    baud
        Bits a second on a real serial line.

    Raises
    ------
    RobotError
        If the URL can be no port; both this and the opener may, and the line says why.
    """
    if not url:
        raise RobotError("a port must be named; `cubeling robot list` shows those there are")
    if url.partition("?")[0] == "sim":  # what `play --robot` calls one
        raise RobotError(f"{url!r} names no simulated robot: say which, as in sim:cubeling")
    scheme, colon, _ = url.partition(":")
    if colon and scheme in SCHEMES:
        return SCHEMES[scheme](url, clock)
    return _Plug(url, baud).open


class _Plug:
    """A port of this computer, or a network's, that may be pulled and put in again."""

    def __init__(self, url: str, baud: int) -> None:
        self._url = url
        self._baud = baud
        self._identity: Identity | None = None

    def open(self) -> Port:
        name = self._url
        if self._identity is not None:
            name = name_of(self._identity) or name
        port = _open_serial(name, self._baud)
        if self._identity is None and "://" not in name:
            self._identity = identity_of(name)
        return port


def _open_serial(url: str, baud: int) -> Port:
    try:
        port = serial.serial_for_url(
            url,
            baudrate=baud,
            timeout=READ_TIMEOUT,
            write_timeout=WRITE_TIMEOUT,
            exclusive=True,  # two programs on one port look like a broken robot to both
        )
    except Exception as error:  # a port that vanishes, a URL that trips pySerial's own parsing
        shown = url if url.isprintable() else repr(url)
        raise RobotError(f"cannot open the port {shown}: {_reason(url, error)}") from error
    return cast(Port, port)


def _reason(url: str, error: Exception) -> str:
    """Say in a person's words why a port does not open; pySerial's own where none is known."""
    text = " ".join(str(error).split())
    for sign, words in _REASONS.items():
        if sign in text:
            return words
    if url.startswith("socket://") and "Errno" not in text:
        return "a socket needs a host and a port, as in socket://localhost:5000"
    return re.sub(r"^.*\[Errno -?\d+\] ", "", text)
