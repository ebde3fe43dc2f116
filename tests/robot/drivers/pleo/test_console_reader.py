"""Where an answer of the console ends, however it is cut and whatever cuts into it."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.robot.drivers.pleo.console_reader import MAX_LINE_CHARS, ConsoleReader
from cubeling.robot.drivers.pleo.timing import PROMPT_SETTLE_S, STRAY_SETTLE_S

POWER = (
    "STATS POWER\r\nPower statistics\r\n> 20 % it may walk\r\nmu: sensor 3 = 1\r\n"
    "Battery sensmu: joint 2 = 30\r\nor value = 57 (584 raw)\r\n"
    "MC_GetMotorStatus Failed: joint 14\r\nBattery temperature = 29 (C)\r\n> "
)


def read(text: str, cuts: tuple[int, ...] = (), echo: str = "STATS POWER") -> ConsoleReader:
    reader = ConsoleReader(("Pleo Monitor",))
    reader.begin(echo)
    data = text.encode("latin-1")
    for start, end in zip((0, *cuts), (*cuts, len(data)), strict=True):
        reader.feed(data[start:end], 1.0)
    return reader


def ended(reader: ConsoleReader, after: float = PROMPT_SETTLE_S) -> bool:
    return reader.has_ended(1.0 + after + 1e-9)


def test_the_battery_is_found_among_noise_that_cuts_into_its_line():
    reader = read(POWER)
    assert ended(reader)
    assert reader.answer.battery == 0.57
    assert reader.answer.error == "MC_GetMotorStatus Failed: joint 14"
    assert reader.skipped == 3


@given(st.sets(st.integers(0, len(POWER)), max_size=12).map(sorted))
def test_any_cut_of_the_answer_reads_the_same(cuts):
    whole, pieces = read(POWER), read(POWER, tuple(cuts))
    assert vars(pieces) == vars(whole)


@pytest.mark.parametrize(
    "text",
    [
        "> ",
        "> \r\n",
        "\r\n> ",
        "> \r\n> ",
        "> > ",
        "done\r\n> ",
        "> mu: sensor 3 = 1\r\n",
        "> mu: sens",
        "> \r\nmu: sensor 3 = 1\r\n",
        ">mu: sensor 3 = 1\r\n ",
        "> MC_GetMotorStatus Failed: joint 14\r\n",
        "> 5 of\r\n> ",
    ],
)
def test_a_prompt_at_the_start_of_a_line_ends_the_answer(text):
    reader = read(text)
    assert not reader.has_ended(1.0 + PROMPT_SETTLE_S / 2)
    assert ended(reader)


@pytest.mark.parametrize(
    "text",
    ["", ">", "> 5", "> mu: but no monitor line\r\n", "a > b", "joint move <id> ", "> 5\r\n"],
)
def test_the_prompts_characters_in_a_text_do_not_end_it(text):
    assert not ended(read(text))


def test_a_prompt_after_a_line_without_an_end_is_taken_when_nothing_follows_for_long():
    reader = read("Battery sensor value = 80 (820)> ")
    assert not ended(reader, STRAY_SETTLE_S / 2)
    assert ended(reader, STRAY_SETTLE_S)
    assert reader.finish().battery == 0.8


def test_text_after_the_prompt_takes_it_back():
    reader = read("> ")
    reader.feed(b"5 joints\r\n", 1.01)
    assert not ended(reader, 10.0)
    reader.feed(b"> ", 1.20)
    assert not reader.has_ended(1.20 + PROMPT_SETTLE_S / 2)
    assert reader.has_ended(1.20 + PROMPT_SETTLE_S + 1e-9)


def test_monitor_lines_do_not_hold_up_a_prompt():
    reader = read("> ")
    for number in range(10):
        reader.feed(f"mu: sensor {number} = 1\r\n".encode(), 1.0 + number / 100)
    assert reader.has_ended(1.0 + PROMPT_SETTLE_S + 1e-9)


@pytest.mark.parametrize(
    ("echo", "error"), [("MOTION PLAY a:error.umf", None), ("", "MOTION PLAY")]
)
def test_the_echo_of_a_command_is_no_error(echo, error):
    found = read("motion play a:error.umf\r\n> ", echo=echo).answer.error
    assert found is None if error is None else found is not None


@pytest.mark.parametrize("line", ["Battery sensor value = 101 (1)", "Battery sensor value = x (1)"])
def test_a_battery_that_cannot_be_is_not_believed(line):
    assert read(f"{line}\r\n> ").answer.battery is None


@given(st.lists(st.binary(max_size=300), max_size=20))
def test_garbage_raises_nothing_and_is_not_kept(chunks):
    reader = ConsoleReader(("Pleo Monitor",))
    for number, chunk in enumerate(chunks):
        reader.feed(chunk, number / 100)
        assert len(reader.line) <= MAX_LINE_CHARS
    reader.has_ended(10.0)
    reader.finish()


def test_a_line_without_an_end_is_not_kept_and_the_next_prompt_is_found():
    reader = ConsoleReader()
    random = np.random.default_rng(1)
    for number in range(1000):
        reader.feed(random.bytes(1000).replace(b"\n", b""), number / 1000)
        assert len(reader.line) <= MAX_LINE_CHARS
    reader.feed(b"\r\n> ", 2.0)
    assert reader.has_ended(2.0 + PROMPT_SETTLE_S + 1e-9)
