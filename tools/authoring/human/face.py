"""The bundled explorer's expressions and visemes, each a set of parameters of its face.

They are exaggerated because on the table the whole face is only forty pixels high.
"""

from dataclasses import dataclass

import numpy as np

from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.expressions import all_morphs
from tools.authoring.modelling.shapes import Array


@dataclass(frozen=True)
class HumanExpression:
    """The parameters of one expression; lengths in metres, forward and upward positive."""

    shut: tuple[float, float] = (0.0, 0.0)
    """Closure of the left and the right eye, 0…1."""

    upper: float = 0.9
    """Height of the upper lids; 0 is the line of the closed eye."""

    upper_tilt: float = 0.0
    """Additional height at the inner corner over that at the outer."""

    lower: float = 1.0
    """Lowering of the lower lids; negative where they are raised above that line."""

    brow: float = 0.0
    """Height of the brows."""

    brow_inner: float = 0.0
    """Additional height of their inner ends."""

    brow_arch: float = 0.0
    """Additional height of their middles."""

    knit: float = 0.0
    """Distance by which the brows are drawn together."""

    width: float = 0.066
    """Half the width of the mouth."""

    smile: float = 0.024
    """Height of the corners of the mouth above its middle."""

    rise: float = 0.0003
    """Height of the upper lip above the line of the closed mouth."""

    drop: float = 0.0003
    """Lowering of the lower lip."""

    square: float = 1.0
    """Exponent of the sine that shapes the opening: 1 round, 0.5 boxy."""

    pout: float = 0.0
    """Protrusion of the lips."""

    teeth: float = 0.0
    """Visible height of the upper teeth below the lip."""

    lower_teeth: float = 0.0
    """Visible height of the lower teeth above the lip."""

    tongue: float = 0.4
    """Height of the tongue in the open mouth, 0…1."""

    tongue_tip: float = 0.0
    """Height of its tip above the rest of it, in openings of the mouth."""

    tongue_out: float = -0.016
    """How far its tip comes out before the lips."""

    press: float = 0.0
    """By how much pressed lips are less broad."""

    tuck: float = 0.0
    """How far the lower lip is drawn in, under the upper teeth."""

    jaw: float = 0.0
    """Lowering of the chin."""

    cheeks: float = 0.0
    """Raise of the cheeks."""


NEUTRAL = HumanExpression()

_MOODS = {
    "blink": HumanExpression(shut=(1.0, 1.0)),
    "blinkLeft": HumanExpression(shut=(1.0, 0.0)),
    "blinkRight": HumanExpression(shut=(0.0, 1.0)),
    "happy": HumanExpression(
        upper=0.78, lower=-0.55, brow=0.012, brow_inner=0.006, brow_arch=0.008,
        width=0.090, smile=0.052, rise=0.006, drop=0.040, square=0.8, teeth=0.016, jaw=0.014,
        cheeks=0.014,
    ),
    "angry": HumanExpression(
        upper=0.66, upper_tilt=-0.62, lower=0.45, brow=-0.014, brow_inner=-0.036, knit=0.016,
        width=0.062, smile=-0.032, rise=0.010, drop=0.013, square=0.5, teeth=0.022,
    ),
    "sad": HumanExpression(
        upper=0.62, upper_tilt=0.36, lower=0.8, brow=-0.002, brow_inner=0.034, brow_arch=-0.01,
        knit=0.008, width=0.052, smile=-0.033, drop=0.003, pout=0.006,
    ),
    "surprised": HumanExpression(
        upper=1.13, lower=1.08, brow=0.024, brow_inner=0.006, brow_arch=0.008,
        width=0.034, smile=0.0, rise=0.022, drop=0.050, jaw=0.026, pout=0.005,
    ),
    "relaxed": HumanExpression(
        upper=0.10, lower=0.30, brow=0.003, brow_inner=0.012, width=0.074, smile=0.046,
        cheeks=0.010,
    ),
    "aa": HumanExpression(width=0.060, smile=0.010, rise=0.012, drop=0.052, jaw=0.028, teeth=0.013),
    "ih": HumanExpression(
        width=0.070, smile=0.018, rise=0.010, drop=0.020, square=0.6, teeth=0.016, jaw=0.006,
    ),
    "ou": HumanExpression(width=0.027, smile=0.0, rise=0.014, drop=0.018, pout=0.022, jaw=0.006),
    "ee": HumanExpression(
        width=0.088, smile=0.028, rise=0.009, drop=0.022, square=0.5, teeth=0.026, jaw=0.004,
    ),
    "oh": HumanExpression(width=0.042, smile=0.002, rise=0.024, drop=0.042, pout=0.014, jaw=0.020),
}  # fmt: skip

