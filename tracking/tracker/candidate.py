"""A pose found in one frame, before it is trusted, and how two of them compare."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tracking.geometry import se3

Array = NDArray[np.float64]

DECISIVE = 8.0
"""Twice the logarithm of a likelihood ratio from which on the better of two poses is right."""


@dataclass(frozen=True)
class Candidate:
    """A pose found in one frame, before it is trusted."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a shift-turn, (6, 6)."""

    source: Literal["markers", "image"]
    """As in `CubeState.source`."""

    faces: tuple[str, ...]
    """As in `CubeState.faces`."""

    error: float
    """As in `CubeState.reprojection_error` [px]."""

    residual: float
    """Edge residual over the share of edges found, or the corner error [px]; smaller is better."""

    certain: bool
    """Whether edges confirm it beyond doubt, or two markers and edges do."""

    blurred: bool = False
    """Whether one marker alone vouches for it, whose edges should have been seen but were not."""

    sweep: Array | None = None
    """Shift-turn of the cube while the shutter was open, (6,), where it was measured."""

    lines: int = 8
    """How many independent measurements the residual rests on, roughly."""


def decisive(best: Candidate, other: Candidate) -> bool:
    """Whether the residuals tell which of two poses is right: a ratio of likelihoods."""
    ratio = max(other.residual, 1e-6) / max(best.residual, 1e-6)
    return bool(min(best.lines, other.lines) * 2 * np.log(ratio) > DECISIVE)


def doubled(found: Candidate, other: Candidate) -> Candidate:
    """Doubt a pose as much as the other one that it could be demands."""
    apart = se3.motion(found.camera_from_cube, other.camera_from_cube)
    return replace(found, covariance=found.covariance + np.outer(apart, apart) / 4)


def close(a: Candidate, b: Candidate) -> bool:
    """Whether two poses are the same for all purposes."""
    step = se3.motion(a.camera_from_cube, b.camera_from_cube)
    return bool(np.linalg.norm(step[:3]) < 0.004 and np.linalg.norm(step[3:]) < np.deg2rad(4))
