"""The benchmark's webcam blooms, blurs and distorts, and its paper cube is worn, as promised."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cubeling.tracking import CubeModel, Intrinsics
from tests.bench.tracking.cameras import WEBCAM_LENS
from tests.bench.tracking.comparison import job_of
from tests.bench.tracking.light import UP, Light
from tests.bench.tracking.optics import LensModel, compressed, srgb_encoded
from tests.bench.tracking.paper import AXES, SMALL_CUBE, BenchmarkCube, Side
from tests.bench.tracking.plans import SEQUENCE_PLANS
from tests.bench.tracking.renderer import Scene, expose
from tests.bench.tracking.sequences import NAMES, sequence
from tests.bench.tracking.worn_paper import patched, worn

pytestmark = pytest.mark.full

EVEN = Light(np.array([0.0, 0.0, -1.0]), power=0.0, sky=0.0, bounce=0.95)

SMALL = LensModel(
    np.array([[900.0, 0, 102.0], [0, 900.0, 97.0], [0, 0, 1]]), np.zeros(5), (200, 200)
)

WEBCAMS = [name for name in NAMES if name.startswith("webcam")]


def drawn(lens: LensModel, cube: BenchmarkCube, pose: np.ndarray) -> np.ndarray:
    """Linear light without noise and vignette, on a dark table."""
    background = np.zeros((lens.size[1], lens.size[0], 3), np.float32)
    poses = lambda times: np.repeat(pose[None], len(times), axis=0)  # noqa: E731
    scene = Scene(lens, cube, EVEN, lambda: background, poses, lambda time: ())
    return np.asarray(expose(scene, 0.0, 0.0, np.random.default_rng(5))[..., 1] / lens.vignette)


def square_on(depth: float, tilt: tuple[float, float, float] = (0, 0, 0)) -> np.ndarray:
    """Pose whose front looks at the camera and is then tilted."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(tilt).as_matrix() @ np.diag([1.0, -1, -1])
    pose[:3, 3] = 0.0013, -0.0007, depth
    return pose


STRAIGHT = replace(WEBCAM_LENS, distortion=np.zeros(5))


ACROSS_PX = np.linspace(-3, 3, 49)
"""Where light is measured across an edge, from black to white."""


def across_border(depth: float) -> np.ndarray:
    """Light at `ACROSS_PX` of the right border of a front of 60 mm.

    The border is slanted, so that each row crosses it at another phase of a pixel, as in ISO 12233.
    """
    cube, pose = BenchmarkCube.load("locomotion"), square_on(depth, (0, 0, 0.04))
    corners = next(side for side in cube.sides if side.name == "front").corners
    _, upper, lower, _ = STRAIGHT.project(corners @ pose[:3, :3].T + pose[:3, 3])
    rows, columns = np.mgrid[int(upper[1]) + 6 : int(lower[1]) - 6, : STRAIGHT.size[0]]
    edge = upper[0] + (rows - upper[1]) * (lower[0] - upper[0]) / (lower[1] - upper[1])
    off = (columns - edge) * (lower[1] - upper[1]) / np.linalg.norm(lower - upper)
    near, light = np.abs(off) < 3.2, drawn(STRAIGHT, cube, pose)
    order = np.argsort(off[near])
    smooth = np.ones(9) / 9
    seen = light[rows, columns][near][order]
    return np.interp(
        ACROSS_PX,
        np.convolve(off[near][order], smooth, "valid"),
        np.convolve(seen, smooth, "valid"),
    )


def crossing(profile: np.ndarray) -> float:
    """Where a rising edge is half way up [px]."""
    return float(np.interp((profile[0] + profile[-1]) / 2, profile, ACROSS_PX))


@pytest.mark.parametrize("depth", [0.2, 0.25, 0.4, 0.6])
def test_white_grows_over_black_by_a_third_of_a_pixel(depth: float) -> None:
    light = across_border(depth)
    assert abs(crossing(light)) < 0.03, "in linear light"
    assert 0.29 < -crossing(srgb_encoded(light)) < 0.43


def test_blur_grows_away_from_the_distance_of_focus() -> None:
    widths = []
    for depth in (0.4, 0.3, 0.25, 0.2):
        spread = np.diff(across_border(depth))
        middle = spread @ ACROSS_PX[1:] / spread.sum()
        widths.append(np.sqrt(spread @ (ACROSS_PX[1:] - middle) ** 2 / spread.sum()))
    assert np.diff(widths).min() > 0.02
    peaks = [WEBCAM_LENS.spread(depth).max() for depth in (0.4, 0.6, 1.1)]
    assert np.diff(peaks).max() < 0


