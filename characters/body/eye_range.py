"""How far eyes turn in their head.

People's eyes turn by 45° and more, but they seldom stay beyond 20° (Stahl, "Eye-head coordination
and the variation of eye-movement accuracy with orbital eccentricity", 2001). The large irises of
drawn eyes reach the lids even sooner, so these limits are those of the bundled characters' faces.
"""

import math

MAX_EYE_YAW_RAD, MAX_EYE_PITCH_RAD = math.radians(20), math.radians(13)
"""Half axes of the ellipse within which eyes look: to either side, up and down [rad]."""

EXACT_SHARE = 0.6
"""Part of this range in which eyes turn as far as asked; beyond, they do less and less."""

STRAINED_SHARE = 0.5
"""Part of the range that is left to eyes when head and eyes together do not reach a point: nobody
keeps looking out of the corner of an eye."""

STRAIN_FROM, STRAIN_TO = 0.7, 1.5
"""Turns that head and eyes together leave undone, in ranges of the eyes: the range begins to become
smaller, and is smallest."""


def range_share(yaw: float, pitch: float) -> float:
    """Return the part of their range that eyes use for a point.

    Parameters
    ----------
    yaw, pitch
        Of the point, relative to where the head will come to rest [rad].
    """
    beyond = _eccentricity(yaw, pitch) - STRAIN_FROM
    strain = min(max(beyond / (STRAIN_TO - STRAIN_FROM), 0.0), 1.0)
    return 1.0 - (1.0 - STRAINED_SHARE) * strain * strain * (3.0 - 2.0 * strain)


def within_range(yaw: float, pitch: float, share: float = 1.0) -> tuple[float, float]:
    """Return a turn of the eyes [rad] that is kept smoothly within part of their range.

    >>> within_range(0.1, 0.0)
    (0.1, 0.0)
    >>> yaw, pitch = within_range(2.0, 0.0)
    >>> 0.99 * MAX_EYE_YAW_RAD < yaw < MAX_EYE_YAW_RAD
    True
    """
    eccentricity = _eccentricity(yaw, pitch)
    exact = EXACT_SHARE * share
    if eccentricity <= exact:
        return yaw, pitch
    left = share - exact
    factor = (share - left * math.exp((exact - eccentricity) / left)) / eccentricity
    return yaw * factor, pitch * factor


def _eccentricity(yaw: float, pitch: float) -> float:
    """Return how far a turn is from the middle, 1 at the end of the range."""
    return math.hypot(yaw / MAX_EYE_YAW_RAD, pitch / MAX_EYE_PITCH_RAD)
