"""Taking blocks over TCP and sending feedback, on one thread that no frame waits for."""

import contextlib
import queue
import selectors
import socket
import threading

from cubeling.app.behaving.splitting import DocumentSplitter, StreamBroken
from cubeling.app.errors import AppError
from cubeling.characters.behaviour import BmlWarning, feedback_xml

MAX_CLIENTS = 16
"""Connections at one time; more are closed at once."""

MAX_WAITING = 256
"""Documents that wait for the next frame; more are refused."""

MAX_UNSENT = 1 << 20
"""Feedback that waits for a client [B]; one that takes less is disconnected."""

MAX_PORT = 65_535
"""The last TCP port."""

RECEIVED_AT_ONCE = 1 << 16
"""Bytes that are taken from a client before it is another's turn."""


class _Client:
    """A connection."""

    def __init__(self, connection: socket.socket) -> None:
        self.connection = connection
        self.splitter = DocumentSplitter()
        self.unsent = bytearray()
        self.broken = False
        """Whether nothing more is taken from it."""


class BlockServer:
    """Receives documents from all clients, and sends feedback to all. Whoever opens it closes it.

    Parameters
    ----------
    port
        The TCP port; 0 for any free one.
    host
        The address that it listens at.

    Raises
    ------
    AppError
        The port cannot be used.
    """

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
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
        self._documents: queue.Queue[bytes] = queue.Queue(MAX_WAITING)
        self._outgoing: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._waking, self._woken = socket.socketpair()
        self._clients: dict[socket.socket, _Client] = {}
        self._selector = selectors.DefaultSelector()
        for each in (self._listener, self._woken, self._waking):
            each.setblocking(False)
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._selector.register(self._woken, selectors.EVENT_READ)
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="blocks", daemon=True)
        self._thread.start()

    def documents(self, timeout_s: float = 0.0) -> list[bytes]:
        """Return the documents that have come; wait for the first one so long at most [s]."""
        found: list[bytes] = []
        with contextlib.suppress(queue.Empty):
            if timeout_s > 0.0:
                found.append(self._documents.get(timeout=timeout_s))
            while True:
                found.append(self._documents.get_nowait())
        return found

    def send(self, document: str) -> None:
        """Send a document to all clients."""
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
                for key, events in self._selector.select():
                    self._serve(key.fileobj, events)
                self._distribute()
            self._distribute()
        finally:
            for client in list(self._clients.values()):
                self._drop(client)
            self._selector.close()
            for each in (self._listener, self._woken, self._waking):
                each.close()

    def _serve(self, ready: object, events: int) -> None:
        if ready is self._listener:
            self._accept()
        elif ready is self._woken:
            with contextlib.suppress(OSError):
                self._woken.recv(4096)
        elif isinstance(ready, socket.socket) and ready in self._clients:
            client = self._clients[ready]
            if events & selectors.EVENT_READ:
                self._receive(client)
            if events & selectors.EVENT_WRITE and ready in self._clients:
                self._flush(client)

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            connection, _ = self._listener.accept()
            if len(self._clients) >= MAX_CLIENTS:
                connection.close()
                return
            connection.setblocking(False)
            self._clients[connection] = _Client(connection)
            self._selector.register(connection, selectors.EVENT_READ)

    def _receive(self, client: _Client) -> None:
        try:
            received = client.connection.recv(RECEIVED_AT_ONCE)
        except BlockingIOError:
            return
        except OSError:
            received = b""
        if not received:
            self._drop(client)
        if not received or client.broken:
            return
        try:
            for document in client.splitter.feed(received):
                self._documents.put_nowait(document)
        except StreamBroken as error:
            self._refuse(client, f"{error}; connect again")
        except queue.Full:
            self._refuse(client, "too many documents at once; connect again, and wait for feedback")

    def _refuse(self, client: _Client, why: str) -> None:
        """Warn one client, and take nothing more from it."""
        warning = BmlWarning("", "PARSING_FAILURE", why, 0.0)
        client.broken = True
        self._offer(client, feedback_xml(warning).encode() + b"\n")

    def _distribute(self) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                document = self._outgoing.get_nowait()
                for client in list(self._clients.values()):
                    if not client.broken:
                        self._offer(client, document)

    def _offer(self, client: _Client, document: bytes) -> None:
        client.unsent += document
        if len(client.unsent) > MAX_UNSENT:
            self._drop(client)
        else:
            self._flush(client)

    def _flush(self, client: _Client) -> None:
        """Send as much as the client takes now."""
        try:
            sent = client.connection.send(client.unsent) if client.unsent else 0
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop(client)
            return
        del client.unsent[:sent]
        wanted = selectors.EVENT_READ | (selectors.EVENT_WRITE if client.unsent else 0)
        self._selector.modify(client.connection, wanted)
        if client.broken and not client.unsent:
            with contextlib.suppress(OSError):
                client.connection.shutdown(socket.SHUT_WR)  # what it still sends is thrown away

    def _drop(self, client: _Client) -> None:
        if self._clients.pop(client.connection, None) is not None:
            self._selector.unregister(client.connection)
            client.connection.close()
