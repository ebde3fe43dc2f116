"""How the apex and the strength of a gesture follow an accent of speech.

Source: Fernández-Baena 2015, section 4.4.3 (M6).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array

LEAST_PSI = 0.01
"""Strengths of accents below this count as this: their logarithm has no end."""

PAIRING_WINDOW_S = (-0.2, 0.5)
"""From when to when, after an apex, its accent may be [s]."""

UNPAIRED_COST = 4.0
"""Cost of a gesture, or of an accent, without a partner: that of two deviations."""

TYPICAL_LEAD_S, LEAD_DEVIATION_S = 0.1, 0.2
"""Mean and standard deviation of PAPT − apex in the corpus [s]."""


@dataclass(frozen=True)
class SynchronyRule:
    """When the apex of a gesture is: Δ = PAPT − apex lies in a window."""

    shortest: float = -0.03
    """Least Δ [s]: the gesture comes after the accent."""

    longest: float = 0.22
    """Greatest Δ [s]: the gesture leads."""

    def holds(self, accent_time: float, apex_time: float) -> bool:
        """Return whether an apex suits an accent.

        >>> SynchronyRule().holds(1.0, 0.9), SynchronyRule().holds(1.0, 0.7)
        (True, False)
        """
        return self.shortest <= accent_time - apex_time <= self.longest


@dataclass(frozen=True)
class IntensityRule:
    """How strong a gesture is: |GSI − (slope · ln PSI + intercept)| < margin (erratum 8)."""

    slope: float = 0.6633
    """GSI per ln PSI."""

    intercept: float = 11.24
    """GSI of the strongest accent."""

    margin: float = 1.0
    """Half the width of the band."""

    def centre(self, psi: Array | float) -> Array:
        """Return the GSI that suits accents of a strength best.

        >>> round(float(IntensityRule().centre(0.01)), 1), float(IntensityRule().centre(1.0))
        (8.2, 11.24)
        """
        logs: Array = np.log(np.maximum(psi, LEAST_PSI))
        return self.intercept + self.slope * logs

    def holds(self, psi: Array | float, strength: Array | float) -> NDArray[np.bool_]:
        """Return whether gestures of a GSI suit accents; the band is open at its edges."""
        inside: NDArray[np.bool_] = np.abs(strength - self.centre(psi)) < self.margin
        return inside

    @staticmethod
    def fit(psi: Array, strengths: Array, margin: float | None = 1.0) -> "IntensityRule":
        """Return the rule of paired accents and gestures, (n,) each, by least squares.

        Without a margin it is the standard deviation of the residuals.

        Raises
        ------
        CharacterError
            If there are fewer than three pairs, or all accents are alike.
        """
        logs = np.log(np.maximum(psi, LEAST_PSI))
        if len(logs) < 3 or np.ptp(logs) < 1e-9:
            raise CharacterError(
                f"intensity rule: {len(logs)} pairs of accents and gestures; give three or more, "
                "with accents of several strengths"
            )
        slope, intercept = np.polyfit(logs, strengths, 1).tolist()
        residuals = strengths - (slope * logs + intercept)
        spread = float(residuals.std(ddof=2)) if margin is None else margin
        return IntensityRule(slope, intercept, spread)

    @staticmethod
    def spread_over(strengths: Array, margin: float = 1.0) -> "IntensityRule":
        """Return the rule for gestures (n,) that nobody spoke with.

        The constants of the thesis are those of its actor; here accents from a tenth of the
        strongest to the strongest go with the strengths from the 10 % to the 90 % quantile.
        """
        weak, strong = np.quantile(strengths, (0.1, 0.9)).tolist()
        return IntensityRule((strong - weak) / math.log(10.0), strong, margin)


def pair(apices: Array, strengths: Array, accents: Array, psi: Array) -> NDArray[np.intp]:
    """Return the number of the accent of each gesture, −1 for none, (gestures,).

    One to one and in order; an accent is between 0.2 s before and 0.5 s after the apex. By dynamic
    programming it is the pairing of the least sum of squared deviations: of Δ from its typical
    value, and of the ranks of GSI and PSI from each other.

    Parameters
    ----------
    apices, strengths
        Time [s], ascending, and GSI of each gesture, (gestures,).
    accents, psi
        Time [s], ascending, and PSI of each accent, (accents,).
    """
    delta = accents[None] - apices[:, None]
    allowed = (delta >= PAIRING_WINDOW_S[0]) & (delta <= PAIRING_WINDOW_S[1])
    unlike = _standard(strengths)[:, None] - _standard(np.log(np.maximum(psi, LEAST_PSI)))[None]
    cost = ((delta - TYPICAL_LEAD_S) / LEAD_DEVIATION_S) ** 2 + unlike**2
    cost = np.where(allowed, cost - 2 * UNPAIRED_COST, math.inf)  # what a pair adds
    count, others = cost.shape
    least = np.zeros((count + 1, others + 1))
    for i in range(1, count + 1):
        with_pair = least[i - 1, :-1] + cost[i - 1]
        least[i, 1:] = np.minimum.accumulate(np.minimum(least[i - 1, 1:], with_pair))
    found = np.full(count, -1, np.intp)
    i, j = count, others
    while i and j:
        if least[i, j] == least[i, j - 1]:
            j -= 1
        elif least[i, j] == least[i - 1, j]:
            i -= 1
        else:
            i, j = i - 1, j - 1
            found[i] = j
    return found


def _standard(values: Array) -> Array:
    """Return values less their mean, over their standard deviation."""
    spread = float(values.std()) if len(values) else 0.0
    return (values - values.mean()) / spread if spread > 1e-9 else np.zeros_like(values)
