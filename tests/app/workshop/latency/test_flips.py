"""The measured delay is the true one, whatever camera and screen add to it."""

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.workshop.latency.flips import FlipDetector, picture_age
from cubeling.app.workshop.latency.session import PATIENCE_S, LatencySession
from cubeling.tracking import LiveFrames
from tests.app.workshop.latency.simulated import SimulatedCamera, SimulatedClock, SimulatedScreen
from tests.examples import some


def opened(lag=0.0, **camera):
    clock = SimulatedClock()
    screen = SimulatedScreen(clock, lag)
    return clock, screen, SimulatedCamera(clock, screen, **camera)


def measured(count=16, lag=0.0, seed=1, **camera):
    clock, screen, source = opened(lag, **camera)
    session = LatencySession(source, count, seed, clock)
    session.run(screen)
    return session, source


@pytest.mark.parametrize(
    ("lag", "camera"),
    some(
        [
            (0.03, {"exposure": 0.016, "delay": 0.4, "noise": 8.0, "mirror": True}),
            (0.012, {"exposure": 0.033, "readout": 0.025, "delay": 0.05}),
            (0.0, {"exposure": 0.004, "readout": 0.0, "delay": 0.02}),
            (0.02, {"rate": 15.0, "exposure": 0.06, "delay": 0.03}),
            (0.01, {"rate": 60.0, "delay": 0.06, "jitter": 0.006}),
        ],
        2,
    ),
)
def test_the_age_of_a_picture_is_right_within_two_milliseconds(lag, camera):
    session, source = measured(lag=lag, **camera)
    flips = session.detector.flips
    assert abs(picture_age(flips) - source.age(lag)) < 0.002
    waited = np.median([each.delay for each in flips]) - source.age(lag)
    assert abs(waited * source.rate - 0.5) < 0.1, "a flip waits for half an interval"
    assert session.detector.missed == 0
    assert isinstance(source, LiveFrames)


def test_the_same_seed_flips_at_the_same_moments():
    one, again, other = (measured(5, seed=seed)[0].detector.flips for seed in (1, 1, 2))
    assert one == again
    assert one != other


def test_without_the_pattern_it_ends_after_a_while_and_says_what_to_do():
    clock, screen, source = opened(blind=True)
    with pytest.raises(AppError, match="did not see the pattern in 30 s: point it at the screen"):
        LatencySession(source, 10, 1, clock).run(screen)
    assert PATIENCE_S < clock() - SimulatedClock().now < PATIENCE_S + 1


def test_a_camera_that_repeats_one_picture_of_the_pattern_is_no_measurement(monkeypatch):
    clock, screen, source = opened()
    seen = source._seen
    monkeypatch.setattr(source, "_seen", lambda number: seen(0))
    with pytest.raises(AppError, match="the camera saw only 0 flips of the pattern"):
        LatencySession(source, 10, 1, clock).run(screen)


def test_a_flip_that_nobody_saw_is_missed_and_the_next_one_counts():
    detector = FlipDetector(seed=1)
    arrived = 10.0

    def pictures(lightness, seconds):
        nonlocal arrived
        for _ in range(round(30 * seconds)):
            arrived += 1 / 30
            detector.add(arrived, lightness)

    pictures(0.9, 0.5)
    assert detector.is_due(arrived)
    detector.show(arrived)
    pictures(None, 0.5)
    assert (detector.missed, detector.flips, detector.is_due(arrived)) == (1, [], False)
    pictures(-0.9, 0.5)
    detector.show(arrived)
    pictures(-0.9, 0.1)
    pictures(0.9, 0.1)
    (flip,) = detector.flips
    assert flip.before < flip.seen
    assert flip.delay == pytest.approx(0.1 + 1 / 30)


def test_a_moment_of_weak_contrast_does_not_flip():
    detector = FlipDetector(seed=1)
    for number in range(60):
        detector.add(number / 30, 0.05)
    assert not detector.is_due(60.0)
