"""How soon a page hears its server again after faults of the line, without camera and pictures."""

import asyncio
import statistics
from collections.abc import Awaitable, Callable
from contextlib import closing
from pathlib import Path

from cubeling.app.ui.web.acceptor import Listener
from cubeling.app.ui.web.server import LOOPBACK, WebServer
from tests.bench.web.chromium import chromium
from tests.bench.web.faulty_proxy import FaultyProxy
from tests.bench.web.serving import TOKEN, say

BAR_S = 0.8
"""The rest of a second is for the camera, the program and the picture [s]."""

TIMES, STEP_S = 8, 0.037
"""How often each fault happens, each time later by so much [s]: whenever the page looks."""

FAULTS: dict[str, Callable[[FaultyProxy], Awaitable[None]]] = {
    "stalled for 0.3 s": lambda proxy: proxy.stall(0.3),
    "stalled for 3 s": lambda proxy: proxy.stall(3.0),
    "dropped": lambda proxy: proxy.cut(0.0),
    "cut for 3 s": lambda proxy: proxy.cut(3.0),
    "forgotten": lambda proxy: proxy.forget(0.0),
    "forgotten for 3 s": lambda proxy: proxy.forget(3.0),
}
"""What happens to the line, by name."""


async def back(_: Path) -> None:
    """Measure how soon a page hears its server again over a line that carries again."""
    welcome = {"rate": 48000, "scenarios": [], "camera": True}
    with closing(WebServer([Listener(LOOPBACK, 0)], TOKEN, welcome)) as server:
        async with chromium() as browser, FaultyProxy(server.ports[0]) as proxy:
            tab = await browser.tab()
            await tab.open(f"http://localhost:{proxy.port}/#{TOKEN.text}")
            await tab.until("Boolean(welcome)")
            for name, happen in FAULTS.items():
                times = []
                for number in range(TIMES):
                    await asyncio.sleep(0.8 + STEP_S * number)
                    await happen(proxy)
                    await tab.run("window.over_s = now()")
                    await tab.until("heard > over_s", 20.0)
                    times.append(await tab.run("heard - over_s"))
                say(
                    f"{name:>17}: {statistics.median(times):.2f} s in the median, "
                    f"{max(times):.2f} s at most (bar: {BAR_S:.1f} s)"
                )
