"""A character that moves mouth and hands as somebody speaks into a microphone."""

import time
from collections.abc import Callable

from cubeling.affect import Emotion
from cubeling.app.errors import AppError
from cubeling.app.sound import NoSoundError
from cubeling.app.speaking.microphone import MICROPHONE_HZ, SILENT_S, Microphone
from cubeling.app.speaking.speech_video import (
    AZIMUTH_RAD,
    ELEVATION_RAD,
    VIEWER,
    focus_of,
)
from cubeling.app.speaking.view import View
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    LiveMouthLayer,
    PosedCharacter,
    RootDelta,
    SpeechIntent,
    layers_of,
)
from cubeling.characters.rendering import PortraitRenderer
from cubeling.characters.speech import (
    DEFAULT_PROFILE,
    Accent,
    MouthTracker,
    OnsetDetector,
    Samples,
    SpeechProfile,
    Utterance,
    blood_of,
)

PREPARED_S = 0.4
"""So much of the preparation of a beat is left out [s]: hands cannot foresee a stressed syllable,
and join in late."""

BEAT_S, WHOLE_S = 0.8, 1.3
"""Time from the beginning of a beat to what it stresses, and to its end [s]."""


class LiveRealizer:
    """Animates a character by sound that comes in blocks, at `rate` [Hz]."""

    def __init__(
        self,
        character: Character,
        rate: int = MICROPHONE_HZ,
        emotion: Emotion | None = None,
        profile: SpeechProfile = DEFAULT_PROFILE,
    ) -> None:
        self._mouth = LiveMouthLayer(character)
        layers = [*layers_of(character), lambda _character, _seed: self._mouth]
        self._animator = Animator(character, place=RootDelta(), layers=layers)
        self._tracker, self._onsets = MouthTracker(rate), OnsetDetector(rate)
        self._emotion, self._profile = emotion, profile
        self._speech: SpeechIntent | None = None

    def update(self, sound: Samples, now: float) -> PosedCharacter:
        """Take the sound up to a time [s], (n,), and return the character at that time."""
        self._mouth.mouth = self._tracker.update(sound)
        strength = self._onsets.update(sound)
        if strength is not None:
            said = Utterance("", "", WHOLE_S, accents=(Accent(BEAT_S, strength),))
            self._speech = SpeechIntent(said, now - PREPARED_S, self._profile)
        command = CharacterCommand(now, gaze=VIEWER, emotion=self._emotion, speech=self._speech)
        return self._animator.update(command)


def speak_live(
    character: Character,
    *,
    size: tuple[int, int],
    view: View,
    emotion: Emotion | None,
    profile: SpeechProfile,
    clock: Callable[[], float] = time.monotonic,
) -> None:
    """Show a character in a window that moves with the microphone, until the window is closed.

    Raises
    ------
    AppError
        There is no microphone or display, or the microphone was lost.
    """
    from cubeling.app.ui.window.picture_window import PictureWindow  # needs a display's libraries

    realizer = LiveRealizer(character, MICROPHONE_HZ, emotion, profile)
    try:
        microphone = Microphone()
    except NoSoundError as error:
        raise AppError(error.advice) from error
    window = PictureWindow(size, "Cubeling: speak")
    renderer = PortraitRenderer(window.context, size)
    begin = last = clock()
    focus = focus_of(character, realizer.update(microphone.read(), 0.0).pose, view)
    try:
        while not window.closed:
            sound, now = microphone.read(), clock()
            last = now if len(sound) else last
            if now - last > SILENT_S:
                raise AppError("the microphone was lost")
            pose = realizer.update(sound, now - begin).pose
            window.show_picture(
                renderer.portrait(
                    character,
                    pose,
                    azimuth=AZIMUTH_RAD,
                    elevation=ELEVATION_RAD,
                    focus=focus,
                    blood=blood_of(emotion),
                )
            )
            window.poll()
    finally:
        renderer.release()
        microphone.close()
        window.close()
