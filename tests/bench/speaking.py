"""Measure how a character speaks: how soon, with how much of its body, and how well that fits.

    python -m tests.bench.speaking [--minutes 2] [--only sound|body|alignment]

The first sound, how far a live mouth is behind, and how fast a video renders; what the body does,
frozen and alive; and whether hands fit their own speech better than others (`speaking_body`).

Sound and text are those of eSpeak NG, so they are ours; latencies of loudspeaker and microphone are
the device's own and not in it.
"""

import argparse
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from rich.console import Console

from cubeling.app.speaking.line_chooser import LineRequest
from cubeling.app.speaking.lines import bundled_lines
from cubeling.app.speaking.live import LiveRealizer
from cubeling.app.speaking.microphone import BLOCK, MICROPHONE_HZ
from cubeling.app.speaking.speaker import line_of
from cubeling.app.speaking.speech_video import Direction, speech_clip, write_video
from cubeling.characters import Character
from cubeling.characters.control.speech_profile import DEFAULT_PROFILE
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs
from cubeling.characters.retargeting.root import with_root_joint
from cubeling.characters.speech.audio import resample
from cubeling.characters.speech.voices import Manner, Voice, espeak
from tests.bench.speaking_body import alignment, body

CONSOLE = Console(highlight=False, soft_wrap=True)
FRAME_S = 1 / 30
LOUDSPEAKER_S = 0.025  # `cubeling.app.sound.loudspeaker.LATENCY_S`
TEXT = (
    "Hello and welcome. I am a small paper person, and I live on your table. Today I want to tell "
    "you how a cube, a voice and a robot come together. "
)
SECONDS_OF_TEXT = 9.3


def first_sound(voice: Voice) -> None:
    """Print the time from a request to the line with its accents, for all bundled lines."""
    took = []
    for scenario in ("companion", "follow", "sketch"):
        for language in ("en", "es"):
            lines = bundled_lines(scenario, language)
            assert lines is not None
            for said in lines.lines.values():
                for text in said:
                    request = LineRequest(text, language, Manner())
                    begin = time.perf_counter()
                    line_of(voice, request, DEFAULT_PROFILE)
                    took.append(time.perf_counter() - begin)
    first, later = took[0], np.array(took[1:])
    worst = later.max() + FRAME_S + LOUDSPEAKER_S
    table = f"a line, {len(took)} lines: median {1e3 * np.median(later):.0f} ms"
    CONSOLE.print(f"{table}, longest {1e3 * later.max():.0f}, the first of all {1e3 * first:.0f}")
    heard = "first sound, with a frame and the loudspeaker's buffer"
    CONSOLE.print(f"{heard}: {1e3 * worst:.0f} ms at most (bar: 150)")


def live_mouth(human: Character, voice: Voice) -> None:
    """Print how far the mouth of a live voice is behind its sound.

    The mouth is taken at the rate of the blocks, by the time that its opening lags behind the
    loudness of the same sound, at the greatest correlation.
    """
    speech = voice.say("Papa, mama, baba! My, oh my! Poppy and Bob are a happy couple.")
    sound = resample(speech.samples, speech.rate, MICROPHONE_HZ)
    performer, mouth = LiveRealizer(human), MouthMorphs.of(human.morphs)
    opening, loudness, took = [], [], []
    for number in range(len(sound) // BLOCK):
        block = sound[number * BLOCK : (number + 1) * BLOCK]
        begin = time.perf_counter()
        pose = performer.update(block, (number + 1) * BLOCK / MICROPHONE_HZ).pose
        took.append(time.perf_counter() - begin)
        opening.append(0.0 if pose.morphs is None else pose.morphs[mouth.numbers].max())
        loudness.append(np.sqrt(np.mean(block * block)))
    lags = range(-10, 30)
    fits = [_correlation(np.array(opening), np.array(loudness), lag) for lag in lags]
    lag = 10.0 * list(lags)[int(np.argmax(fits))]
    behind = lag + 5 + 1e3 * FRAME_S / 2
    CONSOLE.print(f"live mouth: {lag:.0f} ms behind the sound (correlation {max(fits):.2f})")
    CONSOLE.print(f"a block of 10 ms takes {1e3 * np.median(took):.1f} ms")
    CONSOLE.print(f"with half a block and half a frame at 30 Hz: {behind:.0f} ms (bar: 60)")


def _correlation(opening: np.ndarray, loudness: np.ndarray, lag: int) -> float:
    """Return how well one follows the other by a lag [blocks]."""
    count = len(opening) - abs(lag)
    late = opening[max(lag, 0) :][:count]
    early = loudness[max(-lag, 0) :][:count]
    return float(np.corrcoef(late, early)[0, 1])


def rendering(human: Character, voice: Voice, minutes: float) -> None:
    """Print how long a video of a long text takes."""
    text = TEXT * max(round(60 * minutes / SECONDS_OF_TEXT), 1)
    begin = time.perf_counter()
    line = line_of(voice, LineRequest(text, "en", Manner()), DEFAULT_PROFILE)
    said = time.perf_counter() - begin
    clip = speech_clip(human, line, Direction(), 25.0)
    moved = time.perf_counter() - begin - said
    with TemporaryDirectory() as folder:
        write_video(
            Path(folder) / "long.mp4", human, clip, line, size=(640, 480), view="hands",
            subtitles=True,
        )  # fmt: skip
    whole = time.perf_counter() - begin
    seconds = line.utterance.duration
    CONSOLE.print(f"a text of {seconds:.0f} s at 640x480, 25 Hz, takes {whole:.0f} s")
    CONSOLE.print(f"that is {whole / seconds:.2f} of real time (bar: 1)")
    pictures = whole - said - moved
    CONSOLE.print(f"speech {said:.1f} s, motion {moved:.1f} s, pictures {pictures:.1f} s")


def main() -> None:
    """Print all of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=2.0, help="length of the long text")
    parser.add_argument("--only", choices=("sound", "body", "alignment"), help="one part of it")
    asked = parser.parse_args()
    human = with_root_joint(Character.load("human"))
    with espeak() as voice:
        if asked.only in (None, "sound"):
            first_sound(voice)
            live_mouth(human, voice)
            rendering(human, voice, asked.minutes)
        if asked.only in (None, "body"):
            body(voice, CONSOLE)
    if asked.only in (None, "alignment"):
        alignment(human, CONSOLE)


if __name__ == "__main__":
    main()
