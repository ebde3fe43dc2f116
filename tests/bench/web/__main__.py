"""Measures the page in a real browser: `python -m tests.bench.web [SCENE …]`.

The camera is a bundled recording with a binary clock in its corner: how late the picture on the
page is, is read from the pictures themselves, beside those that the camera shows at that moment.
"""

import argparse
import asyncio
import json
import statistics
import time
from collections.abc import Callable, Coroutine
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from tests.bench.web.camera import READ_CLOCK, write_camera
from tests.bench.web.chromium import Tab, chromium
from tests.bench.web.faulty_proxy import FaultyProxy
from tests.bench.web.guide_picture import picture
from tests.bench.web.hostile import hostile
from tests.bench.web.serving import line_times_ms, say, serving

RATE = 30.0
"""Frames a second of the fake camera."""

LOOP_S = 10.0
"""Length of what it shows again and again [s]."""

SAMPLE = (
    "window.samples = []; window.onpicture = (id, taken) => { window.lastTaken = taken; "
    "samples.push([clockOf($('camera')), clockOf($('picture')), taken ? now() - taken : 0]); }; "
    "true"
)


async def play(tab: Tab, address: str) -> None:
    """Open a page, and play."""
    # As a phone, whose rear camera is not shown as in a mirror: the clock can be read.
    await tab.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
    await tab.open(address)
    await tab.until("!document.getElementById('start').hidden && Object.keys(tiles).length > 3")
    await tab.run("document.getElementById('go').click()")
    await tab.until("shown > 2", 60.0)


async def sampled(tab: Tab, seconds: float) -> tuple[list[float], list[float], float]:
    """Return how late pictures are [ms], by clocks in them and by the page, and their rate [Hz]."""
    await tab.run(f"{READ_CLOCK}; {SAMPLE}")
    await asyncio.sleep(seconds)
    samples = json.loads(await tab.run("JSON.stringify(samples)"))
    frames = round(LOOP_S * RATE)
    by_clock = [1000 * ((camera - shown) % frames) / RATE for camera, shown, _ in samples]
    return by_clock, [1000 * each[2] for each in samples], len(samples) / seconds


def median_95(values: list[float]) -> str:
    """Return median and 95th percentile of times, in words."""
    ordered = sorted(values)
    return f"{statistics.median(ordered):.0f} ms, 95 % {ordered[int(0.95 * len(ordered))]:.0f} ms"


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


async def faults(folder: Path) -> None:
    """Stall, drop and cut the connection, reload and hide the page; measure how it goes on."""
    write_camera(folder / "camera.mjpeg", "companion", LOOP_S)
    async with (
        chromium(folder / "camera.mjpeg") as browser,
        serving(folder) as served,
        FaultyProxy(served.port) as proxy,
    ):
        tab = await browser.tab()
        await play(tab, served.at(proxy.port))
        before = (await sampled(tab, 6.0))[0]
        say(f"before:                          late by {median_95(before)}")
        for name, fault in (
            ("stalled for 1 s", lambda: proxy.stall(1.0)),
            ("dropped", lambda: proxy.cut(0.0)),
            ("cut for 10 s", lambda: proxy.cut(10.0)),
            ("stalled for 10 s", lambda: proxy.stall(10.0)),
        ):
            await fault()
            back = await _time_to_picture(tab)
            late = (await sampled(tab, 6.0))[0]
            say(f"{name + ':':<32} back in {back:.2f} s, then late by {median_95(late)}")
        await tab.call("Page.reload")
        await asyncio.sleep(1.0)
        await tab.until("document.readyState === 'complete' && !$('start').hidden")
        await tab.run(f"{READ_CLOCK}; {SAMPLE}; document.getElementById('go').click()")
        say(f"{'reloaded, and play touched:':<32} back in {await _time_to_picture(tab):.2f} s")
        other = await browser.tab()
        await other.call("Page.bringToFront")
        await asyncio.sleep(3.0)
        await tab.call("Page.bringToFront")
        say(f"{'hidden for 3 s:':<32} back in {await _time_to_picture(tab):.2f} s")
        assert not [each for each in tab.log if "exception" in each], tab.log


async def _time_to_picture(tab: Tab) -> float:
    """Return how long it takes until a picture is shown that is taken from now on [s]."""
    began, then = time.monotonic(), await tab.run("now()")
    await tab.until(f"(window.lastTaken || 0) > {then}")
    return time.monotonic() - began


SCENES: dict[str, Callable[[Path], Coroutine[Any, Any, None]]] = {
    "start": start,
    "faults": faults,
    "hostile": hostile,
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
