"""Two bones that reach for a point: a leg, in closed form, in plain numbers.

One leg is a few dozen products, which plain numbers do in a fraction of what as many calls of NumPy
on arrays of two legs take. Vectors are x, y, z and quaternions x, y, z, w, as everywhere.
"""

import math

from characters.skeleton.scalar_quaternions import (
    Quaternion,
    Vector,
    between,
    cross,
    dot,
    length,
    rotate,
    subtract,
)

_STRAIGHTEST = 0.999  # part of a leg's length that a target may need
_KNEE_AXIS = (-1.0, 0.0, 0.0)  # of a leg that is straight: it bends the shin backward


def reach(
    hip: Vector, knee: Vector, ankle: Vector, target: Vector
) -> tuple[Quaternion, Quaternion]:
    """Return the turns that bring an ankle to a target, or as near as the leg is long.

    The first turns the whole leg about the hip, after the second has turned the shin about the
    knee; both in the frame of the points. The knee keeps its plane; the law of cosines says how far
    it bends.

    >>> from characters.skeleton.scalar_quaternions import multiply
    >>> upper, lower = reach((0, 2, 0), (0, 1, 0.1), (0, 0, 0), (0, 0.5, 0))
    >>> x, y, z = rotate(upper, (0.0, -1.0, 0.1))  # where the thigh points now
    >>> sx, sy, sz = rotate(multiply(upper, lower), (0.0, -1.0, -0.1))
    >>> [round(value, 6) + 0.0 for value in (x + sx, 2 + y + sy, z + sz)]
    [0.0, 0.5, 0.0]
    """
    thigh, shin, way = subtract(hip, knee), subtract(ankle, knee), subtract(target, hip)
    long, short = length(thigh), length(shin)
    wanted = min(max(length(way), abs(long - short) + 1e-6 * long), _STRAIGHTEST * (long + short))
    across = cross(thigh, shin)
    size = length(across)
    axis = _KNEE_AXIS
    if size > 1e-9 * long * short:
        axis = (across[0] / size, across[1] / size, across[2] / size)
    bend = math.atan2(size, dot(thigh, shin))
    cosine = (long * long + short * short - wanted * wanted) / (2 * long * short)
    half = (math.acos(min(max(cosine, -1.0), 1.0)) - bend) / 2
    sine = math.sin(half)
    lower = (axis[0] * sine, axis[1] * sine, axis[2] * sine, math.cos(half))
    x, y, z = rotate(lower, shin)
    return between((x - thigh[0], y - thigh[1], z - thigh[2]), way), lower
