"""A camera from the frames in which a cube is waved: all steps in one call."""

from collections.abc import Iterable

from tracking.calibration.collecting import Collector
from tracking.calibration.finders import CubeFinder
from tracking.calibration.solving import Calibration, calibrate, measured_cube
from tracking.cube.model import CubeModel
from tracking.errors import TrackingError
from tracking.geometry.frame import Frame


def calibrate_camera(frames: Iterable[Frame], cube: CubeModel) -> tuple[Calibration, CubeModel]:
    """Find the camera that took some frames of a waved cube, and the cube as it was folded.

    Parameters
    ----------
    frames
        Frames of one size, in order: `open_source(…)` gives them.
    cube
        The cube as it was printed.

    Raises
    ------
    TrackingError
        There are too few still views of the cube, or they do not determine the camera.
    """
    finder = CubeFinder(cube)
    collector: Collector | None = None
    for frame in frames:
        if collector is None:
            collector = Collector(finder, (frame.image.shape[1], frame.image.shape[0]))
        collector.update(frame)
    if collector is None:
        raise TrackingError("there is no frame to calibrate the camera with")
    found = calibrate(collector.views, finder.target(collector.size))
    found.check()
    return found, measured_cube(cube, found.plates)
