"""Scenes of a hand in which few pictures are drawn before it comes."""

import functools
from dataclasses import replace

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Floats, Image
from cubeling.tracking.geometry.frame import Frame
from tests.bench.hand_scenes import RATE_HZ, HandScene, HandView

AT_REST = 5
"""Pictures of the desk at rest: they are shown to and fro, and differ by noise and shadow."""


class RestingScene(HandScene):
    """A cube that a hand takes, turns and slides; the desk before that is drawn five times."""

    def __init__(self, view: HandView, cube: CubeModel, rate_hz: float = RATE_HZ) -> None:
        super().__init__(view, cube, rate_hz)
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
        image = _desk_at_rest(view, self.cube.name, self.rate_hz, shown)
        nothing = np.zeros(image.shape[:2], np.float32)
        return Frame(image, index / self.rate_hz, index), nothing


@functools.lru_cache(6 * AT_REST)
def _desk_at_rest(view: HandView, cube: str, rate_hz: float, index: int) -> Image:
    image = _scene(view, cube, rate_hz).frame(index)[0].image
    image.setflags(write=False)
    return image


@functools.lru_cache(1)
def _scene(view: HandView, cube: str, rate_hz: float) -> HandScene:
    return HandScene(view, CubeModel.load(cube), rate_hz)
