"""Pitch accents, found in the sound of a speech.

A. Fernández-Baena (2015), "Animation and Interaction of Responsive, Expressive, and Tangible 3D
Virtual Characters", section 8.2, with four changes, for which `tests.bench.accents` has figures. A
voiced region that holds several syllables has a nucleus for each. A nucleus is where pitch and
loudness together are highest, each in units of how much the speaker varies it, and it stands out
beside the nuclei around it: nobody keeps distance, level and pitch for minutes. Of accents that are
too close the closest pair is thinned first, so that stricter settings never yield more accents.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.speech.phones import is_vowel
from cubeling.characters.speech.prosody.contours import Prosody, ProsodySettings, measure_prosody
from cubeling.characters.speech.speech import Accent, Phone, Samples

LOCAL_S = 1.0
"""A nucleus stands out beside those that are about so near [s]: a phrase lasts some seconds."""

SPREADS = 4.0
"""More times the usual deviation of a speaker is an error of measurement, or a cough."""

TEN_TO_NINETY = 2.56
"""Standard deviations between the 10 % and the 90 % quantile of a normal distribution."""

UNSTRESSED = 1.5
"""A syllable that is not stressed, such as a clitic, has an accent only if it is raised by so many
units more: whoever speaks may stress what no voice would."""

LEAST_SPREAD_DB, LEAST_SPREAD_SEMITONES = 1.5, 0.7
"""Loudness and pitch that vary less are monotonous."""

SYLLABLE_DIP_DB = 2.0
"""Two syllables of a voiced region are parted by such a dip of intensity [dB] (de Jong and Wempe
2009, "Praat script to detect syllable nuclei and measure speech rate automatically", section 2)."""

PAUSE_FOLLOWS_S = 0.15
"""A nucleus is the last before a pause if its voiced region ends so shortly before it [s]."""


@dataclass(frozen=True)
class AccentSettings:
    """How pitch accents are found."""

    threshold: float = 0.35
    """Least strength, as a share of the strongest nucleus, 0…1: less finds more of the accents that
    people hear (recall), more leaves out more that they do not hear (precision)."""

    min_distance: float = 0.3
    """Least time between two accents [s]."""

    pause_bonus: float = 0.15
    """Added before a pause, where prosody declines, as a share of the strongest nucleus."""

    prosody: ProsodySettings = field(default_factory=ProsodySettings)
    """How pitch, voiced regions and pauses are measured."""


@dataclass(frozen=True, eq=False)
class Nuclei:
    """The nuclei of syllables: where pitch and loudness are highest."""

    times: NDArray[np.float64]
    """When, in order, (n,) [s]."""

    strengths: NDArray[np.float64]
    """How much they stand out, (n,), 0 or more; the strongest is 1."""


def detect_accents(
    samples: Samples,
    rate: int,
    settings: AccentSettings | None = None,
    phones: Sequence[Phone] = (),
) -> tuple[Accent, ...]:
    """Return the pitch accents of a sound; where phones are known, only vowels can have one."""
    settings = settings or AccentSettings()
    return accents_of(measure_prosody(samples, rate, settings.prosody), phones, settings)


def accents_of(
    prosody: Prosody, phones: Sequence[Phone] = (), settings: AccentSettings | None = None
) -> tuple[Accent, ...]:
    """Return the pitch accents of a speech whose prosody is known."""
    settings = settings or AccentSettings()
    nuclei = syllable_nuclei(prosody, phones, settings.pause_bonus)
    strong = nuclei.strengths >= settings.threshold
    times, strengths = nuclei.times[strong], nuclei.strengths[strong]
    kept = _apart(times, strengths, settings.min_distance)
    return tuple(
        Accent(float(time), float(strength))
        for time, strength in zip(times[kept], strengths[kept], strict=True)
    )


def syllable_nuclei(
    prosody: Prosody, phones: Sequence[Phone] = (), pause_bonus: float = 0.15
) -> Nuclei:
    """Return the nuclei of all syllables with their strengths."""
    spans = _vowel_spans(prosody, phones) if phones else _voiced_spans(prosody)
    if not spans:
        return Nuclei(np.zeros(0), np.zeros(0))
    unstressed = np.array([not span.stressed for span in spans])
    voiced = prosody.f0 > 0
    pitch = 12 * np.log2(np.where(voiced, prosody.f0, 1.0))
    prominence = _deviation(prosody.intensity, voiced, LEAST_SPREAD_DB)
    prominence += np.where(voiced, _deviation(pitch, voiced, LEAST_SPREAD_SEMITONES), -SPREADS)
    at = np.array([span.first + prominence[span.first : span.end].argmax() for span in spans])
    times = prosody.times[at]
    local = _local_mean(times, prominence[at])
    strengths = 1.0 / (1.0 + np.exp(-(prominence[at] - local - UNSTRESSED * unstressed)))
    strengths = strengths + pause_bonus * strengths.max() * _before_pause(prosody, at)
    return Nuclei(times, strengths / strengths.max())


def _deviation(
    values: NDArray[np.float64], voiced: NDArray[np.bool_], least: float
) -> NDArray[np.float64]:
    """Return how far values are above their median, in units of how much the speaker varies them.

    Outliers, such as pitch that is an octave off, count no more than `SPREADS` units.
    """
    if not voiced.any():
        return np.zeros(len(values))
    low, middle, high = np.quantile(values[voiced], (0.1, 0.5, 0.9))
    spread = max((high - low) / TEN_TO_NINETY, least)
    return np.asarray(((values - middle) / spread).clip(-SPREADS, SPREADS))


def _local_mean(times: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of nuclei nearby, (n,), and of all where there are few."""
    means = np.empty(len(values))
    usual = float(values.mean())
    firsts = np.searchsorted(times, times - 4.0 * LOCAL_S)
    lasts = np.searchsorted(times, times + 4.0 * LOCAL_S)
    for index, (first, last) in enumerate(zip(firsts.tolist(), lasts.tolist(), strict=True)):
        weights = np.exp(-(((times[first:last] - times[index]) / LOCAL_S) ** 2) / 2.0)
        means[index] = (weights @ values[first:last] + usual) / (weights.sum() + 1.0)
    return means


