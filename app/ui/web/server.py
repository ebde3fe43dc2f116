"""The server of the page: it runs on a thread, and nobody who plays waits for it."""

import asyncio
import contextlib
import queue
import re
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import cast, get_args
from urllib.parse import urlsplit

from aiohttp import web

from cubeling.app.admission import Token
from cubeling.app.errors import AppError
from cubeling.app.ui.web.acceptor import Acceptor, Listener
from cubeling.app.ui.web.client import CARDS, LAST_WORDS_S, Look, PageClient, ShownPicture
from cubeling.app.ui.web.content import OpenedContent, WebContent, exchange
from cubeling.app.ui.web.language import LANGUAGES, English, language_of
from cubeling.app.ui.web.limits import WebLimits
from cubeling.app.ui.web.messages import PLAYER_ROLES, Role, Said
from cubeling.app.ui.web.page import Documents, page, view_page
from cubeling.app.ui.web.place import CameraPlace
from cubeling.tracking import ImageFeed

LOOPBACK = "127.0.0.1"
"""The address of this computer that no other one reaches."""

SOCKET_PATH, PROTOCOL = "/socket", "cubeling"
"""Where the WebSocket is, and its subprotocol; the token is offered as the other one."""

TOKEN_PATH = "/token"
"""Where a page that gets no WebSocket asks why: 403 for a wrong token, 503 without room."""

PAGE_PATHS, VIEW_PATH = ("/", "/window", "/camera"), "/view"
"""One page, which looks at its address, and the one that only shows the picture."""

REFUSED = "the token is missing or wrong\n"

KEEPS_CAMERA = "A recording keeps its camera: end it first"
"""What a page is told whose camera would take the place of the recorded one."""

CHECK_EVERY_S = 0.1
"""How often it is looked whom the limits of time let go [s]."""

MAX_REQUESTS = 64
"""What players have asked and nobody has carried out yet; what is more is forgotten."""

PAGE_NAME = re.compile(r"[a-z0-9]{4,32}")
ATTEMPT = re.compile(r"[0-9]{1,16}")
CAMERA_NAME = re.compile(r"[a-z0-9]{1,16}(-[a-z]{1,8})?")


