"""Two bones that reach for a point: a leg, in closed form, in plain numbers.

One leg is a few dozen products, which plain numbers do in a fraction of what as many calls of NumPy
on arrays of two legs take. Vectors are x, y, z and quaternions x, y, z, w, as everywhere.
"""

import math
from collections.abc import Sequence

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

_STRAIGHTEST = 0.999  # part of a leg's length that a target may need
_KNEE_AXIS = (-1.0, 0.0, 0.0)  # of a leg that is straight: it bends the shin backward


def reach(
    hip: Vector, knee: Vector, ankle: Vector, target: Vector
) -> tuple[Quaternion, Quaternion]:
    """Return the turns that bring an ankle to a target, or as near as the leg is long.

    The first turns the whole leg about the hip, after the second has turned the shin about the
    knee; both in the frame of the points. The knee keeps its plane; the law of cosines says how far
    it bends.

    >>> upper, lower = reach((0, 2, 0), (0, 1, 0.1), (0, 0, 0), (0, 0.5, 0))
    >>> x, y, z = turn(upper, (0.0, -1.0, 0.1))  # where the thigh points now
    >>> sx, sy, sz = turn(multiply(upper, lower), (0.0, -1.0, -0.1))
    >>> [round(value, 6) + 0.0 for value in (x + sx, 2 + y + sy, z + sz)]
    [0.0, 0.5, 0.0]
    """
    thigh, shin, way = _less(hip, knee), _less(ankle, knee), _less(target, hip)
    long, short = _length(thigh), _length(shin)
    wanted = min(max(_length(way), abs(long - short) + 1e-6 * long), _STRAIGHTEST * (long + short))
    across = _cross(thigh, shin)
    size = _length(across)
    axis = _KNEE_AXIS
    if size > 1e-9 * long * short:
        axis = (across[0] / size, across[1] / size, across[2] / size)
    bend = math.atan2(size, _dot(thigh, shin))
    cosine = (long * long + short * short - wanted * wanted) / (2 * long * short)
    half = (math.acos(min(max(cosine, -1.0), 1.0)) - bend) / 2
    sine = math.sin(half)
    lower = (axis[0] * sine, axis[1] * sine, axis[2] * sine, math.cos(half))
    x, y, z = turn(lower, shin)
    return between((x - thigh[0], y - thigh[1], z - thigh[2]), way), lower


def multiply(a: Sequence[float], b: Sequence[float]) -> Quaternion:
    """Return the rotation that does b first and then a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def turn(q: Sequence[float], vector: Sequence[float]) -> Vector:
    """Return a vector turned."""
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
    """Return the shortest rotation from one direction to another."""
    x, y, z = _cross(start, end)
    w = _length(start) * _length(end) + _dot(start, end)
    size = math.sqrt(x * x + y * y + z * z + w * w)
    if size < 1e-12:  # opposite, or nothing at all
        return (0.0, 0.0, 0.0, 1.0)
    return x / size, y / size, z / size, w / size


def conjugate(q: Sequence[float]) -> Quaternion:
    """Return the inverse rotation."""
    return -q[0], -q[1], -q[2], q[3]


def seen_from(frame: Sequence[Sequence[float]], q: Quaternion) -> Quaternion:
    """Return the turn Fᵀ q F: q as it is in a frame F whose rows, (3, 3 or more), are given."""
    x, y, z, w = q
    a, b, c = frame
    return (
        a[0] * x + b[0] * y + c[0] * z,
        a[1] * x + b[1] * y + c[1] * z,
        a[2] * x + b[2] * y + c[2] * z,
        w,
    )


def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _length(a: Vector) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
