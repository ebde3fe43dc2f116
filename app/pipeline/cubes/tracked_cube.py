"""The cube in play: its tracker, and what the player is told of what is in view."""

import logging
from collections.abc import Sequence

from cubeling.app.pipeline.cubes.advice import CubeAdvice
from cubeling.app.pipeline.scenario_errors import described_error
from cubeling.tracking import (
    CubeModel,
    CubeState,
    CubeTracker,
    Frame,
    FrameMarkers,
    Intrinsics,
    LearnedCamera,
    LensEstimate,
    TrackingError,
)

LOG = logging.getLogger(__name__)
"""Shows tracebacks with `cubeling --debug`."""


class TrackedCube:
    """Tracks the cube in play, and reads it as it is printed.

    Parameters
    ----------
    cube
        The cube, as its file says.
    camera
        Which all cubes in play share.
    known_cubes
        The player's other cubes.
    players_cubes
        Those of the other players.
    """

    def __init__(
        self,
        cube: CubeModel,
        camera: LearnedCamera,
        known_cubes: Sequence[CubeModel],
        players_cubes: Sequence[CubeModel] = (),
    ) -> None:
        self._tracker = CubeTracker(cube, camera.intrinsics, camera)
        self._advice = CubeAdvice(cube, camera.intrinsics, known_cubes, players_cubes)
        self.error = ""
        """What the tracker's code raised in the last frame; "" for nothing."""

    def track(self, frame: Frame, markers: FrameMarkers | None = None) -> CubeState:
        """Find the cube in a frame; frames come in the order of time.

        Several cubes may share the `markers` of the frame.

        An error in the tracker's code costs this frame, and never the session.
        """
        self.error = ""
        try:
            return self._tracker.update(frame, markers)
        except TrackingError:  # such as a frame of another size: the next one has it, too
            raise
        except Exception as error:
            self.error = described_error(error)
            LOG.debug("the tracker failed in frame %d", frame.index, exc_info=True)
            return self._tracker.give_up(frame.timestamp)

    def advise(self, frame: Frame, state: CubeState) -> None:
        """Look now and then what the player has to be told of the cube in view.

        One that is printed otherwise than its file says is read as it is, if it can be.
        """
        self._advice.update(frame, state)
        if self._advice.printed is not self._tracker.cube:
            self._tracker.reprint(self._advice.printed)

    def hint(self, playing: str, fixed: bool) -> str:
        """Return what to tell the player, "" for nothing; see `CubeAdvice.hint`."""
        return self._advice.hint(playing, fixed)

    @property
    def other_cube(self) -> CubeModel | None:
        """Another cube than the one in play, if one is in view."""
        return self._advice.other_cube

    @property
    def intrinsics(self) -> Intrinsics:
        """The camera, as the last pose was found through it."""
        return self._tracker.intrinsics

    @property
    def measured_intrinsics(self) -> Intrinsics:
        """The camera, with its focal length as well as play has told it so far."""
        return self._tracker.measured_intrinsics

    @property
    def lens(self) -> LensEstimate:
        """What the cube has shown of the camera's lens so far, besides what its intrinsics say."""
        return self._tracker.lens
