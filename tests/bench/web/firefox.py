"""A real Firefox without a display, with a fake camera, driven by WebDriver BiDi."""

import asyncio
import base64
import itertools
import json
from contextlib import asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import aiohttp

from cubeling.app.commands.look.doctor import FIREFOX, installed
from tests.bench.web.browser import running

START_S = 60.0

PREFERENCES = {
    "media.navigator.streams.fake": True,
    "media.navigator.permission.disabled": True,
    "media.autoplay.default": 0,
    "remote.active-protocols": 1,
    "datareporting.policy.dataSubmissionEnabled": False,
    "app.update.enabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
}
"""Lets pages use a camera that shows moving colours, and lets Firefox look for nothing outside."""


def program() -> str | None:
    """Return the path of Firefox; None where there is none."""
    return installed(*FIREFOX)


class FirefoxTab:
    """One tab, by WebDriver BiDi."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self._socket = socket
        self._numbers = itertools.count(1)
        self._context = ""

    async def start(self) -> dict[str, Any]:
        """Begin a session; return what the browser says of itself."""
        said = await self.call("session.new", capabilities={})
        created = await self.call("browsingContext.create", type="tab")
        self._context = created["context"]
        found: dict[str, Any] = said["capabilities"]
        return found

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Call a method of the protocol, and return its result."""
        number = next(self._numbers)
        await self._socket.send_json({"id": number, "method": method, "params": parameters})
        while True:
            answer = (await asyncio.wait_for(self._socket.receive(), START_S)).json()
            if answer.get("id") == number:
                assert answer["type"] == "success", f"{method}: {answer}"
                result: dict[str, Any] = answer["result"]
                return result

    async def open(self, address: str) -> None:
        """Open an address."""
        await self.call(
            "browsingContext.navigate", context=self._context, url=address, wait="complete"
        )

    async def run(self, script: str) -> Any:
        """Return what an expression is worth in the page: a number, a text, or whether it is so."""
        found = await self.call(
            "script.evaluate",
            expression=script,
            target={"context": self._context},
            awaitPromise=True,
            userActivation=True,
        )
        assert found["type"] == "success", f"{script}: {found}"
        return found["result"].get("value")

    async def until(self, script: str, timeout: float = START_S) -> None:
        """Wait until an expression is true."""
        end = asyncio.get_running_loop().time() + timeout
        while not await self.run(f"Boolean({script})"):
            assert asyncio.get_running_loop().time() < end, f"not within {timeout} s: {script}"
            await asyncio.sleep(0.05)

    async def picture(self, path: Path) -> None:
        """Write what is seen to a PNG file."""
        found = await self.call("browsingContext.captureScreenshot", context=self._context)
        path.write_bytes(base64.b64decode(found["data"]))


@asynccontextmanager
async def firefox():
    """Run Firefox; yield a tab, and the browser's name and version."""
    found = program()
    assert found is not None, "there is no Firefox here: apt install firefox-esr"
    with TemporaryDirectory(prefix="cubeling-firefox-") as profile:
        lines = (
            f"user_pref({name!r}, {str(value).lower()});" for name, value in PREFERENCES.items()
        )
        (Path(profile) / "user.js").write_text("\n".join(lines).replace("'", '"'))
        arguments = (
            "--headless",
            "--no-remote",
            "--profile",
            profile,
            "--remote-debugging-port",
            "0",
        )
        port_file = Path(profile) / "WebDriverBiDiServer.json"
        async with running(found, *arguments, port_file=port_file, start_s=START_S) as where:
            url = f"ws://127.0.0.1:{json.loads(where)['ws_port']}/session"
            async with (
                aiohttp.ClientSession() as session,
                session.ws_connect(url, max_msg_size=0) as socket,
            ):
                tab = FirefoxTab(socket)
                said = await tab.start()
                yield tab, f"{said['browserName']} {said['browserVersion']}"
