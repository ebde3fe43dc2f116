"""Beats: what moves with the stressed syllables of a speech, and the time in which hands live."""

from bisect import bisect_left, bisect_right
from collections.abc import Sequence

import numpy as np

from cubeling.characters.motion.curves import Keyed
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.speech.speech import Accent, Syllable, Utterance


class Pulses:
    """Movements of one shape and many sizes, that add up.

    Parameters
    ----------
    times
        What they are timed by, in order [s].
    sizes
        How large each is, (n, values).
    keys
        Times from there [s], ascending, and the shape's values then: 0 at both ends.
    """

    def __init__(
        self, times: Sequence[float], sizes: Array, keys: Sequence[tuple[float, float]]
    ) -> None:
        self._times, self._sizes = [*times], sizes
        self._first, self._last = keys[0][0], keys[-1][0]
        self._shape = Keyed(
            tuple(time - self._first for time, _ in keys),
            tuple(value for _, value in keys),
            "gonio",
        )

    def at(self, time: float) -> Array:
        """Return their sum at a time [s], (values,)."""
        low = bisect_left(self._times, time - self._last)
        high = bisect_right(self._times, time - self._first)
        found = np.zeros(self._sizes.shape[1])
        for number in range(low, high):
            own = time - self._times[number] - self._first
            found += self._sizes[number] * self._shape.at(own, self._last - self._first)
        return found


HEAD_WEAK_RAD, HEAD_STRONG_RAD = np.deg2rad(1.5), np.deg2rad(6.5)
"""How far the head goes down for the weakest and the strongest accent [rad]."""

TILT_SHARE = 0.35
"""How far it tilts and turns to a side meanwhile, at most, as a share of that."""

HEAD_KEYS = ((-0.52, 0.0), (-0.3, -0.4), (-0.08, 1.0), (0.36, 0.0))
"""It is lifted, down and back again, from the accent [s]: a stroke's apex is some 0.1 s before the
accent, and head and trunk are down about as long before that begins to show."""


def head_beats(accents: Sequence[Accent], rng: np.random.Generator) -> Pulses:
    """Return the small nods with which a head stresses what is said: rotation vectors (3,) [rad].

    Their axes are those of the body: x nods, y turns, z tilts. That heads move with stressed
    syllables: Munhall et al., "Visual prosody and speech intelligibility", 2004; sizes and times
    are ours.
    """
    strengths = np.array([each.strength for each in accents])
    nods = HEAD_WEAK_RAD + (HEAD_STRONG_RAD - HEAD_WEAK_RAD) * strengths
    aside = TILT_SHARE * rng.uniform(-1.0, 1.0, (2, len(accents)))
    sizes = np.stack([nods, nods * aside[0], nods * aside[1]], axis=1)
    return Pulses([each.time for each in accents], sizes, HEAD_KEYS)


SYLLABLE_S = 0.22
"""Longest way from a syllable's nucleus to where its movement begins and ends [s]."""


class SyllableSwing:
    """A number that goes up with one syllable and down with the next, fastest in their nuclei.

    Louder ones take it further; in pauses it rests.
    """

    def __init__(self, syllables: Sequence[Syllable]) -> None:
        self._edges: list[float] = []
        self._levels: list[float] = [0.0]
        for number, each in enumerate(syllables):
            before = syllables[number - 1].time if number else -np.inf
            after = syllables[number + 1].time if number + 1 < len(syllables) else np.inf
            self._edges += [
                max(each.time - SYLLABLE_S, (before + each.time) / 2),
                min(each.time + SYLLABLE_S, (after + each.time) / 2),
            ]
            level = 0.5 * each.loudness * (1.0 if number % 2 else -1.0)
            self._levels += [level, level]

    def at(self, time: float) -> float:
        """Return it at a time of the speech [s], −0.5…0.5."""
        place = bisect_right(self._edges, time)
        if place % 2 == 0:  # between two syllables
            return self._levels[place]
        low, high = self._edges[place - 1], self._edges[place]
        share = smoothstep((time - low) / max(high - low, 1e-6))
        return self._levels[place - 1] + share * (self._levels[place] - self._levels[place - 1])


GRID_S = 0.02
LOUD_S = 0.075
"""How long a syllable is loud, as a standard deviation [s]."""

SLOWEST = 0.35
"""Pace of hands in a pause, as a share of their mean pace."""

MEAN_S = 0.55
"""Over which that mean is taken, as a standard deviation [s]."""


class SyllableClock:
    """The time by which gestures are played: it runs in loud syllables, and lingers in pauses.

    Hands of people move with the loudness of what they say; planned gestures meet it only in their
    apices. Times of accents are kept, so apices stay where they are; between them the pace follows
    the loudness of the syllables, beside its own mean over a second. `share` of that is shown, 0…1.
    """

    def __init__(self, utterance: Utterance, share: float) -> None:
        end, fixed = utterance.duration, [each.time for each in utterance.accents]
        self._times = np.arange(0.0, end + GRID_S, GRID_S)
        self._times[-1] = end
        self._shown = self._times
        share = min(share, 1.0)
        if not utterance.syllables or not share or end < 2 * GRID_S:
            return
        loud = np.zeros(len(self._times))
        for each in utterance.syllables:
            away = (self._times - each.time) / LOUD_S
            loud = np.maximum(loud, (0.3 + 0.7 * each.loudness) * np.exp(-0.5 * away * away))
        pace = SLOWEST + (1.0 - SLOWEST) * loud / np.maximum(_mean(loud), 0.2)
        way = np.concatenate([[0.0], np.cumsum((pace[1:] + pace[:-1]) / 2 * GRID_S)])
        knots = np.array([0.0, *(t for t in fixed if 0.0 < t < end), end])
        # Between two accents the way takes as long as it did: the pace changes, not its end.
        ways = np.interp(knots, self._times, way)
        self._shown = self._times + share * (np.interp(way, ways, knots) - self._times)

    def at(self, time: float) -> float:
        """Return the time at which gestures are shown at a time of the speech [s]."""
        if not 0.0 < time < float(self._times[-1]):
            return time
        place = time / GRID_S
        low = min(int(place), len(self._shown) - 2)
        before, after = self._shown[low : low + 2].tolist()
        share = (time - low * GRID_S) / float(self._times[low + 1] - self._times[low])
        shown: float = before + (after - before) * share
        return shown


def _mean(values: Array) -> Array:
    reach = round(3 * MEAN_S / GRID_S)
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) * GRID_S / MEAN_S) ** 2)
    weight = np.convolve(np.ones(len(values)), kernel, "full")[reach:-reach]
    mean: Array = np.convolve(values, kernel, "full")[reach:-reach] / weight
    return mean
