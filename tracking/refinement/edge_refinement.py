"""Gauss-Newton on the edges of all visible markers: from a good pose to the best one.

Where the model says that an edge runs, the picture is sampled across it. A blurred step is fitted
to each such profile, which tells how far the edge lies from its place to a few hundredths of a
pixel; a shift-turn that takes all edges home together is the correction. The idea is RAPiD's
(Harris and Stennett, 1990); the profile fit, the bloom and the covariance are ours.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracking.cube.edges import EdgeModel
from tracking.cube.faces import FacePlanes
from tracking.cube.model import CubeModel
from tracking.geometry import se3
from tracking.geometry.image_region import Patch
from tracking.geometry.projection import Projection
from tracking.geometry.robust_statistics import quantile
from tracking.refinement.edge_fit import FEWEST, EdgeFit, covariance, fit
from tracking.refinement.profiles import EdgeMeasurements, EdgeProfiles, lay_out

Array = NDArray[np.float64]

GRAZING = 0.15
"""Cosine of the viewing angle below which the edges of a face are too foreshortened to help."""

WIDE = 5.0
PRECISE: tuple[float, ...] = (2.0, 1.0)
"""Widths of the step that is fitted [px]: in the wide search, and first and last otherwise."""

CLOSE = 0.7
"""Once no edge moves by more than this [px] the profiles need not be laid out anew."""

STEADY = 0.04
"""The profiles are measured again while edges move by more than this [px]."""

LAYOUTS = 3
"""So often they are laid out at most."""


@dataclass(frozen=True)
class EdgeRefinement:
    """A pose that rests on edges."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a shift-turn, (6, 6)."""

    residual: float
    """Weighted root mean square distance of the edges from their places [px]."""

    support: float
    """Share of the edge points in view that were found, 0…1."""

    points: int
    """Number of edge points found."""

    lines: int
    """Number of straight lines that they lie on."""

    inner: float
    """The same share for the edges inside the markers, which tell them apart."""

    shares: dict[str, float]
    """The same share for each face in view."""

    crisp: float
    """How steep the dullest edges are beside the steepest, both against what the sweep makes them;
    well below 1 where the cube moved in a way that was not told."""

    steep: float
    """How steep the edges are beside sharp ones that are swept as told; 1 in a sharp picture."""


class EdgeRefiner:
    """Refines poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._faces = FacePlanes(cube)
        self._model = EdgeModel.of(cube)
        self._projection = projection
        self._parts: dict[tuple[int, ...], EdgeModel] = {}

    def refine(
        self, patch: Patch, start: Array, sweep: Array | None = None, wide: bool = False
    ) -> EdgeRefinement | None:
        """Refine a pose that is right to about half a cell in the picture, or a whole one.

        Parameters
        ----------
        patch
            The picture round the cube.
        start
            Pose of the cube, (4, 4).
        sweep
            Shift-turn of the cube while the shutter was open, (6,); None for a cube at rest.
        wide
            Whether to begin with the outlines alone, which can be found from a whole cell away.

        Returns
        -------
        None where too few edges are in view or found, or where they do not agree.
        """
        current = start
        for _ in range(2 if wide else 0):
            rough = self._profiles(patch, current, sweep, True)
            step = fit(patch, rough, None, WIDE) if rough else None
            if step is None:
                return None
            current = se3.moved(current, step.solution[:6])
        found, blurs = None, PRECISE
        for _ in range(LAYOUTS):
            profiles = self._profiles(patch, current, sweep, False)
            step = _converged(patch, profiles, blurs) if profiles else None
            if profiles is None or step is None:
                return None
            found, blurs = (current, profiles, step), PRECISE[1:]
            if np.abs(profiles.slopes @ step.solution[:6]).max() < CLOSE:
                break
            current = se3.moved(current, step.solution[:6])
        return self._judged(*found) if found else None

    def _profiles(
        self, patch: Patch, pose: Array, sweep: Array | None, wide: bool
    ) -> EdgeProfiles | None:
        facing = self._faces.facing(pose, GRAZING)
        if facing not in self._parts:
            self._parts[facing] = self._model.of_faces(facing)
        profiles = lay_out(self._parts[facing], self._projection, pose, patch, sweep, wide)
        return profiles if profiles and len(profiles.numbers) >= FEWEST else None

    def _judged(self, start: Array, profiles: EdgeProfiles, step: EdgeFit) -> EdgeRefinement | None:
        kept = step.strong[step.robust > 0.1]
        if len(kept) < FEWEST:
            return None
        model = profiles.model
        numbers = profiles.numbers
        inner = ~model.outline[numbers]
        face = model.face[numbers]
        count = len(self._faces.names)
        wanted = np.bincount(face, minlength=count)
        found = np.bincount(face[kept], minlength=count)
        return EdgeRefinement(
            se3.moved(start, step.solution[:6]),
            covariance(step, model.line[numbers[step.strong]], profiles.pixels[step.strong]),
            float(np.sqrt((step.robust * step.residual**2).sum() / step.robust.sum())),
            len(kept) / len(numbers),
            len(kept),
            len(np.unique(model.line[numbers[kept]])),
            float(np.count_nonzero(inner[kept])) / max(1, int(np.count_nonzero(inner))),
            {
                self._faces.names[number]: float(found[number] / wanted[number])
                for number in np.flatnonzero(wanted > 10).tolist()
            },
            *_sharpness(step.measured, kept, model.line[numbers[kept]]),
        )


def _sharpness(
    measured: EdgeMeasurements, kept: NDArray[np.intp], lines: NDArray[np.intp]
) -> tuple[float, float]:
    """Compare the steepness of lines with each other, and with what it should be."""
    starts = np.flatnonzero(np.diff(lines, prepend=-1))
    rise = np.add.reduceat(measured.rise[kept], starts)
    fitted = np.add.reduceat(measured.fitted[kept], starts)
    steep = rise / np.maximum(fitted, 1e-9)
    return quantile(steep, 0.15) / max(quantile(steep, 0.85), 1e-9), quantile(steep, 0.5)


def _converged(patch: Patch, profiles: EdgeProfiles, blurs: tuple[float, ...]) -> EdgeFit | None:
    """Fit until the edges stay where they are: the profiles follow them, the geometry stays."""
    shifts: Array | None = None
    step: EdgeFit | None = None
    for blur in (*blurs, *PRECISE[1:] * 2):
        step = fit(patch, profiles, shifts, blur)
        if step is None:
            return None
        before, shifts = shifts, profiles.slopes @ step.solution[:6]
        if before is not None and np.abs(shifts - before).max() < STEADY:
            break
    return step
