"""From the pose of the cube to what the hand does with it."""

import math
from collections import deque
from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.cube.sides import SideDirections
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.state import CubeControls, CubeState
from cubeling.tracking.gestures.detectors import DETECTORS
from cubeling.tracking.gestures.stillness import StillnessDetector
from cubeling.tracking.gestures.table import TableEstimator, TablePlane

MAX_REST_TILT = np.deg2rad(10.0)
"""A face that is tilted less than this lies on the table [rad] (M11)."""

MAX_TOP_TILT = np.deg2rad(30.0)
"""Another face becomes the top face once it is tilted less than this [rad]: 45° would flicker."""

MIN_LIFT_M = 0.010
"""Height above the table from which the cube is lifted, plus the uncertainty of the table."""

TOWARDS_CAMERA = np.array([0.0, 1.0, -1.0])
"""Down in the image plus against the viewing direction [camera frame].

Projected on the table, both point to the camera; the sum works for every tilt. The thesis measures
from the viewing direction, not from the line to the camera (M10): a cube that is slid keeps its
heading.
"""

MIN_LIFT_S = 0.1
"""A cube that seems lifted or tipped for less than this is an error of the tracker."""

MAX_SPEED_TO_START_RESTING, MAX_SPEED_TO_KEEP_RESTING = 0.02, 0.04
"""Below the first speed the cube comes to rest, above the second it no longer rests [m/s]."""

TRAVEL_WINDOW_S = 0.2
"""Time over which this speed is measured (M11)."""

MIN_FORWARD_COSINE = 0.8
"""A body whose front looks up more than this has another forward direction."""

MAX_GAP_S = 0.2
"""Poses further apart than this give no velocity."""


@dataclass(frozen=True)
class _TablePose:
    """Pose of the cube relative to the table."""

    top: str
    tilt: float
    height: float
    tolerance: float
    angle: float
    heading: float
    position: Array

    @property
    def flat(self) -> bool:
        """Whether a face may lie on the table."""
        return self.tilt < MAX_REST_TILT and abs(self.height) < self.tolerance


