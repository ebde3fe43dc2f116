"""Rigid transforms, rotation vectors, and the pose deltas of solvers and covariances.

A *pose delta* is six numbers: a translation [m] and a rotation vector [rad] along the axes of the
outer frame, the rotation about the moving frame's own origin. Position and orientation stay apart,
so a distance of metres never scales an error of rotation.
"""

import math

import numpy as np

from cubeling.tracking.geometry.arrays import Array

SMALL_ANGLE = 1e-6
"""Below this angle [rad] the series is used; its first dropped term is below 1e-24."""


def hat(vectors: Array) -> Array:
    """Cross-product matrices of vectors, (…, 3) → (…, 3, 3).

    >>> (hat(np.array([0.0, 0.0, 1.0])) @ [1.0, 0.0, 0.0]).tolist()
    [0.0, 1.0, 0.0]
    """
    matrices = np.zeros((*np.shape(vectors), 3))
    for row, column, axis in ((2, 1, 0), (0, 2, 1), (1, 0, 2)):
        matrices[..., row, column] = vectors[..., axis]
        matrices[..., column, row] = -vectors[..., axis]
    return matrices


def cross(a: Array, b: Array) -> Array:
    """Cross products of rows, (N, 3); three times as fast as `np.cross`.

    >>> cross(np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]])).tolist()
    [[0.0, 0.0, 1.0]]
    """
    x = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    y = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    z = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.asarray(np.stack([x, y, z], axis=1), np.float64)


def rotation(vector: Array) -> Array:
    """Rotation by |vector| radians about `vector`, (3,) → (3, 3) (Rodrigues' formula).

    >>> rotation(np.array([0.0, np.pi / 2, 0.0])).round(12)[0].tolist()
    [0.0, 0.0, 1.0]
    """
    # Plain numbers: for one vector, the functions of numpy take four times as long.
    x, y, z = vector.tolist()
    angle = math.sqrt(x * x + y * y + z * z)
    sine, versine = 1.0, 0.5  # over the angle, and over its square
    if angle > SMALL_ANGLE:
        sine, versine = math.sin(angle) / angle, (1 - math.cos(angle)) / angle**2
    xx, yy, zz = versine * x * x, versine * y * y, versine * z * z
    xy, yz, zx = versine * x * y, versine * y * z, versine * z * x
    x, y, z = sine * x, sine * y, sine * z
    return np.array(
        [
            [1 - yy - zz, xy - z, zx + y],
            [xy + z, 1 - zz - xx, yz - x],
            [zx - y, yz + x, 1 - xx - yy],
        ]
    )


