"""The synthetic camera as a frame source with ground truth."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.sources.base import FrameSource
from cubeling.tracking.sources.device import Clock
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.choreography import SceneState
from cubeling.tracking.synthetic.exposure import ExposureRenderer, shutter_samples
from cubeling.tracking.synthetic.folding import fold_cube
from cubeling.tracking.synthetic.options import SyntheticOptions
from cubeling.tracking.synthetic.paper_cube import PaperCube
from cubeling.tracking.synthetic.scripts import SCRIPTS, Script

EYE_M = np.array([0.0, 0.37, 0.53])
"""Position of the camera in the table frame."""

LOOK_AT_M = np.array([0.0, 0.05, -0.02])
"""Point that it looks at, in the table frame."""

FOCAL_DEVIATION = 0.002
"""What is stated of its focal length, as a share of it: as surely as a calibration finds it."""


class SyntheticSource(FrameSource):
    """A source that renders a cube on a desk, so that the true poses are known.

    The same name of a script and options give the same images. It may be iterated more than once.

    Raises
    ------
    TrackingError
        There is no such script.
    """

    live = False

    def __init__(self, name: str, options: SyntheticOptions | None = None) -> None:
        if name not in SCRIPTS:
            known = ", ".join(SCRIPTS)
            raise TrackingError(f"there is no synthetic scene '{name}': choose one of {known}")
        self.options = options = options or SyntheticOptions()
        self.intrinsics: Intrinsics | None = webcam(options)
        self.size = (options.width, options.height)
        self.rate = options.rate
        bundled = SCRIPTS[name](0.06, options).cube
        self.cube = fold_cube(CubeModel.load(bundled), options.fold, options.seed)
        """The visible cube, with its folding errors."""
        self._script: Script = SCRIPTS[name](self.cube.edge, options)
        self.camera_from_table = look_at(EYE_M, LOOK_AT_M)
        """Pose of the desk, whose frame has +y up and +z towards the camera, (4, 4)."""
        self.count = options.frames or round(self._script.length * options.rate)
        """Number of frames."""
        self.duration: float | None = self.count / options.rate

    def __iter__(self) -> Iterator[Frame]:
        """Render the frames in order."""
        for index in range(self.count):
            yield self.frame(index)

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def time(self, index: int) -> float:
        """Return the time of a frame: the middle of its exposure [s]."""
        return round(index / self.rate, 9)

    def state(self, index: int) -> SceneState:
        """Return cube and hand in the middle of a frame's exposure."""
        return self._script.at(self.time(index))

    def truth(self, index: int) -> Array:
        """Return `camera_from_cube` in the middle of a frame's exposure, (4, 4)."""
        return self._camera_from_cube(self.state(index))

    def frame(self, index: int) -> Frame:
        """Render the frame of an index, blurred over its exposure time; any order will do."""
        camera, paper, renderer = self._renderer
        time, half = self.time(index), 0.0 if self._script.unrelated else self.options.blur / 2
        ends = [self._script.at(time + shift) for shift in (-half, half)]
        corners = [paper.corners(self._camera_from_cube(state)) for state in ends]
        behind = any((points[:, 2] < 0.02).any() for points in corners)
        count = 1 if behind else shutter_samples(camera, corners)
        shifts = np.linspace(-half, half, count) if count > 1 else np.zeros(1)
        states = [self._script.at(time + float(shift)) for shift in shifts]
        poses = [self._camera_from_cube(state) for state in states]
        image = renderer.draw(states, poses, index, self._script.in_air)
        return Frame(image, time, index)

    def _camera_from_cube(self, state: SceneState) -> Array:
        if self._script.in_air:
            return state.table_from_cube
        return np.asarray(self.camera_from_table @ state.table_from_cube)

    @cached_property
    def _renderer(self) -> tuple[CameraRays, PaperCube, ExposureRenderer]:
        """Set up only when the first image is requested: ground truth alone needs no renderer."""
        assert self.intrinsics is not None
        camera = CameraRays(self.intrinsics, self.camera_from_table)
        paper = PaperCube(self.cube, camera, self.options.seed)
        return camera, paper, ExposureRenderer(camera, paper, self.options)


def open_synthetic(name: str) -> SyntheticSource:
    """Open "NAME" or "NAME?key=value&…", with errors as of `SyntheticSource` and its options."""
    return SyntheticSource(*SyntheticOptions.parse(f"synthetic:{name}"))


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> SyntheticSource:
    """Open "synthetic:NAME?key=value"; size and times are the script's."""
    return open_synthetic(uri.partition(":")[2])


def webcam(options: SyntheticOptions) -> Intrinsics:
    """Return the camera: focal length 900 px at 1280 × 720, a little off centre, mild barrel.

    One that is higher than it is wide is the same camera, held upright as a phone.
    """
    scale = max(options.width, options.height) / 1280
    matrix = np.array(
        [
            [900.0 * scale, 0.0, options.width / 2 + 6.3 * scale],
            [0.0, 901.5 * scale, options.height / 2 - 4.1 * scale],
            [0.0, 0.0, 1.0],
        ]
    )
    lens = options.distortion * np.array([-0.11, 0.055, 0.0006, -0.0004, -0.012])
    return Intrinsics(matrix, lens, (options.width, options.height), FOCAL_DEVIATION)


def look_at(eye: Array, target: Array) -> Array:
    """Return `camera_from_table` of an upright camera at `eye` that looks at `target`."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    turn = np.stack([right, np.cross(forward, right), forward])
    return se3.pose(turn, -turn @ eye)
