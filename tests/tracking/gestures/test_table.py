"""The table is learned from rests, kept steady, and given up when the cube proves another."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.cube.sides import SideDirections, box_sides
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.state import CubeControls, CubeState
from cubeling.tracking.gestures.gestures import CubeGestures
from cubeling.tracking.gestures.table import rest_of

Array = NDArray[np.float64]

RATE = 30.0
EDGE = 0.06
NOISE = np.array([5e-5, 5e-5, 1e-4, 3e-4, 3e-4, 3e-4])


def camera(pitch_deg: float, distance: float = 0.5, roll_deg: float = 0.0) -> Array:
    pitch = np.deg2rad(pitch_deg)
    up = np.array([0, -np.cos(pitch), -np.sin(pitch)])
    z = np.array([0, np.sin(pitch), -np.cos(pitch)])
    pose = se3.pose(np.stack([np.cross(up, z), up, z], axis=1), np.array([0, 0, distance]))
    roll = se3.rotation(np.array([0, 0, np.deg2rad(roll_deg)]))
    return se3.pose(roll, np.zeros(3)) @ pose


def at(x: float = 0.0, y: float = 0.0, z: float = 0.0, turn_deg: float = 0.0) -> Array:
    turn = se3.rotation(np.array([0, np.deg2rad(turn_deg), 0]))
    return se3.pose(turn, np.array([x, y + EDGE / 2, z]))


class Desk:
    """Shows a cube on a desk, or above it, to the gestures."""

    def __init__(self, camera_from_table: Array, seed: int = 0) -> None:
        self.camera = camera_from_table
        self.gestures = CubeGestures(CubeModel.load("companion"))
        self.generator = np.random.default_rng(seed)
        self.time = 0.0
        self.focal_scale, self.focal_shift = 1.0, np.zeros(6)

    def rest(
        self, table_from_cube: Array, seconds: float, tremor: float = 0.0
    ) -> list[CubeControls]:
        """Rest with noise like the tracker's, and with a hand's tremor of 9 Hz [m]."""
        seen = []
        for _ in range(round(seconds * RATE)):
            shake = np.zeros(6)
            phase = 2 * np.pi * 9 * self.time
            shake[:3] = tremor * np.sin([phase, phase + 1, phase + 2])
            noise = self.generator.normal(0, 1, 6) * NOISE
            pose = se3.apply_delta(self.camera @ table_from_cube, noise + shake)
            state = CubeState(
                visible=True,
                camera_from_cube=pose,
                velocity=np.zeros(6),
                covariance=np.diag(NOISE**2) + np.outer(self.focal_shift, self.focal_shift),
                source="markers",
                faces=("top",),
                reprojection_error=0.1,
                timestamp=self.time,
                focal_scale=self.focal_scale,
                focal_shift=self.focal_shift,
            )
            seen.append(self.gestures.update(state))
            self.time += 1 / RATE
        return seen

    def error(self, controls: CubeControls) -> tuple[float, float]:
        """Height [m] and tilt [rad] of the learned table against the true one at its origin."""
        assert controls.camera_from_table is not None
        difference = se3.inverse(self.camera) @ controls.camera_from_table
        tilt = float(np.arccos(np.clip(difference[1, 1], -1, 1)))
        return abs(float(difference[1, 3])), tilt


@pytest.mark.parametrize("pitch", [0, 20, 45, 70, 80])
@pytest.mark.parametrize("turn", [0, 45, 100])
def test_up_is_found_for_any_desk_camera(pitch: float, turn: float) -> None:
    desk = Desk(camera(pitch))
    if pitch < 20:
        # A camera that looks straight ahead stands higher than the table.
        desk.camera = desk.camera @ at(y=-0.15 - EDGE / 2)
    controls = desk.rest(at(turn_deg=turn), 0.5)[-1]
    height, tilt = desk.error(controls)
    assert controls.top_face == "top"
    assert height < 3e-4
    assert tilt < np.deg2rad(0.15)


@pytest.mark.parametrize("roll", [-25, 25])
def test_a_crooked_camera_still_finds_up(roll: float) -> None:
    desk = Desk(camera(35, roll_deg=roll))
    assert desk.rest(at(turn_deg=30), 0.5)[-1].top_face == "top"


def test_the_table_does_not_jitter_under_a_resting_cube() -> None:
    desk = Desk(camera(35))
    tables = [controls.camera_from_table for controls in desk.rest(at(), 6.0)]
    settled = np.stack([table for table in tables[40:] if table is not None])
    assert len(settled) == len(tables) - 40
    assert np.ptp(settled, axis=0).max() == 0


def test_more_places_make_the_table_better() -> None:
    leaning = se3.pose(se3.rotation(np.array([np.deg2rad(2), 0, 0])), np.zeros(3))
    desk = Desk(camera(35))
    first = desk.rest(at() @ leaning, 1.0)[-1]
    for x, z in ((0.15, 0), (-0.15, 0.1), (0, -0.15), (0.1, 0.15), (0, 0.2)):
        last = desk.rest(at(x, 0, z) @ leaning, 1.0)[-1]
    assert desk.error(first)[1] > np.deg2rad(1.8)
    assert desk.error(last)[1] < np.deg2rad(0.6)


def test_a_trembling_rest_counts_only_until_a_firm_one() -> None:
    desk = Desk(camera(35))
    assert desk.rest(at(y=0.1), 0.9, tremor=8e-4)[-1].top_face is None
    in_air = desk.rest(at(y=0.1), 0.5, tremor=8e-4)[-1]
    assert desk.error(in_air)[0] == pytest.approx(0.1, abs=0.005)
    on_table = desk.rest(at(), 1.0)[-1]
    assert desk.error(on_table)[0] < 5e-4
    assert on_table.resting


def test_a_steady_hand_in_the_air_is_forgotten() -> None:
    desk = Desk(camera(35))
    assert desk.error(desk.rest(at(y=0.1), 1.0)[-1])[0] == pytest.approx(0.1, abs=1e-3)
    assert desk.error(desk.rest(at(), 2.5)[-1])[0] < 5e-4


def test_holding_the_cube_up_does_not_move_the_table() -> None:
    desk = Desk(camera(35))
    desk.rest(at(), 1.0)
    held = desk.rest(at(y=0.08), 3.0, tremor=8e-4)[-1]
    assert held.lifted
    assert desk.error(held)[0] < 5e-4
    assert desk.rest(at(x=0.05), 1.0)[-1].resting


def test_short_rests_that_agree_replace_the_table() -> None:
    desk = Desk(camera(35))
    desk.rest(at(y=0.1), 1.0)
    for number in range(6):
        last = desk.rest(at(x=0.05 * number), 0.8)[-1]
    assert desk.error(last)[0] < 5e-4


@pytest.mark.parametrize(
    "moved", [lambda: camera(50), lambda: camera(35, 0.6)], ids=["tilted", "pulled back"]
)
def test_a_moved_camera_is_noticed(moved: Callable[[], Array]) -> None:
    desk = Desk(camera(35))
    desk.rest(at(), 2.0)
    desk.camera = moved()
    last = desk.rest(at(), 2.5)[-1]
    height, tilt = desk.error(last)
    assert height < 5e-4
    assert tilt < np.deg2rad(0.2)
    assert last.resting


def test_a_side_that_faces_away_is_never_up() -> None:
    away = se3.pose(np.diag([1.0, -1.0, -1.0]), np.array([0, 0, 0.5]))
    rest = rest_of(away, SideDirections(box_sides(EDGE, EDGE, EDGE)))
    assert rest is None or rest.up[2] < 0.2


def test_the_table_stays_under_the_cube_through_a_longer_lens() -> None:
    """The cube looks alike, and is farther away: it was not lifted, and is not placed again."""
    desk = Desk(camera(35))
    before = desk.rest(at(turn_deg=30), 1.0)[-1]
    longer = 1.6
    desk.camera = desk.camera.copy()
    desk.camera[2, 3] += (longer - 1) * (desk.camera @ at())[2, 3]
    desk.focal_scale = longer
    seen = desk.rest(at(turn_deg=30), 1.0)
    assert {(each.lifted, each.placements, each.top_face) for each in seen} == {(False, 1, "top")}
    assert all(each.turns == pytest.approx(before.turns, abs=0.01) for each in seen)
    height, tilt = desk.error(seen[0])
    assert height < 0.002
    assert tilt < np.deg2rad(1.5)
    height, tilt = desk.error(seen[-1])
    assert height < 5e-4
    assert tilt < np.deg2rad(0.3)


def test_doubt_of_the_lens_hides_no_tremor() -> None:
    """A wrong focal length shifts all poses alike, so a hand in the air is still no table."""
    desk = Desk(camera(35))
    desk.focal_shift = np.array([0, 0, 0.15, 0.02, 0, 0])
    assert desk.rest(at(), 0.8, tremor=0.0008)[-1].camera_from_table is None
    assert desk.rest(at(x=0.1), 0.8)[-1].camera_from_table is not None
