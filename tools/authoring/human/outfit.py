"""The bundled explorer's outfit: hoodie, trousers, shoes, a backpack, and the hands.

Its colours contrast with wood and paper, most of all at hands and feet.
"""

from functools import cache

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.hands import hand
from tools.authoring.human.rig import JOINT_POSITIONS
from tools.authoring.human.shoes import CREAM, shoe_parts
from tools.authoring.modelling.lathe import lathe
from tools.authoring.modelling.meshes import mirrored_mesh
from tools.authoring.modelling.sculpt import BodyPart, sculpt
from tools.authoring.modelling.shapes import (
    Array,
    Difference,
    Ellipsoid,
    HalfSpace,
    RoundCone,
    Shape,
    Union,
    Vector,
    cone_chain,
    linear_rgb,
)
from tools.authoring.modelling.surface import project
from tools.authoring.modelling.tube import tube

TEAL = linear_rgb("#12b3b3")
DEEP_TEAL = linear_rgb("#0c8a93")
MUSTARD = linear_rgb("#fbb832")
LEATHER = linear_rgb("#b86a24")
INDIGO = linear_rgb("#3e4a8c")
PALE_INDIGO = linear_rgb("#8590d4")


def outfit_meshes(skeleton: Skeleton) -> list[Mesh]:
    """Return its sculpted parts, of both sides."""
    sided = sculpt("", [hand(), *_leg_parts()], skeleton)
    return [sculpt("", _torso_parts(), skeleton), sided, mirrored_mesh(sided, skeleton)]


def cords(skeleton: Skeleton) -> list[Mesh]:
    """Return the strings of the hood and the straps of the backpack."""
    meshes = []
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        flip = [sign, 1.0, 1.0]
        string = np.array(STRING_LINE_M) * flip
        swings = ["chest", *[f"{side}String"] * 3]
        meshes.append(tube(string, STRING_RADII_M, CREAM, swings, skeleton, 6, 8))
        strap = _on_hoodie(np.array(STRAP_LINE_M)) * flip
        over = ["chest", f"{side}Shoulder", "chest", "chest", "spine2", "spine2", "spine2"]
        meshes.append(tube(strap, 0.019, LEATHER, over, skeleton, 6, 15))
    return meshes


def ribbing(skeleton: Skeleton) -> list[Mesh]:
    """Return the solids of revolution: hem, cuffs and turned-up trousers."""
    hem = np.array([[0.178, 0, 0, 0], [0, 0, 0.036, 0.835], [0, -0.138, 0, 0]])
    meshes = [_ring(hem, DEEP_TEAL, "hips", skeleton, 22)]
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        elbow, wrist, knee, ankle = (
            np.array(JOINT_POSITIONS[f"Left{name}"][1]) * [sign, 1.0, 1.0]
            for name in ("ForeArm", "Hand", "Leg", "Foot")
        )
        cuff = _across(elbow, wrist, 0.004, 0.062, 0.030)
        meshes.append(_ring(cuff, DEEP_TEAL, f"{side}ForeArm", skeleton, 13))
        turn_up = _across(knee, ankle, -0.073, 0.081, 0.034)
        meshes.append(_ring(turn_up, PALE_INDIGO, f"{side}Leg", skeleton, 13))
    return meshes


def _ring(place: Array, color: Vector, joint: str, skeleton: Skeleton, segments: int) -> Mesh:
    """Return a band with a round rim, of radius and half height 1 before it is placed."""
    tilt = np.linspace(-np.pi / 2, np.pi / 2, 6)
    rim = np.stack([0.82 + 0.18 * np.cos(tilt), np.sin(tilt)], axis=-1)
    rings = np.vstack([[0.0, -1.0], rim, [0.0, 1.0]])
    return lathe(rings, [color] * (len(rings) - 1), place, joint, skeleton, segments)


