"""The light that a cube's paper tells."""

import functools
from collections.abc import Callable
from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.tracking.appearance.appearance import MeasuredLight
from cubeling.tracking.appearance.light import LightMeter
from cubeling.tracking.appearance.light_fit import fit_light, fit_patches
from cubeling.tracking.appearance.patches import PAPER_ALBEDO, PaperSampler, white_points
from cubeling.tracking.cube.faces import FacePlanes, face_frame
from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import FACE_AXES, CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.paper_cube import PaperCube
from tests.tracking.drawn import WIDE, held

CUBE = CubeModel.load("locomotion")
PLANES = FacePlanes(CUBE)
TO_LIGHT = np.array([-0.5, -0.7, -0.6]) / np.linalg.norm([-0.5, -0.7, -0.6])
KEY, AMBIENT = np.array([0.5, 0.45, 0.35]), np.array([0.3, 0.32, 0.4])
UP = np.array([0.0, -1.0, 0.0])
NO_PRIOR = np.array([0.0, -1e-3, 0.0])

Shade = Callable[[Array], Array]


def lit(normals: Array) -> Array:
    """Irradiance of surfaces, (N, 3)."""
    return np.asarray(AMBIENT + np.maximum(normals @ TO_LIGHT, 0)[:, None] * KEY)


def lit_one(normal: Array) -> Array:
    return np.asarray(lit(normal[None])[0])


def picture(pose: Array, shade: Shade = lit_one, gain: float = 1.0) -> Image:
    """Draw the faces as bare paper, (H, W, 3) BGR: ink is where no sample is taken."""
    seen = _desk(gain).copy()
    for number in PLANES.faces_towards(pose, 0.0):
        face = CUBE.faces[number]
        right, up = (np.array(axis, float) for axis in FACE_AXES[face.name])
        outline = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)]) * CUBE.edge / 2
        corners = outline[:, :1] * right + outline[:, 1:] * up + face.normal * CUBE.edge / 2
        value = PAPER_ALBEDO * shade(pose[:3, :3] @ face.normal)
        cv2.fillConvexPoly(seen, _pixels(corners, pose), _encoded(value[::-1] * gain).tolist())
    return seen


@functools.cache
def _desk(gain: float) -> Image:
    """Draw the picture without a cube: filling one takes longer than copying it and all else."""
    grey = int(_encoded(np.array([0.2 * gain]))[0])
    return np.full((WIDE.size[1], WIDE.size[0], 3), grey, np.uint8)


def _encoded(light: Array) -> Image:
    """Encode the few colours of a picture, not each pixel."""
    encoded = 1.055 * np.clip(light, 0.0031308, 1) ** (1 / 2.4) - 0.055
    return np.asarray(np.rint(255 * encoded), np.uint8)


def _pixels(points: Array, pose: Array) -> np.ndarray:
    seen = (points @ pose[:3, :3].T + pose[:3, 3]) @ WIDE.matrix.T
    return np.rint(seen[:, :2] / seen[:, 2:]).astype(np.int32)


def state(pose: Array, seconds: float, velocity: Array | None = None) -> CubeState:
    still = np.zeros(6) if velocity is None else velocity
    return CubeState(True, pose, still, np.zeros((6, 6)), "markers", (), 0.0, seconds)


def turned(seconds: float) -> Array:
    """Pose of a cube that is turned by hand, (4, 4)."""
    return held(0.5 + 0.4 * np.sin(seconds), 1.5 * seconds, 0.2 * np.sin(1.7 * seconds))


def shown(
    rate: float, seconds: float, pose: Callable[[float], Array] = turned, shade: Shade = lit_one
) -> MeasuredLight:
    """Return the light after some time of pictures at a rate."""
    meter, light = LightMeter(CUBE, WIDE), None
    for index in range(round(rate * seconds)):
        at = pose(index / rate)
        light = meter.update(picture(at, shade), state(at, index / rate))
    assert light is not None
    return light


def degrees(light: MeasuredLight, truth: Array = TO_LIGHT) -> float:
    return float(np.rad2deg(np.arccos(np.clip(light.to_light @ truth, -1, 1))))


def directions(count: int, seed: int = 1) -> Array:
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    normals[:, 2] = -np.abs(normals[:, 2])
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


