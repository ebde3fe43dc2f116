"""A body that does not reach through itself: safe ranges of its components, and damping.

Source: Egges 2006, section 4.3, with erratum 3 (S14). It looks at one component at a time, so a
posture of several components in their ranges may still collide.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.body.capsules import CapsuleBody
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors

COMPONENTS, SAMPLES, DOMAIN_MARGIN = 10, 100, 0.1
"""Components that are damped; samples of the domain of each; and how much larger it is than that of
the recordings ([GAP]s of S14)."""

LEFT = 0.1
"""Share of the collisions of the recordings that may be left: all ranges become narrower for it."""

_HALVINGS = 6

THRESHOLD, SCALE = 0.7, 0.9
"""Share of a limit from which values are damped, and λ of eq. 4.4."""


def damp(values: Array, limits: Array, threshold: float = THRESHOLD, scale: float = SCALE) -> Array:
    """Return values that stay within limits ≥ 0 (eq. 4.6); negative ones are unchanged.

    Printed, u and w jump at the threshold and end at λ · limit; here u falls from 1 to λ and w
    rises from 0 to 1. It never decreases for thresholds up to 0.9; for later ones, a λ below 0.89
    turns back before the limit.

    >>> damp(np.array([0.6, 0.75, 0.9, 2.0]), np.ones(4)).round(6).tolist()
    [0.6, 0.762059, 0.958125, 1.0]
    """
    start = threshold * limits
    s = np.clip((values - start) / np.maximum(limits - start, 1e-12), 0.0, 1.0)
    w = (1.0 - np.cos(np.pi * s)) / 2.0
    u = 1.0 - (1.0 - scale) * w
    inside = (1.0 - w) * u * values + w * limits
    found: Array = np.where(values <= start, values, np.where(values >= limits, limits, inside))
    return found


@dataclass(frozen=True)
class SafeRanges:
    """How far each component of the upper body may go before the body touches itself."""

    kind: PostureVectors
    """Vectors of the upper body."""

    space: PostureSpace

    low: Array
    """Lower limits, (components,); at most 0."""

    high: Array
    """Upper limits, (components,); at least 0."""

    @staticmethod
    def of(
        clips: Sequence[Pose],
        kind: PostureVectors,
        body: CapsuleBody,
        clear: Pose,
        components: int = COMPONENTS,
        left: float = LEFT,
    ) -> "SafeRanges":
        """Return the ranges for a body, within those of the poses of clips.

        They are about a pose that does not collide, `clear` (1, …): the mean posture of other
        people's recordings may.
        """
        vectors = np.concatenate([kind.vectors(poses) for poses in clips])
        space = replace(PostureSpace.of(vectors), mean=kind.vectors(clear)[0])
        at = space.project(vectors, components)
        margin = DOMAIN_MARGIN * np.ptp(at, axis=0)
        lows, highs = np.minimum(at.min(0) - margin, 0.0), np.maximum(at.max(0) + margin, 0.0)
        for number in range(components):
            for limits in (lows, highs):
                steps = np.zeros((SAMPLES + 1, components))
                steps[:, number] = np.linspace(0.0, limits[number], SAMPLES + 1)
                touches = body.collides(kind.poses(space.restore(steps)), kind.skeleton)
                if touches[1:].any():
                    limits[number] = steps[int(np.argmax(touches[1:])), number]
        return SafeRanges(kind, space, lows, highs)._narrow(clips, body, left)

    def _narrow(self, clips: Sequence[Pose], body: CapsuleBody, left: float) -> "SafeRanges":
        """Return the widest of the ranges, all narrower by one factor, that leave so little."""

        def collisions(share: float) -> int:
            ranges = replace(self, low=share * self.low, high=share * self.high)
            return sum(int(body.collides(ranges.keep(p), self.kind.skeleton).sum()) for p in clips)

        allowed = left * sum(int(body.collides(p, self.kind.skeleton).sum()) for p in clips)
        if collisions(1.0) <= allowed:
            return self
        least, most = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = (least + most) / 2.0
            least, most = (least, middle) if collisions(middle) > allowed else (middle, most)
        return replace(self, low=least * self.low, high=least * self.high)

    def keep(self, pose: Pose) -> Pose:
        """Return a pose (…) whose upper body stays within the ranges; nothing else changes."""
        vectors = self.kind.vectors(pose)
        at = self.space.project(vectors, len(self.high))
        kept = -damp(-damp(at, self.high), -self.low)
        if np.array_equal(kept, at):
            return pose
        moved = vectors + (kept - at) @ self.space.components[:, : len(self.high)].T
        turns = self.kind.poses(moved, pose).rotations
        changed = (kept != at).any(-1)[..., None, None]
        return replace(pose, rotations=np.where(changed, turns, pose.rotations))
