"""Looped clips and the trajectories of their feet, packed to be mixed at one phase."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.ik.legs import LegIK
from cubeling.characters.locomotion.clip_bank import ClipBank
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.phase import PhasedMotion
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_CACHED_TIMES = 64
_LAST_FRAME_CONTACT = 0.45  # contact in the last frame of a span: too little to hold the foot


@dataclass(frozen=True)
class FootTrajectories:
    """Clips, a stance (a standing pose), and the feet in each frame; see `FootTrajectories.of`.

    Shorter steps are drawn towards the stance.
    """

    motions: tuple[PhasedMotion, ...]
    """The clips with their phases."""

    bank: ClipBank
    """The clips, then the stance. The extra values are ball (3), orientation (4) and contact (1) of
    each foot, zeros for the stance."""

    homes: list[list[list[float]]]
    """Mean of ball and orientation of each foot while it stands, (clips, legs, 7)."""

    legs: LegIK
    """The legs of these feet."""

    stance: list[list[float]]
    """Ball (3) and orientation (4) of each foot of the stance, (legs, 7)."""

    _times: dict[tuple[int, float], float] = field(default_factory=dict, repr=False, compare=False)
    """Recent results of `time`, which is called three times a frame for each phase."""

    _last_mix: list[tuple[Sequence[tuple[int, float]], float, list[float]]] = field(
        default_factory=list, repr=False, compare=False
    )
    """The last mix: contributions, phase and contacts, which are read after the pose."""

    @staticmethod
    def of(
        motions: Sequence[PhasedMotion], skeleton: Skeleton, legs: LegIK, standing: Pose
    ) -> "FootTrajectories":
        """Return the trajectories of looped clips, with detected contacts.

        The signs of the orientations are aligned with those of the stance.
        """
        stance = _feet(standing, legs)
        clips = [motion.motion for motion in motions if isinstance(motion.motion, Clip)]
        feet = [_foot_trajectory(clip, skeleton, legs, stance) for clip in clips]
        still = Clip("stance", 1.0, standing[None], loop=False)
        extra = [*(each.reshape(len(each), -1) for each in feet), np.zeros((1, legs.count * 8))]
        bank = ClipBank.of(skeleton, [*clips, still], np.float64, extra)
        homes = [_mean_standing(each).tolist() for each in feet]
        return FootTrajectories(tuple(motions), bank, homes, legs, stance.tolist())

    def mix(
        self, contributions: Sequence[tuple[int, float]], phase: float, share: float
    ) -> tuple[Pose, list[list[float]]]:
        """Return the mean of clips at a phase, and of ball, orientation and contact of each foot.

        `contributions` are number and weight of each clip; the weights sum to one. `share`, 0…1, is
        the weight of the clips in the pose; the rest is the stance, with which feet are not mixed.
        """
        active = [(n, self.time(n, phase), weight * share) for n, weight in contributions]
        if share < 1.0:
            active.append((len(self.motions), 0.0, 1.0 - share))
        pose, numbers = self.bank.blend(active)
        feet: list[list[float]] = (numbers.reshape(-1, 8) / share).tolist()
        self._last_mix[:] = [(contributions, phase, [foot[7] for foot in feet])]
        return pose, feet

    def time(self, number: int, phase: float) -> float:
        """Return the time [s] in a clip at a phase."""
        time = self._times.get((number, phase))
        if time is None:
            if len(self._times) >= _CACHED_TIMES:
                self._times.clear()
            time = self._times[number, phase] = self.motions[number].time(phase)
        return time

    def travel(self, number: int, start: float, end: float) -> RootDelta:
        """Return how the root of a clip moves over the ground between two phases."""
        motion = self.motions[number].motion
        return motion.travel(self.time(number, start), self.time(number, end))

    def contacts(self, contributions: Sequence[tuple[int, float]], phase: float) -> list[float]:
        """Return the weighted mean of the contacts of each foot, 0…1."""
        for mixed, mixed_phase, contacts in self._last_mix:
            if mixed is contributions and mixed_phase == phase:
                return contacts
        return [foot[7] for foot in self.mix(contributions, phase, 1.0)[1]]


def _foot_trajectory(clip: Clip, skeleton: Skeleton, legs: LegIK, stance: Array) -> Array:
    """Return ball, orientation and contact of each foot of a clip, (frames, legs, 8)."""
    feet = np.concatenate([_feet(clip.in_place, legs), np.zeros((len(clip), legs.count, 1))], 2)
    feet[..., 3:7] = rotations.align(feet[..., 3:7], stance[:, 3:])
    down = find_contacts(clip, skeleton, legs.feet)
    # Contacts end by the foot's speed, and so a little late.
    after = np.roll(down[:-1], -1, axis=0)
    leaving = down & ~np.append(after, after[:1], axis=0)
    feet[..., 7] = np.where(leaving, _LAST_FRAME_CONTACT, down)
    return feet


def _mean_standing(feet: Array) -> Array:
    """Return mean ball, on the ground, and orientation of standing feet, (legs, 7).

    `feet` are those of a clip, (frames, legs, 8).
    """
    weight = feet[..., 7:] + 1e-6
    mean: Array = (feet[..., :7] * weight).sum(0) / weight.sum(0)
    mean[:, 1] = feet[..., 1].min(0)
    mean[:, 3:] = rotations.normalize(mean[:, 3:])
    return mean


def _feet(poses: Pose, legs: LegIK) -> Array:
    """Return ball and orientation of each foot in poses (…), (…, legs, 7)."""
    placed = legs.globals(poses)
    ankle, toes = legs.joints[:, 3], legs.joints[:, 4]
    facing = rotations.from_matrix(placed[..., :3, :3][..., ankle, :, :])
    return np.concatenate([placed[..., :3, 3][..., toes, :], facing], axis=-1)