@pytest.mark.parametrize("seed", range(5))
def test_patches_of_a_known_light_give_it_back(seed):
    normals = directions(12, seed)
    light, darker = fit_light(normals, lit(normals), np.ones(12), NO_PRIOR, np.ones((1, 12)))
    assert degrees(light) < 3
    np.testing.assert_allclose(light.ambient, AMBIENT, atol=0.02)
    np.testing.assert_allclose(light.key, KEY, atol=0.03)
    assert light.certainty > 0.9
    assert np.abs(darker).max() < 0.06


def test_light_from_all_around_has_no_key():
    normals = directions(20)
    light, _ = fit_light(
        normals, np.tile(AMBIENT, (20, 1)), np.ones(20), NO_PRIOR, np.ones((1, 20))
    )
    assert light.key.max() < 0.05 * AMBIENT.max()


@pytest.mark.parametrize("ground", [0.4, 1.0])
def test_less_light_from_below_does_not_turn_the_light(ground):
    normals = np.concatenate([directions(40), -directions(40, 2)])
    around = (1 + ground) / 2 + (1 - ground) / 2 * normals @ UP
    key = np.maximum(normals @ TO_LIGHT, 0)[:, None] * KEY
    light = fit_patches(normals, around[:, None] * AMBIENT + key, np.ones(80), UP)
    assert degrees(light) < 5


def test_little_light_from_the_lamp_leaves_its_direction_uncertain():
    normals = directions(60)
    key = np.maximum(normals @ TO_LIGHT, 0)[:, None] * KEY
    strong, weak = (
        fit_patches(normals, AMBIENT + share * key, np.ones(60), UP) for share in (1.0, 0.15)
    )
    assert strong.certainty > 0.8
    assert weak.certainty < 0.6


def test_a_turned_cube_tells_the_light():
    light = shown(20, 4.0)
    assert degrees(light) < 5
    share = light.ambient.sum() / (light.ambient + light.key).sum()
    assert share == pytest.approx(AMBIENT.sum() / (AMBIENT + KEY).sum(), rel=0.08)
    assert light.certainty > 0.8


def test_one_face_alone_gives_low_certainty():
    facing = np.diag([1.0, -1.0, -1.0])
    light = shown(20, 1.0, lambda t: se3.pose(facing, np.array([0, 0, 0.4])))
    assert light.certainty < 0.4


def test_a_saturated_face_is_left_out():
    pose = held()
    sampler = PaperSampler(CUBE, WIDE)
    whole = sampler.measure(picture(pose), pose)
    brightest = int(whole.irradiance.sum(axis=1).argmax())

    def burnt(normal: Array) -> Array:
        same = normal @ whole.normals[brightest] > 0.99
        return np.full(3, 2.0) if same else lit_one(normal)

    rest = sampler.measure(picture(pose, burnt), pose)
    assert len(rest.normals) == len(whole.normals) - 1
    assert (rest.normals @ whole.normals[brightest]).max() < 0.99


def test_patches_are_as_bright_as_the_light_on_them():
    pose = held()
    patches = PaperSampler(CUBE, WIDE).measure(picture(pose), pose)
    assert len(patches.normals) == 3
    np.testing.assert_allclose(patches.irradiance, lit(patches.normals), rtol=0.02)


def test_a_finger_over_a_part_of_a_face_does_not_change_its_patch():
    pose = held()
    image = picture(pose)
    sampler = PaperSampler(CUBE, WIDE)
    bare = sampler.measure(image, pose)
    x, y = _pixels(np.zeros((1, 3)), pose)[0]
    cv2.line(image, (int(x), int(y)), (int(x) + 300, int(y) + 30), (70, 100, 160), 34)
    covered = sampler.measure(image, pose)
    assert len(covered.normals) == len(bare.normals)
    np.testing.assert_allclose(covered.irradiance, bare.irradiance, rtol=0.02)


def test_a_face_in_shadow_does_not_turn_the_light():
    pose = held()
    shaded = int((PLANES.normals @ pose[:3, :3].T @ TO_LIGHT).argmax())
    dark_until = 0.4

    def shadow(seconds: float) -> Shade:
        def shade(normal: Array) -> Array:
            face = turned(seconds)[:3, :3] @ PLANES.normals[shaded]
            dark = seconds > 4 - dark_until and normal @ face > 0.99
            return lit_one(normal) * (0.5 if dark else 1.0)

        return shade

    meter, light = LightMeter(CUBE, WIDE), None
    for index in range(80):
        pose = turned(index / 20)
        light = meter.update(picture(pose, shadow(index / 20)), state(pose, index / 20))
    assert light is not None
    assert degrees(light) < 6


