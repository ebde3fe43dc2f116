"""What light, noise and a swaying camera change in the picture of a desk without anything on it."""

import cv2
import numpy as np

from cubeling.tracking.appearance.hand.structuring_elements import SQUARE_9
from cubeling.tracking.geometry.arrays import Flags, Floats
from cubeling.tracking.geometry.robust_statistics import quantile

MIN_GAIN, MAX_GAIN = 0.45, 2.0
"""Least and most light on the background relative to the light before, as L + 16 of CIELab: a
shadow that comes or goes."""

MIN_CHROMA_NOISE, MIN_DETAIL_NOISE = 0.25, 0.5
"""Least noise that is believed at working resolution, in chroma [CIELab] and in the detail of
lightness [CIELab bytes]: medians over the window."""

CHROMA_LIMIT, DETAIL_LIMIT = 4.0, 1.4
"""Multiples of that noise from which on a pixel is something else."""

SHADE_CHROMA, SHADE_DETAIL, EDGE_DETAIL = 10.0, 0.008, 0.05
"""How much chroma [CIELab] and detail of the gain change in a shadow, per change of the gain; and
how much of the latter at its edge."""

TEXTURE_DETAIL = 0.1
"""How much detail changes where the camera sways by a fraction of a pixel, per deviation of the
background's texture: that of a keyboard is large, and that of skin or wood is small."""

CONSTANT, MAX_NOISE_RATIO = 0.2, 5.0
"""Change below which a pixel is constant, as clipped white and repeated blocks of a video are, and
most noise that is believed, both relative to the least noise."""

EVEN_LIGHT_PX = (5, 5)
"""Sides of a square in which light on the same thing changes little [px]: what differs in it is the
detail of that thing."""

MIN_SAMPLES = 30
"""Least pixels that tell noise."""


def may_be_light(chroma: Floats, change: Floats, shade: Floats, noise: float) -> Flags:
    """Return where other light and noise alone may have made what differs, (h, w).

    Parameters
    ----------
    chroma
        How far the chroma is off that of the background in this light, (h, w) [CIELab].
    change, shade
        L + 16 relative to the background, less one, and the size of that, (h, w).
    noise
        That of the chroma [CIELab].
    """
    lit = chroma < CHROMA_LIMIT * noise + SHADE_CHROMA * shade
    lit &= (change > MIN_GAIN - 1) & (change < MAX_GAIN - 1)
    return np.asarray(lit)


def roughness(gain: Floats, known: Flags, lit: Flags) -> Floats:
    """Return how rough the gain is: its least deviation in a square near each pixel, (h, w).

    A shadow keeps the texture of what it falls on, so there the gain is smooth.

    Parameters
    ----------
    gain
        L + 16 relative to the background, less one, (h, w).
    known
        Where the background is known: nothing else counts in a square, (h, w).
    lit
        Where light alone may have made the gain: nothing else counts, nor the squares around what
        is known and not lit, (h, w).
    """
    counts = known & lit
    weight = counts.astype(np.float32)
    share = cv2.blur(weight, EVEN_LIGHT_PX) + np.float32(1e-3)
    gain = gain * weight
    detail = gain - cv2.blur(gain, EVEN_LIGHT_PX) / share
    detail *= weight
    deviation = cv2.blur(detail * detail, EVEN_LIGHT_PX) / share
    deviation += known ^ counts
    return np.asarray(cv2.sqrt(cv2.erode(deviation, SQUARE_9)), np.float32)


def texture(light: Floats) -> Floats:
    """Return the deviation from the mean in the square around each pixel, (h, w)."""
    detail = light - cv2.blur(light, EVEN_LIGHT_PX)
    return np.asarray(cv2.sqrt(cv2.blur(detail * detail, EVEN_LIGHT_PX)), np.float32)


def measured_noise(deviations: Floats, least: float) -> float:
    """Return the deviation that noise makes, at least `least`: the median, as most looks as before.

    What is constant tells no noise.
    """
    noisy = deviations[deviations > CONSTANT * least]
    if len(noisy) < MIN_SAMPLES:
        return least
    return min(max(quantile(noisy, 0.5), least), MAX_NOISE_RATIO * least)
