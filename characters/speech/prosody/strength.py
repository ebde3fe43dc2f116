"""How strong pitch accents are: EV, EV2 and PSI.

A. Fernández-Baena (2015), section 8.1: the strength of a pitch accent is measured in the nucleus of
the accented syllable. Every factor is scaled to 0…1 over the accents of one speaker, between its
1 % and 99 % quantiles.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.prosody.contours import Prosody

FALL_SEMITONES = 1.0
"""An accent falls (H+L*) if its pitch ends so far below its beginning [semitones]."""


@dataclass(frozen=True, eq=False)
class AccentMeasures:
    """What is measured in the nuclei of accents, each (n,)."""

    duration: NDArray[np.float64]
    """Length of the nucleus [s]."""

    energy: NDArray[np.float64]
    """Mean power [relative to a constant sample of 1]."""

    pitch_range: NDArray[np.float64]
    """Highest minus lowest pitch [semitones]; 0 where it falls."""

    mean_pitch: NDArray[np.float64]
    """Mean pitch [semitones above 1 Hz]; NaN where nothing is voiced."""


def measure_accents(prosody: Prosody, nuclei: Sequence[tuple[float, float]]) -> AccentMeasures:
    """Return the measures of nuclei, given by start and end [s], such as of accented vowels.

    The thesis sets the range of a falling accent to the inverse of the largest range, which, of
    scaled ranges, would be a reward; here it is 0 before scaling (erratum 13 of the specification).
    """
    measures = []
    for start, end in nuclei:
        own = slice(*np.searchsorted(prosody.times, (start, end)).tolist())
        power = 10 ** (prosody.intensity[own] / 10)
        pitch = 12 * np.log2(prosody.f0[own][prosody.f0[own] > 0])
        energy = float(power.mean()) if len(power) else 0.0
        if not len(pitch):
            measures.append((end - start, energy, 0.0, np.nan))
            continue
        falls = pitch[0] - pitch[-1] > FALL_SEMITONES
        spread = 0.0 if falls else float(np.ptp(pitch))
        measures.append((end - start, energy, spread, float(pitch.mean())))
    return AccentMeasures(*np.array(measures, float).reshape(-1, 4).T)


def ev(measures: AccentMeasures) -> NDArray[np.float64]:
    """Return duration × energy, 0…1."""
    return scale_between_quantiles(measures.duration) * scale_between_quantiles(measures.energy)


def ev2(measures: AccentMeasures) -> NDArray[np.float64]:
    """Return EV × pitch range, 0…1: rising accents are strong, flat ones are 0."""
    return ev(measures) * scale_between_quantiles(measures.pitch_range)


def psi(measures: AccentMeasures) -> NDArray[np.float64]:
    """Return EV × the mean of pitch range and mean pitch, 0…1 (equation 8.1)."""
    pitch = 0.5 * scale_between_quantiles(measures.pitch_range) + 0.5 * scale_between_quantiles(
        measures.mean_pitch
    )
    return ev(measures) * pitch


def scale_between_quantiles(
    values: NDArray[np.float64], corpus: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """Return values from 0 to 1 between the 1 % and 99 % quantiles of a corpus; 0 for NaN.

    Without a corpus it is the values themselves. Where all are equal, 0.
    """
    corpus = values if corpus is None else corpus
    if not np.isfinite(corpus).any():
        return np.zeros(values.shape)
    low, high = np.nanquantile(corpus, (0.01, 0.99))
    return np.asarray(np.nan_to_num(((values - low) / max(high - low, 1e-12)).clip(0.0, 1.0)))


def matthews(labels: NDArray[np.bool_], predicted: NDArray[np.bool_]) -> float:
    """Return the correlation of two binary labels (Matthews 1975), −1…1; 0 if one is constant.

    >>> matthews(np.array([True, True, False]), np.array([True, True, False]))
    1.0
    """
    if labels.all() or predicted.all() or not labels.any() or not predicted.any():
        return 0.0
    return float(np.corrcoef(labels, predicted)[0, 1].round(12))
