"""Through which lens the pictures are measured and drawn, and what they tell beside the cube."""

from collections.abc import Sequence

from cubeling.app.pipeline.step_renderer import StepRenderer
from cubeling.tracking import CubeControls, CubeModel, CubeState, Frame, Intrinsics
from cubeling.tracking.appearance import Appearance, AppearanceMeter


class Sight:
    """The lens of one camera, whose focal length may be measured in play. `begin` must follow.

    Parameters
    ----------
    renderer
        Draws through the same lens.
    intrinsics
        Of the camera, as they are at the beginning.
    parts
        What is measured of the pictures, of `APPEARANCE_PARTS`.
    """

    def __init__(
        self, renderer: StepRenderer, intrinsics: Intrinsics, parts: Sequence[str]
    ) -> None:
        self._renderer, self._parts = renderer, tuple(parts)
        self.intrinsics = self.lens = intrinsics
        """As they are at the beginning of the scenario, and as the last pose was found."""

    def take(self, intrinsics: Intrinsics) -> None:
        """Take another camera; `begin` must follow, as the table is another one in its picture."""
        self.intrinsics = intrinsics
        self.look_through(intrinsics)

    def look_through(self, lens: Intrinsics) -> None:
        """Draw through a lens that poses were found through; `begin` must follow."""
        self.lens = lens
        self._renderer.look_through(lens)

    def begin(self, cubes: Sequence[CubeModel]) -> None:
        """Forget what the pictures have shown so far; the cubes are those of the players."""
        self._renderer.play(cubes)
        self._measure_from_now(cubes[0])

    def follow(self, state: CubeState, cube: CubeModel) -> None:
        """Look through the lens of a state."""
        focal = state.focal_scale * self.intrinsics.matrix[0, 0]
        if focal != self.lens.matrix[0, 0]:
            self.look_through(self.intrinsics.lengthen(state.focal_scale, None))
            self._measure_from_now(cube)

    def see(self, frame: Frame, state: CubeState, controls: CubeControls) -> Appearance | None:
        """Measure what the picture tells beside the cube's pose; None where nothing needs it."""
        if not self._parts:
            return None
        return self._meter.update(frame, state, controls.camera_from_table)

    def _measure_from_now(self, cube: CubeModel) -> None:
        self._meter = AppearanceMeter(cube, self.lens, self._parts)
