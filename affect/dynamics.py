"""How an emotion changes: actions and events move it, and it decays to the temperament."""

import math
from collections.abc import Mapping
from types import MappingProxyType

from cubeling.affect.emotion import Emotion
from cubeling.affect.emotion_state import EmotionState
from cubeling.affect.errors import AffectError
from cubeling.affect.personality import Personality, check_range
from cubeling.affect.plane_state import PlaneState

TOP_SPEED = 5.0
"""AvatAR's Speed at which a character moves as fast as it can."""

MAX_TIME_STEP_S = 0.5
"""Longest time that one update accounts for [s]: a camera that hung saw no kisses."""


class Feelings:
    """The emotional state of one character; everything that shows an emotion takes it from here.

    A personality with `emotions` has a state of 24 emotions (`EmotionState`), any other one of
    valence and arousal (`PlaneState`). Both are solved exactly: the result does not depend on how
    often `update` is called, except for the times at which a label may change.

    Parameters
    ----------
    personality
        A personality, or the name of a bundled one or a .toml file.

    Raises
    ------
    AffectError
        If there is no such personality, or its file is invalid.
    """

    def __init__(self, personality: Personality | str = "thesis") -> None:
        if isinstance(personality, str):
            personality = Personality.load(personality)
        self.personality = personality
        """What sets how the emotion changes."""
        self._state: PlaneState | EmotionState = (
            PlaneState(personality)
            if personality.emotions is None
            else EmotionState(personality, personality.emotions)
        )
        self._label_set = personality.label_set
        self._next_word = self._word = self._label_set.start
        # Infinitely long ago: the dwell time never holds back the first word.
        self._word_since = -math.inf
        self._timestamp: float | None = None

    def update(self, action: str, weight: float, timestamp: float, speed: float = 0.0) -> Emotion:
        """Account for what the character did since the last update.

        Parameters
        ----------
        action
            What the character did. An action without a gain in the personality has no effect.
        weight
            Intensity of the action, −1…1: the rate is gain · (1 + weight) / 2.
        timestamp
            Now [s]. The first update only starts the clock; at most `MAX_TIME_STEP_S` counts.
        speed
            AvatAR's Speed, 0…5; more counts as 5.

        Raises
        ------
        AffectError
            If the weight or the speed is out of range, or time runs backwards. The state is then
            unchanged.
        """
        check_range(f"the weight of {action!r}", weight, -1.0, 1.0)
        check_range("the speed", speed, 0.0, math.inf)
        # Before anything is changed: a refused update leaves the state as it was.
        elapsed = self._time_since_update(timestamp)
        movement = min(speed / TOP_SPEED, 1.0) * self.personality.movement
        self._state.advance(action, (1.0 + weight) / 2.0, movement, elapsed)
        self._choose_word(timestamp)
        return self.emotion

    def apply_event(self, event: str, strength: float = 1.0) -> bool:
        """Apply an event, which takes effect at once: the cube is shaken, say.

        Parameters
        ----------
        event
            Its name. One that the personality does not know has no effect.
        strength
            How strong it is, 0…1.

        Returns
        -------
        bool
            Whether the personality knows the event. The next update shows the effect.

        Raises
        ------
        AffectError
            If the strength is out of range.
        """
        check_range(f"the strength of {event!r}", strength, 0.0, 1.0)
        self._state.apply_event(event, strength)
        return event in self.personality.events

    def influence(self, word: str, value: float) -> None:
        """Feel one of the 24 emotions at once: what somebody says makes a character sad, say.

        Parameters
        ----------
        word
            One of the 24 emotions, "fear-confirmed".
        value
            How strongly, 0…1 (`a` of Egges 2006, eq. 5.10); the traits scale it. The next update
            shows the effect.

        Raises
        ------
        AffectError
            If there is no such emotion, or the value is out of range.
        """
        check_range(f"the influence on {word!r}", value, 0.0, 1.0)
        self._state.influence(word, value)

    @property
    def intensities(self) -> Mapping[str, float]:
        """How strongly each of the 24 emotions is felt, 0…1.

        Without a state of them: how far valence and arousal have gone towards the place of each.
        """
        return MappingProxyType(dict(self._state.intensities))

    @property
    def emotion(self) -> Emotion:
        """The emotion now; its word has hysteresis and dwell."""
        return self._state.show(self._word)

    def _choose_word(self, now: float) -> None:
        """Choose the next word, and take it once the present one has lasted its dwell time."""
        # The candidate has hysteresis against itself, not against the word that is shown: during
        # the
        # dwell time it goes on moving, and the newest one is taken at its end.
        labels, personality = self._label_set, self.personality
        self._next_word = self._state.next_word(self._next_word, labels, personality.hysteresis)
        if self._next_word == self._word or now - self._word_since < personality.dwell:
            return
        # Robots have motions only from and to neutral: from happy to angry it passes the hub.
        through_hub = labels.hub not in (None, self._next_word, self._word)
        self._word = str(labels.hub) if through_hub else self._next_word
        self._word_since = now

    def _time_since_update(self, now: float) -> float:
        last = now if self._timestamp is None else self._timestamp
        if not last <= now < math.inf:  # also refuses NaN
            raise AffectError(
                f"feelings at {last} s cannot go back to {now} s: "
                "give each recording its own Feelings"
            )
        self._timestamp = now
        return min(now - last, MAX_TIME_STEP_S)