def rotation_vector(matrix: Array) -> Array:
    """Inverse of `rotation`, (3, 3) → (3,), at most π long.

    >>> rotation_vector(rotation(np.array([0.1, -0.2, 0.3]))).round(12).tolist()
    [0.1, -0.2, 0.3]
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = matrix.tolist()
    cosine = 0.5 * (xx + yy + zz - 1)
    if cosine > 0.5:
        # Less than 60°: the skew part is as exact, and much faster.
        x, y, z = 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)
        sine = math.sqrt(x * x + y * y + z * z)
        scale = math.atan2(sine, cosine) / sine if sine > SMALL_ANGLE else 1.0
        return np.array([scale * x, scale * y, scale * z])
    x, y, z, w = quaternion(matrix)
    sine = float(np.sqrt(x * x + y * y + z * z))
    axis: Array = np.array([x, y, z])
    scale = 2.0 if sine < SMALL_ANGLE else float(2 * np.arctan2(sine, w) / sine)
    return axis * scale


def quaternion(matrix: Array) -> Array:
    """Return the unit quaternion xyzw with w ≥ 0, (3, 3) → (4,), as Shepperd (1978) does."""
    trace = float(np.trace(matrix))
    best = int(np.argmax(np.append(np.diag(matrix), trace)))
    skew = np.array(
        [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
    )
    q: Array = np.append(skew, 1 + trace)
    if best < 3:
        q = np.append(matrix[best] + matrix[:, best], skew[best])
        q[best] = 1 + 2 * matrix[best, best] - trace
    return np.asarray(q / np.copysign(np.linalg.norm(q), q[3]), np.float64)


def pose(rotation_matrix: Array, origin: Array) -> Array:
    """Transform, (4, 4), of a rotation matrix (3, 3) and an origin (3,)."""
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = rotation_matrix
    matrix[:3, 3] = origin
    matrix[3, 3] = 1
    return matrix


def inverse(transform: Array) -> Array:
    """Inverse of a rigid transform, (4, 4) → (4, 4).

    >>> a = pose(rotation(np.array([0.3, 0.1, 0.2])), np.array([1.0, 2.0, 3.0]))
    >>> bool(np.allclose(inverse(a) @ a, np.eye(4)))
    True
    """
    transposed = transform[:3, :3].T
    return pose(transposed, -transposed @ transform[:3, 3])


def apply_delta(transform: Array, pose_delta: Array) -> Array:
    """Apply a pose delta, (6,), to a pose, (4, 4).

    >>> apply_delta(np.eye(4), np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.0]))[:3, 3].tolist()
    [1.0, 2.0, 3.0]
    """
    return pose(rotation(pose_delta[3:]) @ transform[:3, :3], transform[:3, 3] + pose_delta[:3])


def along(transform: Array, pose_delta: Array, shares: Array) -> Array:
    """Poses along a pose delta, as `apply_delta` with each of N shares of it, (N, 4, 4).

    >>> motion = np.array([0.1, 0.0, -0.2, 0.3, -0.1, 0.2])
    >>> half = along(np.eye(4), motion, np.array([0.5]))[0]
    >>> bool(np.allclose(half, apply_delta(np.eye(4), motion / 2)))
    True
    """
    angle = max(float(np.linalg.norm(pose_delta[3:])), 1e-12)
    k = hat(pose_delta[3:] / angle)
    angles = shares[:, None, None] * angle
    rotations = np.eye(3) + np.sin(angles) * k + (1 - np.cos(angles)) * (k @ k)
    poses = np.zeros((len(shares), 4, 4))
    poses[:, :3, :3] = rotations @ transform[:3, :3]
    poses[:, :3, 3] = transform[:3, 3] + shares[:, None] * pose_delta[:3]
    poses[:, 3, 3] = 1
    return poses


def delta(start: Array, end: Array) -> Array:
    """Pose delta, (6,), from one pose to another: `apply_delta` to `start` returns `end`."""
    rotated = rotation_vector(end[:3, :3] @ start[:3, :3].T)
    return np.concatenate([end[:3, 3] - start[:3, 3], rotated])


def deltas(start: Array, ends: Array) -> Array:
    """Pose deltas, (N, 6), from one pose to several, (N, 4, 4); faster than `delta` for each.

    >>> ends = along(np.eye(4), np.array([0.1, 0.0, -0.2, 0.3, -0.1, 0.2]), np.array([0.0, 1.0]))
    >>> deltas(np.eye(4), ends).round(12)[1].tolist()
    [0.1, 0.0, -0.2, 0.3, -0.1, 0.2]
    """
    turned = ends[:, :3, :3] @ start[:3, :3].T
    cosines = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1)
    if cosines.min() <= 0.5:  # see `rotation_vector`
        return np.stack([delta(start, end) for end in ends])
    vectors = 0.5 * (turned[:, [2, 0, 1], [1, 2, 0]] - turned[:, [1, 2, 0], [2, 0, 1]])
    sines = np.sqrt((vectors * vectors).sum(axis=1))
    small = sines <= SMALL_ANGLE
    scales = np.where(small, 1.0, np.arctan2(sines, cosines) / np.where(small, 1.0, sines))
    return np.hstack([ends[:, :3, 3] - start[:3, 3], scales[:, None] * vectors])


def angle_between(a: Array, b: Array) -> float:
    """Angle between the orientations of two poses [rad], 0…π."""
    return float(np.linalg.norm(delta(a, b)[3:]))
