"""A state of 24 emotions, each with an intensity of its own.

Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, section 5.2: e ← e + P a − C_e
(eqs. 5.7 to 5.11), P the responses of the personality. His steps are continuous here: an influence
acts at once, and intensities fade with time, so that the frame rate does not matter.
"""

from cubeling.affect.decay import decay
from cubeling.affect.emotion import Emotion
from cubeling.affect.emotion_settings import EmotionSettings, MoodLayer
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.labels import LabelSet
from cubeling.affect.occ import OCC_PLACES, activation_evaluation, face_intensities
from cubeling.affect.personality import Personality

MIN_INTENSITY = 0.2
"""Weaker emotions than this have no name: the word is "neutral"."""

_SIGNS = {word: 1.0 if valence > 0.0 else -1.0 for word, (valence, _) in OCC_PLACES.items()}


class EmotionState:
    """Intensities of 24 emotions, each 0…1, and the mood under them where there is one.

    The state is `intensities` and `mood`; everything else is given by the personality, which has
    `emotions`.
    """

    def __init__(self, personality: Personality, settings: EmotionSettings) -> None:
        self._personality, self._settings = personality, settings
        self._responses = settings.responses(personality.ocean)
        self._influences = {
            kind: {name: impulse.influences for name, impulse in impulses.items()}
            for kind, impulses in (("gain", personality.gains), ("event", personality.events))
        }
        self.intensities: dict[str, float] = dict.fromkeys(OCC_PLACES, 0.0)
        """How strongly each of the 24 is felt."""
        self.mood = 0.0
        """From bad, −1, to good, 1; 0 without a mood layer."""
        self._movement = 0.0

    def advance(self, action: str, share: float, movement: float, elapsed: float) -> None:
        """Account for a time [s] of an action, at a share of its gain, 0…1.

        `movement` raises the arousal at rest.
        """
        self._movement = movement
        rates = self._effects(self._influences["gain"].get(action, {}), share)
        self._move_mood(rates, elapsed)
        for word, intensity in self.intensities.items():
            rate = rates.get(word, 0.0)
            if intensity > 0.0 or rate > 0.0:
                self.intensities[word] = _clamp(self._after(intensity, rate, elapsed))

    def apply_event(self, event: str, strength: float) -> None:
        """Feel an event at once, at a strength of 0…1."""
        self._feel(self._influences["event"].get(event, {}), strength)

    def influence(self, word: str, value: float) -> None:
        """Feel one of the 24 emotions at once, by a value of 0…1 (a of eq. 5.10)."""
        self._feel(AffectImpulse(emotions={word: value}).influences, 1.0)

    def next_word(self, word: str, labels: LabelSet, hysteresis: float) -> str:
        """Return the word that follows another one.

        Labels that are emotions of the 24, or faces, are chosen by intensity: the strongest one,
        once it leads by the hysteresis. Others are chosen by their places.
        """
        strengths = self._strengths(labels)
        if strengths is None:
            return labels.next(word, self._place(), hysteresis)
        strongest = max(strengths, key=lambda each: strengths[each])
        leads = strengths[strongest] > strengths[word] + hysteresis
        return strongest if leads else word

    def show(self, word: str) -> Emotion:
        """Return the emotion under a word, with its intensity if it has one."""
        place = self._place()
        strengths = self._strengths(self._personality.label_set) or {}
        intensity = None if word == "neutral" else strengths.get(word)
        return Emotion(place.valence, place.arousal, word, intensity)

    def _strengths(self, labels: LabelSet) -> dict[str, float] | None:
        """Return the intensity of each label; None where labels are chosen by their places."""
        if labels.name == "occ":
            return {"neutral": MIN_INTENSITY, **self.intensities}
        if labels.name == "ekman":
            faces: dict[str, float] = dict(face_intensities(self.intensities).items())
            return {"neutral": MIN_INTENSITY} | faces
        return None

    def _place(self) -> Emotion:
        home, colour = self._personality.temperament, self._layer.colour
        rest = home.valence + colour * self.mood, home.arousal + self._movement
        return activation_evaluation(self.intensities, rest)

    def _effects(self, influences: dict[str, float], strength: float) -> dict[str, float]:
        """Return P a: what influences do to who has these traits and this mood."""
        tint = self._layer.colour * self.mood
        return {
            word: value * strength * self._responses[word] * (1.0 + tint * _SIGNS[word])
            for word, value in influences.items()
        }

    def _feel(self, influences: dict[str, float], strength: float) -> None:
        effects = self._effects(influences, strength)
        for word, value in effects.items():
            self.intensities[word] = _clamp(self.intensities[word] + value)
        self._push_mood(effects)

    @property
    def _layer(self) -> MoodLayer:
        return self._settings.mood or _NO_MOOD

    def _push_mood(self, effects: dict[str, float]) -> None:
        push = sum(_SIGNS[word] * value for word, value in effects.items())
        self.mood = min(max(self.mood + self._layer.share * push, -1.0), 1.0)

    def _move_mood(self, rates: dict[str, float], elapsed: float) -> None:
        rate = self._layer.share * sum(_SIGNS[word] * value for word, value in rates.items())
        mood = decay(self.mood, 0.0, rate, self._layer.half_life_s, elapsed)
        self.mood = min(max(mood, -1.0), 1.0)

    def _after(self, intensity: float, rate: float, elapsed: float) -> float:
        settings = self._settings
        if settings.decay == "linear":
            return intensity + (rate - settings.decay_per_s) * elapsed
        return decay(intensity, 0.0, rate, settings.half_life_s, elapsed)


_NO_MOOD = MoodLayer(share=0.0, colour=0.0)


def _clamp(value: float) -> float:
    return min(max(value, 0.0), 1.0)
