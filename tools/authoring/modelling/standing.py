"""What bundled characters do while they stand, in nine moods: when they shift, how they sway."""

import zlib
from dataclasses import dataclass

import numpy as np

from cubeling.affect.regions import SECTOR_WORDS
from tools.authoring.modelling.curves import keys, loop_phases
from tools.authoring.modelling.shapes import Array

MOODS = ("neutral", *SECTOR_WORDS)
"""The moods in which a character is "recorded": the middle of the plane, and its eight sectors."""

DURATION_S = 40.0
"""Length of a recording [s]."""

TOUR = (1.0, -1.0, 1.0, 0.0, -1.0, 0.0)
"""Balance of the rests: 1 on the left foot, 0 on both. Every shift between two comes once."""

_MIN_REST_S, _MAX_REST_S = 2.5, 8.0


@dataclass(frozen=True)
class Stander:
    """Somebody who stands in one mood; a loop."""

    rng: np.random.Generator
    frames: int

    arousal: float
    """−1…1: the aroused shift fast and sway much."""

    @staticmethod
    def of(name: str, mood: str, arousal: float, frames: int) -> "Stander":
        """Return a character in a mood, always the same."""
        return Stander(
            np.random.default_rng(zlib.crc32(f"{name} {mood}".encode())), frames, arousal
        )

    def weight(self) -> Array:
        """Return the balance, (frames,): −1 on the right foot … 1 on the left one."""
        shift = 1.15 * 2.0 ** (-0.6 * self.arousal)  # [s]
        rests = self.rng.uniform(_MIN_REST_S, _MAX_REST_S, len(TOUR))
        rests *= (DURATION_S - shift * len(TOUR)) / rests.sum()
        points, at = [], 0.3
        for balance, rest in zip(TOUR, rests, strict=True):
            drift = self.rng.uniform(0.9, 1.1) if balance else 1.0
            points += [(at / DURATION_S, balance), ((at + rest) / DURATION_S, balance * drift)]
            at += rest + shift
        # It overshoots a little: a body falls onto a leg and comes back.
        return keys(self.frames, *(point for point in points if point[0] < 1.0))

    def sway(self, size: float, low: float = 0.05, high: float = 0.4) -> Array:
        """Return slow waves of a size, (frames,), at frequencies from `low` to `high` [Hz]."""
        cycles = np.arange(max(round(low * DURATION_S), 1), round(high * DURATION_S) + 1)
        phases = self.rng.uniform(0.0, 1.0, len(cycles))
        heights = self.rng.normal(size=len(cycles)) / np.sqrt(cycles)
        turns = cycles[:, None] * loop_phases(self.frames) + phases[:, None]
        total = heights @ np.sin(2 * np.pi * turns)
        lively = 2.0 ** (0.5 * self.arousal)
        return np.asarray(size * lively * total / max(float(np.std(total)), 1e-9))

    def glances(self, size: float) -> Array:
        """Return where it looks aside, (frames,): still for a while, then elsewhere."""
        count = round(DURATION_S / 3.2 * 2.0 ** (0.5 * self.arousal))
        edges = np.sort(self.rng.uniform(0.02, 0.97, count))
        sides = self.rng.normal(size=count) * size
        held = 0.35 / DURATION_S
        points = [(0.0, 0.0)]
        for before, after, side in zip(edges[:-1], edges[1:], sides[:-1], strict=True):
            if after - before > 4 * held:
                points += [(before + held, side), (after - held, side)]
        return keys(self.frames, *points)
