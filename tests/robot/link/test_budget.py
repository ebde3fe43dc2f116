"""A robot that says too much is not listened to."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import robot
from robot.link.budget import BURST, RATE, REST, Budget
from robot.link.exchange import READ_AT_ONCE


def test_a_line_at_full_speed_is_within_the_budget_for_ever():
    budget = Budget()
    for step in range(10_000):
        assert budget.grant(115, step * 0.010) == 115


def test_what_waited_while_this_computer_slept_is_within_the_budget():
    budget = Budget()
    budget.grant(10, 0.0)
    assert budget.grant(BURST, 60.0) == BURST


@given(st.lists(st.tuples(st.integers(0, 5000), st.floats(0, 0.1)), max_size=200))
def test_no_more_is_listened_to_than_the_rate_and_one_burst(arrivals):
    budget, now, heard = Budget(), 0.0, 0
    for count, pause in arrivals:
        now += pause
        granted = budget.grant(count, now)
        assert 0 <= granted <= count
        heard += granted
    assert heard <= BURST + RATE * now + 1


def test_a_clock_that_is_set_back_takes_nothing_away():
    budget = Budget()
    budget.grant(0, 100.0)
    assert budget.grant(1000, 50.0) == 1000


class BabblingPort:
    """Noise without an end, as fast as it is read."""

    def __init__(self) -> None:
        self.noise = np.random.default_rng(1).bytes(READ_AT_ONCE)
        self.reads = 0
        self.in_waiting = 60_000

    def read(self, size=1, /):
        self.reads += 1
        return self.noise[:size]

    def write(self, data, /):
        return len(data)

    def close(self):
        pass


def test_a_port_that_babbles_is_read_at_a_bounded_rate(monkeypatch):
    port = BabblingPort()
    monkeypatch.setattr("robot.link.connection.opener", lambda *_: lambda: port)
    with pytest.raises(robot.RobotError, match="nobody"):
        robot.connect("/dev/babble", answer_within=0.3)
    # Once the burst is spent: every 20 ms two reads. Without a budget there are 50 times as many.
    assert port.reads < 2 * BURST / READ_AT_ONCE + 2 * 2 * 0.3 / REST
