"""Affect display: the face that shows an emotion, and when an action has priority.

Places of words: Russell, "A circumplex model of affect", 1980; which expressions they have is ours.
"""

from collections.abc import Sequence
from operator import mul

from cubeling.affect import OCC_FACES, Emotion
from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import damped_spring, low_pass

FACE_RECIPES: dict[str, tuple[float, ...]] = {
    #            happy angry  sad  surprised relaxed lids
    "happy":     (1.00, 0.00, 0.00, 0.00, 0.00, 0.00),
    "excited":   (0.85, 0.00, 0.00, 0.45, 0.00, 0.00),
    "content":   (0.40, 0.00, 0.00, 0.00, 0.45, 0.00),
    "calm":      (0.10, 0.00, 0.00, 0.00, 0.60, 0.30),
    "sleepy":    (0.00, 0.00, 0.15, 0.00, 0.85, 0.60),
    "bored":     (0.00, 0.00, 0.50, 0.00, 0.15, 0.46),
    "sad":       (0.00, 0.00, 1.00, 0.00, 0.00, 0.00),
    "disgusted": (0.00, 0.60, 0.45, 0.00, 0.00, 0.25),
    "angry":     (0.00, 1.00, 0.00, 0.00, 0.00, 0.00),
    "afraid":    (0.00, 0.00, 0.55, 0.85, 0.00, 0.00),
    "surprised": (0.00, 0.00, 0.00, 1.00, 0.00, 0.00),
    "pleased":   (0.50, 0.00, 0.00, 0.00, 0.30, 0.00),
    "alert":     (0.25, 0.00, 0.00, 0.35, 0.00, 0.00),
    "distressed": (0.0, 0.35, 0.60, 0.20, 0.00, 0.00),
    "displeased": (0.0, 0.40, 0.50, 0.00, 0.00, 0.00),
    "depressed": (0.00, 0.00, 1.00, 0.00, 0.00, 0.20),
    "relaxed":   (0.20, 0.00, 0.00, 0.00, 0.60, 0.20),
}  # fmt: skip
"""Weights of `EXPRESSIONS` and closure of the lids for each word, 0…1."""

FACE_RECIPES.update((word, FACE_RECIPES[face]) for word, face in OCC_FACES.items())  # table 5.2

EMOTIONAL_WORDS = frozenset(FACE_RECIPES)
"""Words with an expression of their own; an action named so shows the emotion by its clip."""

NEUTRAL_SHARE = 0.6
"""Share of the expression that is shown while the word is "neutral"."""

FACE_LAG_S = 0.4
"""Lag with which a face follows an emotion [s]."""

SPEECH_START, SPEECH_FULL = 0.35, 0.75
"""Weights of mouth morphs from which on an action speaks, and at which it leaves no room."""

FULL_EXPRESSION = 0.5
"""Weight of an action's own expression that leaves no room for another."""

YIELD_LAG_S, RETURN_LAG_S = 0.15, 0.7
"""Lags with which the emotion's face yields to an action, and returns [s]."""

NEGLIGIBLE_WEIGHT = 1e-4
"""Weight below which an expression is not visible."""

_CHANNEL_COUNT = len(EXPRESSIONS) + 1  # and the lids
_ZERO_WEIGHTS = (0.0,) * _CHANNEL_COUNT
_SURPRISED_CHANNEL = EXPRESSIONS.index("surprised")


def expression_weights(emotion: Emotion) -> tuple[float, ...]:
    """Return the weights of `EXPRESSIONS`, and the closure of the lids, for an emotion, (6,).

    A word of `FACE_RECIPES` has a face of its own. "neutral" shows a share of what the place in the
    plane of valence and arousal gives; another word, or none, all of it.
    """
    place = emotion.valence, emotion.arousal
    recipe = FACE_RECIPES.get(emotion.word or "")
    if recipe is not None:
        return tuple(emotion.strength * part for part in recipe)
    share = NEUTRAL_SHARE if emotion.word == "neutral" else 1.0
    return tuple(share * part for part in _from_place(*place))


