"""A rolling shutter: its time is measured on a cube that moves, and its slant taken out."""

from collections.abc import Callable

import numpy as np
import pytest

from cubeling.tracking import CubeModel, CubeTracker, Frame
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.edges.edge_refinement import EdgeRefiner
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.refinement.readout import MIN_SAMPLES_EACH_WAY, ReadoutEstimator
from tests.tracking.drawn import CAMERA, Array, held, off, rolled

CUBE = CubeModel.load("companion")
READOUT_S = 0.025
TONE = np.asarray(255 * (np.arange(256) / 255) ** 2.2, np.float32)


def swept(speed: float, y: float) -> Callable[[float], Array]:
    """A cube that moves to the right, at a height in the picture, and turns a little."""
    pose = held(0.5, 0.6, 0.1, (0.0, y, 0.4))
    return lambda when: se3.apply_delta(pose, np.array([speed, 0, 0, 0, 0, speed]) * when)


def learned(readout: float) -> ReadoutEstimator:
    """What a cube tells that is seen while it moves to and fro."""
    projection, estimator = Projection(CAMERA), ReadoutEstimator()
    refiner, footprint = EdgeRefiner(CUBE, projection), Footprint(CUBE, projection)
    for number in range(2 * MIN_SAMPLES_EACH_WAY):
        speed = 0.5 if number % 2 else -0.5
        pose_at = swept(speed, 0.01 * (number // 2 - 2))
        patch = footprint.crop(
            rolled(CUBE, pose_at, readout, 16 if readout else 1, number), pose_at(0.0), TONE
        )
        assert isinstance(patch, Patch)
        found = refiner.refine(patch, pose_at(0.0))
        assert found is not None
        estimator.learn(found.edges, np.array([speed, 0, 0, 0, 0, speed]), CAMERA.size[1])
    return estimator


@pytest.mark.full
@pytest.mark.slow(reason="pictures are drawn row by row")
def test_the_time_of_a_rolling_shutter_is_measured() -> None:
    assert learned(READOUT_S).seconds == pytest.approx(READOUT_S, abs=0.003)


def test_a_shutter_that_does_not_roll_has_no_time_at_all() -> None:
    """Exactly none, so that nothing is changed for such cameras."""
    assert learned(0.0).seconds == 0.0


@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_the_slant_of_a_known_shutter_is_taken_out(speed: float) -> None:
    projection = Projection(CAMERA)
    pose_at, exposure = swept(speed, 0.06), 0.001
    motion = np.array([speed, 0, 0, 0, 0, speed]) * exposure
    picture = rolled(CUBE, pose_at, READOUT_S, 48, 1)
    patch = Footprint(CUBE, projection).crop(picture, pose_at(0.0), TONE)
    assert patch is not None
    errors = []
    for share in (0.0, READOUT_S / exposure):
        found = EdgeRefiner(CUBE, projection).refine(patch, pose_at(0.0), lambda _: motion, share)
        assert found is not None
        errors.append(off(found.camera_from_cube, pose_at(0.0))[0])
    assert errors[0] > 2.5
    assert errors[1] < 0.5


@pytest.mark.full
def test_a_cube_that_is_waved_before_a_rolling_shutter_is_where_it_is() -> None:
    """Once its time is known; before, it is off by 6 mm in the median."""
    tracker, errors = CubeTracker(CUBE, CAMERA), []
    rest = held(0.5, 0.6, 0.1, (0.0, 0.02, 0.4))
    for number in range(40):
        now = number / 30

        def pose_at(when: float, now: float = now) -> Array:
            x = 0.12 * np.sin(0.5 / 0.12 * (now + when))
            return se3.apply_delta(rest, np.array([x, 0, 0, 0, 0, 0]))

        state = tracker.update(Frame(rolled(CUBE, pose_at, READOUT_S, 24, number), now, number))
        assert state.visible
        errors.append(off(state.camera_from_cube, pose_at(0.0))[0])
    assert np.median(errors[:10]) > 3
    assert max(errors[-15:]) < 2
