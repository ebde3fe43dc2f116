"""Gestures from exact poses, so that what the hand does is known exactly."""

from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.state import CubeControls, CubeState
from cubeling.tracking.gestures.detectors import DETECTORS
from cubeling.tracking.gestures.gestures import CubeGestures
from tests.examples import some

Array = NDArray[np.float64]

RATE = 30.0
EDGE = 0.06
UP = np.array([0.0, 1.0, 0.0])
COVARIANCE = np.diag([5e-5, 5e-5, 1e-4, 3e-4, 3e-4, 3e-4]) ** 2

TOPS = {
    "top": np.zeros(3),
    "front": np.array([-np.pi / 2, 0, 0]),
    "back": np.array([np.pi / 2, 0, 0]),
    "right": np.array([0, 0, np.pi / 2]),
    "left": np.array([0, 0, -np.pi / 2]),
    "bottom": np.array([0, 0, np.pi]),
}
"""How the cube is turned so that each face looks up."""


def camera_from_table(pitch_deg: float = 35.0, distance: float = 0.5) -> Array:
    """Camera above the table, +z of the table towards it."""
    pitch = np.deg2rad(pitch_deg)
    up = np.array([0, -np.cos(pitch), -np.sin(pitch)])
    z = np.array([0, np.sin(pitch), -np.cos(pitch)])
    return se3.pose(np.stack([np.cross(up, z), up, z], axis=1), np.array([0, 0, distance]))


def standing(top: str = "top", turn_deg: float = 0.0, x: float = 0.0, z: float = 0.0) -> Array:
    """Pose of a cube that stands on the table, turned clockwise seen from above."""
    turn = se3.rotation(-np.deg2rad(turn_deg) * UP) @ se3.rotation(TOPS[top])
    return se3.pose(turn, np.array([x, EDGE / 2, z]))


class Hand:
    """Gives poses of a cube to the gestures, frame after frame."""

    def __init__(self, pitch_deg: float = 35.0, noise: float = 0.0, seed: int = 0) -> None:
        self.gestures = CubeGestures(CubeModel.load("companion"))
        self.camera = camera_from_table(pitch_deg)
        self.noise = noise
        self.generator = np.random.default_rng(seed)
        self.time = 0.0
        self.all: list[CubeControls] = []

    def show(self, table_from_cube: Array | None) -> CubeControls:
        """One frame; None hides the cube."""
        pose = None
        if table_from_cube is not None:
            jitter = self.generator.normal(0, 1, 6) * ([5e-5] * 3 + [3e-4] * 3) * self.noise
            pose = se3.apply_delta(self.camera @ table_from_cube, jitter)
        state = CubeState(
            pose is not None, pose, np.zeros(6), COVARIANCE, "markers", ("top",), 0.1, self.time
        )
        controls = self.gestures.update(state)
        self.time += 1 / RATE
        self.all.append(controls)
        return controls

    def hold(self, table_from_cube: Array | None, seconds: float = 1.0) -> CubeControls:
        for _ in range(round(seconds * RATE)):
            controls = self.show(table_from_cube)
        return controls

    def play(self, poses: Iterable[Array | None]) -> CubeControls:
        for pose in poses:
            controls = self.show(pose)
        return controls

    def events(self, name: str) -> int:
        return sum(getattr(controls, name) for controls in self.all)


def turning(start_deg: float, end_deg: float, seconds: float, top: str = "top") -> Iterator[Array]:
    for degrees in np.linspace(start_deg, end_deg, round(seconds * RATE)):
        yield standing(top, degrees)


def between(start: Array, end: Array, seconds: float, lift: float = 0.0) -> Iterator[Array]:
    """From pose to pose, with an arc above the table."""
    step = se3.delta(start, end)
    for share in np.linspace(0, 1, round(seconds * RATE)):
        yield se3.apply_delta(start, step * share + np.eye(6)[1] * lift * np.sin(np.pi * share))


@pytest.fixture
def hand() -> Hand:
    return Hand()


def test_the_first_rest_gives_the_table_and_is_placed_once(hand: Hand) -> None:
    controls = hand.hold(standing(), 1.0)
    assert controls.resting
    assert not controls.lifted
    assert controls.top_face == "top"
    assert controls.placements == hand.events("placed") == 1
    assert controls.camera_from_table is not None
    assert np.allclose(controls.camera_from_table, hand.camera, atol=1e-6)
    assert controls.position == pytest.approx([0, 0], abs=1e-6)


