"""A line that the character says: what enters the pipeline from a voice, a file or a recording."""

from dataclasses import dataclass

from cubeling.characters.speech import DEFAULT_PROFILE, Samples, SpeechProfile, Utterance


@dataclass(frozen=True, eq=False)
class SpokenLine:
    """What is said, and its sound."""

    utterance: Utterance
    """What is said, with the times of its phones and accents."""

    samples: Samples
    """The sound, (n,)."""

    rate: int
    """Sample rate of the sound [Hz]."""

    profile: SpeechProfile = DEFAULT_PROFILE
    """How it is said with the body."""
