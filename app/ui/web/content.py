"""What is served beside the page to who tells its token: a desk's state, a study's stimuli."""

import asyncio
from dataclasses import dataclass
from typing import Protocol

from aiohttp import web

from cubeling.app.admission import Token

MAX_SENT_BYTES = 65_536
"""Size of what a page posts [B]."""


class WebContent(Protocol):
    """What is served below a path; it is called on threads of the server, which may wait."""

    def get(self, place: str) -> tuple[str, bytes] | None:
        """Return the media type and the data of what is at a place; None for nothing."""
        ...

    def post(self, data: bytes) -> tuple[str, bytes] | None:
        """Take what a page sends, and return the reply; None for what takes nothing."""
        ...


@dataclass(frozen=True)
class OpenedContent:
    """What `WebServer.open` has opened."""

    content: WebContent
    """Answers for all that is below the path."""

    token: Token
    """Requests have to tell it."""


async def exchange(request: web.BaseRequest, content: WebContent, place: str) -> web.StreamResponse:
    """Answer who knows the token of some content; nothing of it runs in the loop."""
    if request.method == "POST":
        if not 0 < (request.content_length or 0) <= MAX_SENT_BYTES:
            return web.Response(status=413, text="too much, or of no length\n")
        found = await asyncio.to_thread(content.post, await request.read())
    else:
        found = await asyncio.to_thread(content.get, place)
    if found is None:
        return web.Response(status=404, text="there is no such thing\n")
    kind, data = found
    headers = {"Content-Type": kind, "Cache-Control": "no-store"}
    return web.Response(body=data, headers=headers)
