"""A robot's clock is known in the host's time, within the bound that is stated."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.robot.protocol import timing
from cubeling.robot.protocol.clock import RobotClock

WRAP = 2**32
"""Where the robot's milliseconds begin anew."""


class DriftingRobot:
    """A robot whose clock drifts, at a line with these delays there and back [s]."""

    def __init__(self, drift: float, first_ms: int = 0) -> None:
        self.clock = RobotClock()
        self.drift, self.first_ms = drift, first_ms

    def read(self, time: float) -> int:
        """Return what its clock shows at a time of the host [s]."""
        return int(self.first_ms + 1000 * time * (1 + self.drift)) % WRAP

    def beat(self, sent: float, there: float, back: float) -> tuple[float, float]:
        """Exchange a BEAT and a STATE; return the error and its bound [s]."""
        made = sent + there
        ms = self.read(made)
        self.clock.add(ms, sent, made + back)
        known = self.clock.host_time(ms)
        assert known is not None
        return abs(known.host - made), known.error


@pytest.mark.parametrize("drift", [200e-6, 0.0, -200e-6])
@pytest.mark.parametrize("spikes", [False, True], ids=["jitter", "jitter and spikes"])
def test_a_clock_that_drifts_on_a_line_with_jitter_is_known_to_a_few_milliseconds(drift, spikes):
    """2 to 30 ms of jitter and 200 ppm: within 5 ms, where the round trip alone allows 30."""
    random = np.random.default_rng(5)
    robot = DriftingRobot(drift, first_ms=WRAP - 30_000)  # it wraps in the middle
    errors, bounds = [], []
    for time in np.arange(0.0, 60.0, timing.BEAT_EVERY):
        there, back = 0.001 + random.exponential(0.004), 0.002 + random.exponential(0.008)
        if spikes and random.random() < 0.1:
            back += 0.1
        error, bound = robot.beat(100.0 + time, there, back)
        errors.append(error)
        bounds.append(bound)
    assert (np.array(errors) <= bounds).all()
    settled = slice(round(10 / timing.BEAT_EVERY), None)
    assert max(errors[settled]) < 0.005
    assert max(bounds[settled]) < 0.006
    assert robot.clock.drift == pytest.approx(drift, abs=25e-6)


@given(
    st.floats(-timing.CLOCK_TOLERANCE, timing.CLOCK_TOLERANCE),
    st.integers(0, WRAP - 1),
    st.lists(
        st.tuples(st.floats(0.01, 20.0), st.floats(0.0, 0.3), st.floats(0.0, 0.3)),
        min_size=1, max_size=60,
    ),
)  # fmt: skip
def test_the_error_never_exceeds_its_bound(drift, first_ms, beats):
    """Whatever the delays are, however uneven, and however long nothing is heard."""
    robot = DriftingRobot(drift, first_ms)
    time = 0.0
    for pause, there, back in beats:
        time += pause
        error, bound = robot.beat(time, there, back)
        assert error <= bound + 1e-9
        assert bound >= 0.0005


def test_the_time_of_an_earlier_line_of_the_log_is_known_too():
    robot = DriftingRobot(0.0, first_ms=WRAP - 500)
    robot.beat(10.0, 0.001, 0.001)
    written = robot.clock.host_time(robot.read(7.5))
    assert written is not None
    assert written.host == pytest.approx(7.5, abs=written.error)


@given(st.lists(st.integers(0, WRAP - 1), max_size=30))
def test_a_clock_without_any_sense_does_no_harm(readings):
    clock = RobotClock()
    for ms in readings:
        clock.add(ms, 5.0, 5.0)
        clock.host_time(ms)
    assert abs(clock.drift) <= timing.CLOCK_TOLERANCE
