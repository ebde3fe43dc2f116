"""Many clips in one table, to sample and mix many of them, for many characters, at once.

A pose is one row: what a character shows is a weighted sum of a few rows. So sampling and mixing
any number of clips for any number of characters is one look-up, one product and one
normalisation, whatever their number.

A quaternion half way between two frames is a little shorter than one of them, and is mixed as it
is: in a mix of motions that differ much, a joint may lie a thousandth of a turn beside where
`blend.mix` puts it. Single motions are the same.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from characters.errors import CharacterError
from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.pose import Array, Pose, Skeleton

Numbers = NDArray[np.intp]
Floats = NDArray[Any]

_BLOCK = 64  # characters whose rows are looked up at once: so many stay near the processor
_STILL = 1e-7  # [m], or part of a scale: what moves less is the same in every row


@dataclass(frozen=True)
class Bank:
    """Clips of one skeleton, packed; see `Bank.of`."""

    skeleton: Skeleton
    """Whose joints the rows hold."""

    table: Floats
    """A row a frame, (rows, columns): quaternions, then what moves of the rest."""

    starts: Numbers
    """First row of each clip, (clips,)."""

    lasts: Array
    """Frames from the first to the last of each clip, (clips,)."""

    rates: Array
    """Frames a second of each clip, (clips,) [Hz]."""

    loops: NDArray[np.bool_]
    """Whether each clip repeats, (clips,)."""

    still: Pose
    """What every row shares: translations, scales and morphs that no clip changes."""

    moved: Numbers
    """Joints that some clip shifts, (n,); three columns each after the quaternions."""

    scaled: Numbers
    """Joints that some clip scales, (n,); three columns each after these."""

    astray: Numbers
    """Joints that turn so far that not all their quaternions lie in one half of their sphere, (n,);
    their signs are brought to agree whenever they are mixed, those of all others never."""

    beside: int = 0
    """How many columns at the end hold other numbers."""

    @staticmethod
    def of(
        skeleton: Skeleton,
        clips: Sequence[Clip],
        dtype: DTypeLike = np.float32,
        beside: Sequence[Array] | None = None,
    ) -> "Bank":
        """Pack clips; roots with root motion stay in place, as in `Clip.sample`.

        Parameters
        ----------
        skeleton
            Of all of them.
        clips
            What to pack; they are then called by their number.
        dtype
            Of the table. Single precision is good for 0.1 µm at arm's length.
        beside
            Other numbers for each frame of each clip, (frames, columns), that are mixed alike.
        """
        joints = len(skeleton)
        if not clips or any(clip.poses.rotations.shape[1] != joints for clip in clips):
            raise CharacterError(
                f"bank of {len(clips)} clips: each must move the skeleton's {joints} joints"
            )
        poses = [_twice_if_single(clip.in_place) for clip in clips]
        counts = np.array([len(pose.rotations) for pose in poses])
        turns = np.concatenate([pose.rotations for pose in poses])
        turns, astray = _one_sided(turns, counts)
        shifts = np.concatenate([pose.translations for pose in poses])
        scales = _stacked([pose.scales for pose in poses], counts, shifts.shape[1:], 1.0)
        width = max(0 if p.morphs is None else p.morphs.shape[-1] for p in poses)
        morphs = _stacked([pose.morphs for pose in poses], counts, (width,), 0.0)
        moved = np.flatnonzero((np.ptp(shifts, axis=0) > _STILL).any(-1))
        scaled = np.flatnonzero((np.ptp(scales, axis=0) > _STILL).any(-1))
        unscaled = not scaled.size and np.allclose(scales[0], 1.0, atol=_STILL)
        parts = [turns, shifts[:, moved], scales[:, scaled], morphs]
        if beside is not None:
            parts.append(np.concatenate([_twice(each) for each in beside]))
        table = np.concatenate([part.reshape(len(turns), -1) for part in parts], axis=1)
        return Bank(
            skeleton=skeleton,
            table=np.ascontiguousarray(table, dtype),
            starts=np.cumsum([0, *counts[:-1]]),
            lasts=np.array([len(clip) - 1.0 for clip in clips]),
            rates=np.array([clip.rate for clip in clips]),
            loops=np.array([clip.loop for clip in clips]),
            still=Pose(
                shifts[0].astype(dtype),
                turns[0].astype(dtype),
                None if unscaled else scales[0].astype(dtype),
                np.zeros(width, dtype) if width else None,
            ),
            moved=moved,
            scaled=scaled,
            astray=astray,
            beside=0 if beside is None else beside[0].shape[1],
        )

    def __len__(self) -> int:
        """Return the number of clips."""
        return len(self.starts)

    def rows(self, clips: ArrayLike, times: ArrayLike) -> tuple[Numbers, Array]:
        """Return the row at or before each time, (…), and the part of the way to the next.

        Parameters
        ----------
        clips
            Numbers of clips, (…).
        times
            Since the start of each [s], (…); loops repeat, others are held at their ends.
        """
        number = np.asarray(clips, np.intp)
        last = self.lasts[number]
        at = np.asarray(times, float) * self.rates[number]
        safe = np.maximum(last, 1.0)
        at = np.where(self.loops[number], np.mod(at, safe), np.clip(at, 0.0, last))
        frame = np.minimum(at.astype(np.intp), np.maximum(last - 1.0, 0.0).astype(np.intp))
        return self.starts[number] + frame, np.where(last > 0, at - frame, 0.0)

    def mixed(self, clips: ArrayLike, times: ArrayLike, weights: ArrayLike) -> Floats:
        """Return weighted sums of rows, (characters, columns), quaternions not yet at unit length.

        Parameters
        ----------
        clips, times
            What each character plays and when [s], (characters, voices).
        weights
            How much of each, (characters, voices); each row sums to one.
        """
        row, u = self.rows(clips, times)
        share = np.asarray(weights, float)
        factors = np.concatenate([share * (1.0 - u), share * u], axis=-1).astype(self.table.dtype)
        numbers = np.concatenate([row, row + 1], axis=-1)
        total = np.empty((len(numbers), self.table.shape[1]), self.table.dtype)
        for first in range(0, len(numbers), _BLOCK):
            block = slice(first, first + _BLOCK)
            looked_up = self.table.take(numbers[block], axis=0)
            np.matmul(factors[block, None], looked_up, out=total[block, None])
        self._mix_astray(numbers, factors, total)
        return total

    def blended(self, voices: Sequence[tuple[int, float, float]]) -> tuple[Pose, Floats]:
        """Return one character's mixed pose, and what is mixed beside it, (columns,).

        It is what `mixed` and `pose` do, for one character in fewer steps.

        Parameters
        ----------
        voices
            Number of a clip, time since its start [s], and how much of it.
        """
        rows: list[int] = []
        factors: list[float] = []
        for clip, time, weight in voices:
            row, u = self._row(clip, time)
            rows += (row, row + 1)
            factors += (weight * (1.0 - u), weight * u)
        share = np.array(factors, self.table.dtype)
        mixed = share @ self.table.take(rows, axis=0)
        if self.astray.size:
            self._mix_astray(np.array([rows]), share[None], mixed[None])
        turned, shifted, sized, morphed = self.edges
        turns = mixed[:turned].reshape(-1, 4)
        turns = turns / np.sqrt(np.einsum("ji,ji->j", turns, turns))[:, None]
        places, sizes = self.still.translations.copy(), self.still.scales
        places[self.moved] = mixed[turned:shifted].reshape(-1, 3)
        if sizes is not None:
            sizes = sizes.copy()
            sizes[self.scaled] = mixed[shifted:sized].reshape(-1, 3)
        morphs = mixed[sized:morphed] if morphed > sized else None
        return Pose(places, turns, sizes, morphs), mixed[morphed:]

    def _row(self, clip: int, time: float) -> tuple[int, float]:
        """Return what `rows` does, for one time."""
        start, last, rate, loop = self._clips[clip]
        if last == 0.0:
            return start, 0.0
        at = time * rate
        at = at % last if loop else min(max(at, 0.0), last)
        frame = min(int(at), int(last) - 1)
        return start + frame, at - frame

    @cached_property
    def _clips(self) -> list[tuple[int, float, float, bool]]:
        """First row, last frame, rate and loop of each clip, as plain numbers."""
        columns = (self.starts, self.lasts, self.rates, self.loops)
        return list(zip(*(column.tolist() for column in columns), strict=True))

    @cached_property
    def edges(self) -> tuple[int, int, int, int]:
        """Where quaternions, translations, scales and morphs end in a row."""
        turned = 4 * len(self.skeleton)
        shifted = turned + 3 * self.moved.size
        sized = shifted + 3 * self.scaled.size
        return turned, shifted, sized, self.table.shape[1] - self.beside

    def sample(self, clips: ArrayLike, times: ArrayLike, weights: ArrayLike) -> Pose:
        """Return mixed poses, (characters, joints, …); see `mixed` for the arguments."""
        return self.pose(self.mixed(clips, times, weights))

    def pose(self, rows: Floats) -> Pose:
        """Return rows (characters, columns) as poses, with quaternions at unit length."""
        count, joints = len(rows), len(self.skeleton)
        turns, shifts, scales, morphs, _ = np.split(rows, self.edges, axis=1)
        turns = turns.reshape(count, joints, 4)
        turns = turns / np.sqrt(np.einsum("cji,cji->cj", turns, turns))[..., None]
        places = np.tile(self.still.translations, (count, 1, 1))
        places[:, self.moved] = shifts.reshape(count, -1, 3)
        sizes = None
        if self.still.scales is not None:
            sizes = np.tile(self.still.scales, (count, 1, 1))
            sizes[:, self.scaled] = scales.reshape(count, -1, 3)
        return Pose(places, turns, sizes, morphs if morphs.shape[1] else None)

    def _mix_astray(self, numbers: Numbers, factors: Floats, total: Floats) -> None:
        """Mix the joints anew that turn far, with the signs of each character's heaviest row.

        Rows `numbers` (characters, rows) are mixed by `factors` (characters, rows) to `total`
        (characters, columns).
        """
        if not self.astray.size:
            return
        turns = self._astray_table.take(numbers, axis=1)  # (4 n, characters, rows)
        heaviest = np.arange(len(numbers)), factors.argmax(1)
        for place, joint in enumerate(self.astray.tolist()):
            own = turns[4 * place : 4 * place + 4]
            dots = sum(part * part[heaviest][:, None] for part in own)
            signed = np.where(dots < 0, -factors, factors)
            total[:, 4 * joint : 4 * joint + 4] = np.einsum("kcv,cv->ck", own, signed)

    @cached_property
    def _astray_table(self) -> Floats:
        """The quaternions that may disagree, component by component, (4 n, rows)."""
        columns = (4 * self.astray[:, None] + np.arange(4)).ravel()
        return np.ascontiguousarray(self.table[:, columns].T)

    @cached_property
    def stretched(self) -> Numbers:
        """Joints whose scale is not always one, (n,)."""
        if self.still.scales is None:
            return np.zeros(0, np.intp)
        uneven = np.abs(self.still.scales - 1.0).max(-1) > _STILL
        uneven[self.scaled] = True
        return np.flatnonzero(uneven)


def _twice_if_single(pose: Pose) -> Pose:
    """Return poses with their only frame repeated, so that every row has one after it."""
    return pose[np.array([0, 0])] if len(pose.rotations) == 1 else pose


def _twice(rows: Array) -> Array:
    """Return numbers beside such poses, likewise."""
    return rows[[0, 0]] if len(rows) == 1 else rows


def _stacked(
    arrays: Sequence[Array | None], counts: Numbers, shape: tuple[int, ...], default: float
) -> Array:
    """Return arrays (frames, …) one after the other, filled where there is none."""
    return np.concatenate(
        [
            np.full((count, *shape), default) if array is None else array
            for array, count in zip(arrays, counts, strict=True)
        ]
    )


def _one_sided(turns: Array, counts: Numbers) -> tuple[Array, Numbers]:
    """Return quaternions (rows, joints, 4) with each joint's on one side, and where they are not.

    A joint that turns by more than half a turn over all clips cannot be brought to one side
    without a jump of sign between two frames: its signs stay continuous within each clip.
    """
    mean = turns[0]
    for _ in range(3):
        aligned = rotations.align(turns, mean)
        mean = rotations.normalize(aligned.mean(0))
    same_clip = np.ones(len(turns) - 1, bool)
    same_clip[np.cumsum(counts)[:-1] - 1] = False
    jumps = np.einsum("fji,fji->fj", aligned[1:], aligned[:-1])[same_clip] <= 0.0
    far = np.einsum("fji,ji->fj", aligned, mean) <= math.cos(math.pi / 4)
    astray = jumps.any(0) | far.any(0)
    return np.where(astray[:, None], turns, aligned), np.flatnonzero(astray)
