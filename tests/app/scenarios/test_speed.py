"""AvatAR's Speed over a whole turn of the cube."""

import itertools
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.app.scenarios.speed import (
    IDLE_MAX_ANGLE,
    SPEED_MAPS,
    SpeedDial,
    corrected_speed,
    legacy,
)

DEGREES = [d / 4 for d in range(0, 721)]


def test_corrected_map_goes_from_idle_over_walking_to_running():
    assert corrected_speed(math.radians(45)) == 0.0
    assert corrected_speed(math.radians(45.001)) == pytest.approx(0.5, abs=1e-3)
    assert corrected_speed(math.radians(90)) == pytest.approx(1.75)
    assert corrected_speed(math.radians(135)) == pytest.approx(3.0)
    assert corrected_speed(math.radians(180)) == pytest.approx(5.0)


def test_corrected_map_is_continuous_but_at_45_degrees_and_never_falls():
    speeds = [corrected_speed(math.radians(d)) for d in DEGREES]
    steps = [b - a for a, b in itertools.pairwise(speeds)]
    assert all(step >= 0 for step in steps)
    assert sum(step > 0.02 for step in steps) == 1  # the one step, from standing to walking


def test_legacy_map_is_as_printed():
    for degrees in (46, 90, 135, 180):
        assert legacy(math.radians(degrees)) == pytest.approx(1.55 + 4 * degrees / 180)
    assert legacy(IDLE_MAX_ANGLE) == 0.0


@pytest.mark.parametrize("name", SPEED_MAPS)
def test_one_turn_reads_idle_walk_run_walk_idle(name, hand):
    dial = SpeedDial(name)
    gaits: list[str] = []
    for degrees in range(0, 361):
        controls = hand.heading(degrees)
        speed = dial.update(controls.camera_angle, controls.timestamp)
        gait = "idle" if speed <= 0.5 else "walk" if speed <= 3 else "run"
        if not gaits or gaits[-1] != gait:
            gaits.append(gait)
    assert gaits == ["idle", "walk", "run", "walk", "idle"]


@given(st.floats(0, math.pi))
def test_speed_stays_in_its_declared_range(angle):
    assert 0.0 <= corrected_speed(angle) <= 5.0


def test_an_angle_that_trembles_about_45_degrees_does_not_flicker(hand):
    dial = SpeedDial()
    standing = []
    for frame in range(120):
        controls = hand.heading(45 + (2 if frame % 2 else -2))
        standing.append(dial.update(controls.camera_angle, controls.timestamp) == 0.0)
    assert all(standing)


def test_speed_follows_within_a_few_frames():
    dial = SpeedDial()
    for frame in range(31):
        speed = dial.update(math.pi, frame / 30)
    assert speed == pytest.approx(5.0, abs=0.01)
