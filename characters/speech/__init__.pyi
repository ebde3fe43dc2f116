from cubeling.characters.control.speech_profile import (
    DATABASES as DATABASES,
    DEFAULT_PROFILE as DEFAULT_PROFILE,
    RANGES as RANGES,
    SpeechProfile as SpeechProfile,
)
from cubeling.characters.face.complexion import Complexion as Complexion, blood_of as blood_of
from cubeling.characters.face.visemes.sets import viseme_sets as viseme_sets
from cubeling.characters.speech.alignment.by_voice import align as align
from cubeling.characters.speech.alignment.sphinx import align_with_sphinx as align_with_sphinx
from cubeling.characters.speech.audio import read_speech as read_speech, resample as resample
from cubeling.characters.speech.mouth import (
    MouthTracker as MouthTracker,
    phones_from_sound as phones_from_sound,
)
from cubeling.characters.speech.phones import (
    SoundClass as SoundClass,
    is_vowel as is_vowel,
    sound_class as sound_class,
)
from cubeling.characters.speech.prosody.accent_labels import (
    LabelAgreement as LabelAgreement,
    read_accent_labels as read_accent_labels,
)
from cubeling.characters.speech.prosody.accents import (
    AccentSettings as AccentSettings,
    accents_of as accents_of,
    syllable_nuclei as syllable_nuclei,
)
from cubeling.characters.speech.prosody.analysis import utterance_of as utterance_of
from cubeling.characters.speech.prosody.contours import (
    Prosody as Prosody,
    measure_prosody as measure_prosody,
)
from cubeling.characters.speech.prosody.onsets import OnsetDetector as OnsetDetector
from cubeling.characters.speech.prosody.strength import (
    AccentMeasures as AccentMeasures,
    ev as ev,
    ev2 as ev2,
    matthews as matthews,
    measure_accents as measure_accents,
    psi as psi,
)
from cubeling.characters.speech.prosody.stress import stressed_like as stressed_like
from cubeling.characters.speech.recognition import (
    RECOGNIZED_LANGUAGE as RECOGNIZED_LANGUAGE,
    SpeechRecognizer as SpeechRecognizer,
    SpokenPhrase as SpokenPhrase,
    listening_problem as listening_problem,
)
from cubeling.characters.speech.saying import say as say
from cubeling.characters.speech.speech import (
    SILENCE as SILENCE,
    Accent as Accent,
    Samples as Samples,
    Speech as Speech,
    Utterance as Utterance,
)
from cubeling.characters.speech.tagged_text import (
    TEXT_FILE as TEXT_FILE,
    TaggedText as TaggedText,
)
from cubeling.characters.speech.textgrid import (
    Interval as Interval,
    read_textgrid as read_textgrid,
    textgrid_of as textgrid_of,
    with_textgrid as with_textgrid,
    write_textgrid as write_textgrid,
)
from cubeling.characters.speech.voices.espeak import (
    espeak as espeak,
    espeak_installed as espeak_installed,
    espeak_remedy as espeak_remedy,
)
from cubeling.characters.speech.voices.feeling import manner_of as manner_of
from cubeling.characters.speech.voices.voice import (
    Manner as Manner,
    UnspeakableError as UnspeakableError,
    Voice as Voice,
    VoiceError as VoiceError,
)
