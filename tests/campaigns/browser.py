"""Play in a real browser over a line with faults: `python -m tests.campaigns.browser`.

The page's camera and its picture go through a proxy on loopback that stalls, slows down, drops or
forgets connections and is cut off; and what happens to a phone happens to the page: it is hidden,
turned, loaded again, and its camera is taken away. After each fault, the time is measured until a
picture is shown that was taken after it, and how late the pictures are then. The exit code is 1 if
the page is not back in time, says nothing of what it needs, or if its pictures become later and
later.
"""

import argparse
import asyncio
import json
import statistics
import sys
import time
from collections.abc import Awaitable, Callable, Iterable, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.console import Console
from rich.table import Table

from tests.bench.web.camera import PHONE_CAMERA, write_camera
from tests.bench.web.chromium import Chromium, Tab, chromium
from tests.bench.web.faulty_proxy import FaultyProxy
from tests.bench.web.playing import LOOP_S, play, time_to_picture
from tests.bench.web.serving import serving

BACK_S = 1.0
"""A line that works again has a new picture on the page in this time, beyond what one takes without
a fault in the same run [s]: in the median of both, and each time beyond the longest of those. That
is what a busy computer adds."""

GOES_ON_S = 10.0
"""The same of what happens to the phone [s]: a game that begins again, a page that is loaded."""

MAX_GROWTH, FRAME_S = 1.25, 1 / 30
"""The last third of the rounds is at most so much later than the first, and by one frame [s]."""

UPRIGHT = (390, 844)
"""Size of the phone's screen [CSS px]."""

WIDTH_PX = 640
"""Width of its pictures [px]: the line is tried, not how quickly a busy computer tracks."""

WATCHED_S = 4.0
"""Length of what is watched after each fault [s]."""

WATCH = (
    "window.lateness = []; window.onpicture = (id, taken) => { if (taken && taken < now()) "
    "{ window.lastTaken = taken; lateness.push(now() - taken); } }; true"
)
"""Keeps how late pictures are, but of those that were taken before the page was loaded again."""

MIN_ROUNDS = 9
"""With fewer, how late pictures are says nothing of how that grows."""


@dataclass
class Phone:
    """A page that plays over a faulty line."""

    browser: Chromium
    tab: Tab
    proxy: FaultyProxy

    async def hide(self) -> None:
        """Look at another tab for a while."""
        other = await self.browser.tab(hides=True)
        await asyncio.sleep(3.0)
        await other.call("Page.close")
        await self.tab.call("Page.bringToFront")

    async def turn(self) -> None:
        """Turn the phone: its screen and its camera's pictures."""
        await self.tab.run("isTurning = true; openCamera()")
        await time_to_picture(self.tab)
        await self.tab.resize(*UPRIGHT, phone=True)
        await self.tab.run("upright = true")
        await self.tab.until("$('picture').width < $('picture').height")

    async def turn_back(self) -> None:
        """Turn the phone back."""
        await self.tab.resize(*UPRIGHT[::-1], phone=True)
        await self.tab.run("isTurning = upright = false; openCamera()")
        await self.tab.until("$('picture').width > $('picture').height")

    async def lose_camera(self) -> None:
        """Let another program take the camera, and give it back."""
        await self.tab.run("takeCamera()")
        await self.tab.until("!$('trouble').hidden && $('trouble').textContent.length > 20")
        await asyncio.sleep(2.0)
        await self.tab.run("isTaken = false")

    async def reload(self) -> None:
        """Load the page again: nothing is touched."""
        await self.tab.run("window.isOld = true")
        await self.tab.call("Page.reload")
        await self.tab.until("!window.isOld && typeof playing === 'boolean'")
        await self.tab.run(WATCH)


@dataclass(frozen=True)
class Fault:
    """What happens, and how soon the page is to be back after it."""

    happen: Callable[[Phone], Awaitable[None]]
    """Returns when it is over."""

    back_s: float = BACK_S
    """Longest time until a picture is shown that was taken after it, beyond the usual [s]."""


FAULTS: dict[str, Fault] = {
    "stalled for 0.3 s": Fault(lambda phone: phone.proxy.stall(0.3)),
    "stalled for 1 s": Fault(lambda phone: phone.proxy.stall(1.0)),
    "stalled for 3 s": Fault(lambda phone: phone.proxy.stall(3.0)),
    "stalled for 10 s": Fault(lambda phone: phone.proxy.stall(10.0)),
    "dropped": Fault(lambda phone: phone.proxy.cut(0.0)),
    "forgotten": Fault(lambda phone: phone.proxy.forget(0.0)),
    "forgotten for 3 s": Fault(lambda phone: phone.proxy.forget(3.0)),
    "cut for 10 s": Fault(lambda phone: phone.proxy.cut(10.0)),
    "1 MB/s for 5 s": Fault(lambda phone: phone.proxy.slow_down(5.0, 1e6)),
    "tab hidden for 3 s": Fault(Phone.hide),
    "turned": Fault(Phone.turn, GOES_ON_S),
    "turned back": Fault(Phone.turn_back, GOES_ON_S),
    "camera taken for 2 s": Fault(Phone.lose_camera, GOES_ON_S),
    "loaded again": Fault(Phone.reload, GOES_ON_S),
}
"""What happens, by name."""


