"""The exposure time is estimated from how far a cube of known velocity blurs."""

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.refinement.camera_model import (
    EXPOSURE_SAMPLES,
    FIRST_EXPOSURE_S,
    MAX_EXPOSURE_S,
    ExposureEstimator,
)

Array = NDArray[np.float64]


def blurred(
    random: np.random.Generator, exposure: float, speed: float = 0.5
) -> tuple[Array, Array, Array]:
    """What an image tells of the blur motion: weighted motion, information, and the velocity.

    The motion is measured to about 0.3 mm and 0.5°, better across the line of sight than along it.
    """
    velocity = random.normal(0, 1, 6) * np.repeat([1, 4], 3)
    velocity *= speed / np.linalg.norm(velocity[:3])
    axes = np.linalg.qr(random.normal(0, 1, (6, 6)))[0]
    scale = np.array([2e-4, 2e-4, 1e-3, 6e-3, 6e-3, 1e-2])
    covariance = (
        np.diag(scale) @ axes @ np.diag(random.uniform(0.4, 2, 6)) @ axes.T @ np.diag(scale)
    )
    motion = velocity * exposure + random.multivariate_normal(np.zeros(6), covariance)
    information = np.linalg.inv(covariance)
    return information @ motion, information, velocity


@pytest.mark.parametrize(("exposure", "speed"), [(0.004, 1.0), (0.0167, 0.5), (0.033, 0.5)])
def test_the_exposure_is_estimated_to_five_percent(exposure: float, speed: float) -> None:
    estimator, random = ExposureEstimator(), np.random.default_rng(1)
    assert (estimator.exposure, estimator.known) == (FIRST_EXPOSURE_S, False)
    for _ in range(EXPOSURE_SAMPLES):
        estimator.learn(*blurred(random, exposure, speed))
    assert estimator.known
    assert estimator.exposure == pytest.approx(exposure, rel=0.05)


def test_noise_across_the_motion_does_not_matter() -> None:
    """Only the blur along the motion counts, however wrong it is in other directions."""
    information = np.diag([1e8, 1e2, 1e2, 1e3, 1e3, 1e3])
    motion = np.array([0.5 * 0.0167, 0.02, -0.03, 0.2, -0.1, 0.1])
    estimator = ExposureEstimator()
    estimator.learn(information @ motion, information, np.array([0.5, 0, 0, 0, 0, 0]))
    assert estimator.exposure == pytest.approx(0.0167, rel=1e-6)


def test_an_exposure_that_blur_made_zero_is_measured_again() -> None:
    """Blur that seems to run backwards, as of a hand that is seen too late, leaves nothing."""
    estimator, random = ExposureEstimator(), np.random.default_rng(3)
    for _ in range(EXPOSURE_SAMPLES):
        estimator.learn(*blurred(random, -0.0167))
    assert estimator.exposure == 0
    for _ in range(EXPOSURE_SAMPLES):
        estimator.learn(*blurred(random, 0.0167))
    assert estimator.exposure == pytest.approx(0.0167, rel=0.05)


def test_slow_motion_changes_nothing() -> None:
    estimator, random = ExposureEstimator(), np.random.default_rng(2)
    for _ in range(3 * EXPOSURE_SAMPLES):
        estimator.learn(*blurred(random, 0.03, speed=0.01))
    assert (estimator.exposure, estimator.known) == (FIRST_EXPOSURE_S, False)


def test_outliers_change_little() -> None:
    estimator, random = ExposureEstimator(), np.random.default_rng(3)
    for number in range(EXPOSURE_SAMPLES):
        weighted, information, velocity = blurred(random, 0.0167)
        estimator.learn(weighted * (40.0 if number % 3 == 0 else 1.0), information, velocity)
    assert estimator.exposure == pytest.approx(0.0167, rel=0.1)


def test_an_implausible_exposure_is_clipped() -> None:
    for factor, least, most in ((-5.0, 0.0, 0.0), (100.0, MAX_EXPOSURE_S, MAX_EXPOSURE_S)):
        estimator, random = ExposureEstimator(), np.random.default_rng(4)
        weighted, information, velocity = blurred(random, 0.0167)
        estimator.learn(factor * weighted, information, velocity)
        assert least <= estimator.exposure <= most


def test_a_changed_exposure_is_found_within_the_samples_of_the_median() -> None:
    """A camera that exposes longer when the light fades."""
    estimator, random = ExposureEstimator(), np.random.default_rng(5)
    for exposure in (0.008, 0.025):
        for _ in range(EXPOSURE_SAMPLES):
            estimator.learn(*blurred(random, exposure))
        assert estimator.exposure == pytest.approx(exposure, rel=0.05)
