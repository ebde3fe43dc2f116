"""The tracker is right where it speaks, and silent where it cannot be."""

from collections.abc import Iterator

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel, Face, aruco_dictionary
from tracking.errors import TrackingError
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.state import CubeState
from tracking.gestures.gestures import CubeGestures
from tracking.gestures.table import DIRECTIONS
from tracking.synthetic import open_synthetic
from tracking.tracker.tracker import CubeTracker

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

CAMERA = Intrinsics(
    np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]), np.zeros(5), (640, 480)
)
CUBE = CubeModel.load("locomotion")
FINE = 4
"""The drawings below are made this many times larger and then averaged."""


def tilted(x: float = 0.5, y: float = 0.6, z: float = 0.1, at: tuple[float, ...] = ()) -> Array:
    """A cube in front of the camera, seen at three faces."""
    turn = se3.rotation(np.array([x, 0, 0])) @ se3.rotation(np.array([0, y, 0]))
    upright = np.diag([1.0, -1.0, -1.0])
    return se3.pose(
        se3.rotation(np.array([0, 0, z])) @ turn @ upright, np.array(at or (0.0, 0.0, 0.4))
    )


def paste(canvas: Picture, face: Face, pose: Array, half: float) -> None:
    """Draw one face with its white paper, for a camera without distortion."""
    cells = np.pad(~marker_cells(CUBE.dictionary, face.marker_id), 1, constant_values=True)
    right = (face.corners[1] - face.corners[0]) / CUBE.marker_size
    down = (face.corners[3] - face.corners[0]) / CUBE.marker_size
    centre = face.corners.mean(axis=0)
    scale = len(cells) / (CUBE.marker_size * len(cells) / (len(cells) - 2))
    plane = np.stack(
        [right / scale, down / scale, centre - (right + down) * len(cells) / scale / 2]
    )
    to_pixels = CAMERA.matrix @ (plane @ pose[:3, :3].T + pose[:3, 3] * [[0], [0], [1]]).T
    # Cell edges lie at whole numbers of the plane; pixel centres of the texture lie half a pixel
    # off.
    texture = np.kron(cells, np.ones((16, 16))).astype(np.uint8) * 200 + 20
    from_texture = np.array([[1 / 16, 0, 0.5 / 16], [0, 1 / 16, 0.5 / 16], [0, 0, 1]])
    finer = np.array([[FINE, 0, (FINE - 1) / 2], [0, FINE, (FINE - 1) / 2], [0, 0, 1.0]])
    homography = finer @ to_pixels @ from_texture
    size = (canvas.shape[1], canvas.shape[0])
    drawn = cv2.warpPerspective(texture, homography, size, flags=cv2.INTER_NEAREST)
    inside = cv2.warpPerspective(np.ones_like(texture), homography, size, flags=cv2.INTER_NEAREST)
    canvas[inside > 0] = drawn[inside > 0]


