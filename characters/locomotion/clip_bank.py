"""Many clips in one table, from which a mixed pose is taken with one product.

A row of the table is a pose, and a mixed pose is a weighted sum of rows. Quaternions between two
frames are mixed before they are normalised: in a mix of very different motions a joint may deviate
from `blend.mix` by a thousandth of a turn. Single motions are identical.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

Indices = NDArray[np.intp]
Floats = NDArray[Any]

_CONSTANT_TOLERANCE = 1e-7  # [m] or relative scale: smaller changes count as constant


@dataclass(frozen=True)
class ClipBank:
    """Packed clips of one skeleton; see `ClipBank.of`."""

    skeleton: Skeleton
    """The skeleton of all clips."""

    table: Floats
    """One row a frame, (rows, columns): all quaternions, then the other values that vary."""

    starts: Indices
    """First row of each clip, (clips,)."""

    last_frames: Array
    """Number of the last frame of each clip, (clips,)."""

    rates: Array
    """Frame rate of each clip, (clips,) [Hz]."""

    loops: NDArray[np.bool_]
    """Whether each clip repeats, (clips,)."""

    constant: Pose
    """The values that no clip changes."""

    moving: Indices
    """Joints with varying translations, (n,); three columns each after the quaternions."""

    scaling: Indices
    """Joints with varying scales, (n,); three columns each after the translations."""

    sign_ambiguous: Indices
    """Joints whose quaternions do not all lie in one hemisphere, (n,). Their signs are aligned in
    each mix; the signs of the other joints are aligned once, in the table."""

    extra_columns: int = 0
    """Number of columns at the end with other values."""

    @staticmethod
    def of(
        skeleton: Skeleton,
        clips: Sequence[Clip],
        dtype: DTypeLike = np.float32,
        extra: Sequence[Array] | None = None,
    ) -> "ClipBank":
        """Return packed clips; roots with root motion stay in place, as in `Clip.sample`.

        Parameters
        ----------
        skeleton, clips
            Later arguments refer to the clips by number.
        dtype
            Of the table. The error of single precision is about 0.1 µm at 1 m.
        extra
            Other values for each frame of each clip, (frames, columns), that are mixed as well.
        """
        joints = len(skeleton)
        if not clips or any(clip.poses.rotations.shape[1] != joints for clip in clips):
            raise CharacterError(
                f"bank of {len(clips)} clips: each must move the skeleton's {joints} joints"
            )
        poses = [_repeat_single_frame(clip.in_place) for clip in clips]
        counts = np.array([len(pose.rotations) for pose in poses])
        turns = np.concatenate([pose.rotations for pose in poses])
        turns, sign_ambiguous = _align_signs(turns, counts)
        shifts = np.concatenate([pose.translations for pose in poses])
        scales = _stack([pose.scales for pose in poses], counts, shifts.shape[1:], 1.0)
        width = max(0 if p.morphs is None else p.morphs.shape[-1] for p in poses)
        morphs = _stack([pose.morphs for pose in poses], counts, (width,), 0.0)
        moving = np.flatnonzero((np.ptp(shifts, axis=0) > _CONSTANT_TOLERANCE).any(-1))
        scaling = np.flatnonzero((np.ptp(scales, axis=0) > _CONSTANT_TOLERANCE).any(-1))
        unscaled = not scaling.size and np.allclose(scales[0], 1.0, atol=_CONSTANT_TOLERANCE)
        parts = [turns, shifts[:, moving], scales[:, scaling], morphs]
        if extra is not None:
            parts.append(np.concatenate([e[[0, 0]] if len(e) == 1 else e for e in extra]))
        table = np.concatenate([part.reshape(len(turns), -1) for part in parts], axis=1)
        return ClipBank(
            skeleton=skeleton,
            table=np.ascontiguousarray(table, dtype),
            starts=np.cumsum([0, *counts[:-1]]),
            last_frames=np.array([len(clip) - 1.0 for clip in clips]),
            rates=np.array([clip.rate for clip in clips]),
            loops=np.array([clip.loop for clip in clips]),
            constant=Pose(
                shifts[0].astype(dtype),
                turns[0].astype(dtype),
                None if unscaled else scales[0].astype(dtype),
                np.zeros(width, dtype) if width else None,
            ),
            moving=moving,
            scaling=scaling,
            sign_ambiguous=sign_ambiguous,
            extra_columns=0 if extra is None else extra[0].shape[1],
        )

    def __len__(self) -> int:
        return len(self.starts)

    def blend(self, contributions: Sequence[tuple[int, float, float]]) -> tuple[Pose, Floats]:
        """Return a mixed pose, and the mixed extra values, (columns,).

        A contribution is the number of a clip, the time since its start [s], and its weight. Loops
        repeat, other clips hold their ends.
        """
        rows: list[int] = []
        factors: list[float] = []
        for clip, time, weight in contributions:
            row, u = self._row(clip, time)
            rows += (row, row + 1)
            factors += (weight * (1.0 - u), weight * u)
        share = np.array(factors, self.table.dtype)
        mixed = share @ self.table.take(rows, axis=0)
        if self.sign_ambiguous.size:
            self._mix_sign_ambiguous(rows, share, mixed)
        rotation_end, translation_end, scale_end, morph_end = self._column_ends
        turns = mixed[:rotation_end].reshape(-1, 4)
        turns = turns / np.sqrt(np.vecdot(turns, turns))[:, None]
        translations, scales = self.constant.translations.copy(), self.constant.scales
        translations[self.moving] = mixed[rotation_end:translation_end].reshape(-1, 3)
        if scales is not None:
            scales = scales.copy()
            scales[self.scaling] = mixed[translation_end:scale_end].reshape(-1, 3)
        morphs = mixed[scale_end:morph_end] if morph_end > scale_end else None
        return Pose(translations, turns, scales, morphs), mixed[morph_end:]

    def _row(self, clip: int, time: float) -> tuple[int, float]:
        """Return the row at or before a time [s], and the fraction towards the next row."""
        start, last, rate, loop = self._clips[clip]
        if last == 0.0:
            return start, 0.0
        at = time * rate
        at = at % last if loop else min(max(at, 0.0), last)
        frame = min(int(at), int(last) - 1)
        return start + frame, at - frame

    @cached_property
    def _clips(self) -> list[tuple[int, float, float, bool]]:
        """First row, last frame, rate and loop of each clip as Python numbers."""
        columns = (self.starts, self.last_frames, self.rates, self.loops)
        return list(zip(*(column.tolist() for column in columns), strict=True))

    @cached_property
    def _column_ends(self) -> tuple[int, int, int, int]:
        """Ends of quaternions, translations, scales and morphs in a row."""
        turned = 4 * len(self.skeleton)
        shifted = turned + 3 * self.moving.size
        sized = shifted + 3 * self.scaling.size
        return turned, shifted, sized, self.table.shape[1] - self.extra_columns

    def _mix_sign_ambiguous(self, rows: list[int], share: Floats, mixed: Floats) -> None:
        """Mix the sign-ambiguous joints again, with signs aligned to the row of largest weight."""
        turns = self._sign_ambiguous_table.take(rows, axis=0)
        near = np.einsum("rjk,jk->rj", turns, turns[share.argmax()])
        signed = np.where(near < 0.0, -share[:, None], share[:, None])
        columns = 4 * self.sign_ambiguous[:, None] + np.arange(4)
        mixed[columns] = np.einsum("rj,rjk->jk", signed, turns)

    @cached_property
    def _sign_ambiguous_table(self) -> Floats:
        """The sign-ambiguous quaternions, (rows, n, 4)."""
        return self.table[:, : 4 * len(self.skeleton)].reshape(len(self.table), -1, 4)[
            :, self.sign_ambiguous
        ]


def _repeat_single_frame(pose: Pose) -> Pose:
    """Return poses with a single frame repeated, so that every row has a next row."""
    return pose[np.array([0, 0])] if len(pose.rotations) == 1 else pose


def _stack(
    arrays: Sequence[Array | None], counts: Indices, shape: tuple[int, ...], default: float
) -> Array:
    """Return concatenated arrays (frames, …), with the default for those that are None."""
    return np.concatenate(
        [
            np.full((count, *shape), default) if array is None else array
            for array, count in zip(arrays, counts, strict=True)
        ]
    )


def _align_signs(turns: Array, counts: Indices) -> tuple[Array, Indices]:
    """Return quaternions (rows, joints, 4) in one hemisphere for each joint, and the exceptions.

    For a joint that turns by more than half a turn over all clips this would cause sign jumps
    between frames; the signs of these exceptions stay continuous within each clip.
    """
    mean = turns[0]
    for _ in range(3):
        aligned = rotations.align(turns, mean)
        mean = rotations.normalize(aligned.mean(0))
    same_clip = np.ones(len(turns) - 1, bool)
    same_clip[np.cumsum(counts)[:-1] - 1] = False
    jumps = np.einsum("fji,fji->fj", aligned[1:], aligned[:-1])[same_clip] <= 0.0
    far = np.einsum("fji,ji->fj", aligned, mean) <= math.cos(math.pi / 4)
    sign_ambiguous = jumps.any(0) | far.any(0)
    return np.where(sign_ambiguous[:, None], turns, aligned), np.flatnonzero(sign_ambiguous)
