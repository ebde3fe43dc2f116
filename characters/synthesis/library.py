"""Motions side by side: clips of one skeleton at one rate, as one long row of frames."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.baking import placed_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

Frames = NDArray[np.intp]
"""Numbers of frames of a library."""

DEFAULT_RATE_HZ = 60.0
"""The rate of the thesis: windows and durations in frames refer to it."""

_CHUNK_FRAMES = 1024  # placed at once: their matrices stay small

MIN_CLIP_S = 0.2
"""Clips shorter than this hold no step and are refused [s]."""


@dataclass(frozen=True)
class MotionLibrary:
    """Frames of several clips of one skeleton, without their planar root motion."""

    skeleton: Skeleton

    anatomy: Anatomy
    """Which joint is which body part."""

    rate: float
    """Frame rate of all clips [Hz]."""

    names: tuple[str, ...]
    """Name of each clip."""

    starts: Frames
    """First frame of each clip, and after the last clip the number of frames, (clips + 1,)."""

    loops: NDArray[np.bool_]
    """Which clips repeat: their first frame follows their last, (clips,)."""

    poses: Pose
    """(frames, joints, …), the root at the origin."""

    steps: Array
    """How the root moves from each frame to the next, in the frame's own axes: x, z [m], yaw [rad].

    (frames, 3); the last frame of a clip that does not repeat has the step before it.
    """

    contacts: NDArray[np.bool_]
    """Which feet stand, (frames, feet), as `find_contacts` detects it."""

    @staticmethod
    def of(
        clips: Sequence[Clip],
        skeleton: Skeleton,
        anatomy: Anatomy | None = None,
        rate: float = DEFAULT_RATE_HZ,
    ) -> "MotionLibrary":
        """Return a library of clips, resampled to one rate.

        Raises
        ------
        CharacterError
            If there is no clip, a clip is too short, two have one name, or one has no root motion.
        """
        if not clips:
            raise CharacterError("a motion library needs at least one clip")
        names = tuple(clip.name for clip in clips)
        if len(set(names)) < len(names):
            double = next(name for name in names if names.count(name) > 1)
            raise CharacterError(f"two clips are named {double!r}; rename one of them")
        feet = find_feet(skeleton)
        parts = [_resample(_with_root_motion(clip, anatomy), rate) for clip in clips]
        contacts = [find_contacts(clip, skeleton, feet) for clip in parts]
        counts = [len(clip) - 1 if clip.loop else len(clip) for clip in parts]
        poses = [clip.in_place[:count] for clip, count in zip(parts, counts, strict=True)]
        return MotionLibrary(
            skeleton,
            anatomy or Anatomy.guess(skeleton),
            rate,
            names,
            np.concatenate([[0], np.cumsum(counts)]).astype(np.intp),
            np.array([clip.loop for clip in parts]),
            Pose(
                np.concatenate([pose.translations for pose in poses]),
                np.concatenate([pose.rotations for pose in poses]),
            ),
            np.concatenate([_steps(clip)[:n] for clip, n in zip(parts, counts, strict=True)]),
            np.concatenate([down[:count] for down, count in zip(contacts, counts, strict=True)]),
        )

    def __len__(self) -> int:
        return len(self.steps)

    @cached_property
    def clip_of(self) -> Frames:
        """Number of each frame's clip, (frames,)."""
        return np.repeat(np.arange(len(self.names)), np.diff(self.starts))

    @cached_property
    def successors(self) -> Frames:
        """The frame that follows each frame in its clip, −1 at an end, (frames,)."""
        following = np.arange(1, len(self) + 1)
        following[self.starts[1:] - 1] = np.where(self.loops, self.starts[:-1], -1)
        return following

    @cached_property
    def predecessors(self) -> Frames:
        """The frame that precedes each frame in its clip, −1 at a beginning, (frames,)."""
        preceding = np.arange(-1, len(self) - 1)
        preceding[self.starts[:-1]] = np.where(self.loops, self.starts[1:] - 1, -1)
        return preceding

    @cached_property
    def positions(self) -> Array:
        """Position of each joint with the root at the origin, (frames, joints, 3) [m]."""
        return np.concatenate(
            [
                self.poses[first : first + _CHUNK_FRAMES].globals(self.skeleton)[..., :3, 3]
                for first in range(0, len(self), _CHUNK_FRAMES)
            ]
        )

    @cached_property
    def phases(self) -> NDArray[np.int8]:
        """Phase of each frame's step, (frames,): bit n is set while foot n stands (M2.3).

        For a person: 0 flight, 1 left stance, 2 right stance, 3 double support.
        """
        bits = 1 << np.arange(self.contacts.shape[1])
        return np.asarray(self.contacts @ bits, np.int8)

    def clip(self, name: str) -> Frames:
        """Return the frames of a clip."""
        if name not in self.names:
            raise CharacterError(f"no clip {name!r}; there are {', '.join(self.names)}")
        number = self.names.index(name)
        return np.arange(self.starts[number], self.starts[number + 1])

    def only(self, clips: Sequence[int]) -> "MotionLibrary":
        """Return some of the clips, by their numbers, in this order."""
        spans = [np.arange(self.starts[clip], self.starts[clip + 1]) for clip in clips]
        frames = np.concatenate(spans)
        return replace(
            self,
            names=tuple(self.names[clip] for clip in clips),
            starts=np.concatenate([[0], np.cumsum([len(span) for span in spans])]),
            loops=self.loops[list(clips)],
            poses=self.poses[frames],
            steps=self.steps[frames],
            contacts=self.contacts[frames],
        )

    def as_clip(self, name: str) -> Clip:
        """Return a clip of the library, with root motion; a loop ends with its first frame."""
        frames = self.clip(name)
        loop = bool(self.loops[self.names.index(name)])
        places = [RootDelta()]
        for step in self.steps[frames].tolist():
            places.append(places[-1].then(RootDelta(*step)))
        shown = np.append(frames, frames[0]) if loop else frames
        return placed_clip(name, self.rate, self.poses[shown], places[: len(shown)], loop)

    def onward(self, frames: Frames, count: int) -> Frames:
        """Return the frames a number of frames on in their clips; at an end, the last frame."""
        for _ in range(count):
            frames = np.where(self.successors[frames] < 0, frames, self.successors[frames])
        return frames


