"""The recordings of motion matching: clips, the features of their frames, and what suits now."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.motion.mirror import Mirror
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.characters.synthesis.matching.features import (
    ROW_RATE_HZ,
    FeatureJoints,
    FeatureSpace,
    clip_features,
    row_times,
)
from cubeling.characters.synthesis.matching.nearest import NearestRow

LEG_WEIGHTS = {"feet": 0.75, "foot velocities": 1.0, "hips velocity": 1.0, "path": 2.0}
LEG_WEIGHTS |= {"facing": 2.0}
"""Weights of the features that legs and hips are matched by.

Path and facing count more than with Holden et al., so that a wish is answered at once.
"""

ARM_WEIGHTS = {"hands": 0.5, "hand velocities": 0.5, "feet": 1.0, "foot velocities": 1.5}
ARM_WEIGHTS |= {"hips velocity": 2.0, "path": 1.0}
"""Weights of the features that trunk, head and arms are matched by.

Hands keep the motion of the arms continuous; feet, hips and path tie it to the steps of the legs.
"""

TAIL_S = 0.3
"""The last part of a recording is played, but not jumped to [s]."""


@dataclass(frozen=True)
class Playhead:
    """A moment of a clip of a database."""

    clip: int
    """Number of the clip."""

    time: float
    """Time in it [s]; a loop repeats."""


@dataclass(frozen=True)
class MotionDatabase:
    """Clips of one skeleton, and the features of their frames."""

    skeleton: Skeleton
    """The skeleton of the clips."""

    clips: tuple[Clip, ...]
    """The clips, each with root motion."""

    contacts: tuple[NDArray[np.bool_], ...]
    """Which feet stand at each frame of each clip, (frames, feet)."""

    legs: FeatureSpace
    """Features of legs and hips, and of the path ahead."""

    arms: FeatureSpace | None
    """Features of arms and steps; None if the skeleton has no hands."""

    upper: NDArray[np.intp]
    """The joints above the hips, which may play another clip than the legs."""

    joints: FeatureJoints
    """The joints that are compared."""

    acceleration: float
    """Of hands and feet in the clips; one moment in a thousand has more [m/s²]."""

    @staticmethod
    def of(
        clips: Sequence[Clip], skeleton: Skeleton, anatomy: Anatomy, mirror: Mirror | None = None
    ) -> "MotionDatabase":
        """Return the database of clips of a skeleton.

        Parameters
        ----------
        clips
            The clips, with root motion.
        skeleton, anatomy
            Their skeleton, and which of its joints is which body part.
        mirror
            Adds each clip with left and right exchanged.

        Raises
        ------
        CharacterError
            If the skeleton has no feet or no root joint, or no clip moves over the ground.
        """
        joints, upper = _joints(skeleton, anatomy)
        both = [*clips] if mirror is None else [*clips, *map(mirror.clip, clips)]
        _check(both, joints, skeleton)
        for clip in both:
            clip.travel(0.0, 0.0), clip.sample(0.0)  # what it computes once, it computes now
        features = [clip_features(clip, skeleton, joints) for clip in both]
        feet = find_feet(skeleton)
        return MotionDatabase(
            skeleton,
            tuple(both),
            tuple(find_contacts(clip, skeleton, feet) for clip in both),
            FeatureSpace.of(features, LEG_WEIGHTS),
            FeatureSpace.of(features, ARM_WEIGHTS) if joints.hands else None,
            upper,
            joints,
            _acceleration(features),
        )

    def __len__(self) -> int:
        return len(self.legs.values)

    def row(self, head: Playhead) -> int:
        """Return the row of the frame nearest to a moment."""
        first, count = self._first_rows[head.clip : head.clip + 2]
        row = round(head.time * ROW_RATE_HZ)
        rows = count - first
        return first + (row % rows if self.clips[head.clip].loop else min(row, rows - 1))

    def head(self, row: int) -> Playhead:
        """Return the moment of a row."""
        clip = int(np.searchsorted(self._first_rows, row, "right")) - 1
        return Playhead(clip, (row - self._first_rows[clip]) / ROW_RATE_HZ)

    def ends_within(self, head: Playhead, time: float) -> bool:
        """Return whether the clip of a moment ends within a time [s]."""
        clip = self.clips[head.clip]
        return not clip.loop and head.time + time >= clip.duration

    def feet_down(self, head: Playhead) -> list[bool]:
        """Return which feet stand at a moment."""
        frame, u = self.clips[head.clip].position(head.time)
        contacts = self.contacts[head.clip]
        down: list[bool] = contacts[min(frame + round(u), len(contacts) - 1)].tolist()
        return down

    def match_legs(
        self, now: Playhead, ahead: Mapping[str, Array], staying: float = 1.0
    ) -> Playhead | None:
        """Return the moment that suits a path ahead best, from the pose of this moment.

        Parameters
        ----------
        now
            What the legs play.
        ahead
            The wished features "path" and "facing".
        staying
            Factor on the cost of playing on, at most 1: a small gain is no reason to jump. Infinite
            if it cannot.

        Returns
        -------
        Playhead or None
            None to play on.
        """
        row = self.row(now)
        query = self.legs.values[row].copy()
        for name, feature in ahead.items():
            query[self.legs.columns[name]] = self.legs.scale_feature(name, feature)
        return self._jump(self._leg_rows, self.legs, query, row, staying)

    def match_arms(self, arms: Playhead, legs: Playhead, staying: float = 1.0) -> Playhead | None:
        """Return the moment whose arms go on from those of one and suit the steps of another."""
        if self.arms is None:
            return None
        row = self.row(arms)
        query = self.arms.values[row].copy()
        steps = slice(self.arms.columns["feet"].start, None)
        query[steps] = self.arms.values[self.row(legs), steps]
        return self._jump(self._arm_rows, self.arms, query, row, staying)

    def _jump(
        self, rows: NearestRow, space: FeatureSpace, query: Array, row: int, staying: float
    ) -> Playhead | None:
        apart = space.values[row] - query
        found = rows.find(query, float(apart @ apart) * staying if np.isfinite(staying) else np.inf)
        return None if found is None else self.head(int(self._candidates[found[0]]))

    @cached_property
    def stillest(self) -> Playhead:
        """The moment at which the feet are slowest, and the root stays where it is."""
        still = np.zeros(len(self._candidates))
        for name in ("foot velocities", "path"):
            columns = self.legs.columns[name]
            values = self.legs.values[self._candidates, columns]
            at_rest = self.legs.scale_feature(name, np.zeros(values.shape[1]))
            still += np.square(values - at_rest).sum(1)
        return self.head(int(self._candidates[still.argmin()]))

    @cached_property
    def _first_rows(self) -> list[int]:
        """The first row of each clip, and the number of all rows."""
        counts = [len(row_times(clip)) for clip in self.clips]
        return [0, *np.cumsum(counts).tolist()]

    @cached_property
    def _candidates(self) -> NDArray[np.intp]:
        """The rows that may be jumped to."""
        keep: list[NDArray[np.bool_]] = []
        for clip in self.clips:
            times = row_times(clip)
            keep.append(times < (np.inf if clip.loop else max(clip.duration - TAIL_S, 1e-6)))
        return np.flatnonzero(np.concatenate(keep))

    @cached_property
    def _leg_rows(self) -> NearestRow:
        return NearestRow(self.legs.values[self._candidates])

    @cached_property
    def _arm_rows(self) -> NearestRow:
        assert self.arms is not None
        return NearestRow(self.arms.values[self._candidates])

    @cached_property
    def paces(self) -> Array:
        """Speeds over the ground that the clips have, ascending [m/s]."""
        walked = np.concatenate(
            [np.linalg.norm(np.diff(clip.track[:, :2], axis=0), axis=1) * clip.rate
             for clip in self.clips]
        )  # fmt: skip
        return np.sort(walked)


def _acceleration(features: Sequence[Mapping[str, Array]]) -> float:
    """Return the largest acceleration of hands and feet but for one moment in a thousand [m/s²]."""
    found = [np.zeros(1)]
    for each in features:
        for name in ("foot velocities", "hand velocities"):
            changes = np.diff(each[name].reshape(len(each[name]), -1, 3), axis=0) * ROW_RATE_HZ
            found.append(np.linalg.norm(changes, axis=-1).ravel())
    return max(float(np.quantile(np.concatenate(found), 0.999)), 1.0)


def _joints(skeleton: Skeleton, anatomy: Anatomy) -> tuple[FeatureJoints, NDArray[np.intp]]:
    """Return the joints of the features, and those above the hips."""
    found = {part: anatomy.joint(part) for part in ("hips", "leftFoot", "rightFoot")}
    missing = [part for part, joint in found.items() if joint is None]
    if missing or not skeleton.has_root_motion:
        what = "no joint named root on the ground" if not missing else f"no {missing[0]}"
        raise CharacterError(
            f"motion matching: the skeleton has {what}; give a character that walks, or make one "
            "with cubeling character locomotion"
        )
    hips, left, right = (joint for joint in found.values() if joint is not None)
    hands = [anatomy.joint(side + "Hand") for side in ("left", "right")]
    both = tuple(hand for hand in hands if hand is not None)
    spine = anatomy.joint("spine")
    upper = np.array([] if spine is None else subtree(skeleton, spine), np.intp)
    return FeatureJoints(hips, (left, right), both if len(both) == 2 and len(upper) else ()), upper


def _check(clips: Sequence[Clip], joints: FeatureJoints, skeleton: Skeleton) -> None:
    """Refuse clips from which no walking can be put together."""
    for clip in clips:
        if clip.poses.rotations.shape[1] != len(skeleton):
            raise CharacterError(
                f"motion matching: the clip {clip.name!r} is of another skeleton; retarget it first"
            )
    height = float(skeleton.rest.globals(skeleton)[joints.hips, 1, 3])
    travelled = max((np.ptp(clip.track[:, :2], axis=0).max() for clip in clips), default=0.0)
    if travelled < height:
        names = ", ".join(clip.name for clip in clips[:4]) or "none"
        raise CharacterError(
            f"motion matching: none of the clips ({names}) moves over the ground; add a recording "
            "of walking"
        )
