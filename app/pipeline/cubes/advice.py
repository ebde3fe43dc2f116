"""What the player is told of the cube in view: another one, its sheet, or printed otherwise."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from cubeling.app.pipeline.cubes.other_cube import OtherCube, advice
from cubeling.app.pipeline.cubes.print_watch import PrintWatch, fault_advice
from cubeling.tracking import CubeModel, CubeState, Frame, Intrinsics

if TYPE_CHECKING:
    from cubeling.tracking import PrintFault

FOLD_IT, FOLD_IT_SHOWN_S = "This is the sheet: fold it into a cube.", 1.0
"""What the player is told who shows the sheet, and for how long after it was seen [s]."""


class CubeAdvice:
    """Looks at what is in view instead of the cube in play, and at how that is printed.

    Parameters
    ----------
    cube
        The cube in play.
    intrinsics
        Of the camera.
    known_cubes
        The player's other cubes.
    players_cubes
        Those of the other players.
    """

    def __init__(
        self,
        cube: CubeModel,
        intrinsics: Intrinsics,
        known_cubes: Sequence[CubeModel],
        players_cubes: Sequence[CubeModel] = (),
    ) -> None:
        self._cube = cube
        self._other = OtherCube(cube, known_cubes, players_cubes)
        self._print_watch = PrintWatch(cube, intrinsics)
        self.other_cube: CubeModel | None = None
        """Another cube than the one in play, if one is in view."""
        self._print_fault: PrintFault | None = None
        self._now, self._sheet_seen_at = 0.0, -math.inf

    @property
    def printed(self) -> CubeModel:
        """The cube in play as it is printed, as far as it can be tracked so."""
        return self._print_watch.printed

    def update(self, frame: Frame, state: CubeState) -> None:
        """Look at the next frame, now and then."""
        self._now = state.timestamp
        self.other_cube = self._other.update(frame, state)
        self._print_fault = self._print_watch.update(frame, state)
        if state.refused == "flat":
            self._sheet_seen_at = self._now

    def hint(self, playing: str, fixed: bool) -> str:
        """Return what to tell the player, "" for nothing; the arguments are those of `advice`."""
        if 0.0 <= self._now - self._sheet_seen_at < FOLD_IT_SHOWN_S:
            return FOLD_IT
        if self.other_cube is not None:
            return advice(self.other_cube, playing, self._cube.name, fixed)
        if self._print_fault is not None:
            return fault_advice(self._print_fault, self._cube)
        return ""