@pytest.mark.parametrize("pitch", some([35, 10, 60, 78]))
@pytest.mark.parametrize("top", TOPS)
def test_every_face_is_up_when_it_is_up(top: str, pitch: float) -> None:
    hand = Hand(pitch, noise=1.0)
    assert hand.hold(standing(top, 25), 1.0).top_face == top


@pytest.mark.parametrize("top", TOPS)
def test_heading_is_zero_towards_the_camera_and_grows_clockwise(top: str) -> None:
    hand = Hand()
    assert hand.hold(standing(top), 1).heading == pytest.approx(0, abs=1e-6)
    controls = hand.play(turning(0, 120, 2, top))
    assert controls.heading == pytest.approx(np.deg2rad(120))
    assert controls.camera_angle == pytest.approx(np.deg2rad(120))
    controls = hand.play(turning(120, 270, 2, top))
    assert controls.heading == pytest.approx(np.deg2rad(-90))
    assert controls.camera_angle == pytest.approx(np.deg2rad(90))


@pytest.mark.parametrize("pitch", [5, 35, 89])
def test_a_cube_that_is_slid_keeps_its_heading(pitch: float) -> None:
    hand = Hand(pitch)
    hand.hold(standing("top", 90), 1)
    for x, z in ((0.3, 0.1), (-0.3, -0.2)):
        assert hand.show(standing("top", 90, x, z)).camera_angle == pytest.approx(np.pi / 2)


@pytest.mark.parametrize("turns", some([2, -3.5, -2, 0.25], 2))
@pytest.mark.parametrize("top", some(["top", "front", "left"]))
def test_turns_are_counted_past_whole_ones_either_way(top: str, turns: float) -> None:
    hand = Hand(noise=1.0)
    assert hand.hold(standing(top, 30), 1).turns == pytest.approx(0, abs=1e-3)
    controls = hand.play(turning(30, 30 + 360 * turns, 4, top))
    assert controls.turns == pytest.approx(turns, abs=1e-3)
    assert hand.events("placed") == 1
    assert not hand.events("lifted")


def test_turning_on_the_spot_is_resting(hand: Hand) -> None:
    hand.hold(standing(), 1)
    hand.play(turning(0, 720, 3))
    assert all(controls.resting for controls in hand.all[20:])


def test_turns_survive_a_short_hiding(hand: Hand) -> None:
    hand.hold(standing(), 1)
    poses: list[Array | None] = list(turning(0, 720, 4))
    for start in (20, 70):
        poses[start : start + 8] = [None] * 8
    assert hand.play(poses).turns == pytest.approx(2)


def test_a_lift_resets_the_turns(hand: Hand) -> None:
    hand.hold(standing(), 1)
    hand.play(turning(0, 400, 3))
    hand.play(between(standing(turn_deg=40), standing(x=0.1), 1, lift=0.08))
    controls = hand.hold(standing(x=0.1), 0.5)
    assert hand.events("lifted") > 15
    assert controls.placements == hand.events("placed") == 2
    assert controls.turns == pytest.approx(0, abs=1e-9)
    assert controls.position == pytest.approx([0.1, 0], abs=1e-4)


def test_tipping_goes_through_all_faces(hand: Hand) -> None:
    hand.hold(standing("top"), 1)
    before = "top"
    for number, top in enumerate(["front", "bottom", "back", "top", "right", "bottom", "left"], 2):
        hand.play(between(standing(before), standing(top), 0.7, lift=0.02))
        controls = hand.hold(standing(top), 0.5)
        assert (controls.top_face, controls.placements, controls.turns) == (top, number, 0.0)
        assert controls.resting
        before = top
    seen = [controls.top_face for controls in hand.all if controls.top_face]
    assert sum(a != b for a, b in pairwise(seen)) == 7


def test_rocking_on_an_edge_does_not_flicker(hand: Hand) -> None:
    hand.hold(standing(), 1)
    for lean in 45 + 12 * np.sin(np.linspace(0, 40, 120)):
        tipped = se3.pose(
            se3.rotation(np.array([-np.deg2rad(lean), 0, 0])), np.array([0, 0.042, 0])
        )
        assert hand.show(tipped).top_face == "top"
    assert hand.all[-1].lifted


