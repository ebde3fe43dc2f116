"""What the camera's picture tells the drawing: the hand, the light, blur, noise and focus.

It changes nothing but the picture.
"""

import math
from collections.abc import Sequence

import numpy as np

from cubeling.characters.rendering import Box, CameraView, Cover, Focus, MeasuredLight, Softness
from cubeling.tracking import CubeControls, CubeModel, CubeState, Frame, Intrinsics
from cubeling.tracking.appearance import EDGE_SLOPE, HandFinder, HandMask, LightMeter, QualityMeter

DIRECTION_CERTAINTIES = 0.6, 0.8
"""Certainties of the light's direction from which on it is used at all, and fully."""

APERTURE_M = 0.002
"""Diameter of the opening of a webcam's lens [m]: a focal length of 4 mm at f/2."""

FOCUSING_S = 0.5
"""Time constant with which the camera's focus follows the cube [s]."""


class Surroundings:
    """Measures what the drawing follows, frame by frame.

    Parameters
    ----------
    cube, intrinsics
        The cube in play, and the camera.
    chosen
        Which of `REALISM_CHOICES` are measured; those of a face need no measurement.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics, chosen: Sequence[str]) -> None:
        self._cube, self._intrinsics = cube, intrinsics
        self._hand = HandFinder(cube, intrinsics) if "hand" in chosen else None
        self._light = LightMeter(cube, intrinsics) if "light" in chosen else None
        self._quality = QualityMeter(cube, intrinsics) if "softness" in chosen else None
        self._autofocus = Autofocus() if "focus" in chosen else None

    def view(
        self, frame: Frame, state: CubeState, controls: CubeControls, matched: bool = True
    ) -> CameraView:
        """Return the camera's picture with all that is known of the scene but the hand.

        Blur, noise and haze are measured only where the drawing is `matched` to them.
        """
        pose = state.camera_from_cube
        return CameraView(
            frame.image,
            self._intrinsics.matrix,
            self._intrinsics.distortion,
            controls.camera_from_table,
            () if pose is None else (Box(pose, self._cube.edge),),
            light=self._measured_light(frame, state, controls),
            softness=self._softness(frame, state) if matched else None,
            focus=None if self._autofocus is None else self._autofocus.update(state),
        )

    def cover(self, frame: Frame, state: CubeState) -> Cover | None:
        """Return the hand in front of the cube; call it once for each frame."""
        found = None if self._hand is None else self._hand.update(frame.image, state)
        return None if found is None else cover_of(found)

    def _measured_light(
        self, frame: Frame, state: CubeState, controls: CubeControls
    ) -> MeasuredLight | None:
        if self._light is None:
            return None
        table = controls.camera_from_table
        found = self._light.update(frame.image, state, None if table is None else table[:3, 1])
        if found is None:
            return None
        weight = float(np.interp(found.certainty, DIRECTION_CERTAINTIES, (0.0, 1.0)))
        return MeasuredLight(found.to_light, found.key, found.ambient, weight)

    def _softness(self, frame: Frame, state: CubeState) -> Softness | None:
        found = None if self._quality is None else self._quality.update(frame.image, state)
        if found is None:
            return None
        return Softness(found.blur, found.noise, found.haze, found.paper)


def cover_of(hand: HandMask) -> Cover:
    """Return a hand that was found, as the drawing takes it."""
    return Cover(hand.x, hand.y, hand.share, hand.behind, hand.scale, EDGE_SLOPE)


class Autofocus:
    """Follows the distance of the cube, on which a camera focuses."""

    def __init__(self) -> None:
        self._distance = 0.0
        self._time = 0.0

    def update(self, state: CubeState) -> Focus | None:
        """Return what is sharp while the cube is where it is; None before it was seen."""
        pose = state.camera_from_cube
        if pose is not None:
            elapsed = state.timestamp - self._time
            share = 1.0 - math.exp(-max(elapsed, 0.0) / FOCUSING_S) if self._distance else 1.0
            self._distance += share * (float(pose[2, 3]) - self._distance)
        self._time = state.timestamp
        return Focus(self._distance, self._distance, APERTURE_M) if self._distance else None
