"""How unlike two frames are: four distances behind one protocol, by name."""

from collections.abc import Callable

from cubeling.characters.synthesis.body import default_body_plan
from cubeling.characters.synthesis.distances.ahn_wohn import AhnWohn
from cubeling.characters.synthesis.distances.angles import JointAngles
from cubeling.characters.synthesis.distances.distance import FrameDistance, distance_matrix
from cubeling.characters.synthesis.distances.points import PointClouds
from cubeling.characters.synthesis.library import MotionLibrary

LEE_JOINTS = (
    *("leftUpperArm", "rightUpperArm", "leftLowerArm", "rightLowerArm", "hips", "spine"),
    *("leftUpperLeg", "rightUpperLeg", "leftLowerLeg", "rightLowerLeg"),
)
"""Joints that Lee et al. 2002 weigh by one: shoulders, elbows, hips, knees, pelvis and spine."""


def thesis_distance(library: MotionLibrary, velocity: float = 0.0) -> JointAngles:
    """Return the distance of M1 with the joint weights of M2.2."""
    return JointAngles(library, default_body_plan().joint_weights(library.anatomy), velocity)


def lee_distance(library: MotionLibrary, velocity: float = 0.01) -> JointAngles:
    """Return the distance of Lee et al. 2002: D_ij = d(p_i, p_j) + ν d(v_i, v_j) (S26, T 2.22)."""
    joints = (library.anatomy.joint(part) for part in LEE_JOINTS)
    return JointAngles(library, {j: 1.0 for j in joints if j is not None}, velocity)


DISTANCES: dict[str, Callable[[MotionLibrary], FrameDistance]] = {
    "angles": thesis_distance,
    "lee": lee_distance,
    "points": PointClouds,
    "ahn-wohn": AhnWohn,
}
"""All distances by name; a new one is registered here."""

__all__ = [
    "DISTANCES",
    "AhnWohn",
    "FrameDistance",
    "JointAngles",
    "PointClouds",
    "distance_matrix",
    "lee_distance",
    "thesis_distance",
]
