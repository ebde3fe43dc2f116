"""A simulated robot behind a real port: a pseudo-terminal, or a TCP port where there are none."""

import contextlib
import errno
import os
import select
import socket
import sys
import threading
import time
from typing import Literal, Protocol

from robot.contract.closeable import Closeable
from robot.contract.port import Clock
from robot.errors import RobotError
from robot.simulators.base import Simulated
from robot.simulators.cubeling.simulator import Simulator

WAIT = 0.010
"""Longest wait for bytes [s]; the robot lives in steps of 20 ms."""

MAX_READ_BYTES = 4096
"""Most bytes taken from the line in one go."""


class _Line(Protocol):
    """The robot's side of a line that clients come to and leave."""

    url: str
    """What a client gives to pySerial."""

    def read(self) -> bytes:
        """Wait a moment for bytes; none if there are none, or nobody is there."""

    def write(self, data: bytes) -> None:
        """Send what the line takes at once; the rest is lost, as on a real one."""

    def wake(self) -> None:
        """End a read that waits."""

    def close(self) -> None:
        """Give everything back."""


class _PtyLine:
    """A pseudo-terminal. Its far end stays open here too, so a client may come and go."""

    def __init__(self) -> None:
        import termios  # there is none on Windows
        import tty

        self._near, self._far = os.openpty()
        try:
            tty.setraw(self._far, termios.TCSANOW)
            os.set_blocking(self._near, False)
            self.url = os.ttyname(self._far)
            self._alarm, self._bell = os.pipe()
        except BaseException:
            os.close(self._near)
            os.close(self._far)
            raise

    def read(self) -> bytes:
        ready, _, _ = select.select([self._near, self._alarm], [], [], WAIT)
        if self._near not in ready:
            return b""
        try:
            return os.read(self._near, MAX_READ_BYTES)
        except OSError as error:
            if error.errno not in (errno.EIO, errno.EAGAIN):
                raise
            return b""  # the client has just left; another one will come

    def write(self, data: bytes) -> None:
        with contextlib.suppress(BlockingIOError):
            os.write(self._near, data)

    def wake(self) -> None:
        os.write(self._bell, b"!")

    def close(self) -> None:
        for descriptor in (self._near, self._far, self._alarm, self._bell):
            os.close(descriptor)


class _TcpLine:
    """A TCP port on this machine, for one client at a time; the latest one has it."""

    def __init__(self, number: int) -> None:
        self._server = socket.create_server(("127.0.0.1", number))
        self._client: socket.socket | None = None
        self._alarm, self._bell = socket.socketpair()
        self.url = f"socket://127.0.0.1:{self._server.getsockname()[1]}"

    def read(self) -> bytes:
        watched = [self._server, self._alarm, *([self._client] if self._client else [])]
        ready, _, _ = select.select(watched, [], [], WAIT)
        if self._server in ready:
            self._leave()
            self._client, _ = self._server.accept()
            self._client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._client.setblocking(False)
            return b""
        if self._client is None or self._client not in ready:
            return b""
        try:
            data = self._client.recv(MAX_READ_BYTES)
        except OSError:
            data = b""
        if not data:
            self._leave()
        return data

    def write(self, data: bytes) -> None:
        if self._client is not None:
            with contextlib.suppress(OSError):
                self._client.send(data)

    def wake(self) -> None:
        self._bell.send(b"!")

    def close(self) -> None:
        self._leave()
        for one in (self._server, self._alarm, self._bell):
            one.close()

    def _leave(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None


class SimulatedPort(Closeable):
    """Puts a simulated robot behind a real port, for as long as a `with` statement lasts.

    Parameters
    ----------
    simulator
        The robot; a new one if None. It belongs to this port's thread until the end.
    kind
        "pty" for a pseudo-terminal, "tcp" for a port on 127.0.0.1; by default what the system has.
    tcp_port
        Number of the TCP port; 0 for any that is free.
    clock
        The time [s] by which the robot lives.

    Examples
    --------
    >>> import robot
    >>> with SimulatedPort() as port, robot.connect(port.url) as dino:
    ...     dino.catalogue.name
    'Dino'
    """

    def __init__(
        self,
        simulator: Simulated | None = None,
        *,
        kind: Literal["pty", "tcp"] | None = None,
        tcp_port: int = 0,
        clock: Clock = time.monotonic,
    ) -> None:
        kind = kind or ("tcp" if sys.platform == "win32" else "pty")
        self._simulator = simulator or Simulator()
        self._clock = clock
        try:
            self._line: _Line = _PtyLine() if kind == "pty" else _TcpLine(tcp_port)
        except (OSError, ImportError) as error:
            raise RobotError(f"cannot make a port for the simulated robot: {error}") from error
        self.url = self._line.url
        """What pySerial opens to reach the robot."""
        self._ending = threading.Event()
        self._closed = False
        self._thread = threading.Thread(
            target=self._serve, name=f"robot at {self.url}", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """Stop the robot and give the port back. A second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self._ending.set()
        self._line.wake()
        self._thread.join()  # it waits for nothing longer than `WAIT`
        self._line.close()

    def _serve(self) -> None:
        while not self._ending.is_set():
            data = self._line.read()
            now = self._clock()
            self._simulator.receive(data, now)
            answer = self._simulator.bytes_to_send()
            if answer:
                self._line.write(answer)
