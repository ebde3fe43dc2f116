"""Single quaternions xyzw and vectors as tuples of floats.

For one rotation this is much faster than `cubeling.characters.skeleton.rotations`.
"""

import math
from collections.abc import Sequence

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

IDENTITY: Quaternion = (0.0, 0.0, 0.0, 1.0)
"""The rotation by no angle, xyzw."""


def multiply(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """Return the product a b: the rotation b followed by a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(q: Sequence[float]) -> Quaternion:
    """Return the inverse rotation."""
    return -q[0], -q[1], -q[2], q[3]


def normalize(q: Sequence[float]) -> Quaternion:
    """Return a quaternion at unit length.

    >>> normalize((0.0, 0.0, 3.0, 4.0))
    (0.0, 0.0, 0.6, 0.8)
    """
    x, y, z, w = q
    size = math.sqrt(x * x + y * y + z * z + w * w)
    return x / size, y / size, z / size, w / size


def rotate(q: Sequence[float], vector: Sequence[float]) -> Vector:
    """Return a rotated vector.

    >>> half = math.sqrt(0.5)
    >>> [round(value, 6) + 0.0 for value in rotate((0.0, half, 0.0, half), (0.0, 2.0, 1.0))]
    [1.0, 2.0, 0.0]
    """
    qx, qy, qz, w = q
    x, y, z = vector
    cx, cy, cz = qy * z - qz * y, qz * x - qx * z, qx * y - qy * x
    cx, cy, cz = cx + cx, cy + cy, cz + cz
    return (
        x + w * cx + qy * cz - qz * cy,
        y + w * cy + qz * cx - qx * cz,
        z + w * cz + qx * cy - qy * cx,
    )


def between(start: Vector, end: Vector) -> Quaternion:
    """Return the shortest rotation that turns one direction to another."""
    ax, ay, az = start
    bx, by, bz = end
    x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    squares = (ax * ax + ay * ay + az * az) * (bx * bx + by * by + bz * bz)
    w = math.sqrt(squares) + ax * bx + ay * by + az * bz
    size = math.sqrt(x * x + y * y + z * z + w * w)
    if size < 1e-12:  # opposite directions, or zero vectors
        return IDENTITY
    return x / size, y / size, z / size, w / size


def from_rotation_vector(vector: Vector) -> Quaternion:
    """Return the rotation about a vector by its length [rad]."""
    x, y, z = vector
    angle = math.sqrt(x * x + y * y + z * z)
    scale = 0.5 if angle < 1e-9 else math.sin(angle / 2) / angle
    return x * scale, y * scale, z * scale, math.cos(angle / 2)


def to_rotation_vector(q: Sequence[float]) -> Vector:
    """Return axis times angle [rad], of the shorter way.

    >>> [round(value, 6) for value in to_rotation_vector(from_rotation_vector((0.1, -0.2, 0.3)))]
    [0.1, -0.2, 0.3]
    """
    x, y, z, w = q
    sine = math.sqrt(x * x + y * y + z * z)
    sign = -1.0 if w < 0.0 else 1.0
    scale = sign * (2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, abs(w)) / sine)
    return x * scale, y * scale, z * scale


def cross(a: Vector, b: Vector) -> Vector:
    """Return the cross product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> float:
    """Return the dot product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def length(a: Vector) -> float:
    """Return the length of a vector."""
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])


def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def subtract(a: Vector, b: Vector) -> Vector:
    """Return a − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def make_global(turns: list[Quaternion], places: list[Vector], parents: Sequence[int]) -> None:
    """Turn the local rotations and places of joints into global ones, in the lists themselves.

    `parents` are smaller numbers than those of their children, negative for none.
    """
    # Products written out: this is most of what legs, arms and heads cost in a frame.
    for joint, parent in enumerate(parents):
        if parent >= 0:
            qx, qy, qz, qw = turns[parent]
            x, y, z, w = turns[joint]
            turns[joint] = (
                qw * x + qx * w + qy * z - qz * y,
                qw * y - qx * z + qy * w + qz * x,
                qw * z + qx * y - qy * x + qz * w,
                qw * w - qx * x - qy * y - qz * z,
            )
            x, y, z = places[joint]
            cx, cy, cz = qy * z - qz * y, qz * x - qx * z, qx * y - qy * x
            cx, cy, cz = cx + cx, cy + cy, cz + cz
            px, py, pz = places[parent]
            places[joint] = (
                px + x + qw * cx + qy * cz - qz * cy,
                py + y + qw * cy + qz * cx - qx * cz,
                pz + z + qw * cz + qx * cy - qy * cx,
            )
