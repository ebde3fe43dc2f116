"""Vleo's expressions and visemes, each a set of parameters of its face.

They are exaggerated because on the table the whole head is only sixty pixels high.
"""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton import rotations
from tools.authoring.modelling.expressions import all_morphs
from tools.authoring.modelling.shapes import Array


@dataclass(frozen=True)
class VleoExpression:
    """The parameters of one expression; lengths in metres, forward and upward positive."""

    shut: tuple[float, float] = (0.0, 0.0)
    """Closure of the left and the right eye, 0…1."""

    upper: float = 0.88
    """Height of the upper lids; 0 is the line of the closed eye."""

    upper_tilt: float = 0.0
    """Additional height at the inner corner over that at the outer."""

    lower: float = 0.96
    """Lowering of the lower lids; negative where they are raised above that line."""

    brow: float = 0.0
    """Height of the brows, seen from the middle of the eye [rad]."""

    brow_inner: float = 0.0
    """Height of their inner ends beyond that [rad]."""

    width: float = 0.70
    """Half the width of the mouth, seen from the middle of the head [rad]."""

    smile: float = 0.0105
    """Height of the corners of the mouth above its middle."""

    rise: float = 0.0004
    """Height of the upper lip above the line of the closed mouth."""

    drop: float = 0.0042
    """Lowering of the lower lip, without that by the jaw."""

    square: float = 1.0
    """Exponent of the sine that shapes the opening: 1 round, 0.5 boxy."""

    lips: float = 0.0020
    """Visible width of the lips."""

    pout: float = 0.0
    """Protrusion of the lips."""

    tuck: float = 0.0
    """How far the lower lip is drawn in, under the upper teeth."""

    teeth: float = 0.0
    """Visible height of the upper teeth below the lip."""

    tongue_up: float = 0.0
    """Raise of the tip of the tongue."""

    tongue_out: float = 0.0
    """How far the tip of the tongue comes forward."""

    jaw: float = 0.0
    """Opening of the jaw [rad]."""

    cheeks: float = 0.0
    """Raise of the cheeks."""


NEUTRAL = VleoExpression()

_MOODS = {
    "blink": VleoExpression(shut=(1.0, 1.0)),
    "blinkLeft": VleoExpression(shut=(1.0, 0.0)),
    "blinkRight": VleoExpression(shut=(0.0, 1.0)),
    "happy": VleoExpression(
        upper=0.94, lower=0.10, brow=0.10, width=0.86, smile=0.0170, drop=0.0075, jaw=0.16,
        cheeks=0.0040,
    ),
    "angry": VleoExpression(
        upper=0.70, upper_tilt=-0.80, lower=0.62, brow=-0.13, brow_inner=-0.30,
        width=0.52, smile=-0.0050, rise=0.0066, drop=0.0020, square=0.8, lips=0.0022,
        teeth=0.0050,
    ),
    "sad": VleoExpression(
        upper=0.74, upper_tilt=0.46, lower=0.88, brow=-0.02, brow_inner=0.36,
        width=0.44, smile=-0.0120, drop=0.0006, pout=0.0030, lips=0.0030,
    ),
    "surprised": VleoExpression(
        upper=1.20, lower=1.12, brow=0.30, width=0.36, smile=0.0, rise=0.0080, drop=0.0070,
        jaw=0.26, pout=0.0020,
    ),
    "relaxed": VleoExpression(
        upper=0.42, lower=0.72, brow=0.05, width=0.74, smile=0.0130, drop=0.0016,
    ),
    "aa": VleoExpression(width=0.74, smile=0.0085, rise=0.0030, drop=0.0060, square=0.7, jaw=0.72),
    "ih": VleoExpression(width=0.72, smile=0.0090, rise=0.0012, drop=0.0050, square=0.6, jaw=0.10),
    "ou": VleoExpression(
        width=0.125, smile=-0.0005, rise=0.0054, drop=0.0060, lips=0.0074, pout=0.0190,
    ),
    "ee": VleoExpression(width=0.92, smile=0.0125, rise=0.0016, drop=0.0056, square=0.5, jaw=0.04),
    "oh": VleoExpression(
        width=0.31, smile=0.0, rise=0.0085, drop=0.0085, lips=0.0036, pout=0.0065, jaw=0.26,
    ),
}  # fmt: skip

