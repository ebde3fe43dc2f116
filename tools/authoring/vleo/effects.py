"""Effects that fly from Vleo's mouth: hearts with a kiss, sparks with a shout."""

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import circle_profile, frame_toward, lathe
from tools.authoring.modelling.meshes import join
from tools.authoring.modelling.sculpt import BodyPart, PaintCoat, sculpt
from tools.authoring.modelling.shapes import Ellipsoid, RoundCone, Union, Vector, linear_rgb
from tools.authoring.vleo.rig import BURSTS, HEARTS, MOUTH_M

RED, ROSE = linear_rgb("#ff1f4b"), linear_rgb("#ff5c8a")
YELLOW, FLAME, EMBER = linear_rgb("#ffd83d"), linear_rgb("#ff7a1a"), linear_rgb("#e62a10")


def effects(bound: Skeleton) -> list[Mesh]:
    """Return the hearts and bursts at full size, each on its own joint at the mouth."""
    hearts = [_heart(name, color) for name, color in zip(HEARTS, (RED, ROSE, RED), strict=True)]
    bursts = [_burst(name, bound) for name in BURSTS]
    return [*(sculpt("", [heart], bound) for heart in hearts), *bursts]


def _heart(joint: str, color: Vector) -> BodyPart:
    """Return a puffed heart, 45 mm wide."""
    low, side = _at(0.0, -0.0175, 0.0), _at(0.0115, 0.0085, 0.0)
    half = RoundCone(side, low, 0.0125, 0.0018, (1.0, 1.0, 0.75), bones=(joint,), color=color)
    light = Ellipsoid(_at(-0.0135, 0.0125, 0.006), (0.0045, 0.0035, 0.006))
    shine = PaintCoat(light, (1.0, 0.75, 0.8), 0.003, 0.9)
    return BodyPart(Union((half, half.mirrored()), 0.003), 0.0052, (shine,), soft_skin=0.0)


def _burst(joint: str, bound: Skeleton) -> Mesh:
    """Return a spiky star, 60 mm wide, that looks alike from every side."""
    ways = np.array(list(np.ndindex(3, 3, 3))) - 1.0
    corners = np.count_nonzero(ways, axis=1)
    ball = 0.0150 * circle_profile(np.linspace(np.pi, 0, 7))
    place = frame_toward(np.array([0.0, 0.0, 1.0]), np.array(MOUTH_M))
    rays = [lathe(ball, [YELLOW] * 6, place, joint, bound, 10)]
    for way in ways[corners != 2]:  # a cube's six faces and eight corners
        if not way.any():
            continue
        size = 1.0 if np.count_nonzero(way) == 1 else 0.8
        rings = size * np.array([[0, 0], [9.5, 10], [5, 20], [0, 35]]) / 1000
        place = frame_toward(way, np.array(MOUTH_M))
        rays.append(lathe(rings, [FLAME, FLAME, EMBER], place, joint, bound, 5))
    return join("", rays)


def _at(x: float, y: float, z: float) -> Vector:
    return MOUTH_M[0] + x, MOUTH_M[1] + y, MOUTH_M[2] + z
