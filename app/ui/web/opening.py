"""Opening the server of the page, and the screen that it is."""

import io
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import segno
from rich.markup import escape

from cubeling.app.admission import Token
from cubeling.app.pipeline.registry import scenario_names
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.ui.cards.overlay import virtual_robot_side
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.playback.scenario_card import scenario_picture, summary_of
from cubeling.app.ui.web.acceptor import Listener
from cubeling.app.ui.web.camera import PageCameras
from cubeling.app.ui.web.language import English
from cubeling.app.ui.web.messages import TILE, pack
from cubeling.app.ui.web.page import page
from cubeling.app.ui.web.picture import encoded
from cubeling.app.ui.web.screen import HANDLERS, STUDY_HANDLERS, WebScreen
from cubeling.app.ui.web.server import LOOPBACK, WebServer

if TYPE_CHECKING:
    import moderngl

TILE_WIDTH_PX = 400
"""Width of a scenario's picture."""


def open_server(
    port: int, token: Token, *, lan: bool, folder: Path | None, camera: bool, study: bool
) -> WebServer:
    """Open the server; see `running.pages.open_pages`."""
    listeners = [Listener(LOOPBACK, port)]
    fingerprint = ""
    if lan:
        from cubeling.app.ui.web.certificate import lan_address, tls_context

        host = lan_address()
        tls, fingerprint = tls_context(host, folder)
        listeners.append(Listener(host, port, tls))
    names = scenario_names()
    welcome = {
        "scenarios": [
            {"name": each, "title": English(each), "summary": English(summary_of(each))}
            for each in names
        ],
        "rate": SAMPLE_RATE,
        "camera": camera,
    }
    server = WebServer(listeners, token, welcome, main=page(study=study))
    server.fingerprint = fingerprint
    if lan:
        # Who plays shows it to one more phone.
        server.invite(segno.make(server.addresses()[-1], error="l").svg_data_uri(border=2))
    server.tiles = [
        pack(TILE, number, 0.0, encoded(scenario_picture(name, TILE_WIDTH_PX)))
        for number, name in enumerate(names)
    ]
    return server


def page_address(server: WebServer) -> Iterator[str]:
    """Yield what to print: how a browser finds the page, in Rich's markup."""
    own, *others = server.addresses()
    if not others:
        yield f"Open this in a browser of this computer: [bold cyan]{escape(own)}[/]"
        yield "[dim]A phone? Add [cyan]--lan[/]. Ctrl-C ends.[/]"
        return
    (address,), own_port = others, server.ports[0]
    drawn = io.StringIO()
    segno.make(address, error="l", micro=False).terminal(drawn, compact=True)
    yield escape(drawn.getvalue().rstrip("\n"))
    yield f"Scan it with a phone in this network, or open [bold cyan]{escape(address)}[/]"
    yield (
        "The browser warns once, as this computer has made the certificate itself: "
        "choose Advanced, then Proceed. Its SHA-256 begins with "
        f"[bold]{server.fingerprint[:23]}[/]"
    )
    yield (
        f"[dim]Without a warning, over USB: [cyan]adb reverse tcp:{own_port} tcp:{own_port}[/], "
        f"then {escape(own)} on the phone, or in a browser of this computer. Ctrl-C ends.[/]"
    )


def open_page_screen(
    server: WebServer, size: tuple[int, int], folder: Path, closing: ExitStack, *, study: bool
) -> "tuple[WebScreen, moderngl.Context]":
    """Open a session's screen on the pages, and the context to draw in; the stack closes both."""
    from cubeling.characters.rendering import create_context

    context = create_context()
    closing.callback(context.release)
    virtual_robot = VirtualRobot(context, virtual_robot_side(size[1]))
    closing.callback(virtual_robot.close)
    cameras, handlers = PageCameras(server), STUDY_HANDLERS if study else HANDLERS
    screen = WebScreen(server, lambda: cameras.uri, folder, virtual_robot, handlers=handlers)
    closing.callback(screen.close)
    return screen, context
