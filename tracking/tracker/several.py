"""Several cubes in one image, each with markers of its own."""

from collections.abc import Sequence

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import MarkerDetector
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.tracker.frame_markers import FrameMarkers
from cubeling.tracking.tracker.learned_camera import LearnedCamera
from cubeling.tracking.tracker.tracker import CubeTracker


class CubesTracker:
    """Tracks several cubes through the frames of one camera; they share its markers.

    Parameters
    ----------
    cubes
        The cubes; no two of one dictionary may share a marker.
    intrinsics
        The camera; every frame must have its size.

    Raises
    ------
    TrackingError
        Two cubes share a marker, or there is no cube.
    """

    def __init__(self, cubes: Sequence[CubeModel], intrinsics: Intrinsics) -> None:
        if not cubes:
            raise TrackingError("there is no cube to track: name at least one")
        owners: dict[tuple[str, int], str] = {}
        for cube in cubes:
            for face in cube.faces:
                key = (cube.dictionary, face.marker_id)
                if key in owners:
                    raise TrackingError(
                        f"the cubes '{owners[key]}' and '{cube.name}' both have marker "
                        f"{face.marker_id} of {cube.dictionary}: print one with markers of its "
                        "own, as `cubeling cube locomotion-2` does"
                    )
                owners[key] = cube.name
        camera = LearnedCamera(intrinsics)
        self.trackers = tuple(CubeTracker(cube, intrinsics, camera) for cube in cubes)
        """One for each cube, in the order given."""
        self._detectors = {name: MarkerDetector(name) for name, _ in owners}

    def update(self, frame: Frame) -> tuple[CubeState, ...]:
        """Find every cube in the next frame, in the order in which the cubes were given.

        Raises
        ------
        TrackingError
            The size of the frame is not that of the intrinsics.
        """
        markers = FrameMarkers(frame, self._detectors)
        return tuple(tracker.update(frame, markers) for tracker in self.trackers)

    def predict(self, timestamp: float) -> tuple[CubeState, ...]:
        """Return where each cube will be at a time near that of the last frame."""
        return tuple(tracker.predict(timestamp) for tracker in self.trackers)
