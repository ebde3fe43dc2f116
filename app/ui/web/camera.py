"""The camera of a page as that of a session."""

from cubeling.app.ui.web.server import WebServer
from cubeling.tracking import FrameSource, PushedSource, open_source

SCHEME = "phone:"
"""Begins the URI of a page's camera: the rest names it, so that its lens is known again."""


class PageCameras:
    """Opens what the pages of a server send as a camera of a session."""

    def __init__(self, server: WebServer) -> None:
        self._server = server

    @property
    def uri(self) -> str:
        """The camera that sends pictures now, with their size; "" for none."""
        name, size = self._server.camera, self._server.feed.size
        return f"{SCHEME}{name}?size={size[0]}x{size[1]}" if name and size is not None else ""

    def open(self, uri: str, size: tuple[int, int]) -> FrameSource:
        """Open the camera of a page, or another one; raises TrackingError."""
        if uri.startswith(SCHEME):
            return PushedSource(self._server.feed, "phone")
        return open_source(uri, size=size)
