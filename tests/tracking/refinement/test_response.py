"""How a camera's grey values grow with the light is learnt from mixtures of black and white."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.bench.tracking.sequences import sequence
from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import Projection
from tracking.refinement.photometric_fit import Samples, fit
from tracking.refinement.tone_curve import KEPT, STEP, USUAL, Response
from tracking.synthetic import open_synthetic
from tracking.tracker.local_search import Follower
from tracking.tracker.prediction import Sighting, Track

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

BLACK, WHITE = 0.05, 0.8


def seen_through(response: Response, exponent: float, white_share: Array) -> Array:
    """Light of mixtures as read with the response, of a camera of another exponent, 0…255."""
    light = BLACK + white_share * (WHITE - BLACK)
    return np.interp(255 * light ** (1 / exponent), np.arange(256), response.table)


def tones(response: Response, exponent: float) -> tuple[float, float]:
    """Bend and black of the parabola through black, white, and the middle."""
    black, middle, white = seen_through(response, exponent, np.array([0, 0.5, 1]))
    return 4 * (middle - (black + white) / 2) / (white - black), black / white


def teach(response: Response, exponent: float, times: int) -> None:
    for _ in range(times):
        response.learn(*tones(response, exponent))


def track_of(poses: list[Array], times: list[float]) -> Track:
    """Past of a cube whose way is known."""
    track = Track()
    sure = np.diag([1e-10] * 3 + [1e-8] * 3)
    for pose, time in zip(poses, times, strict=True):
        velocity, change = track.motion(pose, sure, time)
        track.add(Sighting(pose, velocity, sure, time, change))
    return track


@pytest.mark.parametrize("exponent", [1.0, 1.8, 2.2])
def test_the_exponent_of_a_camera_is_found_from_its_mixtures(exponent: float) -> None:
    response = Response()
    teach(response, exponent, KEPT)
    assert response.known
    assert response.exponent == pytest.approx(exponent, abs=0.03)
    # With the table that fits, mixtures are straight: there is nothing left to learn.
    assert abs(tones(response, exponent)[0]) < 0.03
    teach(response, exponent, 2 * KEPT)
    assert response.exponent == pytest.approx(exponent, abs=0.03)


@pytest.mark.parametrize("exponent", [1.0, 1.4, 2.2])
def test_noisy_mixtures_of_two_faces_tell_it_too(exponent: float) -> None:
    response, random = Response(), np.random.default_rng(2)
    for _ in range(KEPT):
        drawn = random.uniform(0, 1, 800)
        drawn[:400] = np.rint(drawn[:400])
        face = np.arange(800) % 2
        seen = seen_through(response, exponent, drawn) + random.normal(0, 3, 800)
        blocks = np.arange(800) // 40
        mixture = fit(Samples(face, blocks, seen, drawn, np.zeros((800, 12))), 2)
        response.learn(*mixture.tones)
    assert response.exponent == pytest.approx(exponent, abs=0.2)


@pytest.mark.parametrize("exponent", [0.7, 3.2])
def test_no_camera_is_believed_to_be_beyond_bounds(exponent: float) -> None:
    response = Response()
    teach(response, exponent, KEPT)
    assert 1.0 <= response.exponent <= 2.6


def test_the_table_rises_from_black_to_white() -> None:
    for exponent in (1.0, 1.6, USUAL):
        response = Response()
        teach(response, exponent, KEPT)
        assert response.table.shape == (256,)
        assert (np.diff(response.table) >= 0).all()
        assert (np.diff(response.table[16:]) > 0).all()
        assert response.table[[0, 255]] == pytest.approx([0, 255])


def test_nothing_changes_before_it_is_known_nor_for_a_trifle() -> None:
    response = Response()
    first = response.table.copy()
    teach(response, 1.0, KEPT - 1)
    assert not response.known
    assert response.exponent == USUAL
    assert np.array_equal(response.table, first)
    teach(response, 1.0, 1)
    assert response.exponent == pytest.approx(1.0, abs=0.03)
    trifle = Response()
    teach(trifle, USUAL - STEP / 2, KEPT)
    assert trifle.known
    assert trifle.exponent == USUAL
    assert np.array_equal(trifle.table, first)


@dataclass(frozen=True)
class Film:
    """Some frames of a fast cube, each with its time and the poses at it and two frames before."""

    follower: Callable[[], Follower]
    shots: list[tuple[Picture, list[float], list[Array]]]


@pytest.fixture(scope="module")
def in_linear_light() -> Film:
    scene = sequence("sweep-0.5", 1, 24)
    projection = Projection(Intrinsics(scene.matrix, scene.distortion, scene.size))
    cube = CubeModel.load(scene.cube)
    shots = []
    for number in range(13, 23):  # the fastest of these
        three = range(number - 2, number + 1)
        times, poses = [scene.timestamp(n) for n in three], [scene.truth(n) for n in three]
        shots.append((scene.frame(number), times, poses))
    return Film(lambda: Follower(cube, projection), shots)


def show(film: Film, follower: Follower) -> None:
    """Follow the cube through a film, each time with its true past."""
    for picture, times, poses in film.shots:
        found = follower.follow(picture, track_of(poses[:2], times[:2]), times[2])
        if found is not None:
            step = se3.motion(found.camera_from_cube, poses[2])
            assert np.linalg.norm(step[:3]) < 0.01


def test_a_cube_that_moves_in_linear_light_teaches_two_point_two(in_linear_light: Film) -> None:
    follower = in_linear_light.follower()
    show(in_linear_light, follower)
    assert follower.camera.response.known
    assert follower.camera.response.exponent == pytest.approx(2.2, abs=0.15)


def test_who_took_grey_values_for_light_is_taught_better(in_linear_light: Film) -> None:
    """Each step is made with the table that was learnt before, so it takes a few."""
    follower = in_linear_light.follower()
    teach(follower.camera.response, 1.0, KEPT)
    assert follower.camera.response.exponent == pytest.approx(1.0, abs=0.03)
    show(in_linear_light, follower)
    show(in_linear_light, follower)
    assert follower.camera.response.exponent == pytest.approx(2.2, abs=0.25)


def test_a_drawing_that_blurs_grey_values_teaches_nearly_one() -> None:
    source = open_synthetic("sweep?speed=0.5&blur=0.0167&clutter=0&hand=0&shadow=0")
    assert source.intrinsics is not None
    shots = []
    for number in range(39, 55):
        three = range(number - 2, number + 1)
        times, poses = [source.time(n) for n in three], [source.truth(n) for n in three]
        shots.append((source.frame(number).image, times, poses))
    follower = Follower(source.cube, Projection(source.intrinsics))
    show(Film(lambda: follower, shots), follower)
    assert follower.camera.response.known
    assert 1.0 <= follower.camera.response.exponent <= 1.3
