"""Gestures of few joints move the others too: the spine, the shoulders and the head.

Source: Egges 2006, section 4.4 (S15). Recorded upper bodies move along few components; what a
gesture has along the last ones is what no body does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors

FADE_FROM, FADE_TO = 20 / 48, 30 / 48
"""Shares of the components, first and last, between which the filter fades out: the documents have
48 components, and fade from 20 to 30."""


def fade(count: int, start: float = FADE_FROM, end: float = FADE_TO) -> Array:
    """Return the factor of each component: 1, then a linear fade, then 0.

    >>> fade(48)[[0, 20, 25, 30, 47]].round(6).tolist()
    [1.0, 1.0, 0.5, 0.0, 0.0]
    """
    at = np.arange(count) / count
    factors: Array = np.clip((end - at) / max(end - start, 1e-9), 0.0, 1.0)
    return factors


@dataclass(frozen=True)
class DependentJoints:
    """A linear filter of upper bodies."""

    kind: PostureVectors
    """Vectors of the upper body."""

    neutral: Array
    """The posture that is not changed, (size,)."""

    operator: Array
    """What multiplies the difference to it, (size, size); symmetric."""

    @staticmethod
    def of(
        clips: Sequence[Pose],
        kind: PostureVectors,
        start: float = FADE_FROM,
        end: float = FADE_TO,
    ) -> "DependentJoints":
        """Return the filter of the upper bodies in clips.

        The earlier it fades out, the more the other joints join in, and the less is left of the
        gesture; see `fade`.
        """
        space = PostureSpace.of(np.concatenate([kind.vectors(poses) for poses in clips]))
        axes = space.components
        return DependentJoints(kind, space.mean, axes * fade(kind.size, start, end) @ axes.T)

    def apply(self, vectors: Array) -> Array:
        """Return the filtered vectors, (…, size)."""
        filtered: Array = self.neutral + (vectors - self.neutral) @ self.operator
        return filtered

    def move(self, pose: Pose, share: float = 1.0) -> Pose:
        """Return a pose (…) with a share of the filter; legs and root stay."""
        own = self.kind.vectors(pose)
        return self.kind.poses(own + share * (self.apply(own) - own), pose)
