"""What a speaker does while a speech sounds."""

from cubeling.characters.speech.accents import AccentSettings, detect_accents
from cubeling.characters.speech.speech import Speech, Utterance
from cubeling.characters.speech.tagged_text import TaggedText


def utterance_of(
    speech: Speech, tagged: TaggedText | None = None, settings: AccentSettings | None = None
) -> Utterance:
    """Return a speech without its sound, with its pitch accents.

    With the tagged text that was spoken, also with the gestures that it asks for.
    """
    return Utterance(
        speech.text,
        speech.language,
        speech.duration,
        speech.words,
        speech.phones,
        detect_accents(speech.samples, speech.rate, settings, speech.phones),
        tagged.gesture_spans(speech.words, speech.duration) if tagged is not None else (),
    )
