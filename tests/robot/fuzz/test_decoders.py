"""No decoder fails in a way that is not documented, and none keeps more than its bound."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

from cubeling.robot.drivers import DRIVERS
from cubeling.robot.network.messages import MESSAGE_TYPES
from cubeling.robot.simulators import SIMULATORS
from tests.campaigns.decoders import MAX_GROWTH_BYTES, MAX_HELD_BYTES, TARGETS
from tests.campaigns.soak import weight
from tests.examples import examples

ROOT = Path(__file__).parents[3]

WORDS = [
    b"\0", b"\x81\1\0", b"\x84", b"\x90", b"\x9f", b"> ", b"\r\n", b"\n", b"k", b"ksit", b"?", b"~",
    b"error", b"Battery sensor value = ", b"drop=", b"stall=1s/", b"&", b"1e9", b"nan", b"ms",
]  # fmt: skip
"""What decoders listen for."""

noise = st.binary(max_size=300)
anything = st.one_of(
    noise,
    st.lists(st.one_of(st.sampled_from(WORDS), st.binary(max_size=24)), max_size=24).map(b"".join),
)


def texts_for(name: str) -> list[bytes]:
    """Return what a settings file of this kind looks like when it is right."""
    kind, _, driver = name.partition(":")
    if kind == "personality":
        found = sorted((ROOT / "affect" / "personalities").glob("*.toml"))
    else:
        found = sorted((ROOT / "robot" / "drivers" / driver).glob("*.toml"))
    return [path.read_bytes() for path in found] or [b"a = 1\n"]


@st.composite
def nearly_right(draw, name: str) -> bytes:
    """Take a file that is right, and spoil it here and there."""
    lines = draw(st.sampled_from(texts_for(name))).splitlines(keepends=True)
    for _ in range(draw(st.integers(1, 4))):
        at = draw(st.integers(0, len(lines) - 1))
        kind = draw(st.integers(0, 3))
        key, equals, value = lines[at].partition(b"=")
        if kind == 0:
            del lines[at : at + 1]
        elif kind == 1 and equals:
            other = [b"-1", b"1e400", b"nan", b'""', b"[]", b"true", b"{}", b"1979-05-27", b"[[1]]"]
            lines[at] = key + b"= " + draw(st.sampled_from(other)) + b"\n"
        elif kind == 2:
            lines.insert(at, draw(st.sampled_from(lines)))
        else:
            lines[at] = draw(st.binary(max_size=20)) + value
        if not lines:
            return b""
    return b"".join(lines)


@st.composite
def nearly_a_payload(draw) -> bytes:
    """Write JSON with the names that messages have, and any values."""
    names = sorted({name for kind in MESSAGE_TYPES.values() for name in kind.__struct_fields__})
    values: list[object] = [
        None,
        True,
        -1,
        0,
        2**70,
        0.5,
        1e400,
        float("nan"),
        "",
        "happy",
        "a\0",
        [],
        [[0]],
        {},
    ]
    document = draw(st.dictionaries(st.sampled_from(names), st.sampled_from(values)))
    return json.dumps(document).encode()


def inputs_for(name: str) -> st.SearchStrategy[bytes]:
    """Return what is worth trying on a target."""
    if name.startswith(("settings:", "personality")):
        return st.one_of(nearly_right(name), noise)
    if name.startswith("payload:"):
        return st.one_of(nearly_a_payload(), noise)
    return anything


@pytest.mark.parametrize("name", TARGETS)
def test_no_decoder_fails_on_anything(name):
    target = TARGETS[name]

    @settings(max_examples=examples(30), deadline=None)
    @given(inputs_for(name))
    def holds(data: bytes) -> None:
        target(data)

    holds()


FLOODS_PER_HALF = 32
"""Floods in 128 KiB, of which nothing may be kept for ever."""

FLOODS = {
    "of one byte": b"a" * 4096,
    "without an end of line": bytes(range(32, 127)) * 43,
    "of edges": bytes(4096),
    "of all bytes": bytes(range(256)) * 16,
    "of prompts": b"> " * 2048,
    "of lines": b"k\r\nerror\n" * 455,
}


def check_held(who: object, feed: Callable[[float], None]) -> None:
    """Feed it a quarter of a megabyte, and see that the second half made it no heavier."""
    held = []
    for half in range(2):
        for index in range(FLOODS_PER_HALF):
            feed(0.001 * (half * FLOODS_PER_HALF + index))
        held.append(weight(who)[1])
    assert held[1] < MAX_HELD_BYTES
    assert held[1] - held[0] < MAX_GROWTH_BYTES


@pytest.mark.parametrize("flood", FLOODS)
@pytest.mark.parametrize("name", DRIVERS)
def test_a_driver_that_hears_a_flood_does_not_grow(name, flood):
    driver = DRIVERS[name].make(7, None)
    driver.port_opened(0.0)

    def feed(now: float) -> None:
        driver.receive(FLOODS[flood], now)
        driver.tick(now)
        driver.bytes_to_send()

    check_held(driver, feed)


@pytest.mark.parametrize("flood", FLOODS)
@pytest.mark.parametrize("name", SIMULATORS)
def test_a_flooded_robot_does_not_grow_while_its_output_is_not_read(name, flood):
    robot = SIMULATORS[name](1)
    check_held(robot, lambda now: robot.receive(FLOODS[flood], now))


def test_what_grows_is_found():
    heard: list[bytes] = []
    with pytest.raises(AssertionError):
        check_held(heard, lambda now: heard.append(FLOODS["of edges"] + bytes(1)))
