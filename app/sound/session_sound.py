"""What is heard of a session, on a loudspeaker or in a video."""

from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

import numpy as np

from cubeling.app.pipeline.step import Step, speech_start
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.pipeline.table.stage_sounds import PlayedSound, SoundClip
from cubeling.app.sound.cues import SoundCues, pan_of
from cubeling.app.sound.loudspeaker import Loudspeaker
from cubeling.app.sound.mixer import Mixer
from cubeling.app.sound.synthesis import SAMPLE_RATE, Array
from cubeling.characters import Character
from cubeling.characters.speech import resample

SPEECH_GAIN = 0.9
"""Amplitude of speech beside the other sounds."""


class SoundOutput(Protocol):
    """Lets a mixer be heard, on threads of its own: a `Loudspeaker`, or a browser."""

    playing: bool
    """Whether cues are heard now."""

    problem: str
    """Why nothing is heard; "" while all is well."""

    def close(self) -> None:
        """Fall silent; a second call does nothing."""
        ...


class SessionSound:
    """Turns the steps of a session into sound. Whoever makes it closes it.

    Parameters
    ----------
    mixer
        Mixes the sounds; a video takes its samples from there.
    live
        Whether they are heard on the loudspeaker; its threads start with the first sound.
    muted
        Whether nothing sounds at first.
    moods
        Whether the moods of each player's robot are heard.
    loudspeaker
        Opens what a live session is heard on; None for the loudspeaker of this computer.
    """

    def __init__(
        self,
        mixer: Mixer,
        *,
        live: bool = False,
        muted: bool = False,
        moods: Sequence[bool] = (True,),
        loudspeaker: Callable[[Mixer], SoundOutput] | None = None,
    ) -> None:
        self.mixer = mixer
        """Its `volume` may be changed at any time."""
        self._live, self._moods = live, moods
        self._open_loudspeaker = loudspeaker or Loudspeaker
        self._loudspeaker: SoundOutput | None = None
        self._character: Character | None = None
        self._cues: SoundCues | None = None
        self._line: SpokenLine | None = None
        self._stage: dict[str, PlayedSound] = {}
        self.muted = muted

    @property
    def muted(self) -> bool:
        """Whether nothing sounds; may be changed at any time."""
        return self._muted

    @muted.setter
    def muted(self, muted: bool) -> None:
        self._muted = muted
        if self._live and not muted and self._loudspeaker is None:
            self._loudspeaker = self._open_loudspeaker(self.mixer)

    @property
    def problem(self) -> str:
        """Why nothing is heard, in one line; "" if nothing is wrong."""
        return "" if self._loudspeaker is None else self._loudspeaker.problem

    def play(self, step: Step, character: Character, started_over: bool = False) -> None:
        """Let what begins with a step sound; see `SoundCues.update`. Call it once it is shown."""
        if self._cues is None or character is not self._character:
            self._character = character
            self._cues = SoundCues(character, moods=self._moods)
        cues = self._cues.update(step, started_over)
        unheard = self._loudspeaker is not None and not self._loudspeaker.playing
        if self._muted or unheard:
            self._play_stage((), step.frame.timestamp)
            return
        for cue in cues:
            self.mixer.start(cue)
        self._speak(step)
        self._play_stage(step.outcome.sounds, step.frame.timestamp)

    def _play_stage(self, sounds: Iterable[PlayedSound], now: float) -> None:
        """Let the scenario's own sounds be heard as they are at a time [s]: also from within."""
        playing, self._stage = self._stage, {each.key: each for each in sounds}
        for key in playing.keys() - self._stage.keys():
            self.mixer.play(key, np.zeros(0))
        for key, sound in self._stage.items():
            if key not in playing:
                late = max(round((now - sound.start) * SAMPLE_RATE), 0)
                self.mixer.play(key, sound.volume * at_sample_rate(sound.clip)[late:])
            elif sound.silent_at < playing[key].silent_at:
                self.mixer.play(key, np.zeros(0), fade_s=sound.silent_at - now)

    def _speak(self, step: Step) -> None:
        """Let who speaks say its line, from where it is; silence if nobody does.

        One of the cast speaks at a time; the line of another that has ended may still be read.
        """
        seen = max(step.cast, key=speech_start)
        if seen.line is self._line:
            return
        self._line, speech = seen.line, seen.command.speech
        if seen.line is None or speech is None:
            self.mixer.say(np.zeros(0))
            return
        late = round((step.frame.timestamp - speech.start) * SAMPLE_RATE)
        self.mixer.say(SPEECH_GAIN * at_sample_rate(seen.line)[late:], pan_of(seen.posed, step))

    def restart(self) -> None:
        """Forget the steps so far: the next one does not follow them, as after a seek."""
        self._cues, self._line = None, None
        self.mixer.say(np.zeros(0))
        self._play_stage((), 0.0)

    def close(self) -> None:
        """Fall silent; a second call does nothing."""
        if self._loudspeaker is not None:
            self._loudspeaker.close()


def at_sample_rate(sound: SpokenLine | SoundClip) -> Array:
    """Return a sound at `SAMPLE_RATE`, (n,)."""
    return np.asarray(resample(sound.samples, sound.rate, SAMPLE_RATE), float)
