"""Reachy Mini's SDK behind the interface of a port: lines of JSON in, lines of JSON out.

The SDK waits: for the network, for its daemon, for a motion to end. It does so in a thread of its
own here, so neither the link nor the picture waits with it. A daemon that dies, or says nothing for
a second, is a port that is unplugged.
"""

import contextlib
import importlib
import json
import threading
from collections.abc import Callable
from typing import Any

import serial

from robot.contract.port import READ_TIMEOUT_S, Clock, Port
from robot.drivers.reachy.hand import CONNECT_WITHIN, Hand
from robot.errors import RobotError

PORT = 8000
"""Where the daemon listens, if the URL does not say."""

STATE_EVERY = 0.1
"""The state is told this often [s]."""

ALIVE_EVERY = 1.0
"""How often the SDK is asked whether the daemon still talks [s]; it may take a second to answer."""

PART_WITHIN = 0.8
"""Longest wait at the end for the last request to be sent [s]."""

WAITING_MAX = 65536
"""Most bytes that wait to be read."""

Connect = Callable[[str, int], Any]
"""Connects with the SDK: host and port in, a `reachy_mini.ReachyMini` out."""


def open_reachy(url: str, _clock: Clock) -> Callable[[], Port]:
    """Return what opens a line to the robot whose daemon is at "HOST", "HOST:PORT" or "".

    Raises
    ------
    RobotError
        If the URL is none, or the SDK is not installed.
    """
    host, colon, number = url.partition(":")
    if colon and not (number.isascii() and number.isdigit() and 0 < int(number[:6]) < 65536):
        raise RobotError(f"'reachy:{url}': the port must be a number, as in reachy:localhost:8000")
    if not all(one.isalnum() or one in "-._" for one in host):
        raise RobotError(f"'reachy:{url}': {host!r} is no name of a computer")
    try:
        importlib.import_module("reachy_mini")
    except (ImportError, ValueError) as error:  # ValueError: it misses a library of the system
        reason = " ".join(str(error).split())
        raise RobotError(
            f"Reachy Mini's SDK does not load ({reason}): pip install 'cubeling[reachy]', "
            "and see docs/reachy.md for the system's libraries that it needs"
        ) from None
    return lambda: ReachyLine(host or "localhost", int(number or PORT))


def _connect(host: str, port: int) -> Any:
    sdk = importlib.import_module("reachy_mini")
    return sdk.ReachyMini(
        host=host,
        port=port,
        connection_mode="network",
        media_backend="no_media",
        timeout=CONNECT_WITHIN,
        automatic_body_yaw=False,
        log_level="ERROR",
    )


class ReachyLine:
    """A line to one robot; it connects in the background.

    Parameters
    ----------
    host, port
        Where the robot's daemon listens.
    connect
        How to reach it.
    """

    def __init__(self, host: str, port: int, connect: Connect = _connect) -> None:
        self._address = host, port
        self._connect = connect
        self._lock = threading.Condition()
        self._target: dict[str, Any] | None = None
        self._parting = self._parted = self._broken = False
        self._arrived = bytearray()
        name = f"reachy {host}:{port}"
        self._thread = threading.Thread(target=self._serve, name=name, daemon=True)
        self._thread.start()

    # --- The port's side -------------------------------------------------------------------------

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once."""
        with self._lock:
            return len(self._arrived)

    def read(self, size: int = 1, /) -> bytes:
        """Read up to `size` bytes; waits at most `READ_TIMEOUT_S` for the first."""
        with self._lock:
            if not self._arrived and not self._broken:
                self._lock.wait(READ_TIMEOUT_S)
            if not self._arrived and self._broken:
                raise serial.SerialException("the robot's daemon does not answer")
            data = bytes(self._arrived[:size])
            del self._arrived[:size]
            return data

    def write(self, data: bytes, /) -> int:
        """Hand whole lines to the robot; of several targets the latest counts."""
        for line in data.splitlines():
            said = json.loads(line)
            with self._lock:
                self._parting |= "bye" in said
                self._target = said if "target" in said else self._target
                self._lock.notify_all()
        return len(data)

    def cancel_read(self) -> None:
        """End a read that waits."""
        with self._lock:
            self._lock.notify_all()

    def close(self) -> None:
        """Let the robot go; waits at most `PART_WITHIN`."""
        with self._lock:
            self._parting = True
            self._lock.notify_all()
            self._lock.wait_for(lambda: self._parted, PART_WITHIN)

    # --- The robot's side, in its own thread -----------------------------------------------------

    def _serve(self) -> None:
        try:
            mini = self._connect(*self._address)
            with contextlib.closing(Hand(mini)) as hand:
                hand.get_up()
                self._tell({"hello": hand.version, **hand.state()})
                self._follow(hand)
                hand.part(self._sent)
        except Exception:  # whatever the SDK raises: the line is dead, and looked for again
            with self._lock:
                self._broken = True
        finally:
            self._sent()

    def _follow(self, hand: Hand) -> None:
        """Carry out targets until the end, and tell the state meanwhile."""
        looks = 0
        while True:
            with self._lock:
                self._lock.wait_for(lambda: self._parting or self._target, STATE_EVERY)
                target, self._target = self._target, None
                if self._parting:
                    return
            if target is not None:
                hand.turn(target["target"])
                self._tell({"taken": target["number"], **hand.state()})
                continue
            looks += 1
            if looks * STATE_EVERY >= ALIVE_EVERY:
                looks = 0
                hand.check()
            self._tell(hand.state())

    def _tell(self, what: dict[str, Any]) -> None:
        with self._lock:
            if len(self._arrived) < WAITING_MAX:
                self._arrived += json.dumps(what).encode() + b"\n"
            self._lock.notify_all()

    def _sent(self) -> None:
        with self._lock:
            self._parted = True
            self._lock.notify_all()
