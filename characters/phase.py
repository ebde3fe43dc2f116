"""Where in its stride a motion is: phase 0 at the left footfall, one half at the right.

Two clips that are both at phase 0.3 may be mixed: left steps then meet left steps, whatever the
lengths of the clips.
"""

import itertools
import math
import re
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, cast

import numpy as np

from characters.clip import Clip
from characters.motion import STANDING, Motion, Step
from characters.pose import Array, Pose, Skeleton

# "LeftFoot", "foot_l", "Foot.L.001", "FootL" and their like.
_LEFT = re.compile(r"(?i:left|(?:^|[._\s])l(?:[._\s]|$))|[a-z]L(?:$|[^a-z])")
_RIGHT = re.compile(r"(?i:right|(?:^|[._\s])r(?:[._\s]|$))|[a-z]R(?:$|[^a-z])")
_SHUFFLE = 0.1  # a foot that swings less than this part of the body's height takes no steps


class Cyclic(Motion, Protocol):
    """A motion that repeats, addressed by its phase: one cycle, two steps, per unit."""

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase; whole numbers are left footfalls."""
        ...

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two phases, start ≤ end."""
        ...


@dataclass(frozen=True)
class Phased:
    """A looped motion with marks for its phase; `Cyclic`."""

    motion: Motion
    """What is played."""

    marks: tuple[float, ...] = ()
    """Times of phases 0, ½, 1, 1½ … over one loop of the motion [s]; empty: phase 0 at its start.

    Ascending, the first within the loop, all within one duration of the first; an even number.
    """

    @property
    def duration(self) -> float:
        """Length of one cycle [s]; a clip may hold several."""
        return self.motion.duration / max(len(self.marks) // 2, 1)

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.motion.sample(self.time(phase))

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two phases."""
        return self.motion.travel(self.time(start), self.time(end))

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s] after a left footfall."""
        return self.at(time / self.duration)

    def travel(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two times [s]."""
        return self.between(start / self.duration, end / self.duration)

    def time(self, phase: float) -> float:
        """Return the time [s] in the motion at a phase, through the marks and smooth at them.

        Monotone cubic interpolation (Fritsch and Butland, 1984): where steps are even it is a
        straight line.

        >>> clip = Clip("c", 10.0, Pose(np.zeros((11, 1, 3)), np.zeros((11, 1, 4))))
        >>> Phased(clip, (0.2, 0.6)).time(0.5), Phased(clip, (0.2, 0.6)).time(-1.0)
        (0.6, -0.8)
        """
        if not self.marks:
            return phase * self.motion.duration
        loops, at = divmod(2 * phase, len(self.marks))
        mark = min(int(at), len(self.marks) - 1)
        u = at - mark
        (a, slope_a), (b, slope_b) = self._knots[mark], self._knots[mark + 1]
        between = a + u * (
            slope_a
            + u * (3 * (b - a) - 2 * slope_a - slope_b + u * (slope_a + slope_b - 2 * (b - a)))
        )
        return between + loops * self.motion.duration

    @cached_property
    def _knots(self) -> list[tuple[float, float]]:
        """Time [s] and slope [s per half cycle] at each mark and at the first of the next loop."""
        times = [*self.marks, self.marks[0] + self.motion.duration]
        gaps = [later - earlier for earlier, later in itertools.pairwise(times)]
        before = [gaps[-1], *gaps]
        after = [*gaps, gaps[0]]
        slopes = [2 * a * b / (a + b) for a, b in zip(before, after, strict=True)]
        return list(zip(times, slopes, strict=True))


@dataclass(frozen=True)
class Still:
    """A pose that is held, as if it had a cycle; `Cyclic`."""

    pose: Pose
    """What is held."""

    duration: float
    """Length of the cycle that it keeps up with [s]."""

    def at(self, phase: float) -> Pose:
        """Return the pose."""
        return self.pose

    def between(self, start: float, end: float) -> Step:
        """Return no motion."""
        return STANDING

    def sample(self, time: float) -> Pose:
        """Return the pose."""
        return self.pose

    def travel(self, start: float, end: float) -> Step:
        """Return no motion."""
        return STANDING


@dataclass(frozen=True)
class Endless:
    """A motion without an end, as if it had cycles of one second; `Cyclic`."""

    motion: Motion
    """What is played."""

    @property
    def duration(self) -> float:
        """It has no end."""
        return math.inf

    def at(self, phase: float) -> Pose:
        """Return the pose after so many seconds."""
        return self.motion.sample(phase)

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start, end)

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.motion.sample(time)

    def travel(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two times [s]."""
        return self.motion.travel(start, end)


def in_step(motion: Motion) -> Cyclic:
    """Return any motion as one with a phase; where it has none of its own, 0 is its start."""
    # Asked for every frame, where an isinstance of a protocol would be ten times as slow.
    if hasattr(motion, "at") and hasattr(motion, "between"):
        return cast(Cyclic, motion)
    return Phased(motion) if math.isfinite(motion.duration) else Endless(motion)


def takes_steps(motion: Motion) -> bool:
    """Return whether phase 0 of a motion is a left footfall and one half a right one."""
    if isinstance(motion, Phased):
        return bool(motion.marks)
    inner: Motion | None = getattr(motion, "motion", None)
    members: tuple[Motion, ...] = getattr(motion, "members", ())
    return any(map(takes_steps, members if inner is None else (inner,)))


def phased(clip: Clip, skeleton: Skeleton) -> Phased:
    """Return a clip with its footfalls as marks, or with none if it takes no regular steps."""
    left, right = (footfalls(clip, feet, skeleton) for feet in find_feet(skeleton))
    if not left or len(left) != len(right):
        return Phased(clip)
    start = left[0]
    marks = [(t - start) % clip.duration + start for t in [*left, *right]]
    order = sorted(range(len(marks)), key=marks.__getitem__)
    if any((number < len(left)) != (place % 2 == 0) for place, number in enumerate(order)):
        return Phased(clip)  # two steps of one foot in a row: no walk
    return Phased(clip, tuple(sorted(marks)))


def find_feet(skeleton: Skeleton) -> tuple[list[int], list[int]]:
    """Return the joints of the left and the right foot, found by their names."""
    feet = [
        joint
        for joint, name in enumerate(skeleton.names)
        if "foot" in name.lower() or "toe" in name.lower()
    ]
    left = [joint for joint in feet if _LEFT.search(skeleton.names[joint])]
    right = [joint for joint in feet if _RIGHT.search(skeleton.names[joint])]
    return left, right


def footfalls(clip: Clip, feet: list[int], skeleton: Skeleton) -> list[float]:
    """Return the times [s] in a looped clip at which a foot lands.

    A foot lands just after it was farthest forward of the body (Zeni, Richards and Higginson, "Two
    simple methods for determining gait events", Gait & Posture 2008); that needs no floor, and
    works for clips that walk in place. Where the root moves, it lands when its speed over the
    ground has fallen well below the body's.
    """
    if not feet or not clip.loop or len(clip) < 5:
        return []
    placed = clip.in_place.globals(skeleton)[:-1, :, :3, 3]  # the last frame is the first
    forward = placed[:, feet, 2].mean(1)
    tall = (placed[..., 1].max(1) - placed[:, feet, 1].min(1)).mean()
    middle, swing = (forward.max() + forward.min()) / 2, np.ptp(forward)
    if swing < _SHUFFLE * tall:
        return []
    crests = _crests(forward - middle, swing / 4)
    if clip.cycle.length < swing:
        return [_peak(forward, frame) / clip.rate for frame in crests]
    world = clip.poses.globals(skeleton)[..., :3, 3][:, feet].mean(1)
    speed = np.linalg.norm(np.diff(world[:, [0, 2]], axis=0), axis=1) * clip.rate
    slow = 0.3 * clip.cycle.length / clip.duration
    return [_falls_below(speed, slow, frame) / clip.rate for frame in crests]


def _falls_below(speed: Array, threshold: float, frame: int) -> float:
    """Return when the speeds of the intervals after a frame fall below a threshold [frames]."""
    count = len(speed)
    for later in range(frame, frame + count):
        fast, slow = speed[later % count], speed[(later + 1) % count]
        if fast >= threshold > slow:
            # An interval's speed is that of its middle.
            return float(later + 0.5 + (fast - threshold) / (fast - slow)) % count
    return float(frame)


def _crests(wave: Array, margin: float) -> list[int]:
    """Return the highest frame of each stretch above +margin, which −margin ends; periodic."""
    start = int(wave.argmin())
    crests: list[int] = []
    best = -1
    for offset in range(len(wave) + 1):
        frame = (start + offset) % len(wave)
        if wave[frame] > margin and (best < 0 or wave[frame] > wave[best]):
            best = frame
        elif wave[frame] < -margin and best >= 0:
            crests.append(best)
            best = -1
    return sorted(crests)


def _peak(wave: Array, frame: int) -> float:
    """Return where the parabola through a crest and its neighbours is highest [frames]."""
    count = len(wave)
    before, top, after = wave[(frame - 1) % count], wave[frame], wave[(frame + 1) % count]
    bend = before - 2 * top + after
    return float(frame + (0.5 * (before - after) / bend if bend < 0 else 0.0)) % count
