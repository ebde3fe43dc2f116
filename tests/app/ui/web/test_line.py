"""How soon a page is back over a line that carries again, for each kind of fault at any moment.

The page's own `link.js` runs in a browser, but its clock, its network and its server are simulated:
no time passes, and a busy computer changes nothing.
"""

import asyncio
import json
from pathlib import Path

import pytest

from cubeling.app.ui.web.page import _joined
from tests.bench.web.chromium import chromium, program

pytestmark = [
    pytest.mark.skipif(program() is None, reason="there is no Chromium: apt install chromium"),
    pytest.mark.slow("starts a browser"),
    pytest.mark.full,
]

LINE = Path(__file__).with_name("line.js")

PICTURE_S = 0.2
"""What is left of the second for the camera's place, a frame, and its way through the program."""

KINDS = {
    "stalled": (0.1, 0.3, 0.45, 0.7, 1.0, 1.9, 3.0, 10.0),
    "cut": (0.0, 0.1, 0.5, 1.0, 3.0, 10.0),
    "forgotten": (0.0, 0.1, 0.5, 1.0, 3.0, 10.0),
}
"""How long each kind of fault lasts [s]: data that is held back, connections that end, and those
that are silent for ever, as after a router's loss or in another network."""

LINES = {
    "this computer": {"latency": 0.001, "trips": 1, "answers_s": 0.0},
    "wireless, TLS": {"latency": 0.004, "trips": 2, "answers_s": 0.02},
    "far, TLS": {"latency": 0.025, "trips": 2, "answers_s": 0.02},
    "very far, TLS": {"latency": 0.2, "trips": 2, "answers_s": 0.02},
}
"""Lines: their time one way [s], round trips of a handshake, and the server's to answer [s]."""


MOMENTS, STEP_S = 16, 0.037
"""When faults begin: everywhere between two looks of the page, which are 0.1 and 0.2 s apart."""


async def worst(faults):
    """Return the longest time until something is heard again, and connections, of each fault."""
    async with chromium() as browser:
        tab = await browser.tab()
        await tab.call("Runtime.enable")
        await tab.run(LINE.read_text() + "; window.simulate = simulate; true")
        await tab.run(f"window.source = {json.dumps(_joined(['link.js']))}; true")
        script = (
            f"(async () => {{ const found = []; for (const each of {json.dumps(faults)}) "
            "found.push(await simulate(source, each)); return JSON.stringify(found); })()"
        )
        return json.loads(await tab.run(script))


@pytest.mark.parametrize("kind", KINDS)
def test_a_page_is_back_in_less_than_a_second_whenever_a_fault_ends(kind):
    faults = [
        {"kind": kind, "begin": 2.0 + STEP_S * moment, "seconds": seconds, "quick": quick}
        | LINES[line]
        for line in [*LINES][:3]
        for moment in range(MOMENTS)
        for seconds in KINDS[kind]
        for quick in (True, False)
    ]
    found = asyncio.run(worst(faults))
    backs = [99.0 if each["back"] is None else each["back"] for each in found]  # null: infinite
    longest = max(zip(backs, map(str, faults), strict=True))
    assert longest[0] <= 1.0 - PICTURE_S, longest


def test_what_is_only_held_back_needs_no_other_connection():
    faults = [
        {"kind": "stalled", "begin": 2.0 + STEP_S * moment, "seconds": seconds, "quick": True}
        | LINES["this computer"]
        for moment in range(MOMENTS)
        for seconds in (0.3, 1.0, 3.0)
    ]
    assert all(each["opened"] == 1 for each in asyncio.run(worst(faults)))


def test_a_slow_line_is_a_line():
    faults = [
        {"kind": "cut", "begin": 2.0, "seconds": seconds, "quick": True} | LINES["very far, TLS"]
        for seconds in (0.0, 1.0, 3.0)
    ]
    assert all(each["back"] is not None for each in asyncio.run(worst(faults)))
