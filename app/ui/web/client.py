"""One page that is connected: what waits to be sent to it, and what it sends."""

import asyncio
import contextlib
from collections import deque
from collections.abc import Callable
from typing import Protocol

import msgspec
from aiohttp import WSMsgType, web

from cubeling.app.errors import AppError
from cubeling.app.ui.web.fineness import FinenessControl
from cubeling.app.ui.web.language import localized
from cubeling.app.ui.web.limits import RateLimit, WebLimits
from cubeling.app.ui.web.messages import PICTURE, Role, Said, pack, read_said, unpack

MAX_WAITING = 32
"""Messages and sounds that wait for a page; of more, the oldest are left out."""

LAST_WORDS_S = 1.0
"""Time for the message that says why a page is disconnected [s]."""


CARDS = "cards "
"""Begins the kind of a picture with cards: the language of the hint follows."""

Look = tuple[str, int]
"""How a picture is wanted: its kind, "cards en", "plain" or "cutout", and place in `FINENESSES`."""


class ShownPicture(Protocol):
    """A picture for the pages."""

    @property
    def number(self) -> int:
        """Of the picture, from 1; a page names it when it has shown it."""
        ...

    def data(self, look: Look) -> bytes | None:
        """Return it encoded; None if nobody wanted that kind."""
        ...

    def taken(self, page: str) -> float:
        """Return when its frame was taken, by the clock of a page; 0 if by another camera."""
        ...


class PageClient:
    """A page with the token. All of it happens in the loop of the server.

    Nothing that waits for it grows: the newest picture replaces the one before it, and at most
    `WebLimits.pictures_in_flight` are on their way.
    """

    def __init__(
        self,
        socket: web.WebSocketResponse,
        page: str,
        attempt: int,
        role: Role,
        kind: str,
        language: str,
        limits: WebLimits,
        clock: Callable[[], float],
    ) -> None:
        self.page, self.role = page, role
        self.attempt = attempt
        """Which connection of the page this is: a later one has a larger number."""
        self.camera = ""
        """The camera that it has named last; "" for the one that it had before a cut."""
        self.heard = clock()
        """When it said something last [s]."""
        self._kind, self._language, self._fineness = kind, language, FinenessControl()
        self._socket, self._limits, self._clock = socket, limits, clock
        self._messages = RateLimit(limits.messages_per_s, limits.messages_burst_s)
        self._bytes = RateLimit(limits.bytes_per_s)
        self._texts: deque[str] = deque(maxlen=MAX_WAITING)
        self._sounds: deque[bytes] = deque(maxlen=MAX_WAITING)
        self._picture: ShownPicture | None = None
        self._in_flight: deque[tuple[int, float]] = deque()
        self._waiting = asyncio.Event()
        self._left: asyncio.Future[str] = asyncio.get_running_loop().create_future()

    @property
    def look(self) -> Look | None:
        """How it wants its pictures now; None if it wants none."""
        return None if self.role == "camera" else (self._kind, self._fineness.level)

    def tell(self, **message: object) -> None:
        """Send a message in JSON; what is `English` in it is sent in the page's language."""
        self._texts.append(msgspec.json.encode(localized(message, self._language)).decode())
        self._waiting.set()

    def show(self, picture: ShownPicture) -> None:
        """Send a picture, unless a newer one comes before it can be sent."""
        if self.look is not None:
            self._fineness.offer(self._clock())
            self._picture = picture
            self._waiting.set()

    def send(self, message: bytes) -> None:
        """Send a binary message that must not be left out, if it is read soon enough."""
        self._sounds.append(message)
        self._waiting.set()

    async def serve(
        self, hear: Callable[[Said], None], see: Callable[[int, float, bytes], None]
    ) -> str:
        """Exchange messages until the page leaves; return why it has to, or "".

        `hear` is called with what it says, and `see` with number, time and JPEG of its pictures.
        """
        sending = asyncio.create_task(self._send())
        receiving = asyncio.create_task(self._receive(hear, see))
        try:
            await asyncio.wait(
                (sending, receiving, self._left), return_when=asyncio.FIRST_COMPLETED
            )
            if self._left.done():
                return self._left.result()
            return receiving.result() if receiving.done() else ""
        finally:
            for task in (sending, receiving):
                task.cancel()
            await asyncio.gather(sending, receiving, return_exceptions=True)

    def leave(self, why: str) -> None:
        """Disconnect it for a reason, which `serve` returns."""
        if not self._left.done():
            self._left.set_result(why)

    async def close(self, why: str) -> None:
        """Disconnect it, and say why; call it after `serve`."""
        with contextlib.suppress(TimeoutError, ConnectionError, RuntimeError):
            await asyncio.wait_for(
                self._socket.close(code=4000, message=why.encode()[:120]), LAST_WORDS_S
            )

    async def _receive(
        self, hear: Callable[[Said], None], see: Callable[[int, float, bytes], None]
    ) -> str:
        async for message in self._socket:
            now = self.heard = self._clock()
            if message.type not in (WSMsgType.TEXT, WSMsgType.BINARY):
                return ""
            if not (self._messages.allows(1, now) and self._bytes.allows(len(message.data), now)):
                return "this page sends too much"
            try:
                if message.type == WSMsgType.BINARY:
                    _, number, taken, jpeg = unpack(message.data)
                    see(number, taken, jpeg)
                elif len(message.data) > self._limits.text_bytes:
                    return "this page says too much"
                else:
                    self._hear(read_said(message.data), hear)
            except AppError as error:
                return str(error)
        return ""

    def _hear(self, said: Said, hear: Callable[[Said], None]) -> None:
        if said.do == "shown":
            while self._in_flight and self._in_flight[0][0] <= said.id:
                _, sent = self._in_flight.popleft()
                self._fineness.shown(self._clock() - sent)
            self._waiting.set()
        else:
            hear(said)

    async def _send(self) -> None:
        while True:
            await self._waiting.wait()
            self._waiting.clear()
            while self._texts:
                await self._socket.send_str(self._texts.popleft())
            while self._sounds:
                await self._socket.send_bytes(self._sounds.popleft())
            picture, free = self._picture, self._limits.pictures_in_flight - len(self._in_flight)
            look = self.look
            if picture is None or look is None or free <= 0:
                continue
            self._picture = None
            data = picture.data(look)
            if data is not None:
                self._in_flight.append((picture.number, self._clock()))
                taken = picture.taken(self.page)
                await self._socket.send_bytes(pack(PICTURE, picture.number, taken, data))
