"""Reachy Mini's SDK behind the interface of a port: lines of JSON in both directions.

The SDK waits for the network, its daemon and the end of a motion, here in a thread of its own. A
daemon that dies, or is silent for a second, is an unplugged port.
"""

import contextlib
import importlib
import json
import threading
from collections.abc import Callable
from typing import Any

import serial

from cubeling.robot.contract.port import READ_TIMEOUT_S, Clock, Port
from cubeling.robot.drivers.reachy.sdk import CONNECT_TIMEOUT_S, SdkRobot
from cubeling.robot.errors import RobotError

DEFAULT_TCP_PORT = 8000
"""Port of the daemon if the URL names none."""

STATE_INTERVAL_S = 0.1
"""Interval of the state messages [s]."""

CHECK_INTERVAL_S = 1.0
"""Interval at which the connection to the daemon is checked [s]; the SDK may take a second."""

LEAVE_TIMEOUT_S = 0.8
"""Longest wait at the end for the last request to be sent [s]."""

MAX_UNREAD_BYTES = 65536
"""Most bytes that wait to be read."""

Connect = Callable[[str, int], Any]
"""Returns a connected `reachy_mini.ReachyMini` for a host and a port."""


def open_reachy(url: str, _clock: Clock) -> Callable[[], Port]:
    """Return a function that connects to the daemon at "HOST", "HOST:PORT" or "".

    Raises RobotError if the URL is wrong, or the SDK is not installed.
    """
    host, colon, number = url.partition(":")
    if colon and not (number.isascii() and number.isdigit() and 0 < int(number[:6]) < 65536):
        raise RobotError(f"'reachy:{url}': the port must be a number, as in reachy:localhost:8000")
    if not all(char.isalnum() or char in "-._" for char in host):
        raise RobotError(f"'reachy:{url}': {host!r} is no name of a computer")
    try:
        importlib.import_module("reachy_mini")
    except (ImportError, ValueError) as error:  # ValueError: a system library is missing
        reason = " ".join(str(error).split())
        raise RobotError(
            f"Reachy Mini's SDK does not load ({reason}): pip install reachy-mini, "
            "and see docs/reachy.md for the system's libraries that it needs"
        ) from None
    return lambda: ReachyPort(host or "localhost", int(number or DEFAULT_TCP_PORT))


def _connect(host: str, port: int) -> Any:
    sdk = importlib.import_module("reachy_mini")
    return sdk.ReachyMini(
        host=host,
        port=port,
        connection_mode="network",
        media_backend="no_media",
        timeout=CONNECT_TIMEOUT_S,
        automatic_body_yaw=False,
        log_level="ERROR",
    )


class ReachyPort:
    """A connection to one robot's daemon, made in the background."""

    def __init__(self, host: str, port: int, connect: Connect = _connect) -> None:
        self._address = host, port
        self._connect = connect
        self._changed = threading.Condition()
        self._target: dict[str, Any] | None = None
        self._leaving = self._left = self._broken = False
        self._arrived = bytearray()
        name = f"reachy {host}:{port}"
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._thread.start()

    @property
    def in_waiting(self) -> int:
        """Number of bytes that can be read at once."""
        with self._changed:
            return len(self._arrived)

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes; waits at most `READ_TIMEOUT_S` for the first."""
        with self._changed:
            if not self._arrived and not self._broken:
                self._changed.wait(READ_TIMEOUT_S)
            if not self._arrived and self._broken:
                raise serial.SerialException("the robot's daemon does not answer")
            data = bytes(self._arrived[:size])
            del self._arrived[:size]
            return data

    def write(self, data: bytes, /) -> int:
        """Process whole lines; of several targets the latest counts."""
        for line in data.splitlines():
            message = json.loads(line)
            with self._changed:
                self._leaving |= "bye" in message
                self._target = message if "target" in message else self._target
                self._changed.notify_all()
        return len(data)

    def cancel_read(self) -> None:
        """End a read that waits."""
        with self._changed:
            self._changed.notify_all()

    def close(self) -> None:
        """Leave the robot; waits at most `LEAVE_TIMEOUT_S`."""
        with self._changed:
            self._leaving = True
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._left, LEAVE_TIMEOUT_S)

    def _serve(self) -> None:
        """Connect and carry out targets; runs in its own thread."""
        try:
            mini = self._connect(*self._address)
            with contextlib.closing(SdkRobot(mini)) as sdk:
                sdk.get_up()
                self._report({"hello": sdk.version, **sdk.state()})
                self._follow(sdk)
                sdk.leave(self._mark_left)
        except Exception:  # any exception of the SDK: the port is gone, and is reopened
            with self._changed:
                self._broken = True
        finally:
            self._mark_left()

    def _follow(self, sdk: SdkRobot) -> None:
        """Carry out targets until the end, and report the state between them."""
        polls = 0
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._leaving or self._target, STATE_INTERVAL_S)
                target, self._target = self._target, None
                if self._leaving:
                    return
            if target is not None:
                sdk.set_target(target["target"])
                self._report({"taken": target["number"], **sdk.state()})
                continue
            polls += 1
            if polls * STATE_INTERVAL_S >= CHECK_INTERVAL_S:
                polls = 0
                sdk.check()
            self._report(sdk.state())

    def _report(self, message: dict[str, Any]) -> None:
        with self._changed:
            if len(self._arrived) < MAX_UNREAD_BYTES:
                self._arrived += json.dumps(message).encode() + b"\n"
            self._changed.notify_all()

    def _mark_left(self) -> None:
        with self._changed:
            self._left = True
            self._changed.notify_all()
