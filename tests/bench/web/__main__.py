"""Measures the page in a real browser: `python -m tests.bench.web [SCENE …]`.

The camera is a bundled recording with a binary clock in its corner: how late the picture on the
page is, is read from the pictures themselves, beside those that the camera shows at that moment.
"""

import argparse
import asyncio
import statistics
import time
from collections.abc import Callable, Coroutine
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from cubeling.app.ui.web.page import MAX_PAGE_BYTES
from tests.bench.web.back import back
from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium
from tests.bench.web.faulty_proxy import FaultyProxy
from tests.bench.web.firefox import firefox as open_firefox, program as firefox_program
from tests.bench.web.guide_picture import picture
from tests.bench.web.hostile import hostile
from tests.bench.web.playing import LOOP_S, RATE, median_95, play, sampled
from tests.bench.web.serving import line_times_ms, say, serving
from tests.bench.web.sizes import sizes


async def start(folder: Path) -> None:
    """Measure from `cubeling serve` to playing, and how late the picture is."""
    write_camera(folder / "camera.mjpeg", "companion", LOOP_S)
    async with chromium(folder / "camera.mjpeg") as browser:
        began = time.monotonic()
        async with serving(folder, "--scenario", "companion") as served:
            tab = await browser.tab()
            await play(tab, served.address)
            say(f"from `cubeling serve` to playing: {time.monotonic() - began:.1f} s (bar: 20 s)")
            by_clock, by_page, rate = await sampled(tab, 15.0)
    line, line_95 = line_times_ms(served.output)
    say(f"glass to glass, by clocks in the pictures: {median_95(by_clock)}, {rate:.1f} Hz")
    say(f"the same as the page shows it:             {median_95(by_page)}")
    say(f"of that the line's own time:               {line:.0f} ms, 95 % {line_95:.0f} ms")
    beyond = statistics.median(by_clock) - line
    beyond_95 = sorted(by_clock)[int(0.95 * len(by_clock))] - line_95
    say(
        f"beyond it: {beyond * RATE / 1000:.1f} frame intervals in the median (bar: 2), "
        f"{beyond_95 * RATE / 1000:.1f} at 95 % (bar: 4)"
    )


async def line(folder: Path) -> None:
    """Measure what the pictures of 720p need of a line, and how they fit into narrower ones."""
    write_camera(folder / "camera.mjpeg", "companion", LOOP_S)
    async with (
        chromium(folder / "camera.mjpeg") as browser,
        serving(folder, "--quality", "reduced") as served,
        FaultyProxy(served.port) as proxy,
    ):
        tab = await browser.tab()
        await play(tab, served.at(proxy.port))
        for megabits in (0.0, 20.0, 10.0, 5.0, 2.5):
            proxy.bytes_per_s = megabits * 1e6 / 8
            await asyncio.sleep(SETTLE_S)
            up, down, number = proxy.up, proxy.down, await tab.run("number")
            _, late, rate = await sampled(tab, 10.0)
            up, down = proxy.up - up, proxy.down - down
            number, shown = await tab.run("number") - number, max(len(late), 1)
            say(
                f"{f'{megabits:.1f} Mbit/s' if megabits else 'as it is':>12}: {rate:4.1f} Hz, late "
                f"by {median_95(late)}; up {up / max(number, 1) / 1000:.0f} kB a picture, "
                f"{8 * up / 1e7:.1f} Mbit/s, {8 * RATE * up / max(number, 1) / 1e6:.1f} at 30 Hz; "
                f"down {down / shown / 1000:.0f} kB, {8 * down / 1e7:.1f} Mbit/s, "
                f"{8 * RATE * down / shown / 1e6:.1f} at 30 Hz"
            )


async def firefox(folder: Path) -> None:
    """Play in Firefox, whose camera shows moving colours; measure how late the picture is."""
    if firefox_program() is None:
        return say("there is no Firefox: apt install firefox-esr")
    async with open_firefox() as (tab, name), serving(folder) as served:
        await tab.open(served.address)
        await tab.until("!$('start').hidden && Object.keys(tiles).length > 3")
        await tab.run("$('go').click()")
        await tab.until("delays.length > 30", 120.0)
        shown = await tab.run("`${$('picture').width} x ${$('picture').height}`")
        late = await tab.run("$('delay').textContent")
    say(f"{name} connects, and shows pictures of {shown}, late by {late} in the median")


async def size(_: Path) -> None:
    """Print what a browser loads of the page of each role."""
    for role, found in sizes().items():
        say(f"{role:>7}: {found / 1000:.1f} kB (bar: {MAX_PAGE_BYTES / 1000:.0f} kB)")


SETTLE_S = 6.0
"""Time in which pictures become as fine as a line carries [s]."""

SCENES: dict[str, Callable[[Path], Coroutine[Any, Any, None]]] = {
    "start": start,
    "hostile": hostile,
    "line": line,
    "back": back,
    "firefox": firefox,
    "size": size,
    "picture": picture,
}
"""The scenes by name; the picture is drawn only when it is named."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", choices=[*SCENES, []], help="all without a name")
    for name in parser.parse_args().scenes or [*SCENES][:-1]:
        say(f"-- {name}: {SCENES[name].__doc__}")
        with TemporaryDirectory(prefix="cubeling-web-") as folder:
            asyncio.run(SCENES[name](Path(folder)))


if __name__ == "__main__":
    main()