_VISEMES = {
    "PP": HumanExpression(width=0.058, smile=0.015, rise=0.0, drop=0.0, press=0.0035, pout=0.001),
    "FF": HumanExpression(
        width=0.062, smile=0.012, rise=0.013, drop=-0.004, teeth=0.0115, tuck=0.010, press=0.001,
        square=0.7,
    ),
    "TH": HumanExpression(
        width=0.064, smile=0.012, rise=0.010, drop=0.015, teeth=0.009, tongue=0.5, tongue_tip=-0.02,
        tongue_out=0.003, jaw=0.005, square=0.8,
    ),
    "DD": HumanExpression(
        width=0.066, smile=0.015, rise=0.009, drop=0.017, teeth=0.009, lower_teeth=0.004,
        tongue=0.5, tongue_tip=0.4, tongue_out=-0.012, jaw=0.005, square=0.7,
    ),
    "kk": HumanExpression(
        width=0.062, smile=0.012, rise=0.009, drop=0.026, teeth=0.010, tongue=0.8, tongue_tip=-0.4,
        tongue_out=-0.02, jaw=0.012,
    ),
    "CH": HumanExpression(
        width=0.040, smile=0.004, rise=0.013, drop=0.015, teeth=0.014, lower_teeth=0.013,
        pout=0.014, jaw=0.003, square=0.6,
    ),
    "SS": HumanExpression(
        width=0.074, smile=0.022, rise=0.009, drop=0.011, teeth=0.010, lower_teeth=0.009,
        square=0.5,
    ),
    "nn": HumanExpression(
        width=0.064, smile=0.014, rise=0.009, drop=0.021, teeth=0.008, tongue=0.5, tongue_tip=0.35,
        tongue_out=-0.012, jaw=0.007, square=0.8,
    ),
    "RR": HumanExpression(
        width=0.042, smile=0.004, rise=0.011, drop=0.018, teeth=0.007, tongue=0.6, tongue_tip=0.1,
        pout=0.011, jaw=0.006,
    ),
    "aa": HumanExpression(
        width=0.062, smile=0.012, rise=0.012, drop=0.052, teeth=0.012, tongue=0.35, jaw=0.030,
        square=0.9,
    ),
    "E": HumanExpression(
        width=0.075, smile=0.021, rise=0.010, drop=0.034, teeth=0.013, tongue=0.5, jaw=0.014,
        square=0.7,
    ),
    "I": HumanExpression(
        width=0.084, smile=0.027, rise=0.009, drop=0.019, teeth=0.014, lower_teeth=0.004,
        tongue=0.7, jaw=0.004, square=0.5,
    ),
    "O": HumanExpression(
        width=0.037, smile=0.002, rise=0.020, drop=0.037, tongue=0.3, pout=0.016, jaw=0.020,
    ),
    "U": HumanExpression(
        width=0.023, smile=0.0, rise=0.010, drop=0.012, tongue=0.3, pout=0.026, jaw=0.006,
    ),
}  # fmt: skip
"""The shapes of the mouth in speech, by the names of the Oculus visemes."""

_PARTS = {
    "mouthSmile": HumanExpression(width=0.088, smile=0.052, cheeks=0.010),
    "mouthFrown": HumanExpression(width=0.054, smile=-0.030),
    "browInnerUp": HumanExpression(brow=0.010, brow_inner=0.020),
    "browOuterUp": HumanExpression(brow=0.018, brow_inner=-0.010, brow_arch=0.010),
    "browDown": HumanExpression(brow=-0.012, brow_inner=-0.016, knit=0.012),
    "eyeWide": HumanExpression(upper=1.08, lower=1.06),
}
"""Movements of one part of the face, by ARKit's names."""


EXPRESSIONS = all_morphs(NEUTRAL, _MOODS, _VISEMES, _PARTS)
"""Every morph: expressions and vowels by VRM's names, visemes, and parts of the face."""

MOUTH_CENTRE_M = np.array([0.0, 1.327])
"""x and y of the centre of the closed mouth [m]."""


def skin_displacement(points: Array, face: HumanExpression) -> Array:
    """Return how far jaw and cheeks displace points of the skin, (n, 3) [m]."""
    x, y, z = points.T
    front = smoothstep(z / 0.11)
    chin = smoothstep((MOUTH_CENTRE_M[1] + 0.004 - y) / 0.04) * front
    apart = ((np.abs(x) - 0.115) / 0.05) ** 2 + ((y - 1.362) / 0.04) ** 2
    cheek = np.exp(-apart) * front
    jaw = chin[:, None] * [0.0, -face.jaw, -0.25 * face.jaw]
    outward = np.stack([0.5 * np.sign(x), np.ones_like(x), 0.8 * np.ones_like(x)], axis=-1)
    return np.asarray(jaw + cheek[:, None] * outward * face.cheeks)
