"""OSC over UDP: sending, and receiving from whoever sends, without ever waiting."""

import math
import socket
import struct
import sys
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

from pythonosc.osc_packet import OscPacket

from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.errors import AppError
from cubeling.robot import Closeable

Value = bool | int | float | str
"""An argument of a message."""

MAX_BUNDLE_BYTES = 1400
"""Messages are put together in one datagram up to this size [B], which networks do not divide."""

MAX_DATAGRAM_BYTES = 2048
"""A longer datagram is dropped: what may be asked for is short [B]."""

READ_AT_ONCE, READ_BYTES_AT_ONCE, DROP_AT_ONCE = 64, 8192, 1024
"""So many datagrams and bytes are read of what waits at a frame, and so many datagrams more are
thrown away. What waits longer is dropped by the system: no flood makes a frame late."""

MAX_BUNDLES = 4
"""A datagram may hold so many bundles, in each other or not."""

_BUNDLE = b"#bundle\0"
_IMMEDIATE = 1  # the time tag of what is to be done at once
_SO_RXQ_OVFL = 40  # of Linux: counts what the system has dropped


@dataclass(frozen=True)
class OscMessage:
    """One message of OSC."""

    address: str
    """Where it goes: "/cubeling/time"."""

    arguments: tuple[Value, ...]


class OscSender(Closeable):
    """Sends messages to an address by UDP; nobody need listen. A second `close` does nothing.

    Raises AppError if there is no such host.
    """

    def __init__(self, address: UdpAddress) -> None:
        family, self._target = address.resolve()
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        self.dropped = 0
        """Datagrams that the system did not take."""

    def send(self, messages: Iterable[OscMessage]) -> None:
        """Send messages, to be carried out immediately, in as few datagrams as go unbroken."""
        waiting: list[bytes] = []
        for message in messages:
            data = _encoded(message)
            if waiting and 16 + sum(map(len, waiting)) + 4 * (len(waiting) + 1) + len(data) > (
                MAX_BUNDLE_BYTES
            ):
                self._send(waiting)
                waiting = []
            waiting.append(data)
        if waiting:
            self._send(waiting)

    def _send(self, contents: list[bytes]) -> None:
        # A time tag in the future would be kept by some receivers until their memory is full.
        parts = [_BUNDLE, struct.pack(">Q", _IMMEDIATE)]
        for each in contents:
            parts += [struct.pack(">i", len(each)), each]
        try:
            self._socket.sendto(b"".join(parts), self._target)
        except OSError:  # its buffer is full, or the network is down: the next frame is newer
            self.dropped += 1

    def close(self) -> None:
        """Let go of the port."""
        self._socket.close()


class OscReceiver(Closeable):
    """Receives messages by UDP, a frame's worth at a time. A second `close` does nothing.

    There is no thread: what comes waits in the system's buffer, whose size bounds it.

    Raises AppError if the port cannot be had.
    """

    def __init__(self, address: UdpAddress) -> None:
        family, target = address.resolve()
        self._socket = socket.socket(family, socket.SOCK_DGRAM)
        try:
            self._socket.bind(target)
        except OSError as error:
            self._socket.close()
            raise AppError(f"OSC cannot listen at {address}: {error.strerror}") from error
        self._socket.setblocking(False)
        self._counts_lost = False
        if sys.platform == "linux":
            with suppress(OSError):
                self._socket.setsockopt(socket.SOL_SOCKET, _SO_RXQ_OVFL, 1)
                self._counts_lost = True
        self.port = int(self._socket.getsockname()[1])
        """The port; that of the address, or the one that the system chose for 0."""
        self.malformed = 0
        """Datagrams that are no OSC."""
        self.dropped = 0
        """Datagrams that came faster than they are read."""
        self._lost = 0

    def receive(self) -> list[OscMessage]:
        """Return the messages that have come, of a few datagrams; drop the rest."""
        found: list[OscMessage] = []
        size = 0
        for number in range(READ_AT_ONCE + DROP_AT_ONCE):
            data = self._read()
            if data is None:
                break
            size += len(data)
            if number >= READ_AT_ONCE or size > READ_BYTES_AT_ONCE:
                self.dropped += 1
                continue
            messages = decoded(data)
            if messages is None:
                self.malformed += 1
            else:
                found += messages
        return found

    def _read(self) -> bytes | None:
        """Return the next datagram; None if none waits."""
        try:
            if not self._counts_lost:  # Windows has no `recvmsg`
                return self._socket.recv(MAX_DATAGRAM_BYTES + 1)
            data, ancillary, _, _ = self._socket.recvmsg(MAX_DATAGRAM_BYTES + 1, 64)
        except OSError:  # none waits, or the network is down
            return None
        for level, kind, value in ancillary:
            if (level, kind) == (socket.SOL_SOCKET, _SO_RXQ_OVFL):
                lost = struct.unpack("=I", value[:4])[0]
                self.dropped += (lost - self._lost) % (1 << 32)
                self._lost = lost
        return data

    def close(self) -> None:
        """Let go of the port."""
        self._socket.close()


def _encoded(message: OscMessage) -> bytes:
    """Return a message as OSC 1.0 writes it; python-osc takes twenty times as long."""
    tags, parts = ",", []
    for value in message.arguments:
        if isinstance(value, str):
            tags += "s"
            parts.append(_padded(value))
        elif isinstance(value, float):
            tags += "f"
            parts.append(struct.pack(">f", value))
        else:  # truth too: many programs know no truth values
            tags += "i"
            parts.append(struct.pack(">i", value))
    return b"".join((_padded_once(message.address), _padded_once(tags), *parts))


def _padded(text: str) -> bytes:
    """Return a text with the zeros that end it; a name that comes from a file's may be no UTF-8."""
    data = text.encode(errors="replace")
    return data + b"\0" * (4 - len(data) % 4)


_padded_once = lru_cache(1024)(_padded)
"""The same for what comes again in each frame."""


def decoded(datagram: bytes) -> list[OscMessage] | None:
    """Return the messages of a datagram, whatever their time tags; None if it is no OSC.

    Numbers that are not finite, and arguments of other types than numbers and texts, are none.
    """
    if len(datagram) > MAX_DATAGRAM_BYTES or datagram.count(_BUNDLE) > MAX_BUNDLES:
        return None
    try:
        return [
            OscMessage(str(each.message.address), tuple(_values(each.message.params)))
            for each in OscPacket(datagram).messages
        ]
    except Exception:  # python-osc raises what its parts do: nothing that comes may end a session
        return None


def _values(parameters: Iterable[object]) -> Iterator[Value]:
    for value in parameters:
        if not isinstance(value, bool | int | float | str):
            raise ValueError(f"an argument is a {type(value).__name__}")
        if isinstance(value, float) and not math.isfinite(value):
            raise ValueError("an argument is not finite")
        yield value
