"""The corners of the cube's markers in one picture, as detected or by all of their edges."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.markers import Observation
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.geometry.robust_statistics import quantile, robust_weight
from cubeling.tracking.refinement.edges.edge_fit import MIN_OUTLIER_PX, FittedEdges
from cubeling.tracking.refinement.lens_estimate import BLUR_ERROR_SHARE, MAX_BLUR_PX
from cubeling.tracking.refinement.systematic_error import CORNER_ERROR_PX

DETECTED_CORNER_PX = 0.45
"""Error of a corner that OpenCV has detected, along each axis, one standard deviation: how white
grows over black moves those of each face by another amount."""

MIN_FACE_EDGES = 40
"""Fewer edge points do not show how a face is bent in the picture."""

ROBUST_STEPS = 3
"""How often the weights of edges are found, as in `fit_edges`."""

POINTS_ALIKE = 8.0
"""So many points of an edge have their error in common: that of light, print and pixel phase."""

HOMOGRAPHY_SPREAD_PX = 3.0
"""How far edges may be from where the pose puts them, one standard deviation."""


@dataclass(frozen=True)
class FaceCorners:
    """The marker of one face in one picture."""

    face: str
    """Name of the face."""

    corners: Array
    """Its corners in the image, (4, 2) [px], in the order of `Face.corners`."""

    error_px: float
    """Error of a corner along each axis, one standard deviation, besides that of the paper."""

    @property
    def width(self) -> float:
        """Width of the marker across its longest side [px]: a slanted one is narrow."""
        sides = self.corners - np.roll(self.corners, 1, axis=0)
        (a, b), (c, d) = self.corners[2] - self.corners[0], self.corners[3] - self.corners[1]
        return float(abs(a * d - b * c) / 2 / np.linalg.norm(sides, axis=1).max())


def detected_faces(observations: Sequence[Observation]) -> list[FaceCorners]:
    """Return the faces of detected markers; none where one was detected twice."""
    names = [each.face.name for each in observations]
    if len(set(names)) < len(names):
        return []
    return [FaceCorners(each.face.name, each.corners, DETECTED_CORNER_PX) for each in observations]


def fitted_faces(
    cube: CubeModel,
    projection: Projection,
    camera_from_cube: Array,
    faces: Sequence[str],
    edges: FittedEdges,
) -> list[FaceCorners]:
    """Return where the edges of some faces put the corners of their markers.

    Edges are not where the pose, (4, 4), puts them, as that holds for a cube and a lens that may
    both be wrong. How they differ is fitted as a homography of each face by itself.
    """
    profiles, fit = edges.profiles, edges.fit
    blur = quantile(profiles.blur, 0.5)
    if blur > MAX_BLUR_PX:
        return []
    residual = edges.residual_without_k1
    common = float(np.hypot(CORNER_ERROR_PX, BLUR_ERROR_SHARE * blur))
    found = []
    for number, face in enumerate(cube.faces):
        chosen = profiles.face[fit.strong] == number
        if face.name not in faces or np.count_nonzero(chosen) < MIN_FACE_EDGES:
            continue
        points = fit.strong[chosen]
        places = profiles.model.points[profiles.numbers[points]]
        fields = _homography_fields(projection, camera_from_cube, face.corners, places)[1]
        rows = np.einsum("ni,nij->nj", profiles.normals[points], fields)
        pixels, at_corners = _homography_fields(
            projection, camera_from_cube, face.corners, face.corners
        )
        prior = np.einsum("nij,nik->jk", at_corners, at_corners) / HOMOGRAPHY_SPREAD_PX**2
        solution, covariance = _robust_solution(
            rows, residual[chosen], fit.measured.information[points], prior
        )
        own = float(np.einsum("nij,jk,nik->", at_corners, covariance, at_corners)) / 8
        error = float(np.hypot(common, np.sqrt(POINTS_ALIKE * own)))
        found.append(FaceCorners(face.name, pixels + at_corners @ solution, error))
    return found


def _robust_solution(
    rows: Array, residual: Array, information: Array, prior: Array
) -> tuple[Array, Array]:
    """Solve for the homography of a face by its edges, without those that do not fit it.

    Returns it, (8,), and its covariance if all edge points were independent, (8, 8).

    The weights of the pose would not do: what does not fit a wrong lens is no outlier.
    """
    weights: Array = information
    solution: Array = np.zeros(8)
    normal: Array = prior
    for _ in range(ROBUST_STEPS):
        weighted = rows * weights[:, None]
        normal = np.asarray(weighted.T @ rows + prior, np.float64)
        solution = np.asarray(np.linalg.solve(normal, weighted.T @ residual), np.float64)
        off = residual - rows @ solution
        weights = np.asarray(information * robust_weight(off, MIN_OUTLIER_PX), np.float64)
    return np.asarray(solution, np.float64), np.asarray(np.linalg.inv(normal), np.float64)


def _homography_fields(
    projection: Projection, camera_from_cube: Array, corners: Array, places: Array
) -> tuple[Array, Array]:
    """Return where places on a face are seen, and how its eight small homographies move them.

    `corners` are those of its marker, (4, 3). Pixels, (N, 2), and moves, (N, 2, 8) [px].
    """
    middle = corners.mean(axis=0)
    axes = np.stack([corners[1] - corners[0], corners[0] - corners[3]]) / 2
    flat = (places - middle) @ axes.T / np.square(axes).sum(axis=1)
    rotated = places @ camera_from_cube[:3, :3].T
    pixels, by_point = projection.project_with_jacobian(rotated + camera_from_cube[:3, 3])
    by_flat = by_point @ (camera_from_cube[:3, :3] @ axes.T)
    u, v = flat.T
    one, zero = np.ones_like(u), np.zeros_like(u)
    along = np.stack([one, zero, u, v, zero, zero, u * u, u * v], axis=1)
    up = np.stack([zero, one, zero, zero, u, v, u * v, v * v], axis=1)
    return pixels, np.asarray(by_flat @ np.stack([along, up], axis=1), np.float64)
