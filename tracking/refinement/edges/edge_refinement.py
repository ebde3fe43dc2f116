"""Gauss-Newton on the edges of all visible markers, from a good pose to the best one.

A blurred step is fitted to the image across each edge. It gives the distance of the edge from its
expected position; the correction is the pose delta that brings all edges into place together. The
idea is RAPiD's (Harris and Stennett, 1990); the profile fit, the bloom and the covariance are ours.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.edges import EdgeModel
from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Indices, run_starts
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.robust_statistics import quantile
from cubeling.tracking.refinement.edges.edge_fit import (
    MIN_EDGE_POINTS,
    EdgeFit,
    FittedEdges,
    covariance,
    fit_edges,
    without_doubtful_k1,
)
from cubeling.tracking.refinement.edges.profiles import (
    EdgeMeasurements,
    EdgeProfiles,
    place_profiles,
)

MIN_FACING_COSINE = 0.15
"""Cosine of the viewing angle below which the edges of a face are too foreshortened to help."""

WIDE_PX, NARROW_PX = 2.0, 1.0
"""Widths of the fitted step: a wide one finds edges that are farther off, a narrow one is exact."""

MAX_SHIFT_PX, MAX_PLACEMENTS = 0.7, 3
"""The profiles are placed again where an edge moves by more than this, but only so often."""

CONVERGED_PX, MAX_FITS = 0.12, 3
"""The profiles are measured again where an edge moved by more than this, as a step leaves some
hundredths of it; but only so often."""

REST_BLUR_PX = 0.03
"""A cube whose edges are blurred by less than this is expected to rest."""

BlurMotion = Callable[[Array], Array]
"""How a cube at a pose, (4, 4), moves during the exposure: a pose delta, (6,)."""


def at_rest(_: Array) -> Array:
    """Return the `BlurMotion` of a cube at rest."""
    return np.zeros(6)


@dataclass(frozen=True)
class EdgeRefinement:
    """A pose that rests on edges."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a pose delta, (6, 6)."""

    residual: float
    """Weighted root mean square distance of the edges from their expected positions [px]."""

    support: float
    """Share of the edge points in view that were found, 0…1."""

    line_count: int
    """Number of straight lines that the edge points lie on."""

    inner_support: float
    """The support of the edges inside the markers, which tell markers apart."""

    face_support: dict[str, float]
    """The support of each face in view."""

    sharpness_ratio: float
    """Steepness of the dullest edges over that of the sharpest, each relative to the expected blur;
    well below 1 where the cube moved in another way than expected."""

    sharpness: float
    """Median steepness of the edges relative to the expected blur; 1 in a sharp image."""

    edges: FittedEdges
    """The edges that the pose rests on."""


class EdgeRefiner:
    """Refines poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._model = EdgeModel.of(cube)
        self._projection = projection
        self._parts: dict[tuple[int, ...], EdgeModel] = {}

    def refine(
        self,
        patch: Patch,
        start: Array,
        blur_motion: BlurMotion = at_rest,
        readout_share: float = 0.0,
    ) -> EdgeRefinement | None:
        """Refine a pose, (4, 4), that is right to about half a cell in the image.

        `readout_share` is how long the rolling shutter takes, in exposure times. None where too few
        edges are in view or found, or where they do not agree.
        """
        current = start
        found, k1 = None, 0.0
        for _ in range(MAX_PLACEMENTS):
            profiles = self._profiles(patch, current, blur_motion(current), k1, readout_share)
            step = _fit_repeatedly(patch, profiles, wide=found is None) if profiles else None
            if profiles is None or step is None:
                return None
            found = current, profiles, step
            if np.abs(profiles.shifts(step.solution)).max() < MAX_SHIFT_PX:
                break
            current = se3.apply_delta(current, step.solution[:6])
            k1 += float(step.solution[8:].sum())
        return self._summary(*found) if found else None

    def _profiles(
        self, patch: Patch, pose: Array, blur_motion: Array, k1: float, readout_share: float
    ) -> EdgeProfiles | None:
        facing = self._faces.faces_towards(pose, MIN_FACING_COSINE)
        if facing not in self._parts:
            self._parts[facing] = self._model.of_faces(facing)
        profiles = place_profiles(
            self._parts[facing],
            self._projection,
            pose,
            patch,
            blur_motion,
            k1,
            readout_share * blur_motion,
        )
        return profiles if profiles and len(profiles.numbers) >= MIN_EDGE_POINTS else None

    def _summary(
        self, start: Array, profiles: EdgeProfiles, step: EdgeFit
    ) -> EdgeRefinement | None:
        kept = step.strong[step.robust > 0.1]
        if len(kept) < MIN_EDGE_POINTS:
            return None
        model = profiles.model
        numbers = profiles.numbers
        inner = ~model.outline[numbers]
        face, lines = model.face[numbers], model.line[numbers[kept]]
        count = len(self._faces.names)
        strong = step.strong
        spread = covariance(step, model.line[numbers[strong]], profiles.pixels[strong])
        if profiles.bends is not None:
            step = without_doubtful_k1(step, profiles.k1, float(spread[8, 8]))
        wanted = np.bincount(face, minlength=count)
        found = np.bincount(face[kept], minlength=count)
        return EdgeRefinement(
            se3.apply_delta(start, step.solution[:6]),
            spread[:6, :6],
            float(np.sqrt((step.robust * step.residual**2).sum() / step.robust.sum())),
            len(kept) / len(numbers),
            len(run_starts(lines)),
            float(np.count_nonzero(inner[kept])) / max(1, int(np.count_nonzero(inner))),
            {
                self._faces.names[number]: float(found[number] / wanted[number])
                for number in np.flatnonzero(wanted > 10).tolist()
            },
            *_sharpness(step.measured, kept, lines),
            FittedEdges(profiles, step),
        )


def _sharpness(measured: EdgeMeasurements, kept: Indices, lines: Indices) -> tuple[float, float]:
    """Return `sharpness_ratio` and `sharpness` of the lines."""
    starts = run_starts(lines)
    rise = np.add.reduceat(measured.rise[kept], starts)
    fitted = np.add.reduceat(measured.fitted[kept], starts)
    sharpness = rise / np.maximum(fitted, 1e-9)
    ratio = quantile(sharpness, 0.15) / max(quantile(sharpness, 0.85), 1e-9)
    return ratio, quantile(sharpness, 0.5)


def _fit_repeatedly(patch: Patch, profiles: EdgeProfiles, wide: bool) -> EdgeFit | None:
    """Fit until the edges stay in place: the profiles follow them, the geometry stays.

    Where a first, wide step moves them so far that they are placed again, it is the only one. A
    cube at rest needs none.
    """
    shifts = np.zeros(len(profiles.numbers))
    if wide and profiles.blur.max() < REST_BLUR_PX:
        step = fit_edges(patch, profiles, shifts, NARROW_PX)
        if step is not None and np.abs(profiles.shifts(step.solution)).max() < CONVERGED_PX:
            return step
    if wide:
        step = fit_edges(patch, profiles, shifts, WIDE_PX, steps=2)
        if step is None:
            return None
        shifts = profiles.shifts(step.solution)
        if np.abs(shifts).max() > MAX_SHIFT_PX:
            return step
    for _ in range(MAX_FITS):
        step = fit_edges(patch, profiles, shifts, NARROW_PX)
        if step is None:
            return None
        before, shifts = shifts, profiles.shifts(step.solution)
        if np.abs(shifts - before).max() < CONVERGED_PX:
            break
    return step
