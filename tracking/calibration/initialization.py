"""A first guess: the focal length that fits most views, and a pose for each view."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np

from cubeling.tracking.calibration import camera_vector
from cubeling.tracking.calibration.view import View
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.projection import Projection, planar_poses

FIELDS_OF_VIEW_RAD = np.deg2rad(np.linspace(30, 100, 15))
"""Horizontal fields of view to try: telephoto to action camera."""

MAX_VIEWS = 12
"""Maximum number of views to try them on."""

MAX_MISFIT = 0.04
"""The error of a view is limited to this, so that a wrong one does not decide [image widths]."""


def initial_camera(views: Sequence[View], size: tuple[int, int]) -> Array:
    """Return the parameters (9,) of the distortion-free camera that fits the views best.

    A few views of two faces or of a tilted one determine the focal length to some percent.
    """
    indices = np.unique(np.linspace(0, len(views) - 1, MAX_VIEWS).astype(int))
    chosen = [views[i] for i in indices]
    centre = (size[0] - 1) / 2, (size[1] - 1) / 2
    focals = size[0] / 2 / np.tan(FIELDS_OF_VIEW_RAD / 2)
    cameras = [np.array([focal, focal, *centre, 0, 0, 0, 0, 0]) for focal in focals]
    return min(cameras, key=lambda camera: _misfit(chosen, camera, size))


def _misfit(views: Sequence[View], camera: Array, size: tuple[int, int]) -> float:
    errors = [min((error for _, error in _poses(view, camera)), default=np.inf) for view in views]
    return float(np.minimum(errors, MAX_MISFIT * size[0]).mean())


def best_pose(view: View, camera: Array) -> Array | None:
    """Return `camera_from_target` of a view, (4, 4); None if no pose fits its points."""
    found = min(_poses(view, camera), key=lambda pair: pair[1], default=None)
    return None if found is None else found[0]


def _poses(view: View, camera: Array) -> Iterator[tuple[Array, float]]:
    """Propose poses of a view, each with its root mean square error [px].

    The pose of a single plate is ambiguous: each plate proposes both of its poses, and each
    proposal is refined on the points of all plates.
    """
    projection = Projection(camera_vector.to_intrinsics(camera, (1, 1)))
    rays = projection.rays(view.pixels)
    starts = [
        pose
        for own in (view.plates == number for number in np.unique(view.plates))
        for pose in planar_poses(view.points[own], rays[own], cv2.SOLVEPNP_IPPE)
    ]
    for start in starts:
        guess = se3.rotation_vector(start[:3, :3])[:, None], start[:3, 3:].copy()
        rotation, origin = cv2.solvePnPRefineLM(view.points, rays, np.eye(3), None, *guess)
        pose = se3.pose(se3.rotation(np.ravel(rotation)), np.ravel(origin))
        points = view.points @ pose[:3, :3].T + pose[:3, 3]
        if np.isfinite(points).all() and points[:, 2].min() > 0.01:
            pixels = projection.project(points)
            errors = np.einsum("ni,ni->n", view.normals, view.pixels - pixels)
            yield pose, float(np.sqrt((errors**2).mean()))
