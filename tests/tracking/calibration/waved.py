"""Views of a cube that is waved in front of a camera: exact corners plus noise."""

import numpy as np

from cubeling.tracking.calibration import camera_vector
from cubeling.tracking.calibration.view import View, view_of_corners
from cubeling.tracking.geometry import se3


def folded_corners(cube, random, millimetres=1.0, degrees=1.0):
    """Marker corners of a cube with folding errors, (faces, 4, 3)."""
    corners = []
    for face in cube.faces:
        centre = face.corners.mean(axis=0)
        turn = se3.rotation(np.deg2rad(random.uniform(-degrees, degrees, 3)))
        shift = random.uniform(-millimetres, millimetres, 3) / 1000
        corners.append((face.corners - centre) @ turn.T + centre + shift)
    return np.array(corners)


def corner_views(
    cube, real, camera, size, random, count, noise, tilt=40.0, near=0.25, only_main=False
):
    """Views of the corners: every face in turn, tilted randomly by up to `tilt` degrees."""
    views: list[View] = []
    while len(views) < count:
        number = len(views) % len(cube.faces)
        pose = _held(cube.faces[number].normal, random, tilt, near, size, camera[0])
        numbers = [number] if only_main else range(len(cube.faces))
        plates, points, pixels = [], [], []
        for plate in numbers:
            seen = real[plate] @ pose[:3, :3].T + pose[:3, 3]
            centre = seen.mean(axis=0)
            cosine = -(pose[:3, :3] @ cube.faces[plate].normal) @ centre / np.linalg.norm(centre)
            exact = camera_vector.project(camera, seen)
            if cosine < 0.25 or (exact < 0).any() or (exact > np.array(size) - 1).any():
                continue
            plates += [plate] * 4
            points.append(cube.faces[plate].corners)
            pixels.append(exact + random.normal(0, noise, exact.shape))
        if plates:
            time = float(len(views))
            views.append(
                view_of_corners(
                    time, np.array(plates), np.concatenate(points), np.concatenate(pixels)
                )
            )
    return views


def _held(normal, random, tilt, near, size, focal):
    """A pose in the image with one face towards the camera, up to a tilt."""
    up = np.cross(-normal, random.standard_normal(3))
    up /= np.linalg.norm(up)
    square = np.stack([np.cross(up, -normal), up, -normal])
    axis = np.append(random.standard_normal(2), 0)
    turn = se3.rotation(axis / np.linalg.norm(axis) * np.deg2rad(random.uniform(0, tilt)))
    distance = random.uniform(near, 2.4 * near)
    place = random.uniform(-0.78, 0.78, 2) * np.array(size) / 2 / focal
    return se3.pose(turn @ square, np.array([*place, 1.0]) * distance)


def aligned(one, other):
    """Distances of points, (…, 3), after the best rigid motion of the first onto the second."""
    a, b = one.reshape(-1, 3), other.reshape(-1, 3)
    left, _, right = np.linalg.svd((a - a.mean(axis=0)).T @ (b - b.mean(axis=0)))
    turn = left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right
    return np.linalg.norm((a - a.mean(axis=0)) @ turn - (b - b.mean(axis=0)), axis=1)
