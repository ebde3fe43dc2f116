"""Who and what is on the table, as a scenario finds it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.props import PosedBody
from cubeling.characters import PosedCharacter, TableView
from cubeling.tracking import CubeControls, CubeState

PLAYER_POSITION = np.array([0.0, 2.0])
"""A point far towards the camera, (x, z) on the table [m]: where the player sits."""


@dataclass(frozen=True)
class Situation:
    """Who and what is on the table, and what the character can do."""

    character: PosedCharacter | None = None
    """The character as after the previous frame; None in the first."""

    body: PosedBody | None = None
    """Its body then, which tells how hard a place is to reach; None in the first frame."""

    actions: tuple[str, ...] = ()
    """Names of the actions that the character can perform."""

    walks: bool = True
    """Whether the character walks and runs; else it hops."""

    body_length: float = 0.0
    """Length of the character on the table, from front to back [m]."""

    cube: NDArray[np.float64] | None = None
    """`table_from_cube`, (4, 4) [m]; None where the cube is not seen."""

    heard: int | None = None
    """Number in the cast of who has ended a line since the previous frame; None for nobody."""

    view: TableView | None = None
    """From where and how far the table is seen; None before the table is known."""


@dataclass(frozen=True)
class SeenCube:
    """The cube of a player in a frame."""

    state: CubeState
    """Its pose in the camera frame, if it is seen."""

    controls: CubeControls
    """What the hand does with it."""


def table_from_cube(state: CubeState, controls: CubeControls) -> NDArray[np.float64] | None:
    """Return where a cube that is seen is on the table, (4, 4) [m]."""
    table, cube = controls.camera_from_table, state.camera_from_cube
    if table is None or cube is None or not controls.visible:
        return None
    return np.asarray(np.linalg.inv(table) @ cube)
