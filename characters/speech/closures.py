"""When a stop closes: speech synthesis says when it bursts."""

import itertools
from dataclasses import replace

import numpy as np

from cubeling.characters.speech.frames import frame_blocks
from cubeling.characters.speech.phones import sound_class
from cubeling.characters.speech.speech import SILENCE, Speech

SEARCHED_S = 0.08
"""How long before the burst a closure may begin [s]."""

MIN_DROP_DB = 6.0
"""Least drop of the level from the phone before to the closure [dB]."""

HOP_S, WINDOW_S = 0.0025, 0.008
"""Time from frame to frame, and length of a frame [s]."""


def with_closures(speech: Speech) -> Speech:
    """Return a speech whose stops and affricates begin when the mouth closes.

    eSpeak NG reports a stop when it bursts, 15 to 45 ms after the sound has broken off. Here the
    boundary is where the level has fallen half its way.
    """
    times = np.arange(HOP_S / 2, speech.duration, HOP_S)
    power = np.zeros(len(times))
    window = max(int(WINDOW_S * speech.rate), 1)
    for own, frames in frame_blocks(speech.samples, speech.rate, times, window):
        power[own] = (frames * frames).mean(1)
    level = 10 * np.log10(power + 1e-9)
    phones = list(speech.phones)
    for index, (before, stop) in enumerate(itertools.pairwise(speech.phones)):
        if sound_class(stop.symbol) not in ("stop", "affricate") or before.symbol == SILENCE:
            continue
        earliest = max(0.7 * before.start + 0.3 * before.end, stop.start - SEARCHED_S)
        first, last = np.searchsorted(times, (earliest, stop.start + 2 * HOP_S)).tolist()
        part = level[first:last]
        lowest = int(part.argmin()) if len(part) else 0
        drop = float(part[: lowest + 1].max() - part[lowest]) if len(part) else 0.0
        if drop < MIN_DROP_DB:
            continue
        above = np.flatnonzero(part[: lowest + 1] > part[lowest] + drop / 2)
        closed = float(times[first + above[-1] + 1])
        if closed < stop.start:
            phones[index] = replace(phones[index], end=closed)
            phones[index + 1] = replace(phones[index + 1], start=closed)
    return replace(speech, phones=tuple(phones))
