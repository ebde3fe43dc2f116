"""What moves with the stressed syllables of a speech, and the time in which hands live.

All of it is planned for a whole speech: values at many `times` [s], from the start of its sound.
"""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.speech import Accent, Syllable, Utterance


def pulses(
    times: Array, at: Sequence[float], sizes: Array, keys: Sequence[tuple[float, float]]
) -> Array:
    """Return movements of one shape and many sizes, that add up, (times, values).

    Parameters
    ----------
    times
        When, ascending and even, (times,) [s].
    at
        What each is timed by [s].
    sizes
        How large each is, (n, values).
    keys
        Times from there [s], ascending, and the shape's values then: 0 at both ends.
    """
    found = np.zeros((len(times), sizes.shape[1]))
    moments, values = np.array(keys).T
    for time, size in zip(at, sizes, strict=True):
        first, last = np.searchsorted(times, (time + moments[0], time + moments[-1])).tolist()
        own = np.interp(times[first:last] - time, moments, np.arange(len(keys)))
        low = np.minimum(own.astype(int), len(keys) - 2)
        eased = (1.0 - np.cos(np.pi * (own - low))) / 2.0
        shape = values[low] + (values[low + 1] - values[low]) * eased
        found[first:last] += shape[:, None] * size
    return found


HEAD_WEAK_RAD, HEAD_STRONG_RAD = np.deg2rad(1.5), np.deg2rad(6.5)
"""How far the head goes down for the weakest and the strongest accent [rad]."""

TILT_SHARE = 0.35
"""How far it tilts and turns to a side meanwhile, at most, as a share of that."""

HEAD_KEYS = ((-0.42, 0.0), (-0.22, -0.4), (0.03, 1.0), (0.42, 0.0))
"""It is lifted, down and back again, from the accent [s]."""


ASIDE_KEYS = tuple((time, abs(value)) for time, value in HEAD_KEYS)
"""It is aside while it is lifted too [s]."""


def head_beats(times: Array, accents: Sequence[Accent], rng: np.random.Generator) -> Array:
    """Return the small nods with which a head stresses what is said, (times, 3) [rad].

    They are rotation vectors about the body's axes: x nods, y turns, z tilts. That heads move with
    stressed syllables: Munhall et al., "Visual prosody and speech intelligibility", 2004; sizes and
    times are ours.
    """
    strengths = np.array([each.strength for each in accents])
    nods = HEAD_WEAK_RAD + (HEAD_STRONG_RAD - HEAD_WEAK_RAD) * strengths
    turn, tilt = TILT_SHARE * rng.uniform(-1.0, 1.0, (len(accents), 2)).T
    at = [each.time for each in accents]
    nod = pulses(times, at, nods[:, None], HEAD_KEYS)
    aside = pulses(times, at, np.stack([nods * turn, nods * tilt], axis=1), ASIDE_KEYS)
    return np.concatenate([nod, aside], axis=1)


SYLLABLE_S = 0.22
"""Longest way from a syllable's nucleus to where its movement begins and ends [s]."""


def syllable_swing(times: Array, syllables: Sequence[Syllable]) -> Array:
    """Return what goes up with one syllable and down with the next, (times,), −0.5…0.5.

    It is fastest in their nuclei, goes further in louder ones, and rests in pauses.
    """
    if not syllables:
        return np.zeros(len(times))
    nuclei = np.array([each.time for each in syllables])
    loudness = np.array([each.loudness for each in syllables])
    middles = (nuclei[1:] + nuclei[:-1]) / 2.0
    starts = np.maximum(nuclei - SYLLABLE_S, np.append(-np.inf, middles))
    ends = np.minimum(nuclei + SYLLABLE_S, np.append(middles, np.inf))
    levels = np.append(0.0, 0.5 * loudness * np.where(np.arange(len(nuclei)) % 2, 1.0, -1.0))
    place = np.searchsorted(starts, times, side="right")  # of syllables that have begun
    now = np.maximum(place - 1, 0)
    share = (times - starts[now]) / np.maximum(ends[now] - starts[now], 1e-6)
    before = levels[now]
    moved: Array = before + smoothstep(share.clip(0.0, 1.0)) * (levels[place] - before)
    return moved


LOUD_S = 0.075
"""How long a syllable is loud, as a standard deviation [s]."""

PAUSE_PACE = 0.35
"""Pace of hands in a pause, as a share of their mean pace."""

MEAN_S = 0.55
"""Over which that mean is taken, as a standard deviation [s]."""


def syllable_clock(times: Array, utterance: Utterance) -> Array:
    """Return how far the time by which gestures are played is ahead, (times,) [s].

    Hands of people move with the loudness of what they say; planned gestures meet it in their
    apices only. So their time runs in loud syllables, and lingers in pauses. At accents it is the
    true time, so that apices stay where they are; between them its pace follows the loudness of the
    syllables, beside its own mean over a second.
    """
    step, end = float(times[1] - times[0]), utterance.duration
    loud = np.zeros(len(times))
    for each in utterance.syllables:
        away = (times - each.time) / LOUD_S
        loud = np.maximum(loud, (0.3 + 0.7 * each.loudness) * np.exp(-0.5 * away * away))
    pace = PAUSE_PACE + (1.0 - PAUSE_PACE) * loud / np.maximum(_mean(loud, MEAN_S / step), 0.2)
    way = np.append(0.0, np.cumsum((pace[1:] + pace[:-1]) / 2.0 * step))
    accents = (each.time for each in utterance.accents)
    knots = np.array([times[0], 0.0, *(t for t in accents if 0.0 < t < end), end, times[-1]])
    # Between two accents the way takes as long as it did: its pace changes, not its end.
    shown = np.interp(way, np.interp(knots, times, way), knots)
    ahead: Array = np.where((times > 0.0) & (times < end), shown - times, 0.0)
    return ahead


def _mean(values: Array, deviation: float) -> Array:
    """Return the mean of what there is under a Gaussian of a standard deviation [values]."""
    reach = round(3.0 * deviation)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    weight = np.convolve(np.ones(len(values)), kernel)[reach:-reach]
    mean: Array = np.convolve(values, kernel)[reach:-reach] / weight
    return mean
