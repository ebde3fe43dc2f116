"""A block server with its character in a process of its own, and clients of it."""

import multiprocessing
import resource
import socket
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection

from cubeling.app.admission import Token
from cubeling.app.behaving.live import play_live
from cubeling.app.behaving.player import BehaviourFrame, BehaviourPlayer
from cubeling.app.behaving.server import BlockServer
from cubeling.app.behaving.voice import SilentSource
from cubeling.characters import Character

TOKEN = Token("campaign-token")

RATE = 25.0
"""Frames a second."""

ANSWER_S = 30.0
"""Time in which the process answers, or the campaign ends [s]."""

SEND_S = 0.5
"""Time in which a socket takes or gives something, or an attack goes on [s]."""


RETRY_S = 0.2
"""Time after which a client connects again that was told to [s]."""


@dataclass(frozen=True)
class Seen:
    """What the process has seen since it was asked last."""

    frames: int

    worst_s: float
    """Longest time from one frame to the next [s]."""

    worst_cpu_s: float
    """Most CPU time of the thread that makes the frames, for one [s]."""

    peak_mb: float
    """Most memory of the process so far [MB]."""


class Watched:
    """Shows nothing, and measures the time between frames until it is told to stop."""

    def __init__(self, pipe: Connection) -> None:
        self.closed = False
        self._pipe = pipe
        self._last: tuple[float, float] | None = None
        self._frames, self._worst = 0, (0.0, 0.0)

    def show(self, player: BehaviourPlayer, frame: BehaviourFrame) -> None:
        """Note the time, and answer."""
        now = time.monotonic(), time.thread_time()
        if self._last is not None:
            self._worst = (
                max(self._worst[0], now[0] - self._last[0]),
                max(self._worst[1], now[1] - self._last[1]),
            )
        self._last, self._frames = now, self._frames + 1
        while self._pipe.poll():
            self.closed = self._pipe.recv() == "stop"
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
            self._pipe.send(Seen(self._frames, *self._worst, peak))
            self._frames, self._worst = 0, (0.0, 0.0)


def _serve(pipe: Connection) -> None:
    with closing(BlockServer(0, TOKEN)) as server:
        player = BehaviourPlayer(Character.load("human"), SilentSource("no voice"))
        pipe.send(server.port)
        play_live(player, server, Watched(pipe), RATE)


@dataclass(frozen=True)
class Served:
    """A running server."""

    port: int

    pipe: Connection

    def seen(self, question: str = "seen") -> Seen:
        """Return what the process has seen since this was asked last.

        Raises
        ------
        TimeoutError
            The process does not answer.
        """
        self.pipe.send(question)
        if not self.pipe.poll(ANSWER_S):
            raise TimeoutError("the server does not answer")
        seen: Seen = self.pipe.recv()
        return seen

    def connect(self, first: str | None = None, patience_s: float = SEND_S) -> socket.socket:
        """Return a connection whose first line is sent, with the token unless another is given."""
        client = socket.create_connection(("127.0.0.1", self.port), patience_s)
        client.sendall((f"token {TOKEN.text}\n" if first is None else first).encode())
        return client


@contextmanager
def serve() -> Iterator[Served]:
    """Run a server, and end it afterwards."""
    here, there = multiprocessing.Pipe()
    process = multiprocessing.get_context("spawn").Process(target=_serve, args=(there,))
    process.start()
    try:
        if not here.poll(ANSWER_S):
            raise TimeoutError("the server does not start")
        yield Served(here.recv(), here)
        here.send("stop")
        process.join(ANSWER_S)
    finally:
        if process.is_alive():
            process.kill()
        process.join()


def served_s(server: Served, name: str, patience_s: float) -> float:
    """Return how long it takes until a block of a new client starts [s]; inf if it does not.

    When it is told that there is no room, it replaces what goes on; that there is no place, it
    connects again.
    """
    began = time.monotonic()
    while time.monotonic() < began + patience_s:
        served, later = _answer(server, name, began + patience_s)
        if served:
            return time.monotonic() - began
        if not later:
            break
        time.sleep(RETRY_S)
    return float("inf")


def _answer(server: Served, name: str, until: float) -> tuple[bool, bool]:
    """Return whether a block of a client that connects now starts, or it is told to come later."""
    heard = b""
    with suppress(OSError), closing(server.connect(None, until - time.monotonic())) as client:
        client.sendall(_block(name))
        while (left := until - time.monotonic()) > 0.0:
            client.settimeout(left)
            part = client.recv(1 << 16)
            if not part:
                break
            heard += part
            if f'id="{name}:start"'.encode() in heard:
                return True, False
            if f'id="{name}" type="IMPOSSIBLE_TO_SCHEDULE"'.encode() in heard:
                heard = b""
                client.sendall(_block(name, 'composition="REPLACE"'))
            heard = heard[-(1 << 16) :]
    return False, b"connect later" in heard


def _block(name: str, more: str = "") -> bytes:
    return f'<bml id="{name}" {more}><head id="nod" lexeme="NOD"/></bml>\n'.encode()
