"""A blurred image gives the pose in the middle of the exposure, and the motion."""

from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import MIN_CORRELATION, BlurSearch
from cubeling.tracking.refinement.camera_model import MIN_BLUR_PX, CameraModelEstimator, ToneCurve
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.photometry.motion_blur_alignment import MotionBlurAligner
from cubeling.tracking.refinement.photometry.photometric_fit import Alignment
from cubeling.tracking.tracker.local_search import LocalTracker
from cubeling.tracking.tracker.prediction import Track, TrackedPose
from tests.examples import some
from tests.tracking.drawn import CAMERA, held, off, photograph, scene

Array = NDArray[np.float64]

CUBE, OTHER = CubeModel.load("locomotion"), CubeModel.load("companion")
ALIGNER = MotionBlurAligner(CUBE, Projection(CAMERA))
LIGHT = ToneCurve().table
VIEWS = [held(), held(0.8, -0.5, 0.4), held(0.4, 2.2, -0.3), held(-0.6, 0.7, 1.0)]
DIRECTIONS = (0.0, 1.0, 2.0)
DISTANCE = 1.0 / 60
"""At 1 m/s with the shutter open for a sixtieth of a second [m]."""


@dataclass(frozen=True)
class Shot:
    """A picture of a moving cube."""

    patch: Patch
    pose: Array
    motion: Array

    def align(
        self, start: Array, aligner: MotionBlurAligner = ALIGNER, coarse: bool = True
    ) -> Alignment | None:
        """Align with a past that expects a motion 15 % too short, and knows that it may be off."""
        expected = 0.85 * self.motion
        sizes = [np.linalg.norm(expected[:3]), np.linalg.norm(expected[3:])]
        prior = np.hypot(0.35 * np.repeat(sizes, 3), np.repeat([0.004, 0.06], 3))
        return aligner.align(self.patch, start, expected, prior, coarse)

    def found(self, start: Array) -> Alignment:
        alignment = self.align(start)
        assert alignment is not None
        return alignment


def shot(pose: Array, motion: Array, cube: CubeModel = CUBE) -> Shot:
    return Shot(
        Patch.crop(photograph(scene((cube, pose), sweep=motion)), None, LIGHT), pose, motion
    )


def offset_pose(pose: Array, random: np.random.Generator) -> Array:
    """A pose 3 mm and 2° off."""
    step = random.normal(0, 1, (2, 3))
    step *= np.array([[0.003], [np.deg2rad(2)]]) / np.linalg.norm(step, axis=1, keepdims=True)
    return se3.apply_delta(pose, step.ravel())


@pytest.fixture(scope="module")
def shots() -> list[Shot]:
    """Cubes that move across the picture at 1 m/s, and turn a little."""
    random = np.random.default_rng(1)
    shots = []
    for view in VIEWS:
        for way in DIRECTIONS:
            across = DISTANCE * np.array([np.cos(way), np.sin(way), 0.0])
            shots.append(shot(view, np.append(across, random.normal(0, 0.02, 3))))
    return shots


@pytest.fixture(scope="module", params=some([1, 4]), ids="{} starts".format)
def alignments(
    shots: list[Shot], request: pytest.FixtureRequest
) -> list[tuple[Shot, Alignment | None]]:
    random = np.random.default_rng(2)
    starts = range(request.param)
    return [(each, each.align(offset_pose(each.pose, random))) for each in shots for _ in starts]


def test_the_pose_is_found_from_three_millimetres_and_two_degrees_off(
    alignments: list[tuple[Shot, Alignment | None]],
) -> None:
    found = [(each, alignment) for each, alignment in alignments if alignment]
    errors = np.array([off(alignment.camera_from_cube, each.pose) for each, alignment in found])
    assert len(found) > len(alignments) / 2
    assert (errors.max(axis=0) < [0.5, 0.3]).all()
    assert (np.median(errors, axis=0) < [0.25, 0.1]).all()
    assert min(alignment.min_correlation for _, alignment in found) > 0.95


def test_alignment_succeeds_from_every_such_start(
    alignments: list[tuple[Shot, Alignment | None]],
) -> None:
    assert all(alignment for _, alignment in alignments)


@pytest.mark.parametrize(("view", "lengths"), [(0, 3.25), (1, 3.0), (2, 2.875)])
def test_a_cube_is_not_found_where_blur_leaves_too_little_of_each_face(
    view: int, lengths: float
) -> None:
    sweep = np.array([DISTANCE, 0, 0, 0, 0, 0])
    taken = shot(VIEWS[view], sweep)
    expected = lengths * sweep + (0, 0, 0, 0, 0.9, 0)
    sure = np.repeat([0.0005, 0.005], 3)
    assert ALIGNER.align(taken.patch, taken.pose, expected, sure, coarse=False) is None


def test_the_motion_across_the_image_is_measured(
    alignments: list[tuple[Shot, Alignment | None]],
) -> None:
    for each, alignment in alignments:
        if alignment:
            error = np.linalg.norm((alignment.blur_motion - each.motion)[:2])
            assert error < 0.15 * np.linalg.norm(each.motion[:2])