class CubeGestures:
    """Recognises what the hand does with one cube.

    It keeps no clock: all times come from `CubeState.timestamp`.

    Parameters
    ----------
    cube
        The cube, or any convex body; only its sides matter.
    """

    def __init__(self, cube: CubeModel) -> None:
        self._sides = SideDirections(cube.sides)
        self._table_estimator = TableEstimator(self._sides)
        self._table: TablePlane | None = None
        self._stillness = StillnessDetector()
        self._detectors = {name: make() for name, make in DETECTORS.items()}
        self._turns = TurnCounter()
        self._positions: deque[tuple[float, list[float]]] = deque()
        self._last: tuple[float, Array] | None = None
        self._focal_scale = 1.0
        self._lifted_since: float | None = None
        self._handled = True
        self._placed_top: str | None = None
        self._controls = CubeControls(False, None, 0.0, 0.0, 0.0, False, False, False, None, 0.0)

    def update(self, state: CubeState) -> CubeControls:
        """Return what the hand does, given the next state."""
        pose, now = state.camera_from_cube, state.timestamp
        before = replace(
            self._controls, visible=state.visible, placed=False, gestures=(), timestamp=now
        )
        if not state.visible or pose is None:
            self._controls = before
            return before
        if state.focal_scale != self._focal_scale:
            self._look_through(state.focal_scale)
        velocity = self._velocity(now, pose)
        made = [name for name, each in self._detectors.items() if each.update(now, pose, velocity)]
        # Before the position is remembered: `_learn` needs the time since the last pose.
        self._learn(state, pose)
        self._remember(now, pose[:3, 3])
        self._last = (now, pose)
        before = replace(before, gestures=tuple(made))
        table = self._table_estimator.table
        self._controls = before if table is None else self._on_table(before, table, pose)
        return self._controls

    def _look_through(self, focal_scale: float) -> None:
        """Keep the table under the cube where a longer lens shows both farther away."""
        longer, self._focal_scale = focal_scale / self._focal_scale, focal_scale
        if self._last is not None:
            place = self._last[1][:3, 3]
            self._table_estimator.move(farther(place, longer))
            # It is the same table: nothing was placed on it.
            self._table = self._table_estimator.table
        self._last = None
        self._stillness = StillnessDetector()
        self._positions.clear()

    def _velocity(self, now: float, pose: Array) -> Array:
        if self._last is None or not 0 < now - self._last[0] <= MAX_GAP_S:
            return np.zeros(6)
        return se3.delta(self._last[1], pose) / (now - self._last[0])

    def _learn(self, state: CubeState, pose: Array) -> None:
        # A wrong focal length moves the poses of all frames alike, so it hides no tremor.
        noise = np.diag(state.covariance) - state.focal_shift**2
        self._stillness.add(state.timestamp, pose, noise)
        if self._stillness.still:
            elapsed = state.timestamp - self._last[0] if self._last else 0.0
            self._table_estimator.learn(pose, self._stillness.firm, min(elapsed, MAX_GAP_S))
        if self._table is not self._table_estimator.table:
            # Another table: nothing of the old one holds any more.
            self._table = self._table_estimator.table
            self._handled = True
            self._lifted_since = None

    def _on_table(self, before: CubeControls, table: TablePlane, pose: Array) -> CubeControls:
        place = self._table_pose(table, pose, before.top_face)
        now = before.timestamp
        lifted = self._is_lifted(now, place)
        steady = self._is_steady(now, before.resting)
        # A cube that rests may tilt by an error of the tracker for `MIN_LIFT_S`, and still rests.
        resting = steady and (place.flat or (before.resting and not lifted))
        # Placed again only after it was in a hand, or with another face up: a cube that is only
        # shoved
        # comes to rest too.
        self._handled |= lifted
        placed = resting and (self._handled or place.top != self._placed_top)
        if placed:
            self._handled = False
            self._placed_top = place.top
            self._turns.restart(place.angle)
        elif place.flat and place.top == self._placed_top:
            self._turns.add(place.angle)
        return replace(
            before,
            top_face=place.top,
            heading=place.heading,
            camera_angle=abs(place.heading),
            turns=self._turns.turns,
            resting=resting,
            placed=placed,
            lifted=lifted,
            position=place.position,
            camera_from_table=table.camera_from_table,
            placements=before.placements + placed,
        )

    def _table_pose(self, table: TablePlane, pose: Array, last_top: str | None) -> _TablePose:
        table_from_camera = se3.inverse(table.camera_from_table)
        table_from_cube = table_from_camera @ pose
        up = table_from_cube[1, :3]
        names = self._sides.normals
        cosine, top = max(zip((self._sides.all_normals @ up).tolist(), names, strict=True))
        tilt = _angle(cosine)
        # Hysteresis: between two faces the last one stays on top.
        if last_top is not None and tilt > MAX_TOP_TILT:
            top = last_top
        position = table_from_cube[[0, 2], 3]
        angle = clockwise_angle(table_from_cube, names[top])
        towards = (table_from_camera[:3, :3] @ TOWARDS_CAMERA)[[0, 2]]
        # Clockwise as seen from above, 0 towards the camera.
        heading = wrap_angle(angle - clockwise_angle_of(towards))
        height, spread = table.height(pose[:3, 3])
        height -= float(self._sides.depths[list(names).index(top)])
        return _TablePose(top, tilt, height, MIN_LIFT_M + spread, angle, heading, position)

    def _is_lifted(self, now: float, place: _TablePose) -> bool:
        """Whether the cube has been off the table, or tipped, for longer than an error lasts."""
        if place.flat:
            self._lifted_since = None
            return False
        if self._lifted_since is None:
            self._lifted_since = now
        return now - self._lifted_since >= MIN_LIFT_S - 1e-9

    def _remember(self, now: float, centre: Array) -> None:
        if self._positions and now - self._positions[-1][0] > MAX_GAP_S:
            self._positions.clear()
        self._positions.append((now, centre.tolist()))
        # One position older than the window stays, so that the window is always covered.
        while len(self._positions) > 2 and now - self._positions[1][0] >= TRAVEL_WINDOW_S - 1e-9:
            self._positions.popleft()

    def _is_steady(self, now: float, resting: bool) -> bool:
        """Whether the cube has hardly moved for a while; it may have turned on the spot."""
        if now - self._positions[0][0] < TRAVEL_WINDOW_S - 1e-9:
            return resting
        centre = self._positions[-1][1]
        travel = max(math.dist(centre, there) for _, there in self._positions)
        # Hysteresis: the noise of a far cube's pose must not end its rest.
        limit = MAX_SPEED_TO_KEEP_RESTING if resting else MAX_SPEED_TO_START_RESTING
        return travel < limit * TRAVEL_WINDOW_S


