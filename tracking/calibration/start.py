"""A first guess: the focal length that most views agree with, and a pose for each view."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from tracking.calibration import lens
from tracking.calibration.view import View
from tracking.geometry import se3

Array = NDArray[np.float64]

FIELDS_OF_VIEW = np.deg2rad(np.linspace(30, 100, 15))
"""Horizontal fields of view that are tried: telephoto to action camera."""

MOST = 12
"""Views that the focal length is sought with."""

BAD = 0.04
"""A view whose points are off by more than this [picture widths] is cut there when they are
summed."""


def first_camera(views: Sequence[View], size: tuple[int, int]) -> Array:
    """Return the camera's nine numbers with the focal length that explains the views best.

    Lens and principal point are those of a perfect camera. A handful of views that show two faces
    or a tilted one tell the focal length to some percent, which is all that is needed here.
    """
    chosen = [views[i] for i in np.unique(np.linspace(0, len(views) - 1, MOST).astype(int))]
    cameras = [perfect(size, field) for field in FIELDS_OF_VIEW]
    return min(cameras, key=lambda camera: _misfit(chosen, camera, size))


def perfect(size: tuple[int, int], field: float) -> Array:
    """Return the nine numbers of a camera without distortion, by its field of view [rad]."""
    focal = size[0] / 2 / np.tan(field / 2)
    return np.array([focal, focal, (size[0] - 1) / 2, (size[1] - 1) / 2, 0, 0, 0, 0, 0])


def _misfit(views: Sequence[View], camera: Array, size: tuple[int, int]) -> float:
    away = [min((off for _, off in poses(view, camera)), default=np.inf) for view in views]
    return float(np.minimum(away, BAD * size[0]).mean())


def best_pose(view: View, camera: Array) -> Array | None:
    """Return `camera_from_target` of a view, (4, 4); None where its points fit no pose."""
    found = min(poses(view, camera), key=lambda pair: pair[1], default=None)
    return None if found is None else found[0]


def poses(view: View, camera: Array) -> Iterator[tuple[Array, float]]:
    """Propose poses for a view, each with its root mean square error [px].

    One plate has two poses that look alike (Collins and Bartoli, 2014); of several plates each
    proposes its own, and the fit of all of them together is the last proposal.
    """
    fitted = lens.camera(camera, (1, 1))
    rays = np.asarray(
        cv2.undistortPoints(view.pixels[:, None], fitted.matrix, fitted.distortion)[:, 0],
        np.float64,
    )
    starts = [
        pose
        for number in view.plate_numbers
        for pose in _of_plate(view.points[view.plates == number], rays[view.plates == number])
    ]
    for start in starts:
        turn, origin = cv2.solvePnPRefineLM(
            view.points,
            rays,
            np.eye(3),
            None,
            se3.rotation_vector(start[:3, :3])[:, None],
            start[:3, 3:].copy(),
        )
        pose = se3.pose(se3.rotation(np.ravel(turn)), np.ravel(origin))
        seen = view.points @ pose[:3, :3].T + pose[:3, 3]
        if np.isfinite(seen).all() and seen[:, 2].min() > 0.01:
            pixels = lens.projected(camera, seen)[0]
            away = np.einsum("ni,ni->n", view.normals, view.pixels - pixels)
            yield pose, float(np.sqrt((away**2).mean()))


def _of_plate(points: Array, rays: Array) -> Iterator[Array]:
    found, turns, origins = cv2.solvePnPGeneric(
        points, rays, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
    )[:3]
    for turn, origin in zip(turns, origins, strict=True) if found else ():
        vectors = np.array([turn, origin], np.float64).reshape(2, 3)
        if np.isfinite(vectors).all():
            yield se3.pose(se3.rotation(vectors[0]), vectors[1])