def test_the_motion_information_does_not_depend_on_the_prior(
    alignments: list[tuple[Shot, Alignment | None]],
) -> None:
    for each, alignment in alignments:
        if alignment:
            pull, information = alignment.motion_information
            assert np.allclose(information, information.T, rtol=1e-6)
            told = np.linalg.solve(information, pull)
            assert np.linalg.norm((told - each.motion)[:2]) < 0.15 * DISTANCE


def test_the_covariance_is_symmetric_and_positive(
    alignments: list[tuple[Shot, Alignment | None]],
) -> None:
    for _, alignment in alignments:
        if alignment:
            covariance = alignment.covariance
            assert covariance.shape == (12, 12)
            assert np.allclose(covariance, covariance.T, rtol=1e-6, atol=1e-15)
            assert np.linalg.eigvalsh(covariance).min() > 0
            # Millimetres and degrees, not metres; and no better than a hundredth of a pixel.
            assert 3e-6 < np.sqrt(np.diag(covariance)[:3]).max() < 3e-3


def test_a_good_start_needs_no_coarse_search(shots: list[Shot]) -> None:
    random = np.random.default_rng(3)
    for each in shots:
        step = random.normal(0, 1, 6) * np.repeat([3e-4, 4e-3], 3)
        alignment = each.align(se3.apply_delta(each.pose, step), coarse=False)
        assert alignment is not None
        assert off(alignment.camera_from_cube, each.pose)[0] < 0.5


def test_the_blur_motion_of_a_cube_at_rest_is_below_the_blur_of_a_lens() -> None:
    still = shot(VIEWS[0], np.zeros(6))
    alignment = still.found(se3.apply_delta(VIEWS[0], np.array([4e-4, -3e-4, 5e-4, 4e-3, 0, 3e-3])))
    assert off(alignment.camera_from_cube, VIEWS[0])[0] < 0.2
    pixels = np.linalg.norm(alignment.blur_motion[:2]) * CAMERA.matrix[0, 0] / VIEWS[0][2, 3]
    assert pixels < MIN_BLUR_PX


def test_a_finger_on_a_face_does_not_shift_the_pose(shots: list[Shot]) -> None:
    each = shots[0]
    grey = each.patch.grey.copy()
    grey[236:262, 282:306] = 90
    covered = Shot(Patch(grey, 0, 0), each.pose, each.motion)
    alignment = covered.found(se3.apply_delta(each.pose, np.array([1e-3, 0, 0, 0, 0.01, 0])))
    assert off(alignment.camera_from_cube, each.pose)[0] < 1.0
    assert np.linalg.norm((alignment.blur_motion - each.motion)[:2]) < 0.15 * DISTANCE


def test_another_cube_does_not_correlate(shots: list[Shot]) -> None:
    for each in shots[::3]:
        other = shot(each.pose, each.motion, OTHER)
        itself = MotionBlurAligner(OTHER, Projection(CAMERA))
        right = other.align(each.pose, itself, coarse=False)
        assert right is not None
        assert right.min_correlation > 0.95
        for coarse in (False, True):
            wrong = other.align(each.pose, coarse=coarse)
            assert wrong is None or wrong.min_correlation < MIN_CORRELATION


def test_an_even_image_does_not_correlate(shots: list[Shot]) -> None:
    random = np.random.default_rng(4)
    grey = (120 + random.normal(0, 2, (480, 640))).astype(np.float32)
    nothing = Shot(Patch(grey, 0, 0), shots[0].pose, shots[0].motion).align(shots[0].pose)
    assert nothing is None or nothing.min_correlation < 0.5


@pytest.mark.parametrize("place", [(2.0, 0, 0.4), (0, 0, -0.4), (0, 0, 0.02)])
def test_no_cube_is_found_outside_the_image_or_behind_the_camera(
    shots: list[Shot], place: tuple[float, float, float]
) -> None:
    assert shots[0].align(held(at=place)) is None


def test_a_finger_over_one_face_does_not_hide_two_others_in_motion() -> None:
    """Both correlate by 0.98 and more, so that the third must be covered."""
    pose = held(0.45, 0.4, 0.0)
    across = 0.5 * np.eye(6)[0]
    light = scene((CUBE, pose), sweep=across / 60)
    corners = CUBE.face("right").corners @ pose[:3, :3].T + pose[:3, 3]
    pixels = Projection(CAMERA).project(corners)
    cv2.fillConvexPoly(light, np.rint(pixels).astype(np.int32), 0.3)
    track, projection = Track(), Projection(CAMERA)
    for time in (-1 / 15, -1 / 30):
        past = se3.apply_delta(pose, time * across)
        track = track.add(TrackedPose(past, across, 1e-8 * np.eye(6), time))
    edges = EdgeSearch(CUBE, projection)
    cells, blur = CellSearch(CUBE, projection), BlurSearch(CUBE, projection, edges)
    tracker = LocalTracker(CUBE, projection, edges, cells, blur)
    prediction, camera = track.predict(0.0), CameraModelEstimator().model
    assert prediction is not None
    found = tracker.search(photograph(light), track, prediction, camera).candidate
    assert found is not None
    assert off(found.camera_from_cube, pose)[0] < 0.5
