"""Small variations of a resting posture, which never repeat and keep a person's tendencies.

Source: Egges 2006, section 3.4 (S9). For each of the first components, the extrema of the recorded
signal are clustered by value and by the time since the one before; a Markov chain of clusters makes
new ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.synthesis.idle.posture_space import PostureSpace
from cubeling.characters.synthesis.library import Frames

COMPONENTS, CLUSTERS, ERROR = 10, 8, 0.1
"""Components that vary; clusters of each; and how far a signal goes back, in its standard
deviations, before an extremum counts ([GAP]s of S9)."""

MIN_SEGMENT_S = 1.0
"""Shorter rests say nothing of variations [s]."""

_ROUNDS = 20  # of k-means


@dataclass(frozen=True)
class ComponentVariations:
    """The extrema of one component, and how they follow each other."""

    pairs: Array
    """Time since the extremum before [s], and value, (n, 2)."""

    members: tuple[Frames, ...]
    """Numbers of the pairs of each cluster."""

    transitions: Array
    """Probability of each cluster after each, (clusters, clusters); rows sum to 1."""


@dataclass(frozen=True)
class Variations:
    """The small variations of a person."""

    components: tuple[ComponentVariations, ...]
    """One for each component; all are still if no rest is long enough."""

    @staticmethod
    def of(segments: Sequence[Array], rate: float, seed: int = 0) -> "Variations":
        """Return the variations in rests: coordinates (frames, components) of a posture space."""
        long = [each - each.mean(0) for each in segments if len(each) >= MIN_SEGMENT_S * rate]
        if not long:
            count = min(segments[0].shape[1], COMPONENTS)
            return Variations((_still(MIN_SEGMENT_S),) * count)
        rng = np.random.default_rng(seed)
        spreads = np.concatenate(long).std(0)[:COMPONENTS]
        return Variations(
            tuple(
                _component([each[:, number] for each in long], ERROR * spread, rate, rng)
                for number, spread in enumerate(spreads.tolist())
            )
        )


def _component(
    signals: Sequence[Array], error: float, rate: float, rng: np.random.Generator
) -> ComponentVariations:
    """Return the extrema of one component's signals, clustered."""
    found = []
    for signal in signals:
        frames = np.array(extrema(signal, error))
        # Before the first one there is none, and the last one may be the end of the recording.
        found.append(np.stack([np.diff(frames) / rate, signal[frames[1:]]], axis=1)[:-1])
    pairs = np.concatenate(found)
    if not len(pairs):
        return _still(max(map(len, signals)) / rate)
    labels = _clusters(pairs / np.maximum(pairs.std(0), 1e-12), min(CLUSTERS, len(pairs)), rng)
    count = int(labels.max()) + 1
    follows = np.full((count, count), 1e-12)
    start = 0
    for each in found:
        own = labels[start : start + len(each)]
        np.add.at(follows, (own[:-1], own[1:]), 1.0)
        start += len(each)
    follows[follows.sum(1) < 0.5] += np.bincount(labels, minlength=count)
    members = tuple(np.flatnonzero(labels == number) for number in range(count))
    return ComponentVariations(pairs, members, follows / follows.sum(1, keepdims=True))


def _still(time: float) -> ComponentVariations:
    """Return the variations of a component that does not vary."""
    return ComponentVariations(np.array([[time, 0.0]]), (np.zeros(1, np.intp),), np.ones((1, 1)))


def extrema(signal: Array, error: float) -> list[int]:
    """Return where a signal turns round by more than an error: its zig-zag extrema.

    A signal that never moves that far has one, in its middle.

    >>> extrema(np.array([0.0, 1.0, 0.9, 2.0, 0.0, 0.1, 0.0, 3.0]), 0.5)
    [0, 3, 4, 7]
    """
    high = low = 0
    found: list[int] = []
    rising: bool | None = None
    values = signal.tolist()
    for frame, value in enumerate(values):
        high = frame if value > values[high] else high
        low = frame if value < values[low] else low
        if rising is not False and value < values[high] - error:
            found.append(high)
            rising, low = False, frame
        elif rising is not True and value > values[low] + error:
            found.append(low)
            rising, high = True, frame
    return [len(values) // 2] if rising is None else [*found, high if rising else low]


def _clusters(points: Array, count: int, rng: np.random.Generator) -> Frames:
    """Return the cluster of each point, (n,): k-means, numbered without gaps."""
    centres = points[rng.choice(len(points), count, replace=False)]
    for _ in range(_ROUNDS):
        labels = np.linalg.norm(points[:, None] - centres, axis=-1).argmin(1)
        for number in np.unique(labels).tolist():
            centres[number] = points[labels == number].mean(0)
    numbered: Frames = np.unique(labels, return_inverse=True)[1]
    return numbered


class VariationStream:
    """Makes variations in the order of time."""

    def __init__(
        self, variations: Variations, space: PostureSpace, rng: np.random.Generator
    ) -> None:
        self._rng, self._axes = rng, space.components[:, : len(variations.components)]
        count = len(variations.components)
        self._before, self._after = np.zeros((count, 2)), np.zeros((count, 2))  # time, value
        self.change(variations)

    def change(self, variations: Variations) -> None:
        """Take other variations, of as many components, from the next extremum of each on."""
        self._components = variations.components
        self._clusters = [int(self._rng.integers(len(each.members))) for each in self._components]

    def at(self, time: float) -> Array:
        """Return the offset of the posture at a time [s], not earlier than the last one; (size,).

        Between extrema, components follow a cubic curve that is level at both (Hermite).
        """
        for number in np.flatnonzero(self._after[:, 0] <= time).tolist():
            self._advance(number, time)
        u = (time - self._before[:, 0]) / np.maximum(self._after[:, 0] - self._before[:, 0], 1e-9)
        values = self._before[:, 1] + (self._after[:, 1] - self._before[:, 1]) * smoothstep(u)
        offset: Array = self._axes @ values
        return offset

    def _advance(self, number: int, time: float) -> None:
        own = self._components[number]
        while self._after[number, 0] <= time:
            row = own.transitions[self._clusters[number]]
            self._clusters[number] = cluster = int(self._rng.choice(len(row), p=row))
            members = own.members[cluster]
            (_, low), (_, high) = self._before[number], self._after[number]
            turning = members[(own.pairs[members, 1] < high) == (low < high)]
            members = turning if len(turning) else members  # an extremum turns round
            wait, value = own.pairs[int(self._rng.choice(members))]
            self._before[number] = self._after[number]
            self._after[number] = self._before[number, 0] + wait, value
