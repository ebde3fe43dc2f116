"""The synthetic camera as a source of frames, with the truth beside it."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from tracking.cube.model import CubeModel
from tracking.errors import TrackingError
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics
from tracking.sources.base import FrameSource
from tracking.sources.device import Clock
from tracking.synthetic.choreography import Moment
from tracking.synthetic.exposure import Exposure, moments_of
from tracking.synthetic.folding import folded
from tracking.synthetic.lens import Lens
from tracking.synthetic.options import SyntheticOptions
from tracking.synthetic.paper_cube import PaperCube
from tracking.synthetic.scripts import SCRIPTS, Script

Array = NDArray[np.float64]

EYE = np.array([0.0, 0.37, 0.53])
"""Where the camera is, in the table frame [m]."""

LOOKS_AT = np.array([0.0, 0.05, -0.02])
"""What it looks at, in the table frame [m]."""


class SyntheticSource(FrameSource):
    """A source that renders a cube on a desk, so that the true poses are known.

    The same name and options give the same images. It may be iterated more than once.

    Parameters
    ----------
    name
        Name of a script.
    options
        How the camera sees and how the script runs.

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
        self.name = name
        self.options = options = options or SyntheticOptions()
        self.intrinsics: Intrinsics | None = webcam(options)
        self.size = (options.width, options.height)
        self.rate = options.rate
        bundled = SCRIPTS[name](0.06, options).cube
        self.cube = folded(CubeModel.load(bundled), options.fold, options.seed)
        """The cube that is seen, as it was folded."""
        self._script: Script = SCRIPTS[name](self.cube.edge, options)
        self.camera_from_table = looking(EYE, LOOKS_AT)
        """Where the desk is: its frame has +y up, +z towards the camera, (4, 4)."""
        self.count = options.frames or round(self._script.length * options.rate)
        """How many frames there are."""
        self.duration: float | None = self.count / options.rate
        self._lens: Lens | None = None
        self._exposure: Exposure | None = None
        self._paper: PaperCube | None = None

    def __iter__(self) -> Iterator[Frame]:
        """Draw the frames in order."""
        for index in range(self.count):
            yield self.frame(index)

    def close(self) -> None:
        """Do nothing: nothing is open."""

    def time(self, index: int) -> float:
        """Return the time of a frame, the middle of its exposure [s]."""
        return round(index / self.rate, 9)

    def moment(self, index: int) -> Moment:
        """Return cube and hand in the middle of a frame's exposure."""
        return self._script.at(self.time(index))

    def truth(self, index: int) -> Array:
        """Return `camera_from_cube` in the middle of a frame's exposure, (4, 4)."""
        return self._camera_from_cube(self.moment(index))

    def frame(self, index: int) -> Frame:
        """Draw one frame."""
        lens, paper, exposure = self._studio()
        time, half = self.time(index), self.options.blur / 2
        ends = [self._script.at(time + shift) for shift in (-half, half)]
        if self._script.loose:
            ends = [self._script.at(time)] * 2
        corners = [paper.corners(self._camera_from_cube(moment)) for moment in ends]
        behind = any((points[:, 2] < 0.02).any() for points in corners)
        count = 1 if behind else moments_of(lens, corners)
        shifts = np.linspace(-half, half, count) if count > 1 else np.zeros(1)
        moments = [self._script.at(time + float(shift)) for shift in shifts]
        poses = [self._camera_from_cube(moment) for moment in moments]
        image = exposure.draw(moments, poses, index, self._script.loose or self._script.aloft)
        return Frame(image, time, index)

    def _camera_from_cube(self, moment: Moment) -> Array:
        if self._script.loose or self._script.aloft:
            return moment.table_from_cube
        return np.asarray(self.camera_from_table @ moment.table_from_cube)

    def _studio(self) -> tuple[Lens, PaperCube, Exposure]:
        """Set up when the first picture is asked for: who wants only the truth need not wait."""
        if self._lens is None or self._paper is None or self._exposure is None:
            assert self.intrinsics is not None
            self._lens = Lens(self.intrinsics)
            self._paper = PaperCube(self.cube, self._lens, self.options.seed)
            self._exposure = Exposure(self._lens, self._paper, self.camera_from_table, self.options)
        return self._lens, self._paper, self._exposure


def open_synthetic(name: str) -> SyntheticSource:
    """Open "NAME" or "NAME?key=value&…"; see `SCRIPTS` and `SyntheticOptions`.

    Raises
    ------
    TrackingError
        There is no such script or option.
    """
    return SyntheticSource(*SyntheticOptions.parse(f"synthetic:{name}"))


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> SyntheticSource:
    """Open "synthetic:NAME?key=value"; size and times are the script's."""
    return open_synthetic(uri.partition(":")[2])


def webcam(options: SyntheticOptions) -> Intrinsics:
    """Return the camera: focal length 900 px at 1280 × 720, a little off centre, mild barrel."""
    scale = options.width / 1280
    matrix = np.array(
        [
            [900.0 * scale, 0.0, options.width / 2 + 6.3 * scale],
            [0.0, 901.5 * scale, options.height / 2 - 4.1 * scale],
            [0.0, 0.0, 1.0],
        ]
    )
    lens = options.distortion * np.array([-0.11, 0.055, 0.0006, -0.0004, -0.012])
    return Intrinsics(matrix, lens, (options.width, options.height))


def looking(eye: Array, target: Array) -> Array:
    """Return `camera_from_table` of an upright camera at `eye` that looks at `target`."""
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    turn = np.stack([right, np.cross(forward, right), forward])
    return se3.pose(turn, -turn @ eye)