@dataclass(frozen=True)
class _Syllable:
    """The frames of the nucleus of a syllable."""

    first: int
    end: int
    stressed: bool = True
    """False only if a voice does not stress it, and does stress others."""


def _voiced_spans(prosody: Prosody) -> list[_Syllable]:
    """Return the frames of each syllable: voiced regions, cut where the intensity dips."""
    spans: list[_Syllable] = []
    for start, end in prosody.voiced:
        first, last = np.searchsorted(prosody.times, (start, end)).tolist()
        cuts = _dips(prosody.intensity[first:last])
        bounds = [first, *(first + cut for cut in cuts), last]
        spans += [_Syllable(a, b) for a, b in itertools.pairwise(bounds) if b > a]
    return spans


def _dips(intensity: NDArray[np.float64]) -> list[int]:
    """Return the indices of dips of `SYLLABLE_DIP_DB` or more below the peaks on both sides."""
    cuts: list[int] = []
    peak, lowest, dip = -np.inf, np.inf, 0
    for index, value in enumerate(intensity.tolist()):
        if value < lowest:
            lowest, dip = value, index
        if min(peak, value) - lowest >= SYLLABLE_DIP_DB:
            cuts.append(dip)
            peak, lowest, dip = value, value, index
        elif value >= peak:
            peak, lowest, dip = value, value, index
    return cuts


def _vowel_spans(prosody: Prosody, phones: Sequence[Phone]) -> list[_Syllable]:
    """Return the voiced frames of each vowel; vowels side by side are one syllable."""
    voiced, spans = prosody.f0 > 0, list[_Syllable]()
    start, stressed = None, False
    told = any(phone.stressed for phone in phones)
    for phone, after in zip(phones, [*phones[1:], None], strict=True):
        if not is_vowel(phone.symbol):
            continue
        start = phone.start if start is None else start
        stressed |= phone.stressed is not False
        if after is not None and is_vowel(after.symbol) and not (told and after.stressed):
            continue
        first, last = np.searchsorted(prosody.times, (start, phone.end)).tolist()
        inside = first + np.flatnonzero(voiced[first:last])
        if len(inside):
            last = int(inside[-1])
            spans.append(_Syllable(int(inside[0]), last + 1, stressed or not told))
        start, stressed = None, False
    return spans


def _before_pause(prosody: Prosody, at: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which nuclei are the last before a pause, or before the end."""
    times = prosody.times[at]
    stops = np.append(prosody.pauses[:, 0], prosody.duration)
    last = np.searchsorted(times, stops, side="left") - 1
    ends = np.append(prosody.voiced[:, 1], 0.0)  # of the voiced regions
    region = np.searchsorted(prosody.voiced[:, 0], times, side="right") - 1
    ends = np.maximum(ends[region], times)
    found = np.zeros(len(at), bool)
    for nucleus, stop in zip(last, stops, strict=True):
        found[nucleus] |= bool(nucleus >= 0 and stop - ends[nucleus] <= PAUSE_FOLLOWS_S)
    return found


def _apart(
    times: NDArray[np.float64], strengths: NDArray[np.float64], min_distance: float
) -> NDArray[np.intp]:
    """Return which accents stay: the weaker of the closest pair goes until none is too close.

    The order of removals does not depend on `min_distance`, only where it stops; and a weak accent
    never removes a strong one. So the accents of stricter settings are among those of looser ones.
    """
    kept = np.arange(len(times))
    while len(kept) > 1:
        gaps = np.diff(times[kept])
        closest = int(gaps.argmin())
        if gaps[closest] >= min_distance:
            break
        weaker = closest + int(strengths[kept[closest + 1]] <= strengths[kept[closest]])
        kept = np.delete(kept, weaker)
    return kept
