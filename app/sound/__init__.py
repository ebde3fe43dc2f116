"""Sound: steps, kisses, shouts and moods, synthesised, mixed, and played or written to a video.

Start with `SessionSound`. `SOUNDS` lists all sounds.
"""

from app.sound.bank import SoundBank, write_wave
from app.sound.cues import Cue, SoundCues
from app.sound.loudspeaker import Loudspeaker, NoSoundError
from app.sound.mixer import Mixer
from app.sound.session_sound import SessionSound
from app.sound.sounds import SOUNDS
from app.sound.synthesis import SAMPLE_RATE

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
    "write_wave",
]
