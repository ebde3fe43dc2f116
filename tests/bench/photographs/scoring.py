"""Errors of poses, relative poses of markers, and whether stated covariances hold them."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.geometry import se3
from tests.bench.photographs.dodecahedron import medoid
from tests.bench.photographs.marker_corners import Array
from tests.bench.tracking.scoring import MAX_RECALL_ERROR, MIN_WRONG_ERROR

Result = TypeVar("Result")
Parameters = ParamSpec("Parameters")

CONSENSUS_STEPS, OUTLIER = 15, 2.0
"""Steps to a consensus, and how many medians away a pose has lost half of its weight."""


@dataclass(frozen=True, eq=False)
class StatedPose:
    """A pose with the covariance that its tracker states."""

    pose: Array
    """(4, 4) [m]."""

    covariance: Array | None = None
    """Of a pose delta, about the origin of the pose, (6, 6); None where none is stated."""

    def at(self, frame: Array) -> "StatedPose":
        """The pose of a frame that is fixed to this one, (4, 4)."""
        pose = self.pose @ frame
        if self.covariance is None:
            return StatedPose(pose)
        # A rotation moves what is far from its centre.
        by_delta = np.eye(6)
        by_delta[:3, 3:] = -se3.hat(pose[:3, 3] - self.pose[:3, 3])
        return StatedPose(pose, by_delta @ self.covariance @ by_delta.T)

    def relative(self, other: "StatedPose") -> "StatedPose":
        """The other's pose as seen from this one, both errors taken as independent."""
        pose = se3.inverse(self.pose) @ other.pose
        if self.covariance is None or other.covariance is None:
            return StatedPose(pose)
        moved, turn = self.at(pose).covariance, np.kron(np.eye(2), self.pose[:3, :3].T)
        assert moved is not None
        return StatedPose(pose, turn @ (moved + other.covariance) @ turn.T)


def sizes(deltas: Array) -> tuple[Array, Array]:
    """Distances [m] and angles [rad] of pose deltas, (N, 6)."""
    rows = np.reshape(deltas, (-1, 6))
    return np.linalg.norm(rows[:, :3], axis=1), np.linalg.norm(rows[:, 3:], axis=1)


def are_right(deltas: Array) -> Array:
    """Whether each pose is as near to the truth as recall asks, (N,)."""
    shift, turn = sizes(deltas)
    return np.asarray((shift <= MAX_RECALL_ERROR[0]) & (turn <= MAX_RECALL_ERROR[1]))


def are_wrong(deltas: Array) -> Array:
    """Whether each pose is silently wrong, (N,)."""
    shift, turn = sizes(deltas)
    return np.asarray((shift > MIN_WRONG_ERROR[0]) | (turn > MIN_WRONG_ERROR[1]))


def medians(deltas: Array) -> tuple[float, float]:
    """Median distance [m] and angle [rad]; NaN where there are none."""
    shift, turn = sizes(deltas)
    return (float(np.median(shift)), float(np.median(turn))) if len(shift) else (np.nan, np.nan)


def chi_square(error: Array, covariance: Array) -> float:
    """Square of an error in units of its standard deviations."""
    return float(error @ np.linalg.solve(covariance, error))


def consensus(poses: list[Array]) -> tuple[Array, Array]:
    """Robust mean of poses of one thing, (4, 4), and the weight of each, (N,), 1 in sum."""
    mean = medoid(poses)[0]
    for _ in range(CONSENSUS_STEPS):
        deltas = np.array([se3.delta(mean, pose) for pose in poses])
        shift, turn = (size / max(float(np.median(size)), 1e-9) for size in sizes(deltas))
        weights = 1 / (1 + (shift**2 + turn**2) / 2 / OUTLIER**2)
        weights /= weights.sum()
        mean = se3.apply_delta(mean, weights @ deltas)
    return mean, weights


def deltas_from_consensus(stated: list[StatedPose]) -> tuple[Array, list[float]]:
    """Pose deltas from the consensus, (N, 6), and χ² of each where covariances are stated.

    A pose draws the consensus to itself, and the others' errors move it: both are known from the
    weights, so a true covariance holds as many as it says.
    """
    mean, weights = consensus([each.pose for each in stated])
    deltas = np.array([se3.delta(mean, each.pose) for each in stated])
    known = [each.covariance for each in stated if each.covariance is not None]
    if len(known) < len(stated):
        return deltas, []
    covariances = np.stack(known)
    of_mean = np.einsum("n,nij->ij", weights**2, covariances)
    own = (1 - 2 * weights)[:, None, None] * covariances + of_mean
    return deltas, [chi_square(*each) for each in zip(deltas, own, strict=True)]


def timed(
    work: Callable[Parameters, Result], *given: Parameters.args, **named: Parameters.kwargs
) -> tuple[Result, float]:
    """What `work` returns, and its CPU time [s]."""
    start = time.process_time()
    result = work(*given, **named)
    return result, time.process_time() - start


def high(values: Sequence[float]) -> float:
    """The 95th percentile; NaN of nothing."""
    return float(np.quantile(values, 0.95)) if len(values) else np.nan


def share(flags: list[bool] | NDArray[np.bool_]) -> float:
    """Share that is true; NaN of nothing."""
    return float(np.mean(np.asarray(flags, np.float64))) if len(flags) else np.nan
