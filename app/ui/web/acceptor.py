"""Accepting connections: so many a second, and strangers for a short time only."""

import asyncio
import gc
import socket
import ssl
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from typing import Any

from aiohttp import web
from aiohttp.web_protocol import RequestHandler

from cubeling.app.errors import AppError
from cubeling.app.ui.web.limits import RateLimit, WebLimits

RETRY_S = 0.5
"""Accepting is tried again after so long, where too many files are open [s]."""

CONNECTIONS_PER_COLLECTION = 20
"""After so many connections, what they have left is collected."""


@dataclass(frozen=True)
class Listener:
    """An address at which the server listens."""

    host: str
    """As "127.0.0.1"."""

    port: int
    """The TCP port; 0 for any free one."""

    tls: ssl.SSLContext | None = None
    """The certificate; None for plain HTTP, which browsers let use the camera on localhost only."""


class Acceptor:
    """Accepts connections for a server of HTTP. Whoever starts it stops it, in the same loop.

    A connection is a stranger until `admit` says that it is a page; the oldest strangers go.

    Parameters
    ----------
    listeners, limits
        Where it listens, and how much it accepts.
    clock
        The time [s].

    Raises
    ------
    AppError
        An address or port cannot be used.
    """

    def __init__(
        self, listeners: Sequence[Listener], limits: WebLimits, clock: Callable[[], float]
    ) -> None:
        self._limits, self._clock = limits, clock
        self._listening = [(_listen(each), each.tls) for each in listeners]
        self.ports: list[int] = [each.getsockname()[1] for each, _ in self._listening]
        """The port of each listener."""
        self._strangers: dict[RequestHandler, float] = {}
        self._connected = 0
        self._tasks: set[asyncio.Task[None]] = set()

    def start(self, server: web.Server) -> None:
        """Accept from now on."""
        for listening, tls in self._listening:
            self._run(self._accept(server, listening, tls))

    async def stop(self) -> None:
        """Accept nothing any more."""
        for task in tuple(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        for listening, _ in self._listening:
            listening.close()

    def admit(self, handler: RequestHandler) -> None:
        """Let a connection stay for as long as it likes."""
        self._strangers.pop(handler, None)

    def check(self, now: float) -> None:
        """Let strangers go whose time is over."""
        # What is no HTTP leaves cycles with a quarter of a megabyte each. A program that draws
        # looks for garbage too seldom for a flood of those, and only young objects are looked at.
        if self._connected >= CONNECTIONS_PER_COLLECTION:
            self._connected = 0
            gc.collect(0)
        for handler, since in tuple(self._strangers.items()):
            if handler.transport is None or now - since > self._limits.stranger_s:
                self._drop(handler)

    def _run(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _accept(
        self, server: web.Server, listening: socket.socket, tls: ssl.SSLContext | None
    ) -> None:
        """Accept connections, so many a second: others wait in the system's queue."""
        rate = self._limits.connections_per_s
        pace = RateLimit(rate, self._limits.burst / rate)
        while True:
            while not pace.allows(1.0, self._clock()):
                await asyncio.sleep(1.0 / rate)
            try:
                accepted, _ = await asyncio.get_running_loop().sock_accept(listening)
            except OSError:  # too many files are open, for example
                await asyncio.sleep(RETRY_S)
                continue
            accepted.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._connected += 1
            self._run(self._connect(server(), accepted, tls))

    async def _connect(
        self, handler: RequestHandler, accepted: socket.socket, tls: ssl.SSLContext | None
    ) -> None:
        loop = asyncio.get_running_loop()
        more = {} if tls is None else {"ssl_handshake_timeout": self._limits.stranger_s}
        try:
            await loop.connect_accepted_socket(lambda: handler, accepted, ssl=tls, **more)
        except (OSError, ssl.SSLError, TimeoutError):
            accepted.close()
            return
        if len(self._strangers) >= self._limits.strangers:
            self._drop(next(iter(self._strangers)))
        self._strangers[handler] = self._clock()

    def _drop(self, handler: RequestHandler) -> None:
        self._strangers.pop(handler, None)
        if handler.transport is not None:
            handler.transport.abort()


def _listen(listener: Listener) -> socket.socket:
    try:
        opened = socket.create_server((listener.host, listener.port), backlog=128)
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise AppError(
            f"cannot listen at {listener.host}:{listener.port}: {reason}; choose another --port"
        ) from error
    opened.setblocking(False)
    return opened
