"""What a character that goes after the cube feels about: it is near, runs away, or waits."""

import numpy as np
from numpy.typing import NDArray

from cubeling.characters import PosedCharacter
from cubeling.tracking import CubeControls

REACHED_M, LOST_M = 0.07, 0.14
"""A cube nearer than the first is reached, one farther than the second is to be reached again; both
from where the character stops [m]."""

CHASED_M, CHASED_S, CHASED_AGAIN_S = 0.10, 0.6, 5.0
"""A cube that moves so far in this time runs away, and does so again no sooner than that."""

STILL_M, STILL_RAD, IGNORED_S = 0.015, np.deg2rad(8), 12.0
"""A cube that neither moves nor turns by this for so long is ignored by the hand."""

Point = NDArray[np.float64]


class Pursuit:
    """Notices what happens between the cube and a character that goes after it.

    The events are "reached", "chased" and "ignored"; personalities say what they mean.
    """

    def __init__(self) -> None:
        self._near = True  # a character that begins beside the cube has reached nothing
        self._past: list[tuple[float, Point]] = []
        self._chased_at = -np.inf
        self._still: tuple[float, Point, float] | None = None  # since when, where, which way

    def update(
        self,
        controls: CubeControls,
        character: PosedCharacter | None,
        stop_distance: float,
        moving: bool,
    ) -> tuple[str, ...]:
        """Return the events of a frame.

        `stop_distance` is how far from the cube the character stops [m], `moving` whether it is to
        move.
        """
        cube, now = controls.position, controls.timestamp
        if cube is None or character is None or not controls.visible:
            self._past.clear()
            self._still = None
            return ()
        happened = {
            "reached": self._is_reached(cube, character, stop_distance),
            "chased": self._is_chased(cube, now) and moving,
            "ignored": self._is_ignored(controls, cube, now),
        }
        if happened["chased"]:
            self._chased_at = now
        return tuple(name for name, true in happened.items() if true)

    def _is_reached(self, cube: Point, character: PosedCharacter, stop_distance: float) -> bool:
        place = character.table_from_character[[0, 2], 3]
        beyond = float(np.linalg.norm(place - cube)) - stop_distance
        was_near, self._near = self._near, beyond < (LOST_M if self._near else REACHED_M)
        return self._near and not was_near

    def _is_chased(self, cube: Point, now: float) -> bool:
        self._past = [each for each in self._past if now - each[0] <= CHASED_S]
        self._past.append((now, cube))
        moved = float(np.linalg.norm(cube - self._past[0][1]))
        return moved > CHASED_M and now - self._chased_at >= CHASED_AGAIN_S

    def _is_ignored(self, controls: CubeControls, cube: Point, now: float) -> bool:
        if self._still is None or controls.lifted or _is_moved(controls, cube, self._still):
            self._still = now, cube, controls.heading
        ignored = now - self._still[0] >= IGNORED_S
        if ignored:
            self._still = now, cube, controls.heading
        return ignored


def _is_moved(controls: CubeControls, cube: Point, still: tuple[float, Point, float]) -> bool:
    _, place, heading = still
    moved = float(np.linalg.norm(cube - place)) > STILL_M
    return moved or abs(np.angle(np.exp(1j * (controls.heading - heading)))) > STILL_RAD
