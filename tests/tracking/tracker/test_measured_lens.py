"""Through a guessed lens poses are doubted, and become right in play; a calibration stays."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.tracker.print_check import PrintFault, cube_with
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.tracking.drawn import CAMERA, Array, held, photograph, scene

CUBE = CubeModel.load("locomotion")
GUESSES = {factor: CAMERA.lengthen(factor, 0.35) for factor in (1.7, 1 / 1.7)}
COUNT = 36


@pytest.fixture(scope="module")
def shown() -> list[tuple[Frame, Array]]:
    """Frames of a cube that is turned and brought nearer, and its poses."""
    frames = []
    for index in range(COUNT):
        t = index / COUNT
        pose = held(
            0.5 + 0.3 * np.sin(7 * t), 0.3 + 0.9 * t, 0.8 * t, at=(0.04 * t, 0, 0.4 - 0.1 * t)
        )
        frames.append((Frame(photograph(scene((CUBE, pose)), seed=index), index / 30, index), pose))
    return frames


def tracked(tracker: CubeTracker, shown: list[tuple[Frame, Array]]) -> list[CubeState]:
    return [tracker.update(frame) for frame, _ in shown]


@pytest.mark.slow(reason="a focal length is known after a second of play")
@pytest.mark.parametrize("factor", GUESSES)
def test_depth_through_a_wrong_guess_is_doubted_then_right(
    shown: list[tuple[Frame, Array]], factor: float
) -> None:
    states = tracked(CubeTracker(CUBE, GUESSES[factor]), shown)
    for state, (_, truth) in zip(states, shown, strict=True):
        if state.visible:
            assert state.camera_from_cube is not None
            error = se3.delta(state.camera_from_cube, truth)
            assert (np.abs(error) < 3 * np.sqrt(np.diag(state.covariance))).all()
    last, truth = states[-1], shown[-1][1]
    assert last.camera_from_cube is not None
    assert last.focal_scale == pytest.approx(1 / factor, rel=0.03)
    assert last.camera_from_cube[2, 3] == pytest.approx(truth[2, 3], rel=0.03)
    assert se3.angle_between(last.camera_from_cube, truth) < np.deg2rad(1)
    first = states[0].camera_from_cube
    assert first is not None
    # The doubt of the first frame is that of the guess, in the depth.
    assert np.sqrt(states[0].covariance[2, 2]) > 0.2 * first[2, 3]
    assert abs(states[0].focal_shift[2]) > 0.2 * first[2, 3]


@pytest.mark.slow(reason="a focal length is known after a second of play")
def test_the_same_frames_tell_the_same_lens(shown: list[tuple[Frame, Array]]) -> None:
    one, other = (CubeTracker(CUBE, GUESSES[1.7]) for _ in range(2))
    for a, b in zip(tracked(one, shown[:12]), tracked(other, shown[:12]), strict=True):
        assert a.camera_from_cube is not None
        assert b.camera_from_cube is not None
        assert np.array_equal(a.camera_from_cube, b.camera_from_cube)
        assert a.focal_scale == b.focal_scale
    assert np.array_equal(one.measured_intrinsics.matrix, other.measured_intrinsics.matrix)
    assert (one.measured_intrinsics.focal_deviation or 1.0) < 0.1
    assert not one.measured_intrinsics.distortion.any()


@pytest.mark.slow(reason="a focal length is known after a second of play")
def test_another_print_is_seen_through_the_lens_that_was_measured(
    shown: list[tuple[Frame, Array]],
) -> None:
    tracker = CubeTracker(CUBE, GUESSES[1.7])
    tracked(tracker, shown[:24])
    before, pose = tracker.measured_intrinsics, held()
    printed = cube_with(CUBE, PrintFault("turned"))
    tracker.reprint(printed)
    assert np.allclose(tracker.measured_intrinsics.matrix, before.matrix)
    assert tracker.measured_intrinsics.focal_deviation == before.focal_deviation
    state = tracker.update(Frame(photograph(scene((printed, pose))), 1.0, 30))
    assert state.camera_from_cube is not None
    assert state.focal_scale == pytest.approx(1 / 1.7, rel=0.05)
    assert state.camera_from_cube[2, 3] == pytest.approx(pose[2, 3], rel=0.05)


@pytest.mark.parametrize("deviation", [None, 0.002])
def test_a_calibration_stays_as_it_is(
    shown: list[tuple[Frame, Array]], deviation: float | None
) -> None:
    wrong: Intrinsics = replace(CAMERA.lengthen(1.02, deviation))
    tracker = CubeTracker(CUBE, wrong)
    states = tracked(tracker, shown[:8])
    assert {state.focal_scale for state in states} == {1.0}
    assert tracker.measured_intrinsics is wrong