def test_lens_is_a_cushion() -> None:
    ideal = np.array([0.0, 0.0, 1.0]) + np.array([[0.5, 0, 0], [0, -0.38, 0]])
    out = np.abs(WEBCAM_LENS.project(ideal) - STRAIGHT.project(ideal)).max(1)
    assert WEBCAM_LENS.distortion[0] == 0.13
    assert out == pytest.approx(600 * 0.13 * np.array([0.5, 0.38]) ** 3, rel=0.05)


@pytest.mark.parametrize("name", WEBCAMS)
def test_trackers_are_told_the_lens_or_all_but_its_distortion(name: str) -> None:
    made = sequence(name, 1, 1)
    told = job_of(made)["camera"]
    assert told["matrix"] == made.matrix.tolist()
    assert made.distortion[0] == 0.13
    assert told["distortion"] == (
        [0.0] * 5 if name == "webcam-nominal" else made.distortion.tolist()
    )


def test_half_the_size_is_the_same_camera() -> None:
    half = sequence("webcam-half", 1, 1)
    full = Intrinsics(WEBCAM_LENS.matrix, WEBCAM_LENS.distortion, WEBCAM_LENS.size)
    assert half.size == (320, 240)
    assert half.frame(0).shape == (240, 320, 3)
    assert np.allclose(half.matrix, full.scale((320, 240)).matrix)


def dotted(side: Side, column: int, row: int) -> Side:
    """Return a black face with one white square."""
    albedo = np.zeros((20, 20), np.float32)
    albedo[row, column] = 1.0
    scale = len(side.albedo) / 20
    place = side.place * np.array([scale, scale, 1])
    place[:, 2] += (side.place[:, 0] + side.place[:, 1]) * (scale - 1) / 2
    return replace(side, albedo=albedo, place=place)


@pytest.mark.parametrize("spot", [(9, 9), (2, 15), (16, 16), (14, 5)])
@pytest.mark.parametrize("seed", [1, 2])
def test_every_point_of_a_bent_face_lies_where_folds_and_bulge_put_it(seed, spot) -> None:
    cube = worn(BenchmarkCube.load(SMALL_CUBE), np.random.default_rng(seed))
    side = next(side for side in cube.sides if side.name == "front")
    assert side.relief is not None
    pose = square_on(0.25, (0.5, 0.4, 0.2))
    only = replace(dotted(side, *spot), relief=side.relief)
    light = drawn(SMALL, replace(cube, sides=(only,)), pose)
    rows, columns = np.mgrid[:200, :200]
    seen = np.array([(columns * light).sum(), (rows * light).sum()]) / light.sum()
    u, v = (np.array(spot) + 0.5) / 10 - 1
    column, row = (np.array(spot) + 0.5) / 20 * len(side.albedo) - 0.5
    point = side.place @ (column, row, 1.0)
    a, b = side.relief.lean
    height = side.relief.bulge * (1 - u * u) * (1 - v * v) * (1 + a * u + b * v)
    height += side.relief.twist * u * v
    told = SMALL.project((point + height * side.normal) @ pose[:3, :3].T + pose[:3, 3])
    flat = SMALL.project(point @ pose[:3, :3].T + pose[:3, 3])
    assert np.linalg.norm(seen - told) < 0.06
    if spot == (9, 9):
        assert np.linalg.norm(flat - told) > 0.3, "a bulge moves the pixels"


def test_folds_do_not_stretch_the_paper() -> None:
    plain = BenchmarkCube.load(SMALL_CUBE)
    for side in worn(plain, np.random.default_rng(5)).sides:
        step = plain.edge / len(side.albedo)
        assert side.place[:, :2].T @ side.place[:, :2] == pytest.approx(step**2 * np.eye(2))


def test_folds_are_off_by_tenths_of_a_millimetre_and_of_a_degree() -> None:
    plain, tilts, shifts = BenchmarkCube.load(SMALL_CUBE), [], []
    for seed in range(12):
        for side in worn(plain, np.random.default_rng(seed)).sides:
            assert side.relief is not None
            assert 0.0001 <= abs(side.relief.bulge) <= 0.0003
            middle = side.place @ ((len(side.albedo) - 1) / 2, (len(side.albedo) - 1) / 2, 1)
            normal = AXES[side.name][2]
            tilts.append(np.degrees(np.arccos(side.normal @ normal)))
            shifts.append(np.linalg.norm(middle - normal * plain.edge / 2))
    assert 0.2 < np.median(tilts) < 0.5
    assert 0.05e-3 < np.median(shifts) < 0.2e-3


