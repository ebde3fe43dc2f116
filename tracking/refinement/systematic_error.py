"""What no residual shows: how far paper, light and lens may have moved a pose.

Every marker is taken to be bent a little: each of its corners is displaced in the image, by blur
and light, and on the paper, by print and folds. A lens that was never measured has another
distortion and another focal length than it says. All edges of a face move together then, so the
pose moves and the residuals stay small.
"""

import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.projection import Projection, radial_bend

CORNER_ERROR_PX, CORNER_ERROR_M = 0.1, 0.00012
"""Displacement of a marker's corner along each axis, one standard deviation: by light, blur and
pixels, and by print, folds and a moving hand. Measured on photographs of one object at two sizes,
which `make bench-photographs` shows."""

SHAPE_FREEDOM, RESIDUAL_SHARE = 2, 0.3
"""A lone marker has so many degrees of freedom beyond its pose, by which the residual of its edges
shows how far its corners are displaced, and how large that residual then is as a share of the
displacement (`test_systematic_error`)."""

BLUR_SHARE, SHARP_PX = 0.5, 0.7
"""Displacement of a corner as a share of the blur beyond that of a focused lens [px]: what blurs is
not a round lens alone, and motion in one direction leans a body by up to 4°. Measured as the
coverage of blurred photographs."""

COMMON_SHIFT_PX = 0.15
"""Displacement of the whole cube in the image, along each axis, one standard deviation."""

UNSTATED_FOCAL = 0.016
"""Standard deviation of the focal length, as a share of it, of a lens whose file does not state it:
those of makers of cameras and of other programs are off by 2 to 3 % (`make bench-photographs`)."""

MAX_LINEAR_FOCAL, FOCAL_CURVATURE = 0.05, 0.15
"""Standard deviation of a focal length, as a share, up to which a pose moves in proportion to it,
and by how much a larger one moves it besides, by its square: turns [rad], and shifts as a multiple
of half a marker (`test_measured_lens`)."""

MEASURED_K1, CLAIMED_K1 = 0.005, 0.1
"""Error of k1 of a lens that was measured, and of one that claims no distortion: hardly any has
none. One standard deviation, as it is before play tells more."""


class SystematicError:
    """Such errors of the poses of one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._projection = projection
        self._corners = {face.name: face.corners for face in cube.faces}
        self._half = cube.marker_size / 2
        stated = projection.intrinsics.focal_deviation
        self._centre = projection.intrinsics.centre_deviation
        self._focal = UNSTATED_FOCAL if stated is None else stated

    def covariance(
        self,
        camera_from_cube: Array,
        faces: tuple[str, ...],
        k1_error: float,
        blur: float = 0.0,
        lone_residual: float | None = None,
    ) -> tuple[Array, Array]:
        """Covariance of a pose delta by the corners of `faces`, (6, 6), and how the lens moves it.

        The latter are the pose deltas by one standard deviation of k1, of the focal length and of
        the principal point, and those by which a guessed focal length moves the pose besides along
        and about each axis, (6, 10).
        `k1_error` is how far the radial distortion is off, and `blur` the blur of the image [px],
        one standard deviation each. Where the lens was never measured, how k1 stretches the cube is
        solved for with the pose, and its error is among those by the corners. `lone_residual` is
        that of the edges of a lone face [px], None for cells and for several faces.
        """
        rotation, origin = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
        arms = np.concatenate([self._corners[name] for name in faces]) @ rotation.T
        points = arms + origin
        _, by_point = self._projection.project_with_jacobian(points)
        columns = [by_point, -by_point @ se3.hat(arms)]
        flat, middle = points[:, :2] / points[:, 2:], origin[:2] / origin[2]
        bends = self._projection.bends(points, origin)
        solved = self._projection.claims_no_distortion
        if solved:
            columns.append(bends[:, :, None])
        rows = np.concatenate(columns, axis=2).reshape(2 * len(points), -1)
        focal = float(self._projection.matrix[0, 0])
        pixels = focal / float(origin[2])
        by_light = CORNER_ERROR_PX + BLUR_SHARE * max(blur - SHARP_PX, 0.0)
        error = float(np.hypot(by_light, CORNER_ERROR_M * pixels))
        if lone_residual is not None:
            error = min(error, _as_displaced(error, lone_residual))
        # Square on, a tilt shows only by its cosine.
        tilt = np.sqrt(2 * error / (self._half * pixels))
        information = rows.T @ rows / error**2
        information[3:6, 3:6] += np.eye(3) / tilt**2
        information[6:, 6:] += 1 / k1_error**2
        inverse = np.linalg.inv(information)[:6]
        shift = np.diag([1, 1, 0, 0, 0, 0]) * (COMMON_SHIFT_PX / pixels) ** 2
        # Where a lens with a larger k1, and with a longer focal length, shows the corners.
        moved = focal * radial_bend(middle) + bends * (not solved)
        modes = np.stack([moved, focal * flat], axis=2).reshape(-1, 2)
        centre = np.tile(np.eye(2), (len(points), 1))
        modes = np.concatenate([modes * (k1_error, self._focal), centre * self._centre], axis=1)
        moves = inverse @ (rows.T @ modes) / error**2
        curved = FOCAL_CURVATURE * self._focal**2 if self._focal > MAX_LINEAR_FOCAL else 0.0
        besides = curved * np.diag([*[self._half] * 3, 1.0, 1.0, 1.0])
        moves = np.concatenate([moves, besides], axis=1)
        return np.asarray(inverse[:, :6] + shift, np.float64), np.asarray(moves, np.float64)


def _as_displaced(expected: float, residual: float) -> float:
    """How far the corners of a lone marker are displaced, whose edges leave a residual [px].

    What is expected of all paper counts as one more measurement of it, as this print may be a
    better one.
    """
    shown = residual / RESIDUAL_SHARE
    mean_square = (expected**2 + SHAPE_FREEDOM * shown**2) / (1 + SHAPE_FREEDOM)
    return float(np.sqrt(mean_square))