def _with_root_motion(clip: Clip, anatomy: Anatomy | None) -> Clip:
    """Return a clip whose joint 0 carries the root motion: a root, or the hips of a recording."""
    if not clip.root_motion:
        if anatomy is not None and anatomy.joint("hips") not in (0, None):
            raise CharacterError(
                f"clip {clip.name!r} has no root motion: retarget it to a character first"
            )
        clip = replace(clip, root_motion=True)
    if clip.duration < MIN_CLIP_S:
        raise CharacterError(
            f"clip {clip.name!r} lasts {clip.duration:.2f} s; give at least {MIN_CLIP_S} s"
        )
    return clip


def _resample(clip: Clip, rate: float) -> Clip:
    """Return a clip at another rate; a loop keeps its length, so its rate is near it."""
    if abs(clip.rate - rate) < 1e-6:
        return clip
    frames = max(round(clip.duration * rate), 1) + 1
    last = len(clip) - 1
    at = np.linspace(0.0, last, frames) if clip.loop else np.arange(0.0, last, clip.rate / rate)
    before = np.minimum(at.astype(int), last - 1)
    u = (at - before)[:, None, None]
    poses = clip.poses
    turns = rotations.continuous(poses.rotations)
    moved = poses.translations[before] * (1 - u) + poses.translations[before + 1] * u
    turned = rotations.normalize(turns[before] * (1 - u) + turns[before + 1] * u)
    return Clip(clip.name, rate, Pose(moved, turned), clip.loop, clip.root_motion)


def _steps(clip: Clip) -> Array:
    """Return the steps of a clip with root motion, (frames, 3), each in its frame's own axes."""
    x, z, yaw = np.diff(clip.track, axis=0).T
    heading = clip.track[:-1, 2]
    sine, cosine = np.sin(heading), np.cos(heading)
    steps = np.stack([cosine * x - sine * z, sine * x + cosine * z, yaw], axis=-1)
    return np.concatenate([steps, steps[-1:]])
