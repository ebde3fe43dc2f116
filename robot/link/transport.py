"""Opens ports by URL, and finds a USB device again after it was unplugged.

Linux numbers USB ports as they appear: what was /dev/ttyACM0 becomes /dev/ttyACM1 while another
program still holds the old name. The USB identity tells whether it is the same device.
"""

import re
import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple, cast

import serial
from serial.tools import list_ports

from cubeling.registry import Registry
from cubeling.robot.contract.port import READ_TIMEOUT_S, Clock, Opener, Port
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import timing

SCHEMES = Registry[Callable[[str, Clock], Opener]](
    {"sim": "cubeling.robot.simulators.memory:open_simulated"}
)
"""Openers of the URL schemes that pySerial does not know."""

WRITE_TIMEOUT_S = 0.2
"""Longest wait in one write [s]; the line fills up when a robot no longer reads."""

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
"""Parts of the operating systems' messages, and what they mean."""


def opener(url: str, clock: Clock = time.monotonic, baud: int = timing.BAUD) -> Opener:
    """Return a function that opens a port, now and after every unplugging.

    For the URL see `robot.connect`; `clock` is for a simulated robot, `baud` for a real line.
    Both this function and the opener raise RobotError with the reason if the URL names no port.
    """
    if not url:
        raise RobotError("a port must be named; `cubeling robot list` shows those there are")
    if url.partition("?")[0] == "sim":
        raise RobotError(f"{url!r} names no simulated robot: say which, as in sim:cubeling")
    scheme, colon, _ = url.partition(":")
    if colon and scheme in SCHEMES:
        return SCHEMES[scheme](url, clock)
    return _PluggablePort(url, baud).open


class UsbIdentity(NamedTuple):
    """Identifies a USB device."""

    vendor: int
    """Vendor id in the USB descriptor."""

    product: int
    """Product id in the USB descriptor."""

    serial: str | None
    """Its serial number; cheap boards have none."""

    socket: str | None
    """Where it is plugged in, by the operating system; used where there is no serial number."""

    def matches(self, other: "UsbIdentity") -> bool:
        """Return whether both are the same device."""
        # Whatever the socket: the player may plug it in elsewhere.
        if self.serial and other.serial:
            return self[:3] == other[:3]
        return self == other


def usb_identity(name: str) -> UsbIdentity | None:
    """Return the identity of the USB device at a port; None if there is none."""
    return next((found for device, found in _usb_devices() if device == name), None)


def find_port(identity: UsbIdentity) -> str | None:
    """Return the port of a USB device; None unless exactly one device matches."""
    names = [device for device, found in _usb_devices() if found.matches(identity)]
    # Two equal boards without serial numbers: opening either could drive the wrong robot.
    return names[0] if len(names) == 1 else None


def _usb_devices() -> list[tuple[str, UsbIdentity]]:
    return [
        (port.device, UsbIdentity(port.vid, port.pid, port.serial_number, port.location))
        for port in list_ports.comports()
        if port.vid is not None
    ]


class _PluggablePort:
    """A port of this computer or of a network that may be unplugged and plugged in again."""

    def __init__(self, url: str, baud: int) -> None:
        self._url = url
        self._baud = baud
        self._identity: UsbIdentity | None = None

    def open(self) -> Port:
        name = self._url
        if self._identity is not None:
            name = find_port(self._identity) or name
        port = _open_serial(name, self._baud)
        # Once only: asked again after a replug, the name may be that of another device.
        if self._identity is None and "://" not in name:
            self._identity = usb_identity(name)
        return port


def _open_serial(url: str, baud: int) -> Port:
    try:
        port = serial.serial_for_url(
            url,
            baudrate=baud,
            timeout=READ_TIMEOUT_S,
            write_timeout=WRITE_TIMEOUT_S,
            exclusive=True,  # two programs on one port look like a broken robot to both
        )
    except Exception as error:  # a port that vanishes, a URL that pySerial cannot parse
        shown = url if url.isprintable() else repr(url)
        raise RobotError(f"cannot open the port {shown}: {_reason(url, error)}") from error
    return cast(Port, port)


def _reason(url: str, error: Exception) -> str:
    """Return why a port does not open, in plain words where the message is known."""
    text = " ".join(str(error).split())
    for sign, words in _REASONS.items():
        if sign in text:
            return words
    if url.startswith("socket://") and "Errno" not in text:
        return "a socket needs a host and a port, as in socket://localhost:5000"
    return re.sub(r"^.*\[Errno -?\d+\] ", "", text)


class SpacedPort:
    """A port with a minimum time between writes, for robots that read all that waits as one line.

    A driver with its own rate limit waits here only with its last bytes.
    """

    def __init__(self, port: Port, spacing: float, clock: Clock) -> None:
        self._port, self._spacing, self._clock = port, spacing, clock
        self._written: float | None = None

    def __getattr__(self, name: str) -> Any:
        return getattr(self._port, name)

    def write(self, data: bytes, /) -> int | None:
        """Write all bytes; waits at most the spacing, if the last write was less than it ago."""
        if data and self._written is not None:
            left = self._spacing - (self._clock() - self._written)
            # Bounded by the spacing, so that a clock that jumps cannot hang the thread.
            if left > 0:
                threading.Event().wait(min(left, self._spacing))
        written = self._port.write(data)
        if data:
            self._written = self._clock()
        return written


def space_writes(open_port: Opener, spacing: float, clock: Clock) -> Opener:
    """Return an opener of the same port with at least `spacing` [s] between its writes."""
    return lambda: cast(Port, SpacedPort(open_port(), spacing, clock))
