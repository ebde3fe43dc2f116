"""A person with a cube: where it is, what the hand does with it, and what is in the way."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import distinct_names
from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.step import PlayerStep, ReplayInputs
from cubeling.app.pipeline.table.obstacles import Obstacles
from cubeling.tracking import (
    CubeControls,
    CubeGestures,
    CubeModel,
    CubeState,
    Frame,
    FrameMarkers,
    Intrinsics,
    LearnedCamera,
)


class CubePlayer:
    """A player with a cube. It changes from frame to frame, and a checkpoint copies it.

    Parameters
    ----------
    name
        Its name among the players.
    robot
        The name of its robot.
    cube, camera, known_cubes, players_cubes
        See `TrackedCube`.
    """

    def __init__(
        self,
        name: str,
        robot: str,
        cube: CubeModel,
        camera: LearnedCamera,
        known_cubes: Sequence[CubeModel],
        players_cubes: Sequence[CubeModel] = (),
    ) -> None:
        self.name, self.robot, self.cube = name, robot, cube
        self.tracked = TrackedCube(cube, camera, known_cubes, players_cubes)
        """The cube in view, and what it has told of the camera."""
        self.obstacles = Obstacles(cube.edge)
        """What is in the way of the characters."""
        self._gestures = CubeGestures(cube)

    def gesture(self, state: CubeState) -> CubeControls:
        """Compute what the hand does with the cube."""
        return self._gestures.update(state)

    def play(
        self, frame: Frame, markers: FrameMarkers, first: CubeControls, recorded: ReplayInputs
    ) -> PlayerStep:
        """Find the cube, and tell what the hand does with it on the table of the `first` player.

        What is recorded of that is taken instead.
        """
        topic = f"/cubes/{self.name}"
        state = recorded.further.get(f"{topic}/state") or self.tracked.track(frame, markers)
        controls = recorded.further.get(f"{topic}/controls")
        controls = controls or on_table_of(first, self.gesture(state))
        return PlayerStep(self.name, state, controls, self.cube.edge, self.robot)


def make_players(
    cubes: Sequence[CubeModel],
    robots: Sequence[str],
    intrinsics: Intrinsics,
    known_cubes: Sequence[CubeModel],
) -> tuple[CubePlayer, ...]:
    """Return a player for each cube, named after it; all look through one camera."""
    camera = LearnedCamera(intrinsics)
    names = distinct_names(each.name for each in cubes)
    return tuple(
        CubePlayer(
            name, robot, cube, camera, known_cubes, [each for each in cubes if each is not cube]
        )
        for name, robot, cube in zip(names, robots, cubes, strict=False)
    )


def on_table_of(first: CubeControls, controls: CubeControls) -> CubeControls:
    """Return a player's controls on the table of the first player, which all characters share.

    Where either table is not known yet, the cube has no place on it.
    """
    table, own, place = first.camera_from_table, controls.camera_from_table, controls.position
    if table is None or own is None or place is None:
        return replace(controls, camera_from_table=table, position=None)
    moved = np.linalg.inv(table) @ own @ [place[0], 0.0, place[1], 1.0]
    return replace(controls, camera_from_table=table, position=np.asarray(moved[[0, 2]], float))


def check_players(cubes: Sequence[CubeModel]) -> None:
    """Refuse cubes of several players that share a marker.

    Raises
    ------
    AppError
        With what to print instead.
    """
    for number, cube in enumerate(cubes):
        for before in cubes[:number]:
            if cube.markers & before.markers:
                raise AppError(
                    f"the cubes '{before.name}' and '{cube.name}' share markers: the second player "
                    "needs others, such as those of: cubeling cube locomotion-2 (or companion-2)"
                )