def draw(*poses: Array, only: tuple[str, ...] = (), noise: float = 1.5) -> Picture:
    """Picture of one or more cubes, (480, 640, 3)."""
    canvas = np.full((480 * FINE, 640 * FINE), 110, np.uint8)
    for pose in poses:
        for face in CUBE.faces:
            centre = pose[:3, :3] @ face.corners.mean(axis=0) + pose[:3, 3]
            if (pose[:3, :3] @ face.normal) @ centre < 0 and (not only or face.name in only):
                paste(canvas, face, pose, CUBE.edge / 2)
    small = cv2.resize(canvas, (640, 480), interpolation=cv2.INTER_AREA).astype(float)
    small = cv2.GaussianBlur(small, (0, 0), 0.7)
    noisy = small + np.random.default_rng(1).normal(0, noise, small.shape)
    grey = np.clip(np.rint(noisy), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def show(picture: Picture, time: float = 0.0, tracker: CubeTracker | None = None) -> CubeState:
    tracker = tracker or CubeTracker(CUBE, CAMERA)
    return tracker.update(Frame(picture, time, 0))


def off(state: CubeState, truth: Array) -> tuple[float, float]:
    """Errors of a state [mm, °]."""
    assert state.camera_from_cube is not None
    step = se3.delta(state.camera_from_cube, truth)
    return float(1000 * np.linalg.norm(step[:3])), float(np.rad2deg(np.linalg.norm(step[3:])))


def test_a_sharp_cube_is_found_to_a_tenth_of_a_millimetre() -> None:
    source = open_synthetic("poses")
    assert source.intrinsics is not None
    errors, inside = [], []
    for index in range(0, 300, 25):
        state = CubeTracker(source.cube, source.intrinsics).update(source.frame(index))
        assert state.visible
        assert state.camera_from_cube is not None
        step = se3.delta(state.camera_from_cube, source.truth(index))
        errors.append(off(state, source.truth(index)))
        inside.append(step @ np.linalg.solve(state.covariance, step) < 12.6)
    millimetres, degrees = np.median(errors, axis=0)
    assert millimetres < 0.1
    assert degrees < 0.05
    assert max(error for error, _ in errors) < 1
    assert np.mean(inside) > 0.8


@pytest.mark.parametrize("scene", ["fingers", "companion"])
def test_the_covariance_is_honest_where_edges_run_along_rows_of_pixels(scene: str) -> None:
    source = open_synthetic(scene)
    assert source.intrinsics is not None
    tracker = CubeTracker(source.cube, source.intrinsics)
    for index in range(6):
        state = tracker.update(source.frame(index))
        assert state.camera_from_cube is not None
        step = se3.delta(state.camera_from_cube, source.truth(index))
        assert step @ np.linalg.solve(state.covariance, step) < 12.6
        # Nor is it bought with a wide one.
        assert np.sqrt(np.diag(state.covariance)[:3]).max() < 4e-4


def test_a_drawing_by_another_hand_is_found_too() -> None:
    for pose in (tilted(), tilted(0.8, -0.5, 0.4), tilted(0.4, 2.2, -0.3)):
        state = show(draw(pose))
        assert off(state, pose)[0] < 0.3
        assert off(state, pose)[1] < 0.1
        assert len(state.faces) >= 2


def test_an_empty_picture_holds_no_cube() -> None:
    state = show(draw())
    assert (state.visible, state.camera_from_cube, state.refused) == (False, None, "")


def test_a_mirrored_picture_holds_no_cube() -> None:
    assert not show(np.ascontiguousarray(draw(tilted())[:, ::-1])).visible


def test_foreign_markers_of_the_same_dictionary_are_no_cube() -> None:
    picture = np.full((480, 640, 3), 200, np.uint8)
    own = {face.marker_id for face in CUBE.faces}
    foreign = [number for number in range(50) if number not in own][:12]
    for place, number in enumerate(foreign):
        marker = cv2.aruco.generateImageMarker(aruco_dictionary(CUBE.dictionary), number, 90)
        top, left = 20 + 150 * (place // 4), 20 + 150 * (place % 4)
        picture[top : top + 90, left : left + 90] = marker[..., None]
    assert not show(picture).visible


def test_markers_that_no_cube_can_show_together_are_not_mixed() -> None:
    """Two faces of two different cubes: one cube is reported, from the markers of one."""
    here, there = tilted(at=(-0.09, 0, 0.4)), tilted(0.5, 2.0, 0.2, at=(0.09, 0, 0.4))
    state = show(draw(here, there))
    assert not state.visible or min(off(state, here)[0], off(state, there)[0]) < 1


def test_of_two_equal_cubes_the_followed_one_stays() -> None:
    here, there = tilted(at=(-0.09, 0, 0.4)), tilted(at=(0.09, 0, 0.4))
    tracker = CubeTracker(CUBE, CAMERA)
    show(draw(here), 0.0, tracker)
    assert off(show(draw(there, here), 1 / 30, tracker), here)[0] < 1


def test_a_jump_needs_a_second_frame() -> None:
    here, there = tilted(at=(-0.12, 0, 0.4)), tilted(at=(0.12, 0, 0.5))
    tracker = CubeTracker(CUBE, CAMERA)
    show(draw(here), 0.0, tracker)
    jumped = show(draw(there), 1 / 30, tracker)
    assert (jumped.visible, jumped.refused) == (False, "jump")
    again = show(draw(there), 2 / 30, tracker)
    assert off(again, there)[0] < 1
    assert np.linalg.norm(again.velocity[:3]) < 0.1


def test_one_face_seen_from_afar_is_right_or_refused() -> None:
    for lean in (0.0, 0.1, 0.3, 0.6, 0.9):
        pose = tilted(lean, 0.0, 0.2, at=(0.05, 0.02, 1.1))
        state = show(draw(pose, only=("front",)))
        assert not state.visible or off(state, pose)[1] < 10
        assert state.visible or state.verdict in ("ambiguous", "blurred", "unsure", "unproved")


def test_a_hidden_cube_is_predicted_for_a_moment_with_growing_doubt() -> None:
    tracker = CubeTracker(CUBE, CAMERA)
    pictures = [draw(tilted(at=(0.01 * number, 0, 0.4))) for number in range(3)]
    for number, picture in enumerate(pictures):
        seen = show(picture, number / 30, tracker)
    assert seen.velocity[0] == pytest.approx(0.3, rel=0.02)
    hidden = [show(draw(), (3 + number) / 30, tracker) for number in range(8)]
    assert not any(state.visible for state in hidden)
    assert hidden[0].source == "predicted"
    assert off(hidden[0], tilted(at=(0.03, 0, 0.4)))[0] < 0.5
    doubts = [np.trace(state.covariance) for state in hidden if state.camera_from_cube is not None]
    assert len(doubts) in (5, 6)
    assert all(np.diff(doubts) > 0)
    assert hidden[-1].camera_from_cube is None


def test_a_frame_of_another_size_is_refused_in_one_line() -> None:
    with pytest.raises(
        TrackingError, match="frame 0 is 320×240 but the intrinsics hold for 640×480"
    ):
        show(np.zeros((240, 320, 3), np.uint8))


def test_the_same_frames_give_the_same_states() -> None:
    pictures = [draw(tilted(at=(0.01 * number, 0, 0.4))) for number in range(4)]

    def run() -> list[str]:
        tracker = CubeTracker(CUBE, CAMERA)
        return [repr(show(picture, n / 30, tracker)) for n, picture in enumerate(pictures)]

    assert run() == run()


def true_states(scene: str) -> Iterator[tuple[CubeState, str]]:
    """States with a tracker's noise, and the face that is truly up, for every frame of a scene."""
    source = open_synthetic(scene)
    spread = np.array([2e-5, 2e-5, 4e-5, 2e-4, 2e-4, 2e-4])
    generator = np.random.default_rng(0)
    for index in range(source.count):
        pose = se3.moved(source.truth(index), generator.normal(0, spread))
        up = source.state(index).table_from_cube[1, :3]
        covariance = np.diag(spread**2)
        yield (
            CubeState(True, pose, np.zeros(6), covariance, "markers", (), 0.1, source.time(index)),
            max(DIRECTIONS, key=lambda name: float(up @ DIRECTIONS[name])),
        )


@pytest.mark.parametrize("scene", ["tip", "companion"])
def test_the_top_face_is_right_in_every_resting_frame(scene: str) -> None:
    gestures = CubeGestures(open_synthetic(scene).cube)
    tops = []
    for state, truth in true_states(scene):
        controls = gestures.update(state)
        if controls.resting:
            tops.append((controls.top_face, truth))
    assert len(tops) > 100
    assert all(found == truth for found, truth in tops)


def test_the_first_frames_of_a_scene_give_the_right_top_face() -> None:
    source = open_synthetic("static")
    assert source.intrinsics is not None
    tracker, gestures = CubeTracker(source.cube, source.intrinsics), CubeGestures(source.cube)
    for index in range(18):
        controls = gestures.update(tracker.update(source.frame(index)))
    assert controls.resting
    assert controls.top_face == "top"
    assert controls.camera_from_table is not None
    table = se3.inverse(source.camera_from_table) @ controls.camera_from_table
    assert abs(table[1, 3]) < 1e-3
    assert table[1, 1] > np.cos(np.deg2rad(0.5))
