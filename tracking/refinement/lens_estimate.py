"""How far the lens bends the picture beyond what its intrinsics claim, measured in play.

A pose explains where a face is seen, but not that a face at the edge of the picture is stretched.
So every frame tells a little of the radial distortion k1. What else could stretch faces is unknown
as well: the focal length, and how the cube was folded. All of these are solved together as in a
bundle adjustment, of which only the normal equations are kept (Triggs et al., 2000, section 6.1).
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Indices
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.robust_statistics import quantile
from cubeling.tracking.refinement.edges.edge_fit import PRIOR_INFORMATION, FittedEdges
from cubeling.tracking.refinement.edges.profiles import EdgeProfiles
from cubeling.tracking.refinement.systematic_error import (
    CLAIMED_K1,
    CORNER_ERROR_M,
    CORNER_ERROR_PX,
    MEASURED_K1,
)

K1_SPREAD, FOCAL_SPREAD, FOLD_SPREAD = 0.5, 0.2, (0.0005, np.deg2rad(0.6))
"""Standard deviations before anything is measured: of k1, of the focal length as a share of it, and
of where a face was glued [m, rad]."""

MEASUREMENTS_PER_FACE = 8
"""Independent errors of all edges of a bent marker: those of its four corners along two axes."""

BLUR_ERROR_SHARE, MAX_BLUR_PX = 0.1, 3.0
"""Error of an edge as a share of its motion blur, and median blur [px] above which a frame tells
nothing: a rolling shutter slants a moving cube, too."""

POINT_STEP = 3
"""Every so many points of the edges are enough: those between are bent alike."""

NEW_POSE = (0.02, np.deg2rad(10))
"""Only a pose that differs by so much from all that were counted tells anything new [m, rad]."""

MAX_FRAMES = 200
"""Frames that are counted at most."""

KNOWN_DEVIATION, MAX_K1, MAX_DEVIATIONS = 0.03, 0.05, 3.0
"""Standard deviation from which on k1 is known, and the k1 that an honest lens may have, absolute
and in standard deviations."""


KNOWN_FOCAL_DEVIATION = 0.007
"""Standard deviation, as a share, from which on a focal length is known."""

MIN_GAIN = 0.8
"""Another focal length is worth taking once its standard deviation has shrunk to this share of that
of the one in use, or where that is wrong by more than half of one."""


@dataclass(frozen=True)
class FocalLength:
    """The focal length of a camera, as far as it is known."""

    scale: float
    """Multiple of the focal lengths of the intrinsics at the beginning."""

    deviation: float
    """Standard deviation, as a share of it."""

    @property
    def known(self) -> bool:
        """Whether play would not tell it better."""
        return self.deviation <= KNOWN_FOCAL_DEVIATION

    def is_better(self, other: "FocalLength") -> bool:
        """Whether this is worth taking instead of another one.

        >>> FocalLength(1.01, 0.03).is_better(FocalLength(1.0, 0.035))
        False
        >>> FocalLength(1.01, 0.02).is_better(FocalLength(1.0, 0.035))
        True
        """
        wrong = abs(np.log(self.scale / other.scale)) > self.deviation / 2
        return bool(wrong or self.deviation < MIN_GAIN * other.deviation)


@dataclass(frozen=True)
class LensEstimate:
    """What was measured of a lens beyond what its intrinsics claim."""

    k1: float = 0.0
    """Radial distortion in OpenCV's model, besides that of the intrinsics."""

    deviation: float = K1_SPREAD
    """Standard deviation of `k1`."""

    @property
    def known(self) -> bool:
        """Whether it was measured well enough."""
        return self.deviation < KNOWN_DEVIATION

    @property
    def off(self) -> bool:
        """Whether the lens surely is not as its intrinsics claim.

        >>> LensEstimate(0.1, 0.01).off, LensEstimate(0.1, 0.04).off, LensEstimate(0.03, 0.005).off
        (True, False, False)
        """
        return self.known and abs(self.k1) > max(MAX_K1, MAX_DEVIATIONS * self.deviation)


