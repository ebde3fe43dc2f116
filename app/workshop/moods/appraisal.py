"""What each event and action of a personality raises: emotions, a face, and a robot's label."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cubeling.affect import WORD_FACES, Emotion, Feelings, Personality, closest_word

ACTION_S = 5.0
"""How long an action of full intensity lasts in the table [s]."""

STEP_S = 0.1
"""Time from update to update [s]."""


@dataclass(frozen=True)
class Appraisal:
    """What something that happens to a character at rest makes it feel."""

    happening: str
    """An event of the personality, or an action."""

    intensities: tuple[tuple[str, float], ...]
    """The 24 emotions that it raises, the strongest first; none without a state of them."""

    emotion: Emotion
    """What character and robot show."""

    face: str
    """Which of Ekman's faces shows it."""

    label: str
    """What a robot with its own moods shows."""


def appraise(personality: Personality, moods: Sequence[str]) -> tuple[Appraisal, ...]:
    """Return what every event and action of a personality raises, for a robot with such moods."""
    happenings = [*personality.events, *personality.gains]
    return tuple(_appraise(personality, each, moods) for each in happenings)


def without_emotions(personality: Personality) -> Personality:
    """Return the same personality with valence and arousal only, and words by their places."""
    return replace(personality, emotions=None)


def _appraise(personality: Personality, happening: str, moods: Sequence[str]) -> Appraisal:
    feelings = Feelings(personality)
    emotion = feelings.update("idle", 0.0, 0.0)
    if happening in personality.events:
        feelings.apply_event(happening)
        emotion = feelings.update("idle", 0.0, 0.0)
    else:
        for step in range(1, round(ACTION_S / STEP_S) + 1):
            emotion = feelings.update(happening, 1.0, step * STEP_S)
    felt = feelings.intensities if personality.emotions is not None else {}
    raised = sorted(
        ((word, value) for word, value in felt.items() if value > 0.0), key=lambda each: -each[1]
    )
    face = WORD_FACES[emotion.label]
    return Appraisal(
        happening, tuple(raised), emotion, face, closest_word(moods, emotion) or emotion.label
    )
