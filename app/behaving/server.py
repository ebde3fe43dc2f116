"""Taking blocks over TCP and sending feedback, on one thread that no frame waits for."""

import contextlib
import math
import queue
import selectors
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from functools import partial

from cubeling.app.admission import ClientLimits, Token
from cubeling.app.behaving.client import ServedClient
from cubeling.app.behaving.splitting import StreamBroken
from cubeling.app.errors import AppError
from cubeling.characters.behaviour import BmlWarning, feedback_xml

MAX_PORT = 65_535
"""The last TCP port."""

RECEIVED_AT_ONCE = 1 << 14
"""Bytes that are taken from a client before it is another's turn."""

MAX_GONE = 64
"""Documents of clients that have gone and wait; the oldest go first."""

CHECK_EVERY_S = 0.5
"""Time after which limits of time are checked, also if nothing comes [s]."""


class _Connection:
    """A client, and what is to be sent to it."""

    def __init__(self, socket: socket.socket, client: ServedClient) -> None:
        self.socket, self.client = socket, client
        self.unsent = bytearray()
        self.left: float | None = None
        """When it was told that it is disconnected [s]: nothing more is taken from it."""

    @property
    def events(self) -> int:
        """What the selector is to wait for; what is thrown away is read too."""
        reading = self.left is not None or not self.client.full
        return (selectors.EVENT_READ if reading else 0) | (
            selectors.EVENT_WRITE if self.unsent else 0
        )