@dataclass(frozen=True)
class Round:
    """What one fault has done."""

    fault: str
    """Its name."""

    usual_s: float
    """Time until a picture was shown that was taken before it happened [s]."""

    longest_s: float
    """The longest of several such times [s]."""

    back_s: float
    """The same after it [s]."""

    late_s: tuple[float, ...]
    """How late the pictures were that came then [s]."""

    @property
    def beyond_s(self) -> float:
        """What the fault added to it [s]."""
        return self.back_s - self.usual_s

    @property
    def median_s(self) -> float:
        """The median of that; infinite if none came."""
        return statistics.median(self.late_s) if self.late_s else float("inf")


@asynccontextmanager
async def playing(folder: Path):
    """Play in a browser over a faulty line."""
    write_camera(folder / "camera.mjpeg", "companion", LOOP_S)
    async with (
        chromium(folder / "camera.mjpeg") as browser,
        serving(folder, "--quality", "reduced", "--robot", "none") as served,
        FaultyProxy(served.port) as proxy,
    ):
        tab = await browser.tab()
        await tab.resize(*UPRIGHT[::-1], phone=True)
        await tab.before_each_page(PHONE_CAMERA)
        await play(tab, served.at(proxy.port, f"/?size={WIDTH_PX}"))
        await tab.run(WATCH)
        yield Phone(browser, tab, proxy)
        errors = [each for each in tab.log if "exception" in each]
        assert not errors, errors


async def one_round(phone: Phone, name: str) -> Round:
    """Let a fault happen, and watch what comes after it."""
    usual = [await time_to_picture(phone.tab) for _ in range(5)]
    await FAULTS[name].happen(phone)
    back = await time_to_picture(phone.tab, 60.0)
    await phone.tab.run(WATCH)
    await asyncio.sleep(WATCHED_S)
    late = json.loads(await phone.tab.run("JSON.stringify(lateness)"))
    return Round(name, statistics.median(usual), max(usual), back, tuple(late))


async def rounds_of(folder: Path, names: Iterable[str], seconds: float) -> list[Round]:
    """Let faults happen one after the other for some time, at least one."""
    end, found = time.monotonic() + seconds, []
    async with playing(folder) as phone:
        for name in names:
            found.append(await one_round(phone, name))
            if time.monotonic() > end:
                break
    return found


def by_fault(rounds: Sequence[Round]) -> dict[str, list[Round]]:
    """Return the rounds of each fault, by its name."""
    found: dict[str, list[Round]] = {}
    for each in rounds:
        found.setdefault(each.fault, []).append(each)
    return found


def growth(rounds: Sequence[Round]) -> tuple[float, float]:
    """Return how late pictures are in the first and in the last third of the rounds [s]."""
    third = max(len(rounds) // 3, 1)
    first, last = (
        statistics.median(each.median_s for each in part)
        for part in (rounds[:third], rounds[-third:])
    )
    return first, last


def wrong(rounds: Sequence[Round]) -> list[str]:
    """Return what is not as it has to be."""
    said = [
        f"{name}: back {beyond:.2f} s later than usual"
        for name, some in by_fault(rounds).items()
        if (beyond := statistics.median(each.beyond_s for each in some)) > FAULTS[name].back_s
    ]
    longest = max(each.longest_s for each in rounds)
    said += [
        f"{each.fault}: back in {each.back_s:.2f} s, and without a fault in {longest:.2f} s"
        for each in rounds
        if each.back_s > longest + FAULTS[each.fault].back_s
    ]
    said += [f"{each.fault}: no picture" for each in rounds if not each.late_s]
    first, last = growth(rounds)
    if len(rounds) >= MIN_ROUNDS and last > MAX_GROWTH * first + FRAME_S:
        said.append(
            f"pictures were late by {1000 * first:.0f} ms, and by {1000 * last:.0f} at last"
        )
    return said


def in_random_order(seed: int, names: Sequence[str]) -> Iterable[str]:
    """Yield all names again and again, in another order each time; who turned turns back."""
    generator = np.random.default_rng(seed)
    turns = {"turned": ["turned", "turned back"], "turned back": []}
    while True:
        for number in generator.permutation(len(names)):
            yield from turns.get(names[number], [names[number]])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--faults", nargs="*", choices=[*FAULTS, []], help="only these")
    given = parser.parse_args()
    names = in_random_order(given.seed, given.faults or [*FAULTS])
    with TemporaryDirectory(prefix="cubeling-browser-") as folder:
        rounds = asyncio.run(rounds_of(Path(folder), names, 60 * given.minutes))
    table = Table(
        "fault", "times", "back in [s]", "beyond usual [s]", "most [s]", "bar", "late [ms]"
    )
    for name, some in by_fault(rounds).items():
        beyond = [each.beyond_s for each in some]
        table.add_row(
            name,
            str(len(some)),
            f"{statistics.median(each.back_s for each in some):.2f}",
            f"{statistics.median(beyond):.2f}",
            f"{max(beyond):.2f}",
            f"{FAULTS[name].back_s:.0f}",
            f"{1000 * statistics.median(each.median_s for each in some):.0f}",
        )
    console = Console(soft_wrap=True, highlight=False)
    console.print(table)
    first, last = growth(rounds)
    usual = statistics.median(each.usual_s for each in rounds)
    console.print(
        f"{len(rounds)} faults; a picture usually takes {usual:.2f} s, without a fault at most "
        f"{max(each.longest_s for each in rounds):.2f} s; late by {1000 * first:.0f} ms in the "
        f"first third of them, by {1000 * last:.0f} ms in the last"
    )
    for line in (problems := wrong(rounds)):
        console.print(line)
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()
