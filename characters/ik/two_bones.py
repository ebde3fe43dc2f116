"""Analytic two-bone inverse kinematics for one leg, several times as fast as NumPy."""

import math

from cubeling.characters.skeleton.scalar_quaternions import (
    IDENTITY,
    Quaternion,
    Vector,
    between,
    cross,
    length,
    multiply,
    rotate,
    subtract,
)

_MAX_EXTENSION = 0.999  # of a leg's length
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
    # Written out: legs bend in every frame, and a call costs as much as the product in it.
    tx, ty, tz = thigh = subtract(hip, knee)
    sx, sy, sz = shin = subtract(ankle, knee)
    aim = subtract(target, hip)
    long = math.sqrt(tx * tx + ty * ty + tz * tz)
    short = math.sqrt(sx * sx + sy * sy + sz * sz)
    wanted = min(max(length(aim), abs(long - short) + 1e-6 * long), _MAX_EXTENSION * (long + short))
    ax, ay, az = ty * sz - tz * sy, tz * sx - tx * sz, tx * sy - ty * sx
    size = math.sqrt(ax * ax + ay * ay + az * az)
    bend = math.atan2(size, tx * sx + ty * sy + tz * sz)
    straightened = IDENTITY
    # The left crossed with the thigh.
    forward, flat = sz * ty - sy * tz, math.sqrt(tz * tz + ty * ty)
    overextended = 0.0 < forward < _MAX_OVEREXTENSION * short * flat and bend > _MIN_STRAIGHT_RAD
    if overextended and knees_ahead:
        # A transition has stretched the knee too far: it bends as far the right way.
        scale = 2.0 * forward / (flat * flat)
        shin = (sx, sy + scale * tz, sz - scale * ty)
        straightened = between((sx, sy, sz), shin)
        ax, ay, az = cross(thigh, shin)
        size = length((ax, ay, az))
    axis = _STRAIGHT_KNEE_AXIS
    if size > 1e-9 * long * short:
        axis = (ax / size, ay / size, az / size)
    cosine = (long * long + short * short - wanted * wanted) / (2 * long * short)
    half = (math.acos(min(max(cosine, -1.0), 1.0)) - bend) / 2
    sine = math.sin(half)
    lower = (axis[0] * sine, axis[1] * sine, axis[2] * sine, math.cos(half))
    x, y, z = rotate(lower, shin)
    upper = between((x - tx, y - ty, z - tz), aim)
    return upper, lower if straightened is IDENTITY else multiply(lower, straightened)