_VISEMES = {
    "PP": VleoExpression(width=0.62, smile=0.0092, rise=0.0, drop=0.0, lips=0.0014),
    "FF": VleoExpression(
        width=0.60, smile=0.0085, rise=0.0052, drop=-0.0014, square=0.7, tuck=0.0034, teeth=0.0052,
    ),
    "TH": VleoExpression(
        width=0.62, smile=0.0085, rise=0.0030, drop=0.0052, square=0.8, jaw=0.08, teeth=0.0026,
        tongue_up=0.0052, tongue_out=0.0210,
    ),
    "DD": VleoExpression(
        width=0.66, smile=0.0092, rise=0.0028, drop=0.0052, square=0.7, jaw=0.10, teeth=0.0026,
        tongue_up=0.0068, tongue_out=0.0080,
    ),
    "kk": VleoExpression(width=0.64, smile=0.0090, rise=0.0022, drop=0.0060, jaw=0.18),
    "CH": VleoExpression(
        width=0.28, smile=0.0010, rise=0.0052, drop=0.0046, square=0.6, lips=0.0040, pout=0.0090,
        jaw=0.03, teeth=0.0062,
    ),
    "SS": VleoExpression(
        width=0.78, smile=0.0115, rise=0.0030, drop=0.0034, square=0.5, jaw=0.01, teeth=0.0044,
    ),
    "nn": VleoExpression(
        width=0.64, smile=0.0090, rise=0.0024, drop=0.0056, square=0.8, jaw=0.14, tongue_up=0.0078,
        tongue_out=0.0070,
    ),
    "RR": VleoExpression(
        width=0.32, smile=0.0020, rise=0.0050, drop=0.0062, lips=0.0036, pout=0.0070, jaw=0.07,
        tongue_up=0.0030,
    ),
    "aa": VleoExpression(width=0.72, smile=0.0085, rise=0.0030, drop=0.0060, square=0.7, jaw=0.52),
    "E": VleoExpression(width=0.80, smile=0.0112, rise=0.0022, drop=0.0058, square=0.6, jaw=0.24),
    "I": VleoExpression(
        width=0.90, smile=0.0125, rise=0.0028, drop=0.0054, square=0.5, jaw=0.06, teeth=0.0030,
        tongue_up=0.0020,
    ),
    "O": VleoExpression(
        width=0.29, smile=0.0, rise=0.0082, drop=0.0085, lips=0.0038, pout=0.0078, jaw=0.24,
    ),
    "U": VleoExpression(
        width=0.135, smile=-0.0003, rise=0.0050, drop=0.0056, lips=0.0070, pout=0.0170,
    ),
}  # fmt: skip
"""The shapes of the mouth in speech, by the names of the Oculus visemes."""

_PARTS = {
    "mouthSmile": VleoExpression(width=0.86, smile=0.0165, rise=0.0004, drop=0.0042, cheeks=0.003),
    "mouthFrown": VleoExpression(width=0.54, smile=-0.0066, rise=0.0004, drop=0.0042),
    "browInnerUp": VleoExpression(brow=0.14, brow_inner=0.22),
    "browOuterUp": VleoExpression(brow=0.24, brow_inner=-0.10),
    "browDown": VleoExpression(brow=-0.12, brow_inner=-0.20),
    "eyeWide": VleoExpression(upper=1.08, lower=1.02),
}
"""Movements of one part of the face, by ARKit's names."""


EXPRESSIONS = all_morphs(NEUTRAL, _MOODS, _VISEMES, _PARTS)
"""Every morph: expressions and vowels by VRM's names, visemes, and parts of the face."""

JAW_HINGE_M = np.array([0.0, 0.2235, 0.124])
"""Axis of the jaw [m]."""


def rotate_with_jaw(points: Array, share: Array, face: VleoExpression) -> Array:
    """Return points (n, 3) rotated with the jaw, each by a share (n,) of its rotation."""
    turned = rotations.rotate(rotations.about("x", face.jaw), points - JAW_HINGE_M) + JAW_HINGE_M
    return np.asarray(points + (turned - points) * share[:, None])


def cheek_displacement(points: Array, face: VleoExpression) -> Array:
    """Return how far raised cheeks displace points of the skin, (n, 3) [m]."""
    apart = (np.abs(points) - [0.047, 0.232, 0.140]) / [0.016, 0.015, 0.020]
    near = np.exp(-np.sum(apart * apart, axis=1))[:, None]
    outward = np.stack([0.5 * np.sign(points[:, 0]), 1 + 0 * points[:, 0], 0 * points[:, 0]], -1)
    return np.asarray(near * outward * face.cheeks)
