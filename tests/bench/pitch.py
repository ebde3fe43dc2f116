"""Pitch beside Praat's, file by file: `python -m tests.bench.pitch`.

Every sound of `shared/data/speech`, tracked with the same parameters by parselmouth. "gross" is the
share of frames that both call voiced, but more than 20 % apart; "voicing" of those that only one of
them calls voiced; "median" is the median difference. "speed" is that of pitch, intensity and
pauses: seconds of sound in a second. The last row is an hour of all of them, again and again.

Exits with 1 if gross errors exceed 1 % in any file.
"""

import resource
import sys
import time
from pathlib import Path

import numpy as np
import parselmouth
from rich.console import Console
from rich.table import Table

from cubeling.characters.speech.audio import read_speech, resample
from cubeling.characters.speech.prosody.contours import measure_prosody
from cubeling.characters.speech.prosody.pitch import PitchSettings, track_pitch
from cubeling.characters.speech.speech import Speech

RECORDINGS = Path(__file__).parents[3] / "shared" / "data" / "speech"
GROSS, MAX_GROSS_SHARE = 0.2, 0.01
HOUR_S, HOUR_RATE = 3600.0, 16_000


def compared(speech: Speech, settings: PitchSettings) -> tuple[int, float, float, float]:
    """Return the frames voiced for both, gross and voicing errors, and the median error [cents]."""
    sound = parselmouth.Sound(speech.samples.astype(float), speech.rate)
    praat = sound.to_pitch_ac(
        time_step=settings.step,
        pitch_floor=settings.floor,
        max_number_of_candidates=15,
        silence_threshold=settings.silence_threshold,
        voicing_threshold=settings.voicing_threshold,
        octave_cost=settings.octave_cost,
        octave_jump_cost=settings.octave_jump_cost,
        voiced_unvoiced_cost=settings.voicing_cost,
        pitch_ceiling=settings.ceiling,
    )
    theirs = praat.selected_array["frequency"]
    track = track_pitch(speech.samples, speech.rate, settings)
    nearest = np.abs(track.times[:, None] - praat.xs()).argmin(0)
    ours = track.f0[nearest]
    both = (ours > 0) & (theirs > 0)
    octaves = np.abs(np.log2(ours[both] / theirs[both]))
    gross = float(np.mean(np.abs(ours[both] / theirs[both] - 1) > GROSS))
    voicing = float(np.mean((ours > 0) != (theirs > 0)))
    return int(both.sum()), gross, voicing, 1200 * float(np.median(octaves))


def main() -> int:
    """Print the table and return an exit code."""
    console = Console(width=100)
    if not RECORDINGS.is_dir():
        console.print(f"no recordings at {RECORDINGS}: nothing to measure")
        return 0
    table = Table(title="pitch beside Praat's")
    for heading in ("sound", "rate", "voiced frames", "gross", "voicing", "median", "speed"):
        table.add_column(heading, justify="left" if heading == "sound" else "right")
    good, sounds = True, []
    for path in sorted(RECORDINGS.glob("*/*.wav")):
        speech = read_speech(path)
        voiced, gross, voicing, median = compared(speech, PitchSettings())
        start = time.perf_counter()
        measure_prosody(speech.samples, speech.rate)
        speed = speech.duration / (time.perf_counter() - start)
        good &= gross <= MAX_GROSS_SHARE
        table.add_row(
            path.stem[-24:],
            f"{speech.rate} Hz",
            f"{voiced}",
            f"{gross:.2%}",
            f"{voicing:.2%}",
            f"{median:.2f} cents",
            f"{speed:.0f} x",
        )
        sounds.append(resample(speech.samples, speech.rate, HOUR_RATE))
    together = np.concatenate(sounds)
    hour = np.tile(together, int(HOUR_S * HOUR_RATE / len(together)) + 1)
    start = time.perf_counter()
    measure_prosody(hour, HOUR_RATE)
    speed = len(hour) / HOUR_RATE / (time.perf_counter() - start)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    table.add_row(
        "an hour", f"{HOUR_RATE} Hz", f"{memory:.0f} MB at most", "", "", "", f"{speed:.0f} x"
    )
    console.print(table)
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
