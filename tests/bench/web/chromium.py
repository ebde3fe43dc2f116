"""A real Chromium without a display, with a fake camera, driven by its DevTools protocol."""

import asyncio
import base64
import itertools
from contextlib import asynccontextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import aiohttp

from cubeling.app.commands.look.doctor import CHROMIUM, installed
from tests.bench.web.browser import running

START_S = 30.0


def program() -> str | None:
    """Return the path of Chromium; None where there is none."""
    return installed(*CHROMIUM)


class Tab:
    """One tab, by its DevTools WebSocket."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self._socket = socket
        self._numbers = itertools.count(1)
        self._answers: dict[int, asyncio.Future[dict[str, Any]]] = {}
        self.log: list[str] = []
        """What the page has written to its console, and its errors."""
        self._reading = asyncio.create_task(self._read())

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Call a method of the protocol, and return its result."""
        number = next(self._numbers)
        future = self._answers[number] = asyncio.get_running_loop().create_future()
        await self._socket.send_json({"id": number, "method": method, "params": parameters})
        answer = await asyncio.wait_for(future, START_S)
        if "error" in answer:
            raise AssertionError(f"{method}: {answer['error']}")
        result: dict[str, Any] = answer["result"]
        return result

    async def run(self, script: str) -> Any:
        """Return what an expression is worth in the page, as if the user had asked for it."""
        found = await self.call(
            "Runtime.evaluate",
            expression=script,
            awaitPromise=True,
            returnByValue=True,
            userGesture=True,
        )
        if "exceptionDetails" in found:
            raise AssertionError(f"{script}: {found['exceptionDetails']}")
        return found["result"].get("value")

    async def until(self, script: str, timeout: float = START_S) -> Any:
        """Wait until an expression is true, and return it."""
        end = asyncio.get_running_loop().time() + timeout
        while not (value := await self.run(script)):
            if asyncio.get_running_loop().time() > end:
                raise AssertionError(f"not within {timeout} s: {script}; {self.log[-5:]}")
            await asyncio.sleep(0.05)
        return value

    async def open(self, address: str) -> None:
        """Open an address."""
        for domain in ("Page", "Runtime", "Log"):
            await self.call(f"{domain}.enable")
        await self.call("Page.navigate", url=address)
        await self.until("document.readyState === 'complete'")

    async def before_each_page(self, script: str) -> None:
        """Run a script before those of each page that is opened here."""
        await self.call("Page.enable")
        await self.call("Page.addScriptToEvaluateOnNewDocument", source=script)

    async def resize(self, width: int, height: int, *, phone: bool = False) -> None:
        """Look at the page on a screen of a size [CSS px]."""
        await self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=2 if phone else 1,
            mobile=phone,
        )

    async def picture(self, path: Path, *, transparent: bool = False) -> None:
        """Write what is seen to a PNG file."""
        if transparent:
            await self.call(
                "Emulation.setDefaultBackgroundColorOverride",
                color={"r": 0, "g": 0, "b": 0, "a": 0},
            )
        found = await self.call("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(found["data"]))

    async def _read(self) -> None:
        async for message in self._socket:
            said = message.json()
            if said.get("id") in self._answers:
                self._answers.pop(said["id"]).set_result(said)
            elif said.get("method") in ("Runtime.exceptionThrown", "Log.entryAdded"):
                self.log.append(str(said["params"])[:600])
            elif said.get("method") == "Runtime.consoleAPICalled":
                self.log.append(str([each.get("value") for each in said["params"]["args"]]))


class Chromium:
    """A running browser."""

    def __init__(self, session: aiohttp.ClientSession, port: str, browser: str) -> None:
        self._session, self._root = session, f"ws://127.0.0.1:{port}"
        self._browser = browser

    async def tab(self, *, hides: bool = False) -> Tab:
        """Open a tab, in a window of its own unless it `hides` the one before it."""
        found = await self._call("Target.createTarget", url="about:blank", newWindow=not hides)
        socket = await self._session.ws_connect(
            f"{self._root}/devtools/page/{found['targetId']}", max_msg_size=0, heartbeat=None
        )
        return Tab(socket)

    async def _call(self, method: str, **parameters: Any) -> dict[str, Any]:
        async with self._session.ws_connect(f"{self._root}{self._browser}") as socket:
            return await Tab(socket).call(method, **parameters)


@asynccontextmanager
async def chromium(camera: Path | None = None, language: str = "en"):
    """Run Chromium; `camera` is an .mjpeg or .y4m file that its camera shows again and again."""
    found = program()
    assert found is not None, "there is no Chromium here"
    with TemporaryDirectory(
        prefix="cubeling-chromium-",
        ignore_cleanup_errors=True,  # its processes end a bit later
    ) as profile:
        arguments = [
            "--headless=new",
            "--no-sandbox",
            "--no-first-run",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--disable-component-update",
            "--ignore-certificate-errors",
            "--autoplay-policy=no-user-gesture-required",
            "--use-fake-ui-for-media-stream",
            "--use-fake-device-for-media-stream",
            f"--lang={language}",
            f"--accept-lang={language}",
            f"--user-data-dir={profile}",
            "--remote-debugging-port=0",
        ]
        if camera is not None:
            arguments.append(f"--use-file-for-fake-video-capture={camera}")
        port_file = Path(profile) / "DevToolsActivePort"
        async with (
            running(
                found, *arguments, "about:blank", port_file=port_file, start_s=START_S
            ) as where,
            aiohttp.ClientSession() as session,
        ):
            yield Chromium(session, *where.split())
