"""The unknowns of a calibration: their residuals, derivatives and priors."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from cubeling.tracking.calibration import camera_vector
from cubeling.tracking.calibration.view import View, join_views
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Flags, Indices

PLATE_SHIFT_SIGMA_M, PLATE_ROTATION_SIGMA_RAD = 0.0012, np.deg2rad(1.2)
"""Prior standard deviations of a face of a hand-made cube about its nominal pose."""

BLOOM_SIGMA_PX = 0.3
"""Prior standard deviation of the bloom of white over black."""

MIN_DEPTH_M = 0.02
"""Points nearer to the camera are moved to this depth, so that the projection stays finite."""


@dataclass(frozen=True)
class CalibrationTarget:
    """What is known about the target and the images, and which unknowns are free."""

    size: tuple[int, int]
    """Size of the images [px]."""

    free: Flags
    """Which of the camera's parameters are free, (9,)."""

    centres: Array
    """Nominal centre of each plate, about which it rotates, (P, 3) [m]."""

    adjust_plates: bool
    """Whether the poses of the plates are free. False for a board: its one plate is the target."""


@dataclass(frozen=True)
class CalibrationModel:
    """Values of all unknowns of a calibration."""

    target: CalibrationTarget
    """What the unknowns describe."""

    camera: Array
    """Parameters of the camera, (9,); see `camera_vector`."""

    plates: Array
    """`target_from_plate` of each plate, (P, 4, 4): the actual pose of a plate relative to its
    nominal pose. Identity for a perfect target."""

    poses: Array
    """`camera_from_target` of each view, (V, 4, 4)."""

    blooms: Array
    """How far white grows over black in each view [px], (V,)."""

    @property
    def free_parameters(self) -> Indices:
        """Indices of the free ones among the 9 + 6 P parameters of camera and plates."""
        free = np.full(9 + 6 * len(self.plates), self.target.adjust_plates)
        free[:9] = self.target.free
        return np.flatnonzero(free)

    def residuals(self, views: Sequence[View]) -> list[Array]:
        """Return measured minus predicted position of each view's rows [px], each (N,)."""
        rows, numbers = self._join_views(views)
        pixels = camera_vector.project(self.camera, self._place(rows, numbers)[2])
        ends = np.cumsum([len(view.points) for view in views])
        return np.split(self._misses(rows, numbers, pixels), ends[:-1])

    def linearise(self, views: Sequence[View]) -> tuple[Array, Array, Array, Array]:
        """Return the residuals of all rows (N,) [px] and derivatives of their prediction.

        These are by the camera (N, 9), by the pose of a row's plate (N, 6), and by the pose and
        bloom of its view (N, 7). Steps of poses are as in `se3.moved`.
        """
        rows, numbers = self._join_views(views)
        from_plate, from_target, in_camera = self._place(rows, numbers)
        pixels, by_point, by_camera = camera_vector.project_with_jacobian(self.camera, in_camera)
        by_point = np.einsum("ni,nij->nj", rows.normals, by_point)
        by_camera = np.einsum("ni,nij->nj", rows.normals, by_camera)
        by_shift = np.einsum("ni,nij->nj", by_point, self.poses[numbers, :3, :3])
        by_plate = np.concatenate([by_shift, se3.cross(from_plate, by_shift)], axis=1)
        by_pose = [by_point, se3.cross(from_target, by_point)]
        by_view = np.concatenate([*by_pose, rows.bloom[:, None]], axis=1)
        return self._misses(rows, numbers, pixels), by_camera, by_plate, by_view

    def _join_views(self, views: Sequence[View]) -> tuple[View, Indices]:
        """Return the rows of all views, and the number of each row's view, (N,)."""
        counts = [len(view.points) for view in views]
        return join_views(0.0, views), np.repeat(np.arange(len(views)), counts)

    def _place(self, rows: View, numbers: Indices) -> tuple[Array, Array, Array]:
        """Place the points of rows of the views with these numbers, (N, 3) each [m].

        From their plate's centre; from the target's origin along the camera's axes; in the camera.
        """
        centres, plates = self.target.centres[rows.plates], self.plates[rows.plates]
        poses = self.poses[numbers]
        from_plate = np.einsum("nij,nj->ni", plates[:, :3, :3], rows.points - centres)
        in_target = from_plate + centres + plates[:, :3, 3]
        from_target = np.einsum("nij,nj->ni", poses[:, :3, :3], in_target)
        points = from_target + poses[:, :3, 3]
        near = points[:, 2:] < MIN_DEPTH_M
        points = np.where(near, points * (1, 1, 0) + (0, 0, MIN_DEPTH_M), points)
        return from_plate, from_target, points

    def _misses(self, rows: View, numbers: Indices, pixels: Array) -> Array:
        """Return how far rows were measured from predicted pixels, (N,) [px]."""
        away = np.einsum("ni,ni->n", rows.normals, rows.pixels - pixels)
        return np.asarray(away - rows.bloom * self.blooms[numbers], np.float64)

    @property
    def prior_cost(self) -> float:
        """The cost of camera and plates by their priors alone."""
        rows, values = self._camera_prior()
        cost = float(((rows @ self.camera - values) ** 2).sum())
        for plate in self.plates if self.target.adjust_plates else ():
            step = se3.delta(np.eye(4), plate)
            cost += float((step[:3] ** 2).sum()) / PLATE_SHIFT_SIGMA_M**2
            cost += float((step[3:] ** 2).sum()) / PLATE_ROTATION_SIGMA_RAD**2
        return cost

    def add_priors(self, normal: Array, right: Array) -> None:
        """Add the priors of camera and plates to the shared normal equations, in place."""
        rows, values = self._camera_prior()
        normal[:9, :9] += rows.T @ rows
        right[:9] -= rows.T @ (rows @ self.camera - values)
        weights = np.repeat(1 / np.square((PLATE_SHIFT_SIGMA_M, PLATE_ROTATION_SIGMA_RAD)), 3)
        for number, plate in enumerate(self.plates):
            at = slice(9 + 6 * number, 15 + 6 * number)
            normal[at, at] += np.diag(weights)
            right[at] -= weights * se3.delta(np.eye(4), plate)

    def _camera_prior(self) -> tuple[Array, Array]:
        return camera_vector.prior(self.target.size, self.camera[0], self.target.free)

    def apply_step(self, shared: Array, by_view: Array) -> Self:
        """Apply a step of camera and plates (9 + 6 P,) and one of each view (V, 7)."""
        camera, width = self.camera + shared[:9], self.target.size[0]
        # A single bad step must not take the focal length out of the range of real cameras.
        camera[:2] = np.clip(camera[:2], 0.2 * width, 8 * width)
        plate_steps = zip(self.plates, shared[9:].reshape(-1, 6), strict=True)
        plates = [se3.apply_delta(plate, step) for plate, step in plate_steps]
        poses = [
            se3.apply_delta(pose, step[:6]) for pose, step in zip(self.poses, by_view, strict=True)
        ]
        blooms = self.blooms + by_view[:, 6]
        return replace(
            self, camera=camera, plates=np.array(plates), poses=np.array(poses), blooms=blooms
        )
