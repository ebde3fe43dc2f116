"""The benchmark's renderer against OpenCV's projection, and against its own promises."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cubeling.tracking import CubeModel
from tests.bench.tracking.cameras import LENS, WEBCAM_LENS
from tests.bench.tracking.hand import Finger
from tests.bench.tracking.light import Light
from tests.bench.tracking.optics import LensModel, Sensor, srgb_encoded
from tests.bench.tracking.paper import AXES, INK_ALBEDO, PAPER_ALBEDO, BenchmarkCube
from tests.bench.tracking.paths import matrices
from tests.bench.tracking.plans import SEQUENCE_PLANS
from tests.bench.tracking.renderer import WHITE_LEVEL, Scene, expose
from tests.bench.tracking.sequences import NAMES, Sequence, sequence

pytestmark = pytest.mark.full

SMALL = LensModel(
    np.array([[1500.0, 0, 203.0], [0, 1490.0, 195.0], [0, 0, 1]]),
    np.array([-0.9, 0.6, 0.002, -0.003, 0.1]),
    (400, 400),
)
"""A strong lens with a small picture: quick to draw, and bent by many pixels at its rim."""

EVEN = Light(np.array([0.0, 0.0, -1.0]), power=0.0, sky=0.0, bounce=1.0)


def scene(pose: np.ndarray, speed: tuple[float, float, float] = (0, 0, 0)) -> Scene:
    def poses(times: np.ndarray) -> np.ndarray:
        moved = np.repeat(pose[None], len(times), axis=0)
        moved[:, :3, 3] += np.outer(times, speed)
        return moved

    background = np.full((400, 400, 3), 0.02, np.float32)
    cube = BenchmarkCube.load("locomotion")
    return Scene(SMALL, cube, EVEN, lambda: background, poses, lambda time: ())


def facing(name: str, tilt: tuple[float, float, float] = (0.25, -0.3, 0.4)) -> np.ndarray:
    """Pose 0.45 m off, with the face `name` turned to the camera and then tilted."""
    right, up, normal = AXES[name]
    square = Rotation.from_matrix(np.stack([right, -up, -normal]))
    turned = Rotation.concatenate([Rotation.from_rotvec(tilt) * square])
    return np.asarray(matrices(turned, np.array([[0.012, -0.009, 0.45]]))[0])


def drawn(what: Scene, exposure: float = 0.0) -> np.ndarray:
    """Linear light without noise and vignette, (400, 400)."""
    light = expose(what, 0.0, exposure, np.random.default_rng(5))[..., 1]
    return light / SMALL.vignette


@pytest.fixture(scope="module")
def fingers() -> Sequence:
    return sequence("fingers", 3)


def test_lens_agrees_with_opencv_and_is_its_own_inverse() -> None:
    random = np.random.default_rng(1)
    for lens in (LENS, SMALL, WEBCAM_LENS):
        pixels = random.uniform(0, lens.size, (500, 2))
        rays = lens.directions(pixels)
        points = np.c_[rays, np.ones(500)] * random.uniform(0.3, 2, (500, 1))
        told, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), lens.matrix, lens.distortion)
        assert np.abs(told[:, 0] - pixels).max() < 1e-6
        assert np.abs(lens.project(points) - pixels).max() < 1e-6


@pytest.mark.parametrize("name", sorted(AXES))
def test_marker_is_drawn_where_opencv_projects_it(name: str) -> None:
    pose = facing(name)
    picture = np.rint(300 * np.clip(drawn(scene(pose)), 0, 0.8)).astype(np.uint8)
    model = CubeModel.load("locomotion")
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    found, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(picture)
    assert ids is not None
    seen = dict(zip(np.ravel(ids).tolist(), found, strict=True))
    face = model.face(name)
    turn, _ = cv2.Rodrigues(pose[:3, :3])
    told, _ = cv2.projectPoints(face.corners, turn, pose[:3, 3], SMALL.matrix, SMALL.distortion)
    assert np.abs(seen[face.marker_id][0] - told[:, 0]).max() < 0.3


def border_of(picture: np.ndarray, pose: np.ndarray) -> float:
    """How far the right border of the front marker lies from where it should, on average [px].

    The darkness of each row is summed up from the black border to the white margin, so blur that
    is even on both sides does not matter.
    """
    corners = CubeModel.load("locomotion").face("front").corners
    told, _ = cv2.projectPoints(
        corners, cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3], SMALL.matrix, SMALL.distortion
    )
    (top, bottom), errors = told[1:3, 0], []
    for row in range(int(top[1]) + 15, int(bottom[1]) - 15):
        share = (row - top[1]) / (bottom[1] - top[1])
        point = corners[1] + share * (corners[2] - corners[1])
        edge, _ = cv2.projectPoints(
            point, cv2.Rodrigues(pose[:3, :3])[0], pose[:3, 3], SMALL.matrix, SMALL.distortion
        )
        column = edge[0, 0, 0]
        first, last = int(column) - 10, int(column) + 12
        profile = picture[row, first:last]
        dark = (profile[-1] - profile) / (profile[-1] - profile[0])
        errors.append(first - 0.5 + dark.sum() - column)
    return float(np.mean(errors))


def test_edges_lie_in_place_to_a_fiftieth_of_a_pixel() -> None:
    pose = facing("front", (0, 0, 0))
    assert abs(border_of(drawn(scene(pose)), pose)) < 0.02


def test_moving_edge_lies_where_it_is_at_mid_exposure() -> None:
    pose = facing("front", (0, 0, 0))
    # 0.2 m/s for 16 ms: 11 pixels of blur.
    picture = drawn(scene(pose, (0.2, 0.0, 0.0)), 0.016)
    sharp = drawn(scene(pose))
    assert np.abs(picture - sharp).max() > 0.2
    assert abs(border_of(picture, pose)) < 0.05


def test_light_is_linear_in_albedo_and_slant() -> None:
    lamp = Light(np.array([0.0, 0.0, -1.0]), power=0.5, sky=0.0, bounce=0.1)
    pose = facing("front", (0.0, 0.6, 0.0))
    picture = drawn(replace(scene(pose), light=lamp))
    face = CubeModel.load("locomotion").face("front")
    middle = face.corners.mean(0)
    falling = 0.1 + 0.5 * np.cos(0.6)
    for share, albedo in (
        (0.92, INK_ALBEDO),
        (1.16, PAPER_ALBEDO),
    ):  # The black border and the white margin.
        points = middle + share * (face.corners - middle) @ np.diag([1, 0, 1])
        points = points @ pose[:3, :3].T + pose[:3, 3]
        for column, row in SMALL.project(points):
            seen = picture[round(row), round(column)]
            assert seen == pytest.approx(albedo * WHITE_LEVEL * falling, rel=0.03)


@pytest.mark.parametrize(("light", "least", "most"), [(1.0, 1.2, 2.6), (0.125, 6.0, 10.0)])
def test_noise_is_that_of_the_room(light: float, least: float, most: float) -> None:
    sensor = Sensor(Sensor.electrons * light)
    for level in (0.05, 0.3, 0.5):
        even = np.full((200, 200, 3), level, np.float32)
        picture = sensor.develop(even, np.random.default_rng(2))
        assert least * 0.9 < picture[..., 1].std() < most * 1.1
        assert picture[..., 1].mean() == pytest.approx(255 * srgb_encoded(np.array(level)), abs=2.5)


def test_same_seed_gives_the_same_bytes_in_any_order(fingers: Sequence) -> None:
    first = fingers.frame(4)
    fingers.frame(40)
    sequence.cache_clear()
    again = sequence("fingers", 3)
    assert np.array_equal(first, again.frame(4))
    assert np.array_equal(fingers.truth(17), again.truth(17))
    assert not np.array_equal(first, fingers.frame(5))


def covered(finger: Finger, point: np.ndarray, camera: np.ndarray) -> bool:
    """Whether the line from `camera` to `point` passes through the finger, by dense steps."""
    line = point + np.linspace(0, 0.12, 400)[:, None] * (camera - point)
    axis = finger.root + np.linspace(0, 1, 100)[:, None] * (finger.tip - finger.root)
    gaps = np.linalg.norm(line[:, None] - axis[None], axis=-1)
    return bool(gaps.min() < finger.radius)


@pytest.mark.parametrize(("name", "first"), [("fingers", 10), ("fingers-start", 0)])
def test_fingers_cover_a_corner_of_every_marker_in_view(name: str, first: int) -> None:
    for seed in (1, 2, 3):
        held = sequence(name, seed, 90)
        for index in range(first, held.count, 8):
            cube_from_camera = np.linalg.inv(held.truth(index))
            camera = cube_from_camera[:3, 3]
            on = {finger.side: finger for finger in held.fingers(index)}
            for face in CubeModel.load(held.cube).faces:
                if (camera - face.corners[0]) @ face.normal <= 0:
                    continue
                hidden = [covered(on[face.name], corner, camera) for corner in face.corners]
                assert any(hidden), (seed, index, face.name)


def test_fingers_come_within_the_first_ten_frames(fingers: Sequence) -> None:
    plain = np.linalg.norm(fingers.fingers(0)[0].tip - fingers.fingers(10)[0].tip)
    assert plain > 0.08
    assert np.array_equal(fingers.fingers(10)[0].tip, fingers.fingers(60)[0].tip)


@pytest.mark.parametrize("name", ["sweep-0.25", "sweep-1.0", "tumble"])
def test_peak_speeds_are_those_of_the_plan(name: str) -> None:
    moving = sequence(name, 2)
    found = np.array([moving.velocity(index) for index in range(moving.count)])
    speeds = np.linalg.norm(found[:, :3], axis=1), np.linalg.norm(found[:, 3:], axis=1)
    assert speeds[0].max() == pytest.approx(SEQUENCE_PLANS[name].speed, rel=0.05)
    assert speeds[1].max() == pytest.approx(SEQUENCE_PLANS[name].turning, rel=0.05)
    assert speeds[0][:9].max() < 1e-9, "the hand starts at rest"
    assert all(moving.in_view(index) for index in range(moving.count))


def test_poses_spread_over_all_depths_and_turns() -> None:
    many = sequence("poses", 1, 200)
    truths = np.array([many.truth(index) for index in range(many.count)])
    counts, _ = np.histogram(truths[:, 2, 3], bins=4, range=(0.3, 0.7))
    assert counts.min() > 30
    for axis in truths[:, 2, :3].T:  # What of the cube looks away from the camera.
        assert np.histogram(axis, bins=4, range=(-1, 1))[0].min() > 30


def test_names_are_those_of_the_issue() -> None:
    asked = {"static", "far", "twist", "sweep-0.25", "sweep-0.5", "sweep-1.0", "tumble", "frontal"}
    assert asked | {"fingers", "darkness", "shaded", "cluttered", "poses"} <= set(NAMES)
