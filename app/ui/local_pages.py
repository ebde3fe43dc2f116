"""Pages for this computer alone, under addresses that nobody can guess: a form, a desk."""

import sys
import threading
from dataclasses import dataclass
from email.message import Message
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Protocol

from cubeling.app.admission import Token
from cubeling.robot import Closeable

LOOPBACK = "127.0.0.1"
"""The address of this computer that no other one reaches."""

MAX_SENT_BYTES = 65_536
"""Longest answer of a page that is read [bytes]."""

QUIET_S = 30.0
"""How long a connection may say nothing [s]."""

FORM_POLICY = (
    "default-src 'none'; img-src 'self'; media-src 'self'; style-src 'unsafe-inline'; "
    "form-action 'self'"
)
"""What a page without scripts may load: nothing from elsewhere."""

HTML = "text/html; charset=utf-8"


@dataclass(frozen=True)
class PageReply:
    """What a browser gets."""

    kind: str
    """The media type of the content, as "image/png"."""

    content: bytes
    policy: str = FORM_POLICY
    """What the page may load and run."""


class LocalPage(Protocol):
    """A page and what belongs to it; it is called on the threads of the server."""

    def get(self, place: str) -> PageReply | None:
        """Return what is at a place below its address, "" for itself; None for nothing."""
        ...

    def post(self, data: bytes) -> PageReply | None:
        """Take what the page sends; return the reply, or None to show the page again."""
        ...


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Let a browser go that was closed; any other error is one of ours."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class LocalPages(Closeable):
    """Serves pages on the loopback address. Close it after use; a second `close` does nothing."""

    def __init__(self) -> None:
        self._pages: dict[str, LocalPage] = {}
        self._closed = False
        self._server = _Server((LOOPBACK, 0), self._handler())
        self._thread = threading.Thread(
            target=self._server.serve_forever, name="pages", daemon=True
        )
        self._thread.start()

    def open(self, page: LocalPage, token: Token | None = None) -> str:
        """Serve a page, and return its address."""
        text = (token or Token.generate()).text
        self._pages[text] = page
        return f"http://{LOOPBACK}:{self._server.server_port}/{text}"

    def close(self) -> None:
        """Stop serving; a second call does nothing."""
        if self._closed:
            return
        self._closed = True
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(timeout=5.0)

    def _page_at(self, path: str, headers: Message) -> tuple[LocalPage | None, str]:
        """Return the page of a path, and the place below it; None for who cannot know it."""
        token, _, place = path.partition("?")[0].lstrip("/").partition("/")
        # A page that is asked for by a name is that of somebody else's site (DNS rebinding).
        if headers.get("Host", "").rpartition(":")[0] not in (LOOPBACK, "localhost"):
            return None, ""
        known = (page for text, page in self._pages.items() if Token(text).admits(token))
        return next(known, None), place

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        pages = self

        class Handler(BaseHTTPRequestHandler):
            timeout = QUIET_S

            def do_GET(self) -> None:
                page, place = pages._page_at(self.path, self.headers)
                self._send(None if page is None else page.get(place))

            def do_POST(self) -> None:
                page, place = pages._page_at(self.path, self.headers)
                length = self.headers.get("Content-Length", "")
                if page is None or place:
                    self._send(None)
                elif not length.isdecimal() or int(length) > MAX_SENT_BYTES:
                    self.send_error(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
                elif len(data := self.rfile.read(int(length))) < int(length):
                    self.close_connection = True  # a browser that was closed while it answered
                elif reply := page.post(data):
                    self._send(reply)
                else:
                    self.send_response(HTTPStatus.SEE_OTHER)
                    self.send_header("Location", self.path)
                    self.send_header("Content-Length", "0")
                    self.end_headers()

            def _send(self, reply: PageReply | None) -> None:
                if reply is None:
                    self.send_error(HTTPStatus.NOT_FOUND)
                    return
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Type", reply.kind)
                self.send_header("Content-Length", f"{len(reply.content)}")
                self.send_header("Cache-Control", "no-store")
                self.send_header("Content-Security-Policy", reply.policy)
                self.send_header("Referrer-Policy", "no-referrer")
                self.end_headers()
                self.wfile.write(reply.content)

            def log_message(self, format: str, *args: Any) -> None:
                """Keep the terminal for the experimenter."""

        return Handler