def _across(start: Array, end: Array, beyond: float, radius: float, half: float) -> Array:
    """Return the frame of a ring around a limb, at a distance beyond its end, (3, 4)."""
    axis = (end - start) / np.linalg.norm(end - start)
    side = np.cross(axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    turn = np.column_stack([side, np.cross(axis, side), axis]) * [radius, radius, half]
    return np.column_stack([turn, end + beyond * axis])


STRING_LINE_M: list[Vector] = [
    (0.036, 1.145, 0.112),
    (0.040, 1.10, 0.130),
    (0.042, 1.055, 0.132),
    (0.043, 1.035, 0.132),
]
STRING_RADII_M = [0.008, 0.008, 0.008, 0.0135]

STRAP_LINE_M: list[Vector] = [
    (0.1, 1.15, -0.13),
    (0.13, 1.21, -0.05),
    (0.133, 1.18, 0.045),
    (0.118, 1.09, 0.099),
    (0.116, 1.0, 0.095),
    (0.15, 0.945, 0.0),
    (0.1, 0.945, -0.12),
]


def _both(shape: Shape) -> Union:
    return Union((shape, shape.mirrored()))


def _torso_parts() -> list[BodyPart]:
    hoodie = _hoodie()
    pocket = Ellipsoid(
        (0, 0.93, 0.1), (0.085, 0.05, 0.04), power=3.5, bones=("spine1", "hips"), color=DEEP_TEAL
    )
    return [
        BodyPart(hoodie, 0.0385, soft_skin=0.045),
        BodyPart(pocket, 0.027, soft_skin=0.03),
        BodyPart(_hood(), 0.031, soft_skin=0.02),
        *_backpack(),
    ]


@cache
def _hoodie() -> Shape:
    """Return trunk and sleeves."""
    spine = ("hips", "spine1", "spine2", "chest")
    trunk = RoundCone(
        (0, 0.9, 0), (0, 1.075, -0.005), 0.165, 0.146, (1, 1, 0.78), bones=spine, color=TEAL
    )
    hem_line = HalfSpace((0, 0.825, 0), (0, 1, 0))
    yoke = RoundCone(
        (0.06, 1.128, -0.01),
        (0.148, 1.134, -0.012),
        0.075,
        0.07,
        bones=("LeftShoulder",),
        color=TEAL,
    )
    sleeve = cone_chain(
        [JOINT_POSITIONS[f"Left{n}"][1] for n in ("Arm", "ForeArm", "Hand")],
        (0.072, 0.063, 0.050),
        ("LeftArm", "LeftForeArm"),
        TEAL,
        0.02,
    )
    return Union((Difference(trunk, hem_line, 0.02), _both(yoke), _both(sleeve)), 0.05)


def _on_hoodie(line: Array) -> Array:
    """Return points of the left side, (n, 3), laid on the hoodie."""
    laid = project(lambda points: _hoodie().distance(points) - 0.007, line.astype(float), 0.06, 5)
    return np.asarray(laid)


def _hood() -> Shape:
    back = Ellipsoid(
        (0, 1.195, -0.092), (0.13, 0.07, 0.062), (0.35, 0, 0), bones=("Hood",), color=TEAL
    )
    collar = cone_chain(
        [(0.0, 1.205, -0.105), (0.09, 1.208, -0.06), (0.1, 1.196, 0.015), (0.032, 1.145, 0.102)],
        (0.045, 0.04, 0.034, 0.026),
        ("chest",) * 3,
        TEAL,
        0.02,
    )
    return Union((back, _both(collar)), 0.02)


def _backpack() -> list[BodyPart]:
    bones = ("Backpack",)
    bag = Ellipsoid((0, 1.015, -0.195), (0.126, 0.15, 0.08), power=3.2, bones=bones, color=MUSTARD)
    flap = Ellipsoid(
        (0, 1.10, -0.203), (0.139, 0.080, 0.097), (-0.08, 0, 0), 3.2, bones=bones, color=LEATHER
    )
    purse = Ellipsoid(
        (0, 0.953, -0.272), (0.075, 0.052, 0.032), power=3.2, bones=bones, color=LEATHER
    )
    buckle = Ellipsoid(
        (0, 1.035, -0.296), (0.022, 0.029, 0.016), power=3.0, bones=bones, color=CREAM
    )
    return [
        BodyPart(bag, 0.036, soft_skin=0.0),
        BodyPart(flap, 0.030, soft_skin=0.0),
        BodyPart(purse, 0.024, soft_skin=0.0),
        BodyPart(buckle, 0.012, soft_skin=0.0),
    ]


def _leg_parts() -> list[BodyPart]:
    bones = ("hips",)
    seat = Ellipsoid((0.04, 0.81, -0.005), (0.1, 0.085, 0.108), bones=bones, color=INDIGO)
    hip, knee, ankle = (np.array(JOINT_POSITIONS[f"Left{n}"][1]) for n in ("UpLeg", "Leg", "Foot"))
    shin_end = ankle + 0.07 * (knee - ankle) / np.linalg.norm(knee - ankle)
    leg = cone_chain(
        [hip, knee, shin_end], (0.086, 0.07, 0.07), ("LeftUpLeg", "LeftLeg"), INDIGO, 0.03
    )
    return [
        BodyPart(Union((seat, leg), 0.03), 0.0385, soft_skin=0.045),
        *shoe_parts(),
    ]