def test_a_tip_that_was_hidden_is_placed(hand: Hand) -> None:
    hand.hold(standing("top"), 1)
    hand.hold(None, 0.7)
    controls = hand.hold(standing("left"), 0.5)
    assert (controls.top_face, controls.placements) == ("left", 2)


def test_a_brief_wrong_tilt_changes_nothing(hand: Hand) -> None:
    hand.hold(standing(), 1)
    hand.play(turning(0, 180, 1))
    wrong = se3.apply_delta(standing(turn_deg=180), np.array([0, 0.004, 0, np.deg2rad(50), 0, 0]))
    hand.play([wrong, wrong])
    hand.play(turning(180, 360, 1))
    controls = hand.hold(standing(turn_deg=360), 0.5)
    assert controls.turns == pytest.approx(1)
    assert controls.placements == 1
    assert not hand.events("lifted")


def test_sliding_is_neither_resting_nor_lifted(hand: Hand) -> None:
    hand.hold(standing(), 1)
    first = len(hand.all)
    hand.play(between(standing(), standing(x=0.2, turn_deg=20), 1))
    middle = hand.all[first + 8 : -2]
    assert not any(controls.resting or controls.lifted for controls in middle)
    controls = hand.hold(standing(x=0.2, turn_deg=20), 0.5)
    assert controls.resting
    assert controls.placements == 1
    assert controls.turns == pytest.approx(20 / 360, abs=1e-6)


def test_a_hidden_cube_keeps_its_last_values(hand: Hand) -> None:
    hand.hold(standing(), 1)
    last = hand.play(turning(0, 90, 1))
    hidden = hand.hold(None, 1)
    assert not hidden.visible
    assert (hidden.turns, hidden.top_face, hidden.resting, hidden.heading) == (
        last.turns,
        last.top_face,
        last.resting,
        last.heading,
    )
    assert not hidden.placed
    assert not hidden.shaken


def shaking(frequency: float, amplitude: float, seconds: float, axis: int) -> Iterator[Array]:
    for t in np.arange(0, seconds, 1 / RATE):
        offset = np.zeros(6)
        offset[axis] = amplitude * np.sin(2 * np.pi * frequency * t)
        yield se3.apply_delta(standing(), offset + np.eye(6)[1] * 0.1)


@pytest.mark.parametrize(
    ("axis", "amplitude"), [(0, 0.04), (1, 0.04), (2, 0.04), (4, 0.6), (5, 0.6)]
)
def test_a_shake_is_recognised_once_a_second(hand: Hand, axis: int, amplitude: float) -> None:
    hand.hold(standing(), 1)
    hand.play(shaking(4, amplitude, 0.95, axis))
    assert hand.events("shaken") == 1


class RaiseDetector:
    """Recognises a cube that begins to rise in the picture: as CONTRIBUTING.md has it."""

    def __init__(self) -> None:
        self._rising = False

    def update(self, timestamp: float, pose: Array, velocity: Array) -> bool:
        before, self._rising = self._rising, bool(velocity[1] < -0.3)  # y points down
        return self._rising and not before


def test_a_registered_gesture_is_reported_once_beside_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(DETECTORS, "raised", RaiseDetector)
    hand = Hand()
    hand.hold(standing(), 1)
    hand.play(between(standing(), se3.apply_delta(standing(), 0.3 * np.eye(6)[1]), 0.5))
    hand.hold(None, 0.1)
    made = [name for controls in hand.all for name in controls.gestures]
    assert made == ["raised"]


def carrying() -> Iterator[Array]:
    places = [standing(), standing(x=0.2, z=-0.1), standing(x=-0.2), standing(turn_deg=90)]
    for start, end in pairwise(places):
        yield from between(start, end, 0.7, lift=0.1)


@pytest.mark.parametrize(
    "motion",
    [carrying, lambda: shaking(1.2, 0.1, 3, 0), lambda: shaking(5, 0.004, 3, 0)],
    ids=["carry", "wave", "tremble"],
)
def test_other_motion_is_no_shake(hand: Hand, motion: Callable[[], Iterator[Array]]) -> None:
    hand.hold(standing(), 1)
    hand.play(motion())
    assert not hand.events("shaken")


def test_the_same_states_give_the_same_controls() -> None:
    def run() -> list[str]:
        hand = Hand(noise=2.0, seed=3)
        hand.hold(standing(), 1)
        hand.play(carrying())
        hand.hold(standing(turn_deg=90), 1)
        return [repr(controls) for controls in hand.all]

    assert run() == run()
