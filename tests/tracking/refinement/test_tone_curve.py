"""The tone curve of a camera is estimated from mixtures of black and white."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import BlurSearch
from cubeling.tracking.refinement.camera_model import (
    EXPONENT_SAMPLES,
    FIRST_EXPONENT,
    MIN_EXPONENT_STEP,
    CameraModelEstimator,
    ToneCurve,
)
from cubeling.tracking.refinement.cell_search import CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.photometry.photometric_fit import PhotometricSamples, fit_tones
from cubeling.tracking.synthetic import open_synthetic
from cubeling.tracking.tracker.local_search import LocalTracker
from cubeling.tracking.tracker.prediction import Track, TrackedPose
from tests.bench.tracking.sequences import Sequence, sequence

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

BLACK, WHITE = 0.05, 0.8


def seen_through(curve: ToneCurve, exponent: float, white_share: Array) -> Array:
    """Light of mixtures as the curve reads it, of a camera of another exponent, 0…255."""
    light = BLACK + white_share * (WHITE - BLACK)
    return np.interp(255 * light ** (1 / exponent), np.arange(256), curve.table)


def tones(curve: ToneCurve, exponent: float) -> tuple[float, float]:
    """Bend and black of the parabola through black, white, and the middle."""
    black, middle, white = seen_through(curve, exponent, np.array([0, 0.5, 1]))
    return 4 * (middle - (black + white) / 2) / (white - black), black / white


def teach(curve: ToneCurve, exponent: float, times: int) -> None:
    for _ in range(times):
        curve.learn(*tones(curve, exponent))


def track_of(poses: list[Array], times: list[float]) -> Track:
    """Track of a cube whose poses are known."""
    track = Track()
    sure = np.diag([1e-10] * 3 + [1e-8] * 3)
    for pose, time in zip(poses, times, strict=True):
        velocity, acceleration = track.motion(pose, sure, time)
        track = track.add(TrackedPose(pose, velocity, sure, time, acceleration))
    return track


@pytest.mark.parametrize("exponent", [1.0, 1.8, 2.2])
def test_the_exponent_of_a_camera_is_found_from_its_mixtures(exponent: float) -> None:
    curve = ToneCurve()
    teach(curve, exponent, EXPONENT_SAMPLES)
    assert curve.known
    assert curve.exponent == pytest.approx(exponent, abs=0.03)
    # With the table that fits, mixtures are straight: there is nothing left to learn.
    assert abs(tones(curve, exponent)[0]) < 0.03
    teach(curve, exponent, 2 * EXPONENT_SAMPLES)
    assert curve.exponent == pytest.approx(exponent, abs=0.03)


@pytest.mark.parametrize("exponent", [1.0, 1.4, 2.2])
def test_noisy_mixtures_of_two_faces_give_the_exponent_too(exponent: float) -> None:
    curve, random = ToneCurve(), np.random.default_rng(2)
    for _ in range(EXPONENT_SAMPLES):
        drawn = random.uniform(0, 1, 800)
        drawn[::2] = np.rint(drawn[::2])
        face = np.arange(800) // 400
        seen = seen_through(curve, exponent, drawn) + random.normal(0, 3, 800)
        blocks = np.arange(800) // 40
        fit = fit_tones(PhotometricSamples(face, blocks, seen, drawn, np.zeros((800, 12))), 2)
        curve.learn(*fit.mixture_tones)
    assert curve.exponent == pytest.approx(exponent, abs=0.2)


@pytest.mark.parametrize("exponent", [0.7, 3.2])
def test_an_implausible_exponent_is_clipped(exponent: float) -> None:
    curve = ToneCurve()
    teach(curve, exponent, EXPONENT_SAMPLES)
    assert 1.0 <= curve.exponent <= 2.6


def test_the_table_rises_from_black_to_white() -> None:
    for exponent in (1.0, 1.6, FIRST_EXPONENT):
        curve = ToneCurve()
        teach(curve, exponent, EXPONENT_SAMPLES)
        assert curve.table.shape == (256,)
        assert (np.diff(curve.table) >= 0).all()
        assert (np.diff(curve.table[16:]) > 0).all()
        assert curve.table[[0, 255]] == pytest.approx([0, 255])


def test_the_table_changes_only_once_known_and_by_more_than_a_trifle() -> None:
    curve = ToneCurve()
    first = curve.table.copy()
    teach(curve, 1.0, EXPONENT_SAMPLES - 1)
    assert not curve.known
    assert curve.exponent == FIRST_EXPONENT
    assert np.array_equal(curve.table, first)
    teach(curve, 1.0, 1)
    assert curve.exponent == pytest.approx(1.0, abs=0.03)
    trifle = ToneCurve()
    teach(trifle, FIRST_EXPONENT - MIN_EXPONENT_STEP / 2, EXPONENT_SAMPLES)
    assert trifle.known
    assert trifle.exponent == FIRST_EXPONENT
    assert np.array_equal(trifle.table, first)


@dataclass(frozen=True)
class Clip:
    """Some frames of a fast cube."""

    cube: CubeModel
    projection: Projection
    shots: list[tuple[Picture, list[float], list[Array]]]
    """Each with the times and the poses of the two frames before it and of itself."""

    def learn(self, camera: CameraModelEstimator) -> None:
        """Follow the cube through the clip, each time with its true past."""
        edges = EdgeSearch(self.cube, self.projection)
        blur = BlurSearch(self.cube, self.projection, edges)
        cells = CellSearch(self.cube, self.projection)
        tracker = LocalTracker(self.cube, self.projection, edges, cells, blur)
        for picture, times, poses in self.shots:
            track = track_of(poses[:2], times[:2])
            prediction = track.predict(times[2])
            assert prediction is not None
            match = tracker.search(picture, track, prediction, camera.model)
            camera.learn(match.blur, match.studied)
            if match.candidate is not None:
                delta = se3.delta(match.candidate.camera_from_cube, poses[2])
                assert np.linalg.norm(delta[:3]) < 0.01


def on_grey(whole: Sequence) -> Sequence:
    """Put the cube before an even grey: its table takes longer to draw than all frames of it."""
    width, height = whole.size
    grey = np.full((height, width, 3), 0.2, np.float32)
    scenes = (replace(scene, background=lambda: grey) for scene in whole.scenes)
    return replace(whole, scenes=tuple(scenes))


@pytest.fixture(scope="module")
def in_linear_light() -> Clip:
    scene = on_grey(sequence("sweep-0.5", 1, 24))
    projection = Projection(Intrinsics(scene.matrix, scene.distortion, scene.size))
    shots = []
    for number in range(13, 23):  # the fastest of these
        three = range(number - 2, number + 1)
        times, poses = [scene.timestamp(n) for n in three], [scene.truth(n) for n in three]
        shots.append((scene.frame(number), times, poses))
    return Clip(CubeModel.load(scene.cube), projection, shots)


@pytest.mark.full
def test_the_exponent_of_images_in_linear_light_is_found(in_linear_light: Clip) -> None:
    camera = CameraModelEstimator()
    in_linear_light.learn(camera)
    assert camera.tone_curve.known
    assert camera.tone_curve.exponent == pytest.approx(2.2, abs=0.15)


def test_a_wrong_exponent_is_corrected(in_linear_light: Clip) -> None:
    """Each measurement uses the table that was learnt before, so it takes some frames."""
    camera = CameraModelEstimator()
    teach(camera.tone_curve, 1.0, EXPONENT_SAMPLES)
    assert camera.tone_curve.exponent == pytest.approx(1.0, abs=0.03)
    in_linear_light.learn(camera)
    in_linear_light.learn(camera)
    assert camera.tone_curve.exponent == pytest.approx(2.2, abs=0.25)


@pytest.mark.slow(reason="tones are known after sixteen frames")
def test_images_that_blur_grey_values_give_an_exponent_near_one() -> None:
    source = open_synthetic("sweep?speed=0.5&blur=0.0167&clutter=0&hand=0&shadow=0&size=640x360")
    assert source.intrinsics is not None
    shots = []
    for number in range(39, 55):
        three = range(number - 2, number + 1)
        times, poses = [source.time(n) for n in three], [source.truth(n) for n in three]
        shots.append((source.frame(number).image, times, poses))
    camera = CameraModelEstimator()
    Clip(source.cube, Projection(source.intrinsics), shots).learn(camera)
    assert camera.tone_curve.known
    assert 1.0 <= camera.tone_curve.exponent <= 1.3