class BlockServer:
    """Receives documents from all clients, and sends feedback to all. Whoever opens it closes it.

    Clients tell the token in their first line. Their documents are taken by turns, one of each.

    Parameters
    ----------
    port
        The TCP port; 0 for any free one.
    token
        What admits a client.
    host
        The address that it listens at.
    limits
        What clients may use.
    clock
        The time [s].

    Raises
    ------
    AppError
        The port cannot be used.
    """

    def __init__(
        self,
        port: int,
        token: Token,
        host: str = "127.0.0.1",
        limits: ClientLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        if not 0 <= port <= MAX_PORT:
            raise AppError(f"there is no port {port}: choose another port, up to {MAX_PORT}")
        try:
            self._listener = socket.create_server((host, port))
        except OSError as error:
            raise AppError(
                f"cannot listen at {host}:{port}: {error.strerror}; choose another port"
            ) from error
        self.port: int = self._listener.getsockname()[1]
        """The port."""
        self._token, self._limits, self._clock = token, limits or ClientLimits(), clock
        self._outgoing: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._waking, self._woken = socket.socketpair()
        self._connections: dict[socket.socket, _Connection] = {}
        self._gone: deque[bytes] = deque(maxlen=MAX_GONE)
        self._turns: deque[deque[bytes]] = deque()
        self._changed = threading.Condition()  # guards the turns and what waits for one
        self._selector = selectors.DefaultSelector()
        for each in (self._listener, self._woken, self._waking):
            each.setblocking(False)
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._selector.register(self._woken, selectors.EVENT_READ)
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="blocks", daemon=True)
        self._thread.start()

    def next_document(self, timeout_s: float = 0.0, most: float = math.inf) -> bytes | None:
        """Return the document whose turn it is, of those of at most so many bytes.

        None if none comes within so many seconds. Who has a longer one keeps its turn.
        """

        def turn() -> deque[bytes] | None:
            return next((each for each in self._turns if len(each[0]) <= most), None)

        with self._changed:
            waiting = self._changed.wait_for(turn, max(timeout_s, 0.0))
            if waiting is None:
                return None
            # By identity: two clients may wait with the same documents.
            self._turns = deque(each for each in self._turns if each is not waiting)
            document = waiting.popleft()
            if waiting:
                self._turns.append(waiting)
        self._wake()  # there is room for more of this client
        return document

    def send(self, document: str) -> None:
        """Send a document, or several in lines, to all clients."""
        self._outgoing.put(document.encode() + b"\n")
        self._wake()

    def close(self) -> None:
        """Offer clients what is unsent, and disconnect them; a second call does nothing."""
        self._closing = True
        self._wake()
        self._thread.join(5.0)

    def _wake(self) -> None:
        with contextlib.suppress(OSError):  # full: it wakes anyway; closed: it has ended
            self._waking.send(b"!")

    def _run(self) -> None:
        try:
            while not self._closing:
                for key, events in self._selector.select(CHECK_EVERY_S):
                    self._serve(key.fileobj, events)
                self._distribute()
                self._check()
            self._distribute()
        finally:
            for connection in list(self._connections.values()):
                self._drop(connection)
            self._selector.close()
            for each in (self._listener, self._woken, self._waking):
                each.close()

    def _serve(self, ready: object, events: int) -> None:
        if ready is self._listener:
            self._accept()
        elif ready is self._woken:
            with contextlib.suppress(OSError):
                self._woken.recv(4096)
        elif isinstance(ready, socket.socket) and ready in self._connections:
            connection = self._connections[ready]
            if events & selectors.EVENT_READ:
                self._receive(connection)
            if events & selectors.EVENT_WRITE and ready in self._connections:
                self._flush(connection)

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            accepted, _ = self._listener.accept()
            accepted.setblocking(False)
            client = ServedClient(self._token, self._limits, self._clock())
            self._connections[accepted] = _Connection(accepted, client)
            self._selector.register(accepted, selectors.EVENT_READ)
            self._receive(self._connections[accepted])  # most tell the token at once
            # Those without the token cannot take the places of those that have it.
            strangers = [c for c in self._connections.values() if not c.client.admitted]
            if len(strangers) > self._limits.strangers:
                self._drop(strangers[0])

    def _receive(self, connection: _Connection) -> None:
        try:
            received = connection.socket.recv(RECEIVED_AT_ONCE)
        except BlockingIOError:
            return
        except OSError:
            received = b""
        if not received:
            self._drop(connection)
        elif connection.left is None:
            client, known = connection.client, connection.client.admitted
            self._read(connection, partial(client.receive, received, self._clock()))
            if client.admitted and not known:
                self._welcome(connection)

    def _read(self, connection: _Connection, read: Callable[[], None]) -> None:
        """Let a client find documents, and give them their turns."""
        waiting = connection.client.waiting
        try:
            with self._changed:
                known = bool(waiting)
                try:
                    read()
                finally:
                    if waiting and not known:
                        self._turns.append(waiting)
                        self._changed.notify()
        except StreamBroken as error:
            self._refuse(connection, f"{error}; connect again")

    def _welcome(self, newcomer: _Connection) -> None:
        """Find a place for a client: of one that is quiet, or none."""
        served = [c for c in self._connections.values() if c.client.admitted and c.left is None]
        if len(served) <= self._limits.clients:
            return
        quiet = min(served, key=lambda connection: connection.client.heard)
        if self._clock() - quiet.client.heard > self._limits.quiet_s:
            self._refuse(quiet, "another client needs the place; connect again")
        else:
            self._refuse(newcomer, f"there are {self._limits.clients} clients; connect later")

    def _refuse(self, connection: _Connection, why: str) -> None:
        """Warn one client, and take nothing more from it."""
        warning = BmlWarning("", "PARSING_FAILURE", why, 0.0)
        connection.left = self._clock()
        self._offer(connection, feedback_xml(warning).encode() + b"\n")

    def _check(self) -> None:
        """Read on where there is room again, and disconnect those that exceed limits of time."""
        now = self._clock()
        for connection in list(self._connections.values()):
            if connection.left is not None:
                if now > connection.left + self._limits.farewell_s:
                    self._drop(connection)
                continue
            client = connection.client
            if connection.socket not in self._selector.get_map() and _is_reset(connection.socket):
                self._drop(connection)
                continue
            with self._changed:
                why = client.overdue(now)
            if why:
                self._refuse(connection, f"{why}; connect again")
                continue
            self._read(connection, partial(client.read, now))
            if connection.socket in self._connections:
                self._watch(connection)

    def _distribute(self) -> None:
        # All at once: each call to a socket gives the interpreter away for some milliseconds.
        documents = b"".join(self._unsent())
        if documents:
            for connection in list(self._connections.values()):
                if connection.left is None and connection.client.admitted:
                    self._offer(connection, documents)

    def _unsent(self) -> Iterator[bytes]:
        with contextlib.suppress(queue.Empty):
            while True:
                yield self._outgoing.get_nowait()

    def _offer(self, connection: _Connection, document: bytes) -> None:
        connection.unsent += document
        self._flush(connection)
        if len(connection.unsent) > self._limits.unsent:
            self._drop(connection)

    def _flush(self, connection: _Connection) -> None:
        """Send as much as the client takes now."""
        try:
            sent = connection.socket.send(connection.unsent) if connection.unsent else 0
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(connection)
            return
        del connection.unsent[:sent]
        self._watch(connection)
        if connection.left is not None and not connection.unsent:
            with contextlib.suppress(OSError):
                connection.socket.shutdown(socket.SHUT_WR)  # what it still sends is thrown away

    def _watch(self, connection: _Connection) -> None:
        """Wait for what a connection is to do next; for one that does nothing, only for room."""
        with self._changed:
            events = connection.events
        watched = connection.socket in self._selector.get_map()
        if watched and events:
            self._selector.modify(connection.socket, events)
        elif watched:
            self._selector.unregister(connection.socket)
        elif events:
            self._selector.register(connection.socket, events)

    def _drop(self, connection: _Connection) -> None:
        if self._connections.pop(connection.socket, None) is None:
            return
        if connection.socket in self._selector.get_map():
            self._selector.unregister(connection.socket)
        connection.socket.close()
        with self._changed:
            # What those that have gone have left shares one turn, or it would come before others'.
            waiting = connection.client.waiting
            if not waiting:
                return
            self._turns = deque(each for each in self._turns if each is not waiting)
            if not self._gone:
                self._turns.append(self._gone)
            self._gone.extend(waiting)


def _is_reset(connection: socket.socket) -> bool:
    """Return whether a connection that is not read has been cut off: it would hold its place."""
    try:
        connection.recv(1, socket.MSG_PEEK)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return False