def test_the_light_is_still_on_a_still_picture():
    meter, pose = LightMeter(CUBE, WIDE), held()
    image = picture(pose)
    lights = [meter.update(image, state(pose, n / 30)) for n in range(300)]
    last, before = lights[-1], lights[150]
    assert last is not None
    assert before is not None
    assert degrees(last, before.to_light) < 0.5
    np.testing.assert_allclose(last.key, before.key, rtol=0.02)


def test_the_light_does_not_depend_on_the_frame_rate():
    slow, fast = shown(15, 3.0), shown(45, 3.0)
    assert degrees(slow, fast.to_light) < 3
    np.testing.assert_allclose(slow.key, fast.key, atol=0.03)
    assert slow.certainty == pytest.approx(fast.certainty, abs=0.05)


def test_automatic_exposure_scales_the_light_and_does_not_turn_it():
    meter, lights = LightMeter(CUBE, WIDE), []
    for index in range(120):
        pose, gain = turned(index / 30), 1.0 if index < 90 else 0.7
        lights.append(meter.update(picture(pose, gain=gain), state(pose, index / 30)))
    before, after = lights[89], lights[119]
    assert before is not None
    assert after is not None
    assert degrees(after, before.to_light) < 3
    np.testing.assert_allclose(after.key, 0.7 * before.key, rtol=0.06)


def test_a_recording_that_is_wound_back_is_measured_on():
    meter, lights = LightMeter(CUBE, WIDE), []
    for index in range(120):
        pose, late = turned(index / 30), index < 90
        shown_at = (300 if late else -90) + index
        image = picture(pose, gain=1.0 if late else 0.7)
        lights.append(meter.update(image, state(pose, shown_at / 30)))
    before, after = lights[89], lights[119]
    assert before is not None
    assert after is not None
    np.testing.assert_allclose(after.key, 0.7 * before.key, rtol=0.06)


def test_a_lamp_that_moves_is_followed():
    other = TO_LIGHT * (-1, 1, 1)

    def elsewhere(normal: Array) -> Array:
        return np.asarray(AMBIENT + max(0.0, float(normal @ other)) * KEY)

    meter, light = LightMeter(CUBE, WIDE), None
    for index in range(200):
        pose = turned(index / 20)
        image = picture(pose, lit_one if index < 60 else elsewhere)
        light = meter.update(image, state(pose, index / 20))
    assert light is not None
    assert degrees(light, other) < 10


@pytest.mark.parametrize(
    "change",
    [
        {"visible": False},
        {"visible": False, "camera_from_cube": None},
        {"source": "predicted"},
        {"velocity": np.array([2.0, 0, 0, 0, 0, 0])},
    ],
    ids=["hidden", "lost", "predicted", "fast"],
)
def test_nothing_is_said_before_paper_is_measured(change):
    meter, image = LightMeter(CUBE, WIDE), picture(held())
    for index in range(30):
        light = meter.update(image, replace(state(held(), index / 30), **change))
        assert light is None


@pytest.fixture(scope="module")
def printed() -> PaperCube:
    """The cube with markers, icons and folds, seen by `WIDE` in light of the same everywhere."""
    return PaperCube(CUBE, CameraRays(WIDE), seed=1)


@pytest.mark.parametrize("face", CUBE.faces, ids=lambda face: face.name)
def test_white_points_are_apart_from_ink_and_folds(printed, face):
    from_face = face_frame(face)
    pose = se3.pose(np.eye(3), np.array([0, 0, 0.15])) @ se3.inverse(from_face)
    region = printed.region(pose)
    drawn, _ = printed.draw(region, [pose], np.array([0.0, 0.0, -1.0]), samples=2)
    points, clearance = white_points(CUBE, face)
    assert points.shape == (32, 3)
    assert clearance > 0.25 * cell_size(CUBE)
    reach = int(0.9 * clearance * WIDE.matrix[0, 0] / 0.15)
    around = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    darkest = cv2.erode(drawn.min(axis=2), around)
    x, y = (_pixels(points, pose) - (region.x, region.y)).T
    assert darkest[y, x].min() > 190  # a rim along the folds is darker than the rest: 203
