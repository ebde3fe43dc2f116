"""Analytic two-bone inverse kinematics for one leg, several times as fast as NumPy."""

import math

from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    between,
    cross,
    dot,
    length,
    multiply,
    rotate,
    subtract,
)

_MAX_EXTENSION = 0.999  # of a leg's length
_LEFT = (1.0, 0.0, 0.0)
_STRAIGHT_KNEE_AXIS = (-1.0, 0.0, 0.0)  # of a straight leg, whose plane is undefined
_MAX_OVEREXTENSION = 0.4  # sine of the angle by which a knee may be bent the wrong way
_MIN_STRAIGHT_RAD = 1.6  # between thigh and shin: a knee that is bent more is bent on purpose


def reach(
    hip: Vector, knee: Vector, ankle: Vector, target: Vector, *, knees_ahead: bool = True
) -> tuple[Quaternion, Quaternion]:
    """Return the rotations that move an ankle to a target, or as near as the leg reaches.

    The second rotates the shin about the knee, then the first rotates the whole leg about the hip;
    both are given in the frame of the points. The knee stays in its plane and bends by the law of
    cosines. Unless `knees_ahead` is false, a knee that bends slightly backwards is corrected.

    >>> from cubeling.characters.skeleton.scalar_quaternions import multiply
    >>> upper, lower = reach((0, 2, 0), (0, 1, 0.1), (0, 0, 0), (0, 0.5, 0))
    >>> x, y, z = rotate(upper, (0.0, -1.0, 0.1))  # the new direction of the thigh
    >>> sx, sy, sz = rotate(multiply(upper, lower), (0.0, -1.0, -0.1))
    >>> [round(value, 6) + 0.0 for value in (x + sx, 2 + y + sy, z + sz)]
    [0.0, 0.5, 0.0]
    """
    thigh, shin, aim = subtract(hip, knee), subtract(ankle, knee), subtract(target, hip)
    long, short = length(thigh), length(shin)
    wanted = min(max(length(aim), abs(long - short) + 1e-6 * long), _MAX_EXTENSION * (long + short))
    across = cross(thigh, shin)
    bend = math.atan2(length(across), dot(thigh, shin))
    straightened = IDENTITY
    ahead = cross(_LEFT, thigh)
    stretched = dot(shin, ahead) / (short * max(length(ahead), 1e-9))
    overextended = 0.0 < stretched < _MAX_OVEREXTENSION and bend > _MIN_STRAIGHT_RAD
    if overextended and knees_ahead:
        # A transition has stretched the knee too far: it bends as far the right way.
        scale = 2.0 * dot(shin, ahead) / dot(ahead, ahead)
        x, y, z = (s - scale * a for s, a in zip(shin, ahead, strict=True))
        straightened = between(shin, (x, y, z))
        shin = (x, y, z)
        across = cross(thigh, shin)
    size = length(across)
    axis = _STRAIGHT_KNEE_AXIS
    if size > 1e-9 * long * short:
        axis = (across[0] / size, across[1] / size, across[2] / size)
    cosine = (long * long + short * short - wanted * wanted) / (2 * long * short)
    half = (math.acos(min(max(cosine, -1.0), 1.0)) - bend) / 2
    sine = math.sin(half)
    lower = (axis[0] * sine, axis[1] * sine, axis[2] * sine, math.cos(half))
    x, y, z = rotate(lower, shin)
    return between((x - thigh[0], y - thigh[1], z - thigh[2]), aim), multiply(lower, straightened)
