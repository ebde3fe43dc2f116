"""Looped clips and where their feet are, packed to be mixed at one phase."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np

from characters.ik.legs import LegIK
from characters.motion.batch.bank import ClipBank
from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts
from characters.motion.motion import RootDelta
from characters.motion.phase import PhasedMotion
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

_REMEMBERED = 64  # times
_LEAVING = 0.45  # how much the last frame of a contact counts: too little to be held


@dataclass(frozen=True)
class Stance:
    """A pose that is stood in, and where its feet are."""

    pose: Pose
    """The pose."""

    feet: Array
    """Ball (3) and facing (4) of each foot, (legs, 7)."""

    @staticmethod
    def of(pose: Pose, legs: LegIK) -> "Stance":
        """Return the stance of a pose."""
        return Stance(pose, _feet(pose, legs))

    @cached_property
    def plain(self) -> list[list[float]]:
        """`feet` in plain numbers."""
        plain: list[list[float]] = self.feet.tolist()
        return plain


@dataclass(frozen=True)
class FootTrajectories:
    """Clips, a stance, and where the feet are in each frame; see `FootTrajectories.of`."""

    motions: tuple[PhasedMotion, ...]
    """The clips by their phases."""

    bank: ClipBank
    """The clips, then the stance. Beside a pose stand ball (3), facing (4) and contact (1) of each
    foot; none for the stance."""

    homes: Array
    """The middle of where each foot stands, on the ground, and how it faces there,
    (clips, legs, 7)."""

    legs: LegIK
    """Whose feet they are."""

    stance: Stance
    """What shorter steps lean to."""

    _times: dict[tuple[int, float], float] = field(default_factory=dict, repr=False, compare=False)
    """Times that were worked out lately: a phase is asked for three times in a frame."""

    _stood: list[tuple[Sequence[tuple[int, float]], float, list[float]]] = field(
        default_factory=list, repr=False, compare=False
    )
    """What was mixed last: voices, phase and contacts, which are asked for after the pose."""

    @staticmethod
    def of(
        motions: Sequence[PhasedMotion], skeleton: Skeleton, legs: LegIK, standing: Pose
    ) -> "FootTrajectories":
        """Return the trajectories of looped clips, with contacts that are found in them.

        Feet face on the side of quaternions on which those of the stance do.
        """
        stance = Stance.of(standing, legs)
        clips = [motion.motion for motion in motions if isinstance(motion.motion, Clip)]
        feet = [_trodden(clip, skeleton, legs, stance) for clip in clips]
        still = Clip("stance", 1.0, _once(standing), loop=False)
        beside = [*(each.reshape(len(each), -1) for each in feet), np.zeros((1, legs.count * 8))]
        bank = ClipBank.of(skeleton, [*clips, still], np.float64, beside)
        homes = np.stack([_home(each) for each in feet])
        return FootTrajectories(tuple(motions), bank, homes, legs, stance)

    def mixed(
        self, voices: Sequence[tuple[int, float]], phase: float, share: float
    ) -> tuple[Pose, list[list[float]]]:
        """Return the mean of clips at a phase, and of ball, facing and contact of each foot.

        Parameters
        ----------
        voices
            Number and weight of each clip; the weights sum to one.
        phase
            Of all of them.
        share
            How much of their mean, 0…1; the rest of the pose, not of the feet, is the stance's.
        """
        heard = [(number, self.time(number, phase), weight * share) for number, weight in voices]
        if share < 1.0:
            heard.append((len(self.motions), 0.0, 1.0 - share))
        pose, numbers = self.bank.blend(heard)
        feet: list[list[float]] = (numbers.reshape(-1, 8) / share).tolist()
        self._stood[:] = [(voices, phase, [foot[7] for foot in feet])]
        return pose, feet

    def time(self, number: int, phase: float) -> float:
        """Return the time [s] in a clip at a phase."""
        key = number, phase
        time = self._times.get(key)
        if time is None:
            if len(self._times) >= _REMEMBERED:
                self._times.clear()
            time = self._times[key] = self.motions[number].time(phase)
        return time

    def travel(self, number: int, start: float, end: float) -> RootDelta:
        """Return how the root of a clip moves over the ground between two phases."""
        motion = self.motions[number].motion
        return motion.travel(self.time(number, start), self.time(number, end))

    def contacts(self, voices: Sequence[tuple[int, float]], phase: float) -> list[float]:
        """Return how much of a mix has each foot on the ground, 0…1."""
        for mixed, at_phase, stood in self._stood:
            if mixed is voices and at_phase == phase:
                return stood
        total = [0.0] * self.legs.count
        for number, weight in voices:
            motion, down = self.motions[number], self._down[number]
            last = len(down) - 1
            at = self.time(number, phase) / motion.motion.duration % 1.0 * last
            frame = min(int(at), last - 1)
            u = at - frame
            for foot, (before, after) in enumerate(zip(down[frame], down[frame + 1], strict=True)):
                total[foot] += weight * (before + (after - before) * u)
        return total

    @cached_property
    def plain_homes(self) -> list[list[list[float]]]:
        """`homes` in plain numbers."""
        plain: list[list[list[float]]] = self.homes.tolist()
        return plain

    @cached_property
    def _down(self) -> list[list[list[float]]]:
        """Whether each foot stands, of each clip frame by frame, as plain numbers."""
        beside = self.bank.table[:, -self.legs.count * 8 :].reshape(-1, self.legs.count, 8)
        starts = self.bank.starts.tolist()
        return [beside[low:high, :, 7].tolist() for low, high in pairwise(starts)]


def _trodden(clip: Clip, skeleton: Skeleton, legs: LegIK, stance: Stance) -> Array:
    """Return ball, facing and contact of each foot of a clip, (frames, legs, 8)."""
    feet = np.concatenate([_feet(clip.in_place, legs), np.zeros((len(clip), legs.count, 1))], 2)
    feet[..., 3:7] = rotations.align(feet[..., 3:7], stance.feet[:, 3:])
    down = find_contacts(clip, skeleton, legs.feet)
    # A foot is known to have left by its speed, so a little after it has.
    after = np.roll(down[:-1], -1, axis=0)
    leaving = down & ~np.append(after, after[:1], axis=0)
    feet[..., 7] = np.where(leaving, _LEAVING, down)
    return feet


def _home(feet: Array) -> Array:
    """Return the middle of where feet (frames, legs, 8) stand, on the ground, (legs, 7)."""
    weight = feet[..., 7:] + 1e-6
    mean: Array = (feet[..., :7] * weight).sum(0) / weight.sum(0)
    mean[:, 1] = feet[..., 1].min(0)
    mean[:, 3:] = rotations.normalize(mean[:, 3:])
    return mean


def _feet(poses: Pose, legs: LegIK) -> Array:
    """Return the ball and the facing of each foot in poses (…), (…, legs, 7)."""
    placed = legs.globals(poses)
    ankle, toes = legs.joints[:, 3], legs.joints[:, 4]
    facing = rotations.from_matrix(placed[..., :3, :3][..., ankle, :, :])
    return np.concatenate([placed[..., :3, 3][..., toes, :], facing], axis=-1)


def _once(pose: Pose) -> Pose:
    """Return a pose as poses of one frame."""
    return Pose(
        pose.translations[None],
        pose.rotations[None],
        None if pose.scales is None else pose.scales[None],
        None if pose.morphs is None else pose.morphs[None],
    )
