"""The bundled explorer's shoes: a sole that bends at the ball, an upper with a cap, and laces."""

from functools import cache

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.lathe import loft
from tools.authoring.modelling.sculpt import BodyPart
from tools.authoring.modelling.shapes import (
    Difference,
    Ellipsoid,
    HalfSpace,
    RoundCone,
    Shape,
    Union,
    Vector,
    linear_rgb,
)
from tools.authoring.modelling.surface import project
from tools.authoring.modelling.tube import tube

CREAM = linear_rgb("#fff3dc")
CORAL = linear_rgb("#f75c43")
RUBBER = linear_rgb("#e9d9bd")

SOLE_CENTRE_M = (0.117, 0.053)
"""x and z of the centre of the left sole [m]."""

SOLE_HALF_SIZE_M = (0.064, 0.155)
"""Half width and half length of a sole [m]."""

SOLE_PROFILE = (
    (0.80, 0.004),
    (0.95, 0.0),
    (1.0, 0.010),
    (1.0, 0.026),
    (0.985, 0.034),
    (0.90, 0.042),
)
"""Scale of the outline and height [m] of each ring, from below."""

TOE_BLEND_M = (0.060, 0.104)
"""Range along z over which skin weights change from the foot to the toes [m]."""


@cache
def _upper() -> Shape:
    bones = ("LeftToe", "LeftFoot")  # in this order: vertices ahead of the ball belong to the toe
    heel = Ellipsoid(
        (0.113, 0.068, -0.022), (0.051, 0.062, 0.069), power=2.4, bones=bones, color=CORAL
    )
    ankle = RoundCone(
        (0.111, 0.1, -0.018), (0.11, 0.145, -0.016), 0.053, 0.057, bones=("LeftFoot",), color=CORAL
    )
    return Union((_toes(0.0, CORAL, bones), heel, ankle), 0.035)


def _toes(more: float, color: Vector, bones: tuple[str, ...]) -> Ellipsoid:
    radii = 0.056 + more, 0.050 + more, 0.097 + more
    return Ellipsoid((0.118, 0.056, 0.095), radii, power=2.4, bones=bones, color=color)


def shoe_parts() -> list[BodyPart]:
    """Return the left upper and its cap."""
    floor = HalfSpace((0, 0.022, 0), (0, 1, 0))
    behind = HalfSpace((0.118, 0.056, 0.142), (0, -0.45, 1))
    cap = Difference(Difference(_toes(0.0055, CREAM, ("LeftToe",)), behind, 0.008), floor, 0.01)
    return [
        BodyPart(Difference(_upper(), floor, 0.01), 0.024, soft_skin=0.025),
        BodyPart(cap, 0.020, soft_skin=0.0),
    ]


def soles_and_laces(skeleton: Skeleton) -> list[Mesh]:
    """Return both soles and the laces."""
    meshes = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        meshes.append(_sole(side, sign, skeleton))
        for i in range(3):
            x = np.linspace(-0.030, 0.030, 5)
            high = np.stack(
                [0.115 + x, 0.112 + 0.02 * i - 14 * x * x, 0.112 - 0.028 * i - 3 * x * x], axis=-1
            )
            lace = project(lambda p: _upper().distance(p) - 0.0035, high, 0.06, 8)
            joint = f"{side}Foot"
            meshes.append(tube(lace * [sign, 1, 1], 0.0085, CREAM, joint, skeleton, 6, 7))
    return meshes


def _sole(side: str, sign: float, skeleton: Skeleton) -> Mesh:
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    # About the upward axis, to the left seen from above: from +z over +x.
    outline = np.stack([np.sin(angle), np.cos(angle)], axis=-1)
    outline = np.sign(outline) * np.abs(outline) ** 0.72 * SOLE_HALF_SIZE_M
    outline[:, 0] *= 1 - 0.10 * np.clip(
        -outline[:, 1] / SOLE_HALF_SIZE_M[1], 0, 1
    )  # a narrower heel
    profile = np.array([(0.0, 0.004), *SOLE_PROFILE, (0.0, 0.042)])
    flat = profile[:, 0, None, None] * outline + SOLE_CENTRE_M
    spring = 0.014 * np.clip((flat[..., 1] - 0.135) / 0.075, 0, 1) ** 2
    heel = 0.42 * np.clip(-0.064 - flat[..., 1], 0, None)  # it lands on a rounded heel
    height = profile[:, 1, None] + spring + heel
    rings = np.stack([flat[..., 0], height, flat[..., 1]], axis=-1) * [sign, 1.0, 1.0]
    toes = smoothstep((rings[..., 2] - TOE_BLEND_M[0]) / (TOE_BLEND_M[1] - TOE_BLEND_M[0]))
    weights = np.zeros((*toes.shape, len(skeleton.names)))
    weights[..., skeleton.names.index(f"{side}Foot")] = 1 - toes
    weights[..., skeleton.names.index(f"{side}Toe")] = toes
    if sign < 0:
        rings, weights = rings[:, ::-1], weights[:, ::-1]
    colors = np.tile(CREAM, (*toes.shape, 1))
    colors[:2] = RUBBER
    return loft(rings, colors, weights, skeleton)
