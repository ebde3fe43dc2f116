"""The photographs of a hand-held dodecahedron, as one sequence that nobody drew.

They are 72 pictures that others took of a real hand; where they are absent these tests are skipped.
"""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.gestures.gestures import CubeGestures
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.photographs import sequence
from tests.bench.photographs.dodecahedron import camera, paths, photograph
from tests.bench.photographs.variants import VARIANTS
from tests.bench.tracking.scoring import CHI2_95_PERCENT
from tests.tracking.showing import show_until_decided

pytestmark = pytest.mark.skipif(not paths(), reason="the photographs are not on this machine")

FEW = range(12)
"""The first turn of the body in the hand, and a leap of 12 cm."""


@pytest.mark.slow(reason="twelve photographs are searched as a whole, for three bodies")
def test_a_hand_held_dodecahedron_is_tracked_through_its_photographs() -> None:
    """Two halves of the body, which share no marker, say the same as the whole one."""
    whole = CubeModel.load(sequence.BODY_FILE)
    bodies = [whole, *(replace(whole, faces=whole.faces[half::2]) for half in (0, 1))]
    trackers = [CubeTracker(body, camera()) for body in bodies]
    gestures = CubeGestures(whole)
    apart = []
    for index, number in enumerate(FEW):
        frame = Frame(photograph(number), index * sequence.INTERVAL_S, index)
        state, *halves = [tracker.update(frame) for tracker in trackers]
        assert gestures.update(state).visible
        assert state.camera_from_cube is not None
        assert len(state.faces) >= 3
        assert state.reprojection_error < 2.5
        apart += [
            se3.delta(state.camera_from_cube, half.camera_from_cube)
            for half in halves
            if half.visible and half.camera_from_cube is not None
        ]
    assert len(apart) > len(FEW)
    shifts, turns = np.linalg.norm(np.reshape(apart, (-1, 2, 3)), axis=2).T
    assert np.median(shifts) < 0.001
    assert shifts.max() < 0.005
    assert np.rad2deg(np.median(turns)) < 0.5
    assert np.rad2deg(turns.max()) < 2.5


@pytest.mark.slow(reason="blurred photographs are searched to the end")
def test_a_photograph_is_tracked_as_if_the_camera_had_moved() -> None:
    """By 10 px, two of its cells: within what is stated of where the sharp one shows the body."""
    body = CubeModel.load(sequence.BODY_FILE)
    for number in (3, 51):
        picture = photograph(number)
        sharp, blurred = (
            show_until_decided(CubeTracker(body, camera()), each)[0]
            for each in (picture, VARIANTS["blurred"](picture, number).picture)
        )
        assert sharp.visible
        assert blurred.visible
        assert sharp.camera_from_cube is not None
        assert blurred.camera_from_cube is not None
        off = se3.delta(blurred.camera_from_cube, sharp.camera_from_cube)
        assert np.linalg.norm(off[:3]) < 0.003
        assert off @ np.linalg.solve(blurred.covariance, off) < CHI2_95_PERCENT


@pytest.mark.full
def test_all_of_them_are_tracked_as_a_bundle_adjustment_says() -> None:
    numbers = range(len(paths()))
    result = sequence.score(numbers, sequence.track(numbers))
    assert (result.found, result.right, result.wrong) == (72, 72, 0)
    assert result.shift[1] < 0.002
    assert np.rad2deg(result.turn[1]) < 0.8
