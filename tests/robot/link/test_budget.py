"""The bytes of a robot are limited to a rate."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling import robot
from cubeling.robot.link.exchange import (
    FLOOD_PAUSE_S,
    MAX_BURST_BYTES,
    MAX_BYTES_PER_S,
    MAX_READ_BYTES,
    TokenBucket,
)


def test_a_line_at_full_speed_is_never_limited():
    bucket = TokenBucket()
    for step in range(10_000):
        assert bucket.grant(115, step * 0.010) == 115


def test_a_burst_after_a_sleep_of_this_computer_is_not_limited():
    bucket = TokenBucket()
    bucket.grant(10, 0.0)
    assert bucket.grant(MAX_BURST_BYTES, 60.0) == MAX_BURST_BYTES


@given(st.lists(st.tuples(st.integers(0, 5000), st.floats(0, 0.1)), max_size=200))
def test_no_more_than_the_rate_and_one_burst_is_granted(arrivals):
    bucket, now, total = TokenBucket(), 0.0, 0
    for count, pause in arrivals:
        now += pause
        granted = bucket.grant(count, now)
        assert 0 <= granted <= count
        total += granted
    assert total <= MAX_BURST_BYTES + MAX_BYTES_PER_S * now + 1


def test_a_clock_that_is_set_back_costs_nothing():
    bucket = TokenBucket()
    bucket.grant(0, 100.0)
    assert bucket.grant(1000, 50.0) == 1000


class BabblingPort:
    """Endless noise, as fast as it is read."""

    def __init__(self) -> None:
        self.noise = np.random.default_rng(1).bytes(MAX_READ_BYTES)
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
    monkeypatch.setattr("cubeling.robot.link.connection.opener", lambda *_: lambda: port)
    with pytest.raises(robot.RobotError, match="nobody"):
        robot.connect("/dev/babble", answer_within=0.3)
    # After the burst: two reads every 20 ms. Without a limit there are 50 times as many.
    assert port.reads < 2 * MAX_BURST_BYTES / MAX_READ_BYTES + 2 * 2 * 0.3 / FLOOD_PAUSE_S
