"""The exposure is learnt from how far a cube of known velocity blurs."""

import numpy as np
import pytest
from numpy.typing import NDArray

from tracking.refinement.exposure import FIRST, KEPT, LONGEST, Shutter

Array = NDArray[np.float64]


def blurred(
    random: np.random.Generator, exposure: float, speed: float = 0.5
) -> tuple[Array, Array, Array]:
    """What a picture tells of the sweep of a cube: pull, information, and the cube's velocity.

    The sweep is told to 0.3 mm and 0.5° or so, across the line of sight better than along it.
    """
    velocity = random.normal(0, 1, 6) * np.repeat([1, 4], 3)
    velocity *= speed / np.linalg.norm(velocity[:3])
    axes = np.linalg.qr(random.normal(0, 1, (6, 6)))[0]
    scale = np.array([2e-4, 2e-4, 1e-3, 6e-3, 6e-3, 1e-2])
    covariance = (
        np.diag(scale) @ axes @ np.diag(random.uniform(0.4, 2, 6)) @ axes.T @ np.diag(scale)
    )
    sweep = velocity * exposure + random.multivariate_normal(np.zeros(6), covariance)
    information = np.linalg.inv(covariance)
    return information @ sweep, information, velocity


@pytest.mark.parametrize(("exposure", "speed"), [(0.004, 1.0), (0.0167, 0.5), (0.033, 0.5)])
def test_the_exposure_is_learnt_to_a_twentieth(exposure: float, speed: float) -> None:
    shutter, random = Shutter(), np.random.default_rng(1)
    assert (shutter.exposure, shutter.known) == (FIRST, False)
    for _ in range(KEPT):
        shutter.learn(*blurred(random, exposure, speed))
    assert shutter.known
    assert shutter.exposure == pytest.approx(exposure, rel=0.05)


def test_noise_across_the_motion_does_not_matter() -> None:
    """Only what the blur tells along the motion counts, however wrong it is elsewhere."""
    information = np.diag([1e8, 1e2, 1e2, 1e3, 1e3, 1e3])
    sweep = np.array([0.5 * 0.0167, 0.02, -0.03, 0.2, -0.1, 0.1])
    shutter = Shutter()
    shutter.learn(information @ sweep, information, np.array([0.5, 0, 0, 0, 0, 0]))
    assert shutter.exposure == pytest.approx(0.0167, rel=1e-6)


def test_slow_motion_teaches_nothing() -> None:
    shutter, random = Shutter(), np.random.default_rng(2)
    for _ in range(3 * KEPT):
        shutter.learn(*blurred(random, 0.03, speed=0.01))
    assert (shutter.exposure, shutter.known) == (FIRST, False)


def test_some_wild_measurements_change_little() -> None:
    shutter, random = Shutter(), np.random.default_rng(3)
    for number in range(KEPT):
        pull, information, velocity = blurred(random, 0.0167)
        shutter.learn(pull * (40.0 if number % 3 == 0 else 1.0), information, velocity)
    assert shutter.exposure == pytest.approx(0.0167, rel=0.1)


def test_a_sweep_against_the_motion_or_beyond_bounds_is_bounded() -> None:
    for factor, least, most in ((-5.0, 0.0, 0.0), (100.0, LONGEST, LONGEST)):
        shutter, random = Shutter(), np.random.default_rng(4)
        pull, information, velocity = blurred(random, 0.0167)
        shutter.learn(factor * pull, information, velocity)
        assert least <= shutter.exposure <= most


def test_another_exposure_is_learnt_within_as_many_frames_as_count() -> None:
    """A camera that opens its shutter longer when the light goes."""
    shutter, random = Shutter(), np.random.default_rng(5)
    for exposure in (0.008, 0.025):
        for _ in range(KEPT):
            shutter.learn(*blurred(random, exposure))
        assert shutter.exposure == pytest.approx(exposure, rel=0.05)
