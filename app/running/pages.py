"""Sessions in browsers: the server of their pages, and a session's screen, sound and camera there.

The libraries of the extra `[web]` are loaded when a server is opened.
"""

import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.admission import Token
from cubeling.app.errors import AppError
from cubeling.app.running.front_end import FrontEnd
from cubeling.app.session import SessionOptions
from cubeling.app.ui.screen import Screen
from cubeling.tracking import FrameSource

if TYPE_CHECKING:
    import moderngl

    from cubeling.app.ui.web.server import WebServer

PHONE_PATIENCE_S = math.inf
"""A phone may sleep for as long as it likes."""

WAIT_S = 0.2
"""While no page sends pictures, Ctrl-C is heard this often [s]."""


def open_pages(
    port: int = 0,
    token: Token | None = None,
    *,
    lan: bool = False,
    folder: Path | None = None,
    camera: bool = False,
    study: bool = False,
) -> "WebServer":
    """Open a server of pages; the caller closes it.

    Parameters
    ----------
    port
        The TCP port; 0 for any.
    token
        What lets players in; None for a new one.
    lan
        Whether this computer's network is let in, over TLS.
    folder
        Where the certificate is kept; None for nowhere.
    camera
        Whether a page's camera is that of the session.
    study
        Whether the page asks the questions of a study, and lets nobody choose what is played.

    Raises
    ------
    AppError
        A library is missing, the port is in use, or there is no network.
    """
    try:
        from cubeling.app.ui.web.opening import open_server
    except ImportError as error:
        raise AppError(
            f"a browser needs the library {error.name}: pip install aiohttp cryptography segno"
        ) from error
    secret = token or Token.generate()
    return open_server(port, secret, lan=lan, folder=folder, camera=camera, study=study)


def page_front_end(server: "WebServer", *, study: bool = False) -> FrontEnd:
    """Return what a session has instead of a window, on the pages of a server."""
    from cubeling.app.ui.web.camera import PageCameras
    from cubeling.app.ui.web.opening import open_page_screen
    from cubeling.app.ui.web.speaker import PageSpeaker

    def open_screen(
        size: tuple[int, int], folder: Path, closing: ExitStack
    ) -> "tuple[Screen, moderngl.Context]":
        return open_page_screen(server, size, folder, closing, study=study)

    return FrontEnd(open_screen, lambda mixer: PageSpeaker(mixer, server), PageCameras(server).open)


@contextmanager
def awaited_camera(
    options: SessionOptions, server: "WebServer"
) -> Iterator[tuple[SessionOptions, FrameSource | None]]:
    """Wait for a page's camera if the options want it; yield the options with it, and the camera.

    It is None for a camera of another kind, which whoever opens the session opens.
    """
    from cubeling.app.ui.web.camera import SCHEME, PageCameras

    if options.source != SCHEME:
        yield options, None
        return
    before = server.feed.number
    while server.feed.next(before, WAIT_S) is None:
        pass
    cameras = PageCameras(server)
    options = replace(options, source=cameras.uri, patience_s=PHONE_PATIENCE_S)
    camera = cameras.open(options.source, (0, 0))
    try:
        yield options, camera
    finally:
        camera.close()
