"""Scenes of a hand in small pictures, of which few are drawn before it comes."""

import functools
from dataclasses import replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.synthetic import SyntheticOptions
from tests.bench.hand_scenes import RATE_HZ, HandScene, HandView

CUBE = CubeModel.load("locomotion")

AT_REST = 3
"""Pictures of the desk at rest: they are shown to and fro, and differ by noise and shadow."""

Size = tuple[int, int]

SMALL: Size = 640, 360
"""Of pictures that are drawn in a third of the time of a webcam's, (width, height) [px]. Cube and
hand are looked for at the same resolution in both."""

FULL: Size = 1280, 720
"""Of the pictures of a webcam, (width, height) [px]."""


class SizedScene(HandScene):
    """A cube that a hand takes, turns and slides, in pictures of some size."""

    def __init__(
        self, view: HandView, cube: CubeModel, rate_hz: float = RATE_HZ, size: Size = SMALL
    ) -> None:
        self.size = size
        """Of the pictures, (width, height) [px]."""
        super().__init__(view, cube, rate_hz)

    @property
    def options(self) -> SyntheticOptions:
        """How the camera sees."""
        return self._options

    @options.setter
    def options(self, options: SyntheticOptions) -> None:
        width, height = self.size
        self._options = replace(options, width=width, height=height)


class RestingScene(SizedScene):
    """Such a scene of which the desk at rest is drawn three times."""

    def __init__(
        self, view: HandView, cube: CubeModel, rate_hz: float = RATE_HZ, size: Size = SMALL
    ) -> None:
        super().__init__(view, cube, rate_hz, size)
        held = (index for index in range(self.count) if self.state(index).grip > 0)
        self.first_held = next(held, self.count)
        """Number of the first frame with the hand."""

    def frame(self, index: int) -> tuple[Frame, Floats]:
        """Return a frame, and what the hand covers of each pixel, (H, W) 0…1."""
        if index >= self.first_held:
            return super().frame(index)
        shown = AT_REST - 1 - abs(index % (2 * AT_REST - 2) - (AT_REST - 1))
        # The hand that will come is not in these pictures.
        view = replace(self.view, skin="000000", azimuth_deg=0.0, exposure=0.0, warmth=0.0)
        image = _desk_at_rest(view, self.cube.name, self.rate_hz, self.size, shown)
        nothing = np.zeros(image.shape[:2], np.float32)
        return Frame(image, index / self.rate_hz, index), nothing


@functools.lru_cache(6 * AT_REST)
def _desk_at_rest(view: HandView, cube: str, rate_hz: float, size: Size, index: int) -> Image:
    image = _scene(view, cube, rate_hz, size).frame(index)[0].image
    image.setflags(write=False)
    return image


@functools.lru_cache(1)
def _scene(view: HandView, cube: str, rate_hz: float, size: Size) -> SizedScene:
    return SizedScene(view, CubeModel.load(cube), rate_hz, size)


def state_at(pose: Array | None, visible: bool = True) -> CubeState:
    """Return the state of a cube at rest that was found in this pose."""
    still = np.zeros(6)
    return CubeState(visible, pose, still, np.zeros((6, 6)), "markers", (), 0.3, 0.0)
