"""The face that a feeling makes: which expressions, how strongly, and when it keeps out of the way.

The words and their places in the plane of valence and arousal are Russell's ("A circumplex model of
affect", 1980); which expression goes with which word is what children draw.
"""

import math
from collections.abc import Sequence
from operator import mul

from affect import Emotion
from characters.face.expressions import EXPRESSIONS, Expressions
from characters.skeleton.pose import Array
from characters.smoothing import low_pass

RECIPES: dict[str, tuple[float, ...]] = {
    #            happy angry  sad  surprised relaxed lids
    "happy":     (1.00, 0.00, 0.00, 0.00, 0.00, 0.00),
    "excited":   (0.90, 0.00, 0.00, 0.30, 0.00, 0.00),
    "content":   (0.40, 0.00, 0.00, 0.00, 0.45, 0.00),
    "calm":      (0.10, 0.00, 0.00, 0.00, 0.60, 0.30),
    "sleepy":    (0.00, 0.00, 0.15, 0.00, 0.85, 0.60),
    "bored":     (0.00, 0.00, 0.50, 0.00, 0.15, 0.46),
    "sad":       (0.00, 0.00, 1.00, 0.00, 0.00, 0.00),
    "disgusted": (0.00, 0.60, 0.45, 0.00, 0.00, 0.25),
    "angry":     (0.00, 1.00, 0.00, 0.00, 0.00, 0.00),
    "afraid":    (0.00, 0.00, 0.75, 0.45, 0.00, 0.00),
    "surprised": (0.00, 0.00, 0.00, 1.00, 0.00, 0.00),
    "pleased":   (0.85, 0.00, 0.00, 0.00, 0.10, 0.00),
    "alert":     (0.25, 0.00, 0.00, 0.35, 0.00, 0.00),
    "distressed": (0.0, 0.35, 0.60, 0.20, 0.00, 0.00),
    "displeased": (0.0, 0.40, 0.50, 0.00, 0.00, 0.00),
    "depressed": (0.00, 0.00, 1.00, 0.00, 0.00, 0.20),
    "relaxed":   (0.20, 0.00, 0.00, 0.00, 0.60, 0.20),
}  # fmt: skip
"""For each word how far every one of `EXPRESSIONS` is on, and how far the lids hang, 0…1."""

_ALIKE = {"joy": "happy", "gratification": "happy", "anger": "angry", "hate": "angry",
          "surprise": "surprised", "fear": "afraid", "disgust": "disgusted",
          "distress": "sad", "pity": "sad"}  # fmt: skip
RECIPES.update((word, RECIPES[alike]) for word, alike in _ALIKE.items())

HINTED = 0.6
"""How much of a feeling shows that is still called neutral."""

FULL, LEAST = 0.85, 0.4
"""So far from neutral an expression is all there, and so much of it there is at least: who is
called angry looks angry."""

LAG = 0.4
"""How slowly a face follows a feeling [s]."""

_LOUD, _QUIET = (
    0.75,
    0.35,
)  # morphs of the mouth from which on it speaks, and below which it is mute
_SPEAKS = 0.5  # expression of an action that leaves no room for another
_GIVES_WAY, _RETURNS = 0.15, 0.7  # [s]: lags of the mood's face when an action speaks, and after

_CHANNELS = len(EXPRESSIONS) + 1  # and the lids
_NOTHING = (0.0,) * _CHANNELS
_SURPRISED = EXPRESSIONS.index("surprised")
_GONE = 1e-4  # of an expression that is not seen any more


def wish(emotion: Emotion) -> tuple[float, ...]:
    """Return how far each of `EXPRESSIONS` is to be on, and how far the lids are to hang, (6,).

    A word of `RECIPES` has a face of its own. "neutral" shows a hint of the place in the plane of
    valence and arousal; another word, or none, all of it.
    """
    place = emotion.valence, emotion.arousal
    strength = math.hypot(*place) / FULL
    recipe = RECIPES.get(emotion.word or "")
    if recipe is not None:
        strength = min(max(strength, LEAST), 1.0)
        return tuple(strength * part for part in recipe)
    share = HINTED if emotion.word == "neutral" else 1.0
    return tuple(share * part for part in _from_place(*place))


