"""A simulated robot behind a real port: a pseudo-terminal, or a TCP port on Windows."""

import contextlib
import errno
import os
import select
import socket
import sys
import threading
import time
from typing import Literal

from cubeling.robot.contract.closeable import Closeable
from cubeling.robot.contract.port import Clock
from cubeling.robot.errors import RobotError
from cubeling.robot.simulators import Simulated
from cubeling.robot.simulators.cubeling.simulator import Simulator

POLL_TIMEOUT_S = 0.010
"""Longest wait for bytes [s]; the robot advances in steps of 20 ms."""

MAX_READ_BYTES = 4096
"""Most bytes of one read."""


class _PtyLine:
    """The robot's side of a pseudo-terminal. It keeps the far end open: clients come and go."""

    def __init__(self) -> None:
        import termios  # not on Windows
        import tty

        self._near, self._far = os.openpty()
        try:
            tty.setraw(self._far, termios.TCSANOW)
            os.set_blocking(self._near, False)
            self.url = os.ttyname(self._far)
        except BaseException:
            os.close(self._near)
            os.close(self._far)
            raise

    def read(self) -> bytes:
        ready, _, _ = select.select([self._near], [], [], POLL_TIMEOUT_S)
        if not ready:
            return b""
        try:
            return os.read(self._near, MAX_READ_BYTES)
        except OSError as error:
            if error.errno not in (errno.EIO, errno.EAGAIN):
                raise
            return b""  # the client has just left; another one may come

    def write(self, data: bytes) -> None:  # what does not fit is lost, as on a real line
        with contextlib.suppress(BlockingIOError):
            os.write(self._near, data)

    def close(self) -> None:
        os.close(self._near)
        os.close(self._far)


class _TcpLine:
    """The robot's side of a local TCP port; it serves the latest client."""

    def __init__(self, number: int) -> None:
        self._server = socket.create_server(("127.0.0.1", number))
        self._client: socket.socket | None = None
        self.url = f"socket://127.0.0.1:{self._server.getsockname()[1]}"

    def read(self) -> bytes:
        watched = [self._server, *([self._client] if self._client else [])]
        ready, _, _ = select.select(watched, [], [], POLL_TIMEOUT_S)
        if self._server in ready:
            self._drop_client()
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
            self._drop_client()
        return data

    def write(self, data: bytes) -> None:
        if self._client is not None:
            with contextlib.suppress(OSError):
                self._client.send(data)

    def close(self) -> None:
        self._drop_client()
        self._server.close()

    def _drop_client(self) -> None:
        if self._client is not None:
            self._client.close()
            self._client = None


class SimulatedPort(Closeable):
    """A simulated robot behind a real port, best used in a `with` statement.

    Parameters
    ----------
    simulator
        The robot; a new one if None. Only this port's thread uses it until `close`.
    kind
        "pty" for a pseudo-terminal, "tcp" for a port on 127.0.0.1; None for what the system has.
    tcp_port
        Number of the TCP port; 0 for any free one.
    clock
        The time of the robot [s].

    Examples
    --------
    >>> from cubeling import robot
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
            self._line: _PtyLine | _TcpLine = _PtyLine() if kind == "pty" else _TcpLine(tcp_port)
        except (OSError, ImportError) as error:
            raise RobotError(f"cannot make a port for the simulated robot: {error}") from error
        self.url = self._line.url
        """The URL of the robot for pySerial."""
        self._closing = threading.Event()
        self._thread = threading.Thread(
            target=self._serve, name=f"robot at {self.url}", daemon=True
        )
        self._thread.start()

    def close(self) -> None:
        """Stop the robot and close the port. A second call does nothing."""
        if self._closing.is_set():
            return
        self._closing.set()
        self._thread.join()  # it never waits longer than `POLL_TIMEOUT_S`
        self._line.close()

    def _serve(self) -> None:
        while not self._closing.is_set():
            data = self._line.read()
            now = self._clock()
            self._simulator.receive(data, now)
            answer = self._simulator.bytes_to_send()
            if answer:
                self._line.write(answer)
