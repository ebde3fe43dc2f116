"""Sound: steps, kisses, shouts and moods, synthesised, mixed, and played or written to a video.

Start with `SessionSound`. `SOUNDS` lists all sounds.
"""

from cubeling.app.sound.bank import SoundBank, write_wave
from cubeling.app.sound.cues import Cue, SoundCues
from cubeling.app.sound.loudspeaker import Loudspeaker, NoSoundError
from cubeling.app.sound.mixer import Mixer
from cubeling.app.sound.session_sound import SessionSound, SoundOutput
from cubeling.app.sound.sounds import SOUNDS
from cubeling.app.sound.synthesis import SAMPLE_RATE

__all__ = [
    "SAMPLE_RATE",
    "SOUNDS",
    "Cue",
    "Loudspeaker",
    "Mixer",
    "NoSoundError",
    "SessionSound",
    "SoundBank",
    "SoundCues",
    "SoundOutput",
    "write_wave",
]