class LensEstimator:
    """Collects what the edges of cubes say of the lens of one camera."""

    def __init__(self, cubes: Sequence[CubeModel], projection: Projection) -> None:
        counts = (len(cube.faces) for cube in cubes)
        *self._first_faces, self._faces = itertools.accumulate(counts, initial=0)
        spreads = [K1_SPREAD, FOCAL_SPREAD, *np.repeat(FOLD_SPREAD, 3).tolist() * self._faces]
        self._information = np.diag(1 / np.square(spreads))
        self._score = np.zeros(len(spreads))
        self._square, self._freedom = 0.0, 0.0
        self._counted = np.empty((0, 12))
        self._projection = projection
        self.estimate = LensEstimate()
        """The best estimate."""

    @property
    def k1_error(self) -> float:
        """How far k1 is from what the intrinsics claim, one standard deviation."""
        found = self.estimate
        if found.off or (found.known and self._projection.claims_no_distortion):
            return float(np.hypot(found.k1, found.deviation))
        return CLAIMED_K1 if self._projection.claims_no_distortion else MEASURED_K1

    def look_through(self, projection: Projection) -> None:
        """Go on with another focal length, which must be nearly the same."""
        change = np.log(projection.matrix[0, 0] / self._projection.matrix[0, 0])
        # What was measured of the focal length was measured from the one before.
        self._score = self._score - self._information[:, 1] * change
        self._projection = projection

    def learn(self, camera_from_cube: Array, edges: FittedEdges, cube: int = 0) -> None:
        """Learn from the edges of a trusted pose, (4, 4), that differs from all before.

        `cube` is the number of the cube.
        """
        face = edges.profiles.face[edges.fit.strong]
        one_face = face[0] == face[-1]
        if one_face or len(self._counted) >= MAX_FRAMES or not self._is_new(camera_from_cube):
            return
        blur = quantile(edges.profiles.blur, 0.5)
        if blur > MAX_BLUR_PX:
            return
        self._counted = np.vstack([self._counted, _flat(camera_from_cube)])
        self._add(camera_from_cube, edges, self._first_faces[cube], blur)
        inverse = np.linalg.inv(self._information)
        found = inverse @ self._score
        # Where edges scatter more than paper does, so does k1.
        chi = (self._square - float(self._score @ found)) / max(self._freedom, 1.0)
        deviation = np.sqrt(inverse[0, 0] * max(1.0, chi))
        self.estimate = LensEstimate(float(found[0]), float(deviation))

    def _is_new(self, pose: Array) -> bool:
        shift, angle = NEW_POSE
        flat = _flat(pose)
        apart = np.square(self._counted[:, 9:] - flat[9:]).sum(axis=1)
        traces = self._counted[:, :9] @ flat[:9]
        return bool(((apart > shift**2) | (traces < 1 + 2 * np.cos(angle))).all())

    def _add(self, pose: Array, edges: FittedEdges, first_face: int, blur: float) -> None:
        """Add the equations of one frame, less what its pose and its blooms explain."""
        fit = edges.fit
        used = np.flatnonzero(fit.robust > 0)[::POINT_STEP]
        points = fit.strong[used]
        face = edges.profiles.face[points] + first_face
        pixels = float(self._projection.matrix[0, 0]) / float(pose[2, 3])
        errors = (CORNER_ERROR_PX, CORNER_ERROR_M * pixels, BLUR_ERROR_SHARE * blur)
        # Without the robust weights: a wrong lens is no outlier.
        weights = fit.measured.information[points]
        totals = np.bincount(face, weights, self._faces)
        weights = weights * MEASUREMENTS_PER_FACE / (totals[face] * np.square(errors).sum())
        own, shared = fit.rows[used, :8], self._shared_rows(pose, edges.profiles, points, face)
        residual = edges.residual_without_k1[used]
        weighted, own_weighted = shared * weights[:, None], own * weights[:, None]
        normal = own_weighted.T @ own + PRIOR_INFORMATION[:8, :8]
        cross = own_weighted.T @ shared
        residual = residual - own @ np.linalg.solve(normal, own_weighted.T @ residual)
        self._information += weighted.T @ shared - cross.T @ np.linalg.solve(normal, cross)
        self._score += weighted.T @ residual
        self._square += float(weights @ residual**2)
        self._freedom += MEASUREMENTS_PER_FACE * np.count_nonzero(totals) - own.shape[1]

    def _shared_rows(
        self, pose: Array, profiles: EdgeProfiles, points: Indices, face: Indices
    ) -> Array:
        """Jacobian of edge positions by what all frames share, (M, 2 + 6 faces) [px].

        `points` are indices of profiles, (M,), and `face` the number of each one's face.
        """
        rotation, camera, zero = pose[:3, :3], self._projection, np.zeros(3)
        places = profiles.model.points[profiles.numbers[points]] @ rotation.T + pose[:3, 3]
        by_all = cv2.projectPoints(places, zero, zero, camera.matrix, camera.distortion)[1]
        # OpenCV's columns: turn (3), shift (3), fx, fy, cx, cy, k1 …
        by_focal = by_all[:, 6] * camera.matrix[0, 0] + by_all[:, 7] * camera.matrix[1, 1]
        by_lens = np.stack([by_all[:, 10], by_focal], axis=1).reshape(-1, 2, 2)
        lens = np.einsum("ni,nij->nj", profiles.normals[points], by_lens)
        # A fold moves its face along the axes of the cube.
        slopes = (profiles.slopes[points].reshape(-1, 2, 3) @ rotation).reshape(-1, 1, 6)
        own_face = face[:, None] == np.arange(self._faces)
        folds = (own_face[:, :, None] * slopes).reshape(len(points), -1)
        return np.concatenate([lens, folds], axis=1)


def _flat(pose: Array) -> Array:
    """Rotation and position of a pose, (4, 4) → (12,)."""
    return np.concatenate([pose[:3, :3].ravel(), pose[:3, 3]])