def _angle(cosine: float) -> float:
    return math.acos(min(max(cosine, -1.0), 1.0))


def farther(place: Array, longer: float) -> Array:
    """Return how things about a place, (3,) [m], move where a lens is `longer` than was assumed.

    They look alike in the picture, and are as large: they are farther away, and turned with the
    line of sight to them. A transform, (4, 4).
    """
    there = place * [1, 1, longer]
    before, after = place / np.linalg.norm(place), there / np.linalg.norm(there)
    axis = np.cross(before, after)
    sine = float(np.linalg.norm(axis))
    turn = se3.rotation(axis * (math.asin(min(sine, 1.0)) / sine if sine > 1e-9 else 0.0))
    return se3.pose(turn, there - turn @ place)


def wrap_angle(angle: float) -> float:
    """Wrap an angle to −π…π.

    >>> wrap_angle(1.5 * np.pi) == -np.pi / 2
    True
    """
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def forward_direction(top: Array) -> Array:
    """Direction in the cube frame, (3,), that is the cube's heading where `top` is up, (3,).

    That of `front`; of `bottom` when `front` is up, and of `top` when `back` is up.

    >>> forward_direction(np.array([0.0, 1.0, 0.0])).tolist()
    [0.0, 0.0, 1.0]
    >>> forward_direction(np.array([0.0, 0.0, 1.0])).tolist()
    [0.0, -1.0, 0.0]
    """
    if abs(top[2]) < MIN_FORWARD_COSINE:
        return np.array([0.0, 0.0, 1.0])
    return np.array([0.0, -np.sign(top[2]), 0.0])


def clockwise_angle(table_from_cube: Array, top: Array) -> float:
    """Direction of the forward side from +z of the table [rad], clockwise seen from above.

    `top` is the direction in the cube frame that is up, (3,).
    """
    forward = table_from_cube[:3, :3] @ forward_direction(top)
    return float(np.arctan2(-forward[0], forward[2]))


def clockwise_angle_of(direction: Array) -> float:
    """Direction on the table, (x, z), from +z [rad], clockwise seen from above."""
    return float(np.arctan2(-direction[0], direction[1]))


class TurnCounter:
    """Unwraps angles: each step is the shorter way around, also after the cube was hidden."""

    def __init__(self) -> None:
        self._angle: float | None = None
        self._total = 0.0

    def restart(self, angle: float) -> None:
        """Count from an angle [rad] on; the sum is 0 again."""
        self._angle, self._total = angle, 0.0

    def add(self, angle: float) -> None:
        """Count up to an angle [rad]; without a start nothing is counted."""
        if self._angle is not None:
            self._total += wrap_angle(angle - self._angle)
            self._angle = angle

    @property
    def turns(self) -> float:
        """Turns since the start, clockwise positive."""
        return self._total / (2 * np.pi)
