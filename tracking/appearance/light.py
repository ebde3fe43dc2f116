"""The light in the room, measured on the white paper of a tracked cube."""

import numpy as np

from cubeling.tracking.appearance.appearance import MeasuredLight
from cubeling.tracking.appearance.patch_memory import MEMORY_S, ExposureGain, PatchMemory
from cubeling.tracking.appearance.patches import PaperSampler
from cubeling.tracking.cube.marker import cell_size
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Image
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState

EXPOSURE_S, MAX_BLUR_CELLS = 0.015, 0.35
"""Expected exposure time, and how far a cube may move during it: beyond, paper and ink mix."""

DEFAULT_UP = np.array([0.0, -np.cos(0.55), -np.sin(0.55)])
"""Up in the axes of a camera that looks down on a desk as most do, (3,)."""

SMOOTHING_S = 0.4
"""Time in which the light that is reported follows the fit."""

CONTRADICTED_S, MIN_KNOWN, CONTRADICTION = 0.25, 0.6, 0.12
"""Time in which all is forgotten while the faces contradict a light whose direction is certain to
this degree, and by how much of all light half of them do so at least."""

MEASURING_INTERVAL_S, FIT_INTERVAL_S = 0.1, 0.3
"""Time from one measurement of the paper to the next, and from one fit to the next: never both in
the same picture."""

MAX_STEP_S = 0.2
"""A longer gap between two pictures counts as this long: one picture proves no more."""


class LightMeter:
    """Measures the light on a tracked cube, from picture to picture; the camera stands still.

    Each face is a patch of known reflectance and orientation. The light on the orientations seen so
    far is remembered, relative to the picture's exposure, and explained by ambient light and one
    direction: irradiance = ambient + key · max(0, normal · to_light).
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self._sampler = PaperSampler(cube, intrinsics)
        self._reach = cube.edge * 0.87
        self._max_travel = MAX_BLUR_CELLS * cell_size(cube)
        self._exposure = ExposureGain()
        self._memory = PatchMemory()
        self._light: MeasuredLight | None = None
        self._looked = self._fitted = self._measured = -np.inf
        self._gain = np.ones(3)

    def update(
        self, image: Image, state: CubeState, up: Array | None = None
    ) -> MeasuredLight | None:
        """Take a picture into account and return the light.

        Parameters
        ----------
        image
            The camera's picture, (H, W, 3) BGR.
        state
            Where the cube is in it.
        up
            Unit vector away from the ground in the camera's frame, (3,), if it is known: light
            comes from above more often than from below.

        Returns
        -------
        None until any paper was measured. See `MeasuredLight.certainty` for how far to trust it.
        """
        now = state.timestamp
        if now < self._looked:  # a recording is wound back
            self._looked = self._fitted = self._measured = now - MEASURING_INTERVAL_S
        if self._measured > self._fitted and now - self._fitted >= FIT_INTERVAL_S - 1e-6:
            fitted = self._memory.fit(DEFAULT_UP if up is None else up)
            self._light = _blend(self._light, fitted, now - self._fitted)
            self._fitted = now
        elif now - self._looked >= MEASURING_INTERVAL_S - 1e-6:
            step = min(now - self._looked, MAX_STEP_S)
            self._looked = now
            self._gain = self._exposure.update(image, step)
            self._memory.age(step)
            self._measure(image, state)
        light = self._light
        if light is None:
            return None
        return MeasuredLight(
            light.to_light, light.key * self._gain, light.ambient * self._gain, light.certainty
        )

    def _measure(self, image: Image, state: CubeState) -> None:
        """Take the paper that is seen into the memory."""
        if not state.visible or state.camera_from_cube is None or not self._still(state):
            return
        patches = self._sampler.measure(image, state.camera_from_cube)
        if len(patches.normals):
            step = min(state.timestamp - self._measured, MAX_STEP_S)
            irradiance = patches.irradiance / self._gain
            if self._light is not None and _contradict(self._light, patches.normals, irradiance):
                self._memory.age(step * MEMORY_S / CONTRADICTED_S)
            self._memory.add(patches, irradiance, step)
            self._measured = state.timestamp

    def _still(self, state: CubeState) -> bool:
        """Whether paper and ink are apart in the picture in spite of the cube's motion."""
        moved, turned = state.velocity[:3], state.velocity[3:]
        speed = np.sqrt(moved @ moved) + self._reach * np.sqrt(turned @ turned)
        return state.source != "predicted" and bool(speed * EXPOSURE_S < self._max_travel)


def _contradict(light: MeasuredLight, normals: Array, irradiance: Array) -> bool:
    """Whether faces are lit otherwise than known: more than one of them, as hands shade one."""
    if light.certainty < MIN_KNOWN or len(normals) < 2:
        return False
    model = light.ambient + np.maximum(normals @ light.to_light, 0)[:, None] * light.key
    off = np.sort(np.abs(irradiance - model).sum(axis=1))
    return bool(off[(len(off) - 1) // 2] > CONTRADICTION * (light.ambient + light.key).sum())


def _blend(last: MeasuredLight | None, new: MeasuredLight, since: float) -> MeasuredLight:
    """Follow a new fit smoothly."""
    if last is None:
        return new
    share = 1 - np.exp(-since / SMOOTHING_S)
    to_light, key, ambient = (
        a + share * (b - a)
        for a, b in (
            (last.to_light, new.to_light),
            (last.key, new.key),
            (last.ambient, new.ambient),
        )
    )
    certainty = last.certainty + share * (new.certainty - last.certainty)
    to_light = to_light / max(float(np.sqrt(to_light @ to_light)), 1e-9)
    return MeasuredLight(to_light, key, ambient, float(certainty))
