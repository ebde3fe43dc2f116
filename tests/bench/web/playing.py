"""Playing in a browser as a phone does, and how late its pictures are."""

import asyncio
import json
import statistics
import time

from tests.bench.web.camera import READ_CLOCK
from tests.bench.web.chromium import Tab

RATE = 30.0
"""Frames a second of the fake camera."""

LOOP_S = 10.0
"""Length of what it shows again and again [s]."""

SAMPLE = (
    "window.samples = []; window.onpicture = (id, taken) => { window.lastTaken = taken; "
    "samples.push([clockOf($('camera')), clockOf($('picture')), taken ? now() - taken : 0]); }; "
    "true"
)


async def open_phone(tab: Tab, address: str) -> None:
    """Open a page as on a phone, up to its button to play."""
    # The rear camera of a phone is not shown as in a mirror: the clock can be read.
    await tab.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
    await tab.open(address)
    await tab.until("!$('start').hidden && Object.keys(tiles).length > 3")


async def play(tab: Tab, address: str) -> None:
    """Open a page, and play."""
    await open_phone(tab, address)
    await tab.run("$('go').click()")
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


async def time_to_picture(tab: Tab, timeout: float = 30.0) -> float:
    """Return how long it takes until a picture is shown that is taken from now on [s]."""
    began, then = time.monotonic(), await tab.run("now()")
    await tab.until(f"(window.lastTaken || 0) > {then}", timeout)
    return time.monotonic() - began