def _from_place(valence: float, arousal: float) -> tuple[float, ...]:
    """Return the weights that valence and arousal give without a word."""
    pleasant, unpleasant, calm = max(valence, 0.0), max(-valence, 0.0), max(-arousal, 0.0)
    excited = min(max(0.5 + arousal, 0.0), 1.0)
    return (
        pleasant * (0.4 + 0.6 * excited),
        unpleasant * excited,
        unpleasant * (1.0 - excited),
        0.15 * max(arousal, 0.0) * (1.0 - abs(valence)),
        0.75 * calm * (1.0 - unpleasant),
        0.74 * calm * calm,
    )


class AffectDisplay:
    """The face of one character.

    An action that speaks, by the mouth or by an expression of its own, has priority over the
    emotion. Without an emotion the face is left to the clips.

    `blinks` tell how far each of the `morphs` closes the lids, (morphs,): see `blink_shares`.
    """

    def __init__(self, morphs: Sequence[str], blinks: Array) -> None:
        found = ExpressionMorphs.of(morphs)
        self._able = bool(found)
        # A face has a few morphs only: plain numbers are quicker than arrays.
        self._speech: list[int] = found.speech.tolist()
        self._parts = [
            (number, [(column, weight) for column, weight in enumerate(row) if weight > 0.0])
            for number, row in zip(found.numbers.tolist(), found.weights.tolist(), strict=True)
        ]
        self._closing: list[float] = (blinks[found.numbers] @ found.weights).tolist()
        self._weights, self._rates = [0.0] * _CHANNEL_COUNT, [0.0] * _CHANNEL_COUNT
        self._room = 1.0
        self._visible = False

    @property
    def active(self) -> bool:
        """Whether there is an expression to be shown."""
        return self._able and self._visible

    def update(self, elapsed: float, emotion: Emotion | None, acted: str = "") -> None:
        """Advance by a time [s] towards the face of an emotion; None for that of the clips.

        Clips that have the face of a word, `acted`, get only what the emotion adds to it.
        """
        targets = _ZERO_WEIGHTS if emotion is None else expression_weights(emotion)
        if acted:
            shown = FACE_RECIPES[acted]
            targets = tuple(max(own - part, 0.0) for own, part in zip(targets, shown, strict=True))
        asked = any(targets)
        if not self._visible and not asked:
            return
        for channel, target in enumerate(targets):
            self._weights[channel], self._rates[channel] = damped_spring(
                self._weights[channel], self._rates[channel], target, elapsed, FACE_LAG_S
            )
        largest = max(map(abs, (*self._weights, *self._rates)))
        self._visible = asked or largest > NEGLIGIBLE_WEIGHT
        if not self._visible:
            self._weights, self._rates = [0.0] * _CHANNEL_COUNT, [0.0] * _CHANNEL_COUNT

    def apply(
        self, weights: Array, elapsed: float, closed: float, acting: float
    ) -> tuple[float, float]:
        """Lay the face over the morph weights (morphs,) of the clips, in place.

        A blink has `closed` the lids so far, and an action shows so much of its own emotion
        (`acting`), both 0…1; `elapsed` is the time since the last call [s].

        Returns
        -------
        How far the expressions close the lids, and how far the emotion lowers them, 0…1.
        """
        values = weights.tolist()
        room = self._room_beside(values, acting)
        lag = YIELD_LAG_S if room < self._room else RETURN_LAG_S
        self._room = low_pass(self._room, room, elapsed, lag)
        room = self._room
        *shown, lowered = [min(max(value * room, 0.0), 1.0) for value in self._weights]
        left = 1.0 - min(sum(shown), 1.0)
        closing = sum(map(mul, shown, self._closing))
        shown[_SURPRISED_CHANNEL] *= 1.0 - closed  # wide eyes would not close
        for number, parts in self._parts:
            values[number] *= left
            for column, weight in parts:
                values[number] += weight * shown[column]
        for number in self._speech:
            values[number] *= left
        weights[:] = values
        return min(closing, 1.0), lowered

    def _room_beside(self, values: list[float], acting: float) -> float:
        """Return the room that the clips leave for an emotion, 0…1."""
        speaking = 0.0
        if self._speech:
            loudest = max([values[number] for number in self._speech])
            speaking = (loudest - SPEECH_START) / (SPEECH_FULL - SPEECH_START)
        if acting > 0.0:
            strongest = max(values[number] for number, _ in self._parts)
            speaking = max(speaking, acting * strongest / FULL_EXPRESSION)
        return 1.0 - min(max(speaking, 0.0), 1.0)
