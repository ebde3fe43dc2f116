"""A pose found in one frame, before it is trusted, and how two of them compare."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cubeling.tracking.cube.model import side_of
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.refinement.edges.edge_fit import FittedEdges
from cubeling.tracking.refinement.evidence import Evidence

MIN_LOG_LIKELIHOOD_RATIO = 8.0
"""Twice the logarithm of a likelihood ratio, by the residuals of edges, from which on the better of
two poses is right."""

LEAST_RESIDUAL = 0.05
"""Residual that paper and lens leave at the right pose, too."""

SAME_POSE = (0.004, np.deg2rad(4))
"""Two poses closer than this are the same for all purposes [m, rad]."""


@dataclass(frozen=True)
class Candidate:
    """A pose found in one frame, before it is trusted."""

    camera_from_cube: Array
    """Pose of the cube, (4, 4) [m]."""

    covariance: Array
    """Of a pose delta, (6, 6), by the residuals: what differs from frame to frame."""

    source: Literal["markers", "image"]
    """As in `CubeState.source`."""

    faces: tuple[str, ...]
    """As in `CubeState.faces`."""

    error: float
    """As in `CubeState.reprojection_error` [px]."""

    residual: float
    """Edge residual over the share of edges found, or the corner error [px]; smaller is better."""

    certain: bool
    """Whether the edges or the blurred image prove that this is the cube."""

    blurred: bool = False
    """Whether the image is too blurred to prove it."""

    blur_motion: Array | None = None
    """Pose delta of the cube during the exposure, (6,), where it was measured."""

    blur: float = 0.0
    """Blur of the image, one standard deviation [px]; 0 where it was not measured."""

    measurements: int = 0
    """Roughly how many independent measurements the residual rests on; 0 if it tells nothing."""

    evidence: Evidence | None = None
    """As in `CellMatch.evidence`; None where the cells were not compared."""

    agreed: bool = False
    """Whether several faces agree on it, so that no other pose can be right."""

    edges: FittedEdges | None = None
    """The edges that the pose rests on; None where it rests on others."""

    @property
    def lone(self) -> bool:
        """Whether all its markers lie on one side of the cube, which may lean either way."""
        return len({side_of(face) for face in self.faces}) == 1

    @property
    def lone_residual(self) -> float | None:
        """Residual of the edges of a lone face [px]; None where others were measured."""
        return self.residual if self.lone and self.measurements else None

    @property
    def rank(self) -> tuple[bool, bool, float, float]:
        """Sorts the better ones first."""
        evidence = self.evidence.total if self.evidence else 0.0
        return not self.certain, not self.agreed, -evidence, self.residual

    def same_pose(self, other: "Candidate") -> bool:
        """Whether two candidates are the same pose for all purposes."""
        delta = se3.delta(self.camera_from_cube, other.camera_from_cube)
        return bool(
            np.linalg.norm(delta[:3]) < SAME_POSE[0] and np.linalg.norm(delta[3:]) < SAME_POSE[1]
        )

    def clearly_better_than(self, other: "Candidate") -> bool:
        """Whether cells, or else the residuals, tell that this pose is right."""
        if self.agreed != other.agreed:
            return self.agreed
        if self.evidence and other.evidence:
            return self.evidence.clearly_exceeds(other.evidence)
        ratio = (other.residual + LEAST_RESIDUAL) / (self.residual + LEAST_RESIDUAL)
        measurements = min(self.measurements, other.measurements)
        return bool(measurements * 2 * np.log(ratio) > MIN_LOG_LIKELIHOOD_RATIO)

    def is_ambiguous_with(self, other: "Candidate") -> bool:
        """Whether another pose may be the right one as well."""
        return not self.same_pose(other) and not self.clearly_better_than(other)

    def widen_to(self, other: "Candidate") -> "Candidate":
        """Return this pose with a covariance that covers another possible pose too."""
        apart = se3.delta(self.camera_from_cube, other.camera_from_cube)
        return replace(self, covariance=self.covariance + np.outer(apart, apart) / 4)
