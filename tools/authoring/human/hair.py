"""The bundled explorer's hair: a cap with a fringe, tufts at the back, and a cowlick."""

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.sculpt import BodyPart
from tools.authoring.modelling.shapes import (
    Difference,
    Ellipsoid,
    RoundCone,
    Union,
    Vector,
    linear_rgb,
)
from tools.authoring.modelling.tube import tube

HAIR = linear_rgb("#7c391d")

COWLICK_LINES_M: tuple[list[Vector], ...] = (
    [(0.0, 1.63, -0.035), (0.0, 1.70, -0.052), (-0.035, 1.748, -0.068), (-0.082, 1.766, -0.074)],
    [(0.046, 1.63, 0.0), (0.063, 1.695, 0.0), (0.07, 1.74, 0.023), (0.05, 1.768, 0.063)],
)
"""Centre lines of the two locks on the crown [m]."""


def hair_parts() -> list[BodyPart]:
    """Return its sculpted parts."""
    cap = Ellipsoid((0, 1.513, -0.031), (0.231, 0.214, 0.221), bones=("head",), color=HAIR)
    nape = Ellipsoid((0, 1.389, -0.106), (0.168, 0.130, 0.124), bones=("head",), color=HAIR)
    brow_line = Ellipsoid((0, 1.392, 0.211), (0.214, 0.214, 0.248))
    whole = Difference(Union((cap, nape), 0.062), brow_line, 0.025)
    fringe = [
        _lock((-0.062, 1.686, 0.097), (0.106, 1.622, 0.186), 0.062, 0.025),
        _lock((0.0, 1.680, 0.109), (0.186, 1.585, 0.118), 0.060, 0.022),
        _lock((-0.087, 1.680, 0.097), (-0.124, 1.598, 0.170), 0.056, 0.020),
        _lock((-0.124, 1.650, 0.062), (-0.196, 1.545, 0.104), 0.056, 0.020),
    ]
    tufts = [
        _lock((0.0, 1.625, -0.161), (0.025, 1.650, -0.280), 0.074, 0.020, "HairTop"),
        _lock((0.099, 1.501, -0.161), (0.137, 1.451, -0.255), 0.074, 0.020, "LeftHairBack"),
        _lock((-0.099, 1.501, -0.161), (-0.124, 1.427, -0.248), 0.074, 0.020, "RightHairBack"),
        _lock((0.192, 1.476, 0.020), (0.214, 1.372, 0.052), 0.042, 0.018, "LeftHairSide"),
        _lock((-0.192, 1.476, 0.020), (-0.214, 1.372, 0.052), 0.042, 0.018, "RightHairSide"),
    ]
    return [BodyPart(Union((whole, *fringe, *tufts), 0.025), 0.026)]


def cowlick(skeleton: Skeleton) -> list[Mesh]:
    """Return the pointed locks on the crown."""
    radii = [0.082, 0.055, 0.030, 0.003]
    joints = ["head", "Cowlick", "Cowlick", "Cowlick"]
    return [tube(line, radii, HAIR, joints, skeleton, 9, 9) for line in COWLICK_LINES_M]


def _lock(a: Vector, b: Vector, ra: float, rb: float, joint: str = "head") -> RoundCone:
    return RoundCone(a, b, ra, rb, bones=(joint,), color=HAIR)