def test_tape_and_lines_lie_beside_the_markers() -> None:
    plain = BenchmarkCube.load(SMALL_CUBE)
    made = worn(plain, np.random.default_rng(4))
    changed = 0
    for before, after in zip(plain.sides, made.sides, strict=True):
        was = np.kron(before.albedo, np.ones((20, 20), np.float32))
        inside = slice(20, -20)
        assert np.array_equal(was[inside, inside], after.albedo[inside, inside])
        changed += not np.array_equal(was, after.albedo)
    assert changed >= 4


def test_a_patch_covers_one_corner_of_every_marker() -> None:
    cube = worn(BenchmarkCube.load(SMALL_CUBE), np.random.default_rng(1))
    for side in patched(cube, 0.3, np.random.default_rng(2)).sides:
        assert side.patch is not None
        corners = [side.patch[row, column] for row in (20, 139) for column in (20, 139)]
        assert sum(corners) == 1
        assert 0.05 < side.patch[20:140, 20:140].mean() < 0.13


def markers_found(picture: np.ndarray) -> dict[int, np.ndarray]:
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    found, ids, _ = cv2.aruco.ArucoDetector(dictionary).detectMarkers(picture)
    return {} if ids is None else dict(zip(map(int, np.ravel(ids)), found, strict=True))


def test_opencv_sees_corners_where_they_are_but_few_markers_under_patches() -> None:
    cube, seen, errors = CubeModel.load(SMALL_CUBE), {"webcam": 0, "webcam-covered": 0}, []
    for name in seen:
        made = sequence(name, 2, 6)
        for index in range(made.count):
            pose, found = made.truth(index), markers_found(made.frame(index))
            turn = cv2.Rodrigues(pose[:3, :3])[0]
            for face in cube.faces:
                if face.marker_id in found:
                    told, _ = cv2.projectPoints(
                        face.corners, turn, pose[:3, 3], made.matrix, made.distortion
                    )
                    off = np.linalg.norm(told[:, 0] - found[face.marker_id][0], axis=1)
                    errors.append(off.mean())
                    seen[name] += 1
    assert seen["webcam"] >= 7
    assert seen["webcam-covered"] <= seen["webcam"] / 4
    assert np.median(errors) < 1.5


def test_one_marker_is_in_view() -> None:
    made = sequence("webcam-one", 1, 20)
    for index in range(made.count):
        pose, toward = made.truth(index), []
        for side in BenchmarkCube.load(SMALL_CUBE).sides:
            ray = pose[:3, :3] @ side.normal * 0.015 + pose[:3, 3]
            toward.append(-(pose[:3, :3] @ side.normal) @ ray / np.linalg.norm(ray))
        assert sorted(toward)[-2] < 0.2 < 0.9 < max(toward)


def test_motion_smears_the_cube_over_ten_pixels_in_any_direction() -> None:
    made = sequence("webcam-blurred", 1, 20)
    ways = []
    for index in range(made.count):
        place, velocity = made.truth(index)[:3, 3], made.velocity(index)[:3]
        ways.append((velocity * made.exposure / place[2] * WEBCAM_LENS.matrix[0, 0])[:2])
    assert np.linalg.norm(ways, axis=1) == pytest.approx(10.0, rel=0.01)
    assert np.abs(np.mean(ways, axis=0)).max() < 5


def test_the_cube_lies_on_the_table_in_half_of_the_frames() -> None:
    made, up = sequence("webcam", 1, 40), UP / np.linalg.norm(UP)
    below = [-made.truth(index)[:3, 3] @ up for index in range(made.count)]
    lying = np.isclose(below, SEQUENCE_PLANS["webcam"].height - 0.015)
    assert 10 < lying.sum() < 30
    for index in np.flatnonzero(lying).tolist():
        assert np.abs(made.truth(index)[:3, :3].T @ up).max() == pytest.approx(1)


def test_same_seed_gives_the_same_bytes_in_any_order() -> None:
    first = sequence("webcam-covered", 3, 6).frame(4)
    sequence.cache_clear()
    again = sequence("webcam-covered", 3, 6)
    again.frame(5)
    assert np.array_equal(first, again.frame(4))
    assert not np.array_equal(first, sequence("webcam-covered", 4, 6).frame(4))


def test_compression_loses_little() -> None:
    ramp = np.add.outer(np.arange(64), np.arange(64))[..., None] + np.array([0, 40, 80])
    off = np.abs(compressed(ramp.astype(np.uint8), 85).astype(int) - ramp)
    assert 0 < off.mean() < 3