class WebServer:
    """Serves the page and exchanges messages with all who know the token.

    Its methods may be called on any thread. Whoever makes it closes it.

    Parameters
    ----------
    listeners
        Where it listens.
    token
        What lets in.
    welcome
        What a page is told first, of "scenarios" and "rate" of the sound.
    limits
        What clients may use.
    clock
        The time [s].
    main
        The page that players get; None for `page()`.

    Raises
    ------
    AppError
        An address or port cannot be used.
    """

    def __init__(
        self,
        listeners: Sequence[Listener],
        token: Token,
        welcome: Mapping[str, object] | None = None,
        limits: WebLimits | None = None,
        clock: Callable[[], float] = time.monotonic,
        *,
        main: Documents | None = None,
    ) -> None:
        self.feed = ImageFeed()
        """The pictures of the camera."""
        self.camera = ""
        """Name of the camera that sends pictures, "ab12-back"; "" before the first."""
        self.keeps_camera = False
        """Whether no other camera may send pictures now, as a recording holds those of one."""
        self.tiles: Sequence[bytes] = ()
        """The scenarios' pictures, as messages."""
        self._token, self._limits, self._clock = token, limits or WebLimits(), clock
        self._welcome = dict(welcome or {})
        self._documents = {VIEW_PATH: view_page(), **dict.fromkeys(PAGE_PATHS, main or page())}
        self._opened: dict[str, OpenedContent] = {}
        self._kept: dict[str, dict[str, object]] = {}
        self._requests: queue.Queue[Said] = queue.Queue(MAX_REQUESTS)
        self._clients: dict[str, PageClient] = {}
        self._place = CameraPlace(clock)
        self._tags: deque[tuple[bytes, str, float]] = deque(maxlen=64)
        self._acceptor = Acceptor(listeners, self._limits, clock)
        self.ports: list[int] = self._acceptor.ports
        """The port of each listener."""
        self._listeners = tuple(listeners)
        self.fingerprint = ""
        """Of the certificate; "" without TLS."""
        self._loop = asyncio.new_event_loop()
        self._closing = False
        self._thread = threading.Thread(target=self._run, name="web", daemon=True)
        self._thread.start()

    @property
    def clients(self) -> tuple[str, ...]:
        """The pages that are connected now."""
        return tuple(self._clients)

    @property
    def wanted(self) -> frozenset[Look]:
        """How somebody looks at pictures."""
        looks = (each.look for each in tuple(self._clients.values()))
        return frozenset(each for each in looks if each is not None)

    def open(
        self,
        path: str,
        content: WebContent,
        token: Token | None = None,
        document: Documents | None = None,
    ) -> None:
        """Serve content below a path, as "/desk", to who tells its token.

        Parameters
        ----------
        path, content
            What is served, and where. Who asks says "Authorization: Bearer TOKEN".
        token
            What lets in, for people other than the players; None for the players' own.
        document
            The page at that path, which anybody may read; None for none.
        """
        self._opened[path] = OpenedContent(content, token or self._token)
        if document is not None:
            self._documents[path] = document

    def addresses(self, path: str = "/", token: Token | None = None) -> list[str]:
        """Return the addresses of a page: on this computer, and in the network if that is let in.

        `token` lets in; None for the players' own.
        """
        secret = (token or self._token).text
        hosts = ["http://localhost", *(f"https://{each.host}" for each in self._listeners[1:])]
        found = zip(hosts, self.ports, strict=True)
        return [f"{host}:{port}{path}#{secret}" for host, port in found]

    def invite(self, code: str) -> None:
        """Let pages that come from now on show a code, a picture as data: URL, to other phones."""
        self._welcome["code"] = code

    def take_requests(self, wait_s: float = 0.0) -> list[Said]:
        """Return what players have asked for since the last call; wait for the first [s]."""
        found: list[Said] = []
        with contextlib.suppress(queue.Empty):
            while True:
                waits = wait_s > 0.0 and not found
                found.append(self._requests.get(block=waits, timeout=wait_s if waits else None))
        return found

    def taken_by(self, jpeg: bytes | None) -> tuple[str, float]:
        """Return which page has sent a picture, and when it was taken by its clock [s]."""
        found = (each[1:] for each in tuple(self._tags) if each[0] is jpeg)
        return next(found, ("", 0.0))

    def show(self, picture: ShownPicture) -> None:
        """Show a picture on all pages."""
        self._tell_all(lambda client: client.show(picture))

    def sound(self, message: bytes) -> None:
        """Let all pages hear a binary message of sound; a camera beside a screen is silent."""
        self._tell_all(lambda client: client.send(message) if client.look else None)

    def tell(self, do: str, **content: object) -> None:
        """Tell all pages the present state of something, and those that come later.

        `do` names it: "status" is that of the session, "sheet" what a study asks.
        """
        self._kept[do] = content
        self._tell_all(lambda client: client.tell(do=do, **content))

    def say(self, words: str) -> None:
        """Show some words in English on all pages for some seconds, in the language of each."""
        self._tell_all(lambda client: client.tell(do="words", said=English(words)))

    def close(self) -> None:
        """Disconnect all; a second call does nothing."""
        if not self._closing:
            self._closing = True
            self._thread.join(5.0)

    def _tell_all(self, tell: Callable[[PageClient], None]) -> None:
        def tell_each() -> None:
            for client in self._clients.values():
                tell(client)

        with contextlib.suppress(RuntimeError):  # its loop has ended
            self._loop.call_soon_threadsafe(tell_each)

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve())
        finally:
            self._loop.close()

    async def _serve(self) -> None:
        self._server = web.Server(self._answer, access_log=None, keepalive_timeout=2.0)
        self._acceptor.start(self._server)
        while not self._closing:
            await asyncio.sleep(CHECK_EVERY_S)
            self._check(self._clock())
        await self._acceptor.stop()
        for client in self._clients.values():
            client.leave("the program ends")
        end = self._clock() + LAST_WORDS_S
        while self._clients and self._clock() < end:
            await asyncio.sleep(0.01)
        await self._server.shutdown(1.0)

    def _check(self, now: float) -> None:
        """Let go whom the limits of time let go."""
        self._acceptor.check(now)
        self._place.check()
        for client in tuple(self._clients.values()):
            if now - client.heard > self._limits.idle_s:
                client.leave("nothing was heard of this page")

    async def _answer(self, request: web.BaseRequest) -> web.StreamResponse:
        documents = self._documents.get(request.path)
        if request.method == "GET" and documents is not None:
            found = documents[language_of(request.headers.get("Accept-Language", ""))]
            return web.Response(body=found.body, headers=found.headers)
        if request.method == "GET" and request.path == SOCKET_PATH:
            return await self._welcome_page(request)
        if request.path == TOKEN_PATH:
            if not self._tells(request, self._token):
                return web.Response(status=403, text=REFUSED)
            answer = web.Response(status=503 if self._has_no_room(request) else 204)
            answer.force_close()  # a page asks this by new connections: an old one may be dead
            return answer
        root, _, place = request.path[1:].partition("/")
        opened = self._opened.get(f"/{root}")
        if opened is None:
            return web.Response(status=404, text="there is no such page\n")
        if not self._tells(request, opened.token):
            return web.Response(status=403, text=REFUSED)
        reply = await exchange(request, opened.content, place)
        self._acceptor.admit(request.protocol)
        return reply

    def _tells(self, request: web.BaseRequest, token: Token) -> bool:
        """Return whether a request tells a token."""
        scheme, _, offered = request.headers.get("Authorization", "").partition(" ")
        return scheme == "Bearer" and token.admits(offered)

    def _has_no_room(self, request: web.BaseRequest) -> bool:
        """Return whether there are too many pages for one more."""
        full = len(self._clients) >= self._limits.clients
        return full and request.query.get("page") not in self._clients

    async def _welcome_page(self, request: web.BaseRequest) -> web.StreamResponse:
        """Open a WebSocket for a page that knows the token; nothing of others is read."""
        offered = [each.strip() for each in
                   request.headers.get("Sec-WebSocket-Protocol", "").split(",")]  # fmt: skip
        name, role, attempt = (request.query.get(each, "") for each in ("page", "role", "attempt"))
        origin = urlsplit(request.headers.get("Origin", "")).netloc
        known = len(offered) == 2 and self._token.admits(offered[1])
        if not known or origin not in ("", request.host):
            return web.Response(status=403, text=REFUSED)
        named = PAGE_NAME.fullmatch(name) and ATTEMPT.fullmatch(attempt)
        if role not in get_args(Role) or not named:
            return web.Response(status=400, text="this is no page of ours\n")
        before = self._clients.get(name)
        if before is not None and before.attempt > int(attempt):
            # It was held up on its way, and the page has given it up.
            return web.Response(status=409, text="this page is connected already\n")
        if self._has_no_room(request):
            return web.Response(status=503, text="there are too many pages\n")
        opened = web.WebSocketResponse(
            protocols=(PROTOCOL,),
            heartbeat=5.0,
            compress=False,
            max_msg_size=self._limits.message_bytes,
        )
        await opened.prepare(request)
        self._acceptor.admit(request.protocol)
        cutout = request.query.get("background") == "none"
        language = request.query.get("language", "")
        language = language if language in LANGUAGES else LANGUAGES[0]
        bare = "cutout" if cutout else "plain"
        kind = f"{CARDS}{language}" if role in PLAYER_ROLES else bare
        client = PageClient(
            opened,
            name,
            int(attempt),
            cast(Role, role),
            kind,
            language,
            self._limits,
            self._clock,
        )
        await self._exchange(client)
        return opened

    async def _exchange(self, client: PageClient) -> None:
        before = self._clients.pop(client.page, None)
        self._clients[client.page] = client
        if before is not None:  # the same page, whose connection was cut
            before.leave("this page is connected again")
        client.tell(do="welcome", **self._welcome)
        for do, content in self._kept.items():
            client.tell(do=do, **content)
        self._place.join(client)
        if client.role in PLAYER_ROLES:
            for tile in self.tiles:
                client.send(tile)
        try:
            why = await client.serve(
                lambda said: self._hear(client, said),
                lambda number, taken, jpeg: self._see(client, number, taken, jpeg),
            )
        finally:
            self._place.leave(client)
            if self._clients.get(client.page) is client:
                del self._clients[client.page]
        if why:
            await client.close(why)

    def _hear(self, client: PageClient, said: Said) -> None:
        if said.do == "tick":
            client.tell(do="tick")
        elif said.do == "camera":
            if not CAMERA_NAME.fullmatch(said.name):
                raise AppError("this is no name of a camera")
            client.camera = said.name
            if self.keeps_camera and said.name != self.camera:
                client.tell(do="words", said=English(KEEPS_CAMERA))
            elif self._place.ask(client, take=said.take):
                self.camera = said.name
                self.feed.begin()
                self._ask(said)
        elif client.role in PLAYER_ROLES:
            self._ask(said)

    def _ask(self, said: Said) -> None:
        with contextlib.suppress(queue.Full):
            self._requests.put_nowait(said)

    def _see(self, client: PageClient, number: int, taken: float, jpeg: bytes) -> None:
        client.tell(do="got", id=number)
        if client.camera in ("", self.camera) and self._place.saw(client):
            # The source finds the picture's time by its very bytes.
            self._tags.append((jpeg, client.page, taken))
            if not self.feed.push(jpeg, taken):
                raise AppError("this page sends pictures that are no JPEG of a camera's size")