def _from_place(valence: float, arousal: float) -> tuple[float, ...]:
    """Return what the place alone says, without a word."""
    good, bad, calm = max(valence, 0.0), max(-valence, 0.0), max(-arousal, 0.0)
    stirred = min(max(0.5 + arousal, 0.0), 1.0)
    return (
        good * (0.4 + 0.6 * stirred),
        bad * stirred,
        bad * (1.0 - stirred),
        0.15 * max(arousal, 0.0) * (1.0 - abs(valence)),
        0.75 * calm * (1.0 - bad),
        0.74 * calm * calm,
    )


class Face:
    """The face of one character.

    An action that speaks, by the mouth or by an expression of its own, wins over the mood, which
    comes back when it is over. Nothing here touches a face that feels nothing.

    Parameters
    ----------
    morphs
        Names of the character's morphs.
    blinks
        How much of a blink is in each, (morphs,), as `blinks_in` gives it.
    """

    def __init__(self, morphs: Sequence[str], blinks: Array) -> None:
        there = Expressions.of(morphs)
        self.able = bool(there)
        """Whether it can show anything."""
        # A face has a few morphs only: plain numbers are quicker than arrays.
        self._speech: list[int] = there.speech.tolist()
        self._parts = [
            (number, [(column, weight) for column, weight in enumerate(row) if weight > 0.0])
            for number, row in zip(there.numbers.tolist(), there.weights.tolist(), strict=True)
        ]
        self._shut: list[float] = (blinks[there.numbers] @ there.weights).tolist()
        self._now, self._speeds = [0.0] * _CHANNELS, [0.0] * _CHANNELS
        self._room = 1.0
        self.felt = False
        """Whether there is anything to be shown."""

    def update(self, elapsed: float, emotion: Emotion | None) -> None:
        """Advance by a time [s] towards the face of an emotion; None for that of the clips."""
        wished = _NOTHING if emotion is None else wish(emotion)
        stirred = any(wished)
        if not self.felt and not stirred:
            return
        rate = 2.0 / LAG
        decay = math.exp(-rate * elapsed)  # of a critically damped spring, as in `damped_spring`
        for number, to in enumerate(wished):
            away, speed = self._now[number] - to, self._speeds[number]
            push = speed + rate * away
            self._now[number] = to + (away + push * elapsed) * decay
            self._speeds[number] = (speed - rate * push * elapsed) * decay
        self.felt = stirred or max(map(abs, (*self._now, *self._speeds))) > _GONE
        if not self.felt:
            self._now, self._speeds = [0.0] * _CHANNELS, [0.0] * _CHANNELS

    def show(
        self, weights: Array, elapsed: float, closed: float, acting: float
    ) -> tuple[float, float]:
        """Lay the face over the weights of morphs (morphs,) that clips give, in place.

        Parameters
        ----------
        weights
            Of all morphs.
        elapsed
            Since the last call [s].
        closed
            How far a blink has closed the lids, 0…1.
        acting
            How much an action shows a feeling of its own, 0…1.

        Returns
        -------
        How far the expressions hold the lids closed, and how far they are to hang, 0…1.
        """
        values = weights.tolist()
        room = self._room_beside(values, acting)
        lag = _GIVES_WAY if room < self._room else _RETURNS
        self._room = low_pass(self._room, room, elapsed, lag)
        room = self._room
        *shown, hang = [min(max(value * room, 0.0), 1.0) for value in self._now]
        left = 1.0 - min(sum(shown), 1.0)
        shut = sum(map(mul, shown, self._shut))
        shown[_SURPRISED] *= 1.0 - closed  # wide eyes would not close
        for number, parts in self._parts:
            values[number] *= left
            for column, weight in parts:
                values[number] += weight * shown[column]
        for number in self._speech:
            values[number] *= left
        weights[:] = values
        return min(shut, 1.0), hang

    def _room_beside(self, values: list[float], acting: float) -> float:
        """Return how much room the clips leave for a mood, 0…1."""
        speaking = 0.0
        if self._speech:
            loudest = max([values[number] for number in self._speech])
            speaking = (loudest - _QUIET) / (_LOUD - _QUIET)
        if acting > 0.0:
            strongest = max(values[number] for number, _ in self._parts)
            speaking = max(speaking, acting * strongest / _SPEAKS)
        return 1.0 - min(max(speaking, 0.0), 1.0)
