"""What a speaker does while a speech sounds."""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.speech.prosody.accents import AccentSettings, accents_of, syllable_nuclei
from cubeling.characters.speech.prosody.contours import Prosody, measure_prosody
from cubeling.characters.speech.prosody.strength import scale_between_quantiles
from cubeling.characters.speech.speech import Phone, Speech, Syllable, Utterance
from cubeling.characters.speech.tagged_text import TaggedText

LOUDNESS_EXPONENT = 0.6
"""Loudness grows with this power of the sound pressure (S. S. Stevens 1955, "The measurement of
loudness", Journal of the Acoustical Society of America 27(5))."""


def utterance_of(
    speech: Speech, tagged: TaggedText | None = None, settings: AccentSettings | None = None
) -> Utterance:
    """Return a speech without its sound, with its pitch accents and its syllables.

    With the tagged text that was spoken, also with the gestures that it asks for.
    """
    settings = settings or AccentSettings()
    prosody = measure_prosody(speech.samples, speech.rate, settings.prosody)
    return Utterance(
        speech.text,
        speech.language,
        speech.duration,
        speech.words,
        speech.phones,
        accents_of(prosody, speech.phones, settings),
        tagged.gesture_spans(speech.words, speech.duration) if tagged is not None else (),
        syllables_of(prosody, speech.phones),
    )


def syllables_of(prosody: Prosody, phones: Sequence[Phone] = ()) -> tuple[Syllable, ...]:
    """Return the syllables of a speech whose prosody is known, with their loudness."""
    times = syllable_nuclei(prosody, phones).times
    if not len(times):
        return ()
    at = np.searchsorted(prosody.times, times).clip(0, len(prosody.times) - 1)
    loudness = scale_between_quantiles(10 ** (LOUDNESS_EXPONENT * prosody.intensity[at] / 20))
    return tuple(map(Syllable, times.tolist(), loudness.tolist()))
