"""From where the cube is to what the hand does with it."""

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.state import CubeControls, CubeState
from tracking.gestures.shaking import ShakeDetector
from tracking.gestures.stillness import Stillness
from tracking.gestures.table import DIRECTIONS, Table, TableLearner
from tracking.gestures.turning import TurnCounter, clockwise_angle, clockwise_angle_of, wrapped

Array = NDArray[np.float64]

LEVEL = np.deg2rad(10.0)
"""A face that leans less than this lies on the table [rad] (M11)."""

OTHER_TOP = np.deg2rad(30.0)
"""The top face changes once another one leans less than this [rad]: 45° would flicker."""

LIFTED = 0.010
"""Height above the table from which the cube is lifted [m], beyond what is unsure of the table."""

TO_CAMERA = np.array([0.0, 1.0, -1.0])
"""Down in the picture and against the view [camera frame]: over the table both lead to the camera.

The thesis measures the cube's angle from the view, not from the line to the camera (M10), so that
a cube that is slid keeps its heading. Looking level the view alone would do, looking straight
down the picture's edge; their sum does for every tilt between.
"""

NOISE = 0.1
"""What looks lifted or tipped for less than this is taken for an error of the tracker [s]."""

TRAVEL = (0.02, 0.04)
"""Slower than the first the cube comes to rest, faster than the second it no longer rests [m/s]."""

TRAVEL_TIME = 0.2
"""Time over which travel is measured [s] (M11)."""

GAP = 0.2
"""Poses further apart than this say nothing of the velocity between them [s]."""


@dataclass(frozen=True)
class _Place:
    """Where the cube is relative to the table."""

    top: str
    tilt: float
    height: float
    tolerance: float
    angle: float
    heading: float
    position: Array

    @property
    def flat(self) -> bool:
        """Whether a face could lie on the table."""
        return self.tilt < LEVEL and abs(self.height) < self.tolerance


class CubeGestures:
    """Understands the hand that plays with one cube.

    Deterministic: time comes from `CubeState.timestamp` only.

    Parameters
    ----------
    cube
        The cube; only its edge matters.
    """

    def __init__(self, cube: CubeModel) -> None:
        self._edge = cube.edge
        self._learner = TableLearner(cube.edge)
        self._table: Table | None = None
        self._stillness = Stillness()
        self._shake = ShakeDetector()
        self._turns = TurnCounter()
        self._track: deque[tuple[float, Array]] = deque()
        self._last: tuple[float, Array] | None = None
        self._off_since: float | None = None
        self._handled = True
        self._placed_top: str | None = None
        self._controls = CubeControls(
            False, None, 0.0, 0.0, 0.0, False, False, False, False, None, 0.0
        )

    def update(self, state: CubeState) -> CubeControls:
        """Take in the next state and tell what it means."""
        pose, now = state.camera_from_cube, state.timestamp
        before = replace(
            self._controls,
            visible=state.visible,
            placed=False,
            shaken=False,
            timestamp=now,
        )
        if not state.visible or pose is None:
            self._controls = before
            return before
        shaken = self._shake.update(now, self._velocity(now, pose))
        self._learn(state, pose)
        self._remember(now, pose[:3, 3])
        self._last = (now, pose)
        before = replace(before, shaken=shaken)
        table = self._learner.table
        self._controls = before if table is None else self._on_table(before, table, pose)
        return self._controls

    def _velocity(self, now: float, pose: Array) -> Array:
        if self._last is None or not 0 < now - self._last[0] <= GAP:
            return np.zeros(6)
        return se3.delta(self._last[1], pose) / (now - self._last[0])

    def _learn(self, state: CubeState, pose: Array) -> None:
        self._stillness.add(state.timestamp, pose, state.covariance)
        if self._stillness.still:
            elapsed = state.timestamp - self._last[0] if self._last else 0.0
            self._learner.learn(pose, self._stillness.firm, min(elapsed, GAP))
        if self._table is not self._learner.table:
            # Another table: what was known of the old one no longer holds.
            self._table = self._learner.table
            self._handled = True
            self._off_since = None

    def _on_table(self, before: CubeControls, table: Table, pose: Array) -> CubeControls:
        place = self._place(table, pose, before.top_face)
        now = before.timestamp
        off = self._off(now, place)
        steady = self._steady(now, before.resting)
        resting = steady and (place.flat or (before.resting and not off))
        self._handled |= off
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
            lifted=off,
            position=place.position,
            camera_from_table=table.camera_from_table,
            placements=before.placements + placed,
        )

    def _place(self, table: Table, pose: Array, last_top: str | None) -> _Place:
        table_from_camera = se3.inverse(table.camera_from_table)
        table_from_cube = table_from_camera @ pose
        up = table_from_cube[1, :3]
        leans = {name: _angle(float(up @ normal)) for name, normal in DIRECTIONS.items()}
        top = min(leans, key=lambda name: leans[name])
        tilt = leans[top]
        if last_top is not None and leans[top] > OTHER_TOP:
            top = last_top
        position = table_from_cube[[0, 2], 3]
        angle = clockwise_angle(table_from_cube, top)
        towards = (table_from_camera[:3, :3] @ TO_CAMERA)[[0, 2]]
        heading = wrapped(angle - clockwise_angle_of(towards))
        height, spread = table.height(pose[:3, 3])
        return _Place(top, tilt, height - self._edge / 2, LIFTED + spread, angle, heading, position)

    def _off(self, now: float, place: _Place) -> bool:
        """Whether the cube has been off the table, or tipped, for longer than an error lasts."""
        if place.flat:
            self._off_since = None
            return False
        if self._off_since is None:
            self._off_since = now
        return now - self._off_since >= NOISE - 1e-9

    def _remember(self, now: float, centre: Array) -> None:
        if self._track and now - self._track[-1][0] > GAP:
            self._track.clear()
        self._track.append((now, centre))
        # One moment older than the time stays, so that the time is always covered.
        while len(self._track) > 2 and now - self._track[1][0] >= TRAVEL_TIME - 1e-9:
            self._track.popleft()

    def _steady(self, now: float, resting: bool) -> bool:
        """Whether the cube has hardly travelled for a while; it may have turned on the spot."""
        if now - self._track[0][0] < TRAVEL_TIME - 1e-9:
            return resting
        centre = self._track[-1][1]
        travel = max(float(np.linalg.norm(centre - there)) for _, there in self._track)
        return travel < TRAVEL[resting] * TRAVEL_TIME


def _angle(cosine: float) -> float:
    return float(np.arccos(np.clip(cosine, -1, 1)))
