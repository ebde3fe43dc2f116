"""Gestures as a motion: parts of recordings, bridges between them, and rest."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.curves import Keyed
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.masks import Mask
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.smoothing import smoothstep
from cubeling.characters.synthesis.gestures.library import GestureLibrary

RAMP_S = 0.3
"""How long the weight takes from 0 in rest to 1, and back [s]."""

_COAST_S = 0.08  # over which what leaves a gesture loses its speed
_SNAP = 1e-6  # frames: rounding of times must not change a recorded frame


@dataclass(frozen=True, eq=False)
class PlayedSegment:
    """A stretch of rotations that is played at an even pace."""

    start: float
    """When it begins [s]."""

    turns: Array
    """(frames, joints, 4), with continuous signs."""

    first: float = 0.0
    """The frame that it begins with."""

    pace: float = 0.0
    """Frames of the recording that are played in a second; 0 holds the first."""

    def at(self, time: float) -> Array:
        """Return the rotations at a time [s] not before its start, (joints, 4)."""
        last = len(self.turns) - 1
        frame = min(self.first + (time - self.start) * self.pace, float(last))
        whole = round(frame)
        if abs(frame - whole) < _SNAP:
            recorded: Array = self.turns[whole]
            return recorded
        low = int(frame)
        before = self.turns[low]
        mixed: Array = before + (self.turns[low + 1] - before) * (frame - low)
        mixed /= np.sqrt(np.vecdot(mixed, mixed))[:, None]
        return mixed


@dataclass(frozen=True, eq=False)
class Ends:
    """How a gesture begins or ends: a posture, and how fast the joints turn in it."""

    turns: Array
    """(joints, 4)."""

    spins: Array
    """(joints, 3) [rad/s]."""

    @staticmethod
    def of(turns: Array, frame: int, rate: float, warp: float, leaving: bool) -> "Ends":
        """Return the ends of frames (frames, joints, 4) that are played warped.

        Before a frame that is `leaving`, or from another one on, the speed is taken.
        """
        one, other = (max(frame - 1, 0), frame) if leaving else (frame, frame + 1)
        other = min(other, len(turns) - 1)
        between = rotations.multiply(rotations.conjugate(turns[one]), turns[other])
        return Ends(turns[frame], rotations.to_rotation_vector(between) * (rate / warp))

    @staticmethod
    def still(turns: Array) -> "Ends":
        """Return the ends of who rests in a posture (joints, 4)."""
        return Ends(turns, np.zeros((len(turns), 3)))


def bridge(
    start: float, length: float, leaving: Ends, arriving: Ends, rate: float
) -> PlayedSegment:
    """Return the way from one posture to another, with the speeds that they have.

    Both are carried on while their speed fades away, and cross-faded with a smoothstep (M7).
    """
    steps = max(round(length * rate), 2)
    times = np.linspace(0.0, length, steps + 1)[:, None, None]
    on, back = (_COAST_S * (1.0 - np.exp(-each / _COAST_S)) for each in (times, length - times))
    gone = rotations.multiply(leaving.turns, rotations.from_rotation_vector(leaving.spins * on))
    arrived = rotations.align(arriving.turns, leaving.turns)  # once: both move while they fade
    coming = rotations.multiply(arrived, rotations.from_rotation_vector(-arriving.spins * back))
    mixed = gone + (coming - gone) * smoothstep(times / length)
    return PlayedSegment(start, rotations.normalize(mixed), 0.0, steps / length)


@dataclass(frozen=True, eq=False)
class PlannedGestureMotion:
    """Gestures from rest to rest; a `Motion` of the upper body.

    What is not of `mask` is at rest in its poses. `motion.layers.lay_over` lays it over a
    character's own motion, by `weight`.
    """

    library: GestureLibrary
    """Whose gestures they are."""

    segments: tuple[PlayedSegment, ...]
    """What is played, in order; the last one is held."""

    duration: float
    """When hands are in rest again, and the speech has ended [s]."""

    weights: Keyed
    """How much of it shows over time."""

    @property
    def mask(self) -> Mask:
        """1 for each joint that it moves, (joints of the skeleton,)."""
        return self.library.mask

    def weight(self, time: float) -> float:
        """Return how much of it shows at a time [s]: 0 in rest, 1 in a gesture."""
        return self.weights.at(time, self.duration)

    def turns(self, time: float) -> Array:
        """Return the rotations of the library's joints at a time [s], (joints, 4)."""
        return self.segments[max(bisect_right(self._starts, time) - 1, 0)].at(time)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        rest = self.library.skeleton.rest
        turns = rest.rotations.copy()
        turns[self.joints] = self.turns(time)
        return Pose(rest.translations, turns)

    def travel(self, start: float, end: float) -> RootDelta:
        """Return no movement: the feet stay."""
        return RootDelta()

    @cached_property
    def _starts(self) -> list[float]:
        return [segment.start for segment in self.segments]

    @cached_property
    def joints(self) -> NDArray[np.intp]:
        """Numbers of the joints that it moves, (joints,)."""
        return np.array(self.library.joints, np.intp)


@dataclass(frozen=True)
class RestToRestSpan:
    """Gestures from rest to rest; times in seconds."""

    left: float
    """When rest is left."""

    first: float
    """When the first stroke begins."""

    last: float
    """When the last stroke ends."""

    again: float
    """When hands are in rest again."""


def weight_curve(spans: Sequence[RestToRestSpan]) -> Keyed:
    """Return 0 in rest and 1 from the first to the last stroke of a span."""
    times, values = [-RAMP_S], [0.0]
    for span in spans:
        left, again = span.left, span.again
        up = min(left + RAMP_S, max(span.first, left + 1e-2))
        down = max(again - RAMP_S, span.last, up + 1e-3)
        times += [left, up, down, max(again, down + 1e-3)]
        values += [0.0, 1.0, 1.0, 0.0]
    return Keyed(tuple(times), tuple(values), "cubic")
