"""The bundled explorer's head: face, hair and eyes."""

import numpy as np

from characters.authoring.cord import cord
from characters.authoring.human_rig import EYE_RADII
from characters.authoring.rig import joint_places
from characters.authoring.sculpt import Paint, Part, lathe
from characters.authoring.shapes import Array, Cone, Cut, Ellipsoid, Shape, Union, Vector, rgb
from characters.mesh import Mesh
from characters.pose import Skeleton

SKIN = rgb("#f4b98c")
BLUSH = rgb("#ea7560")
HAIR = rgb("#7c391d")
INK = rgb("#1b1020")
BROWN = rgb("#7d4519")
LIP = rgb("#9c3b34")
EYE_WHITE = (0.93, 0.93, 0.95)


def head_parts() -> list[Part]:
    """Return what is carved: face with ears, neck, hair."""
    ear = Ellipsoid(
        (0.1814, 1.4366, -0.0108), (0.0259, 0.0454, 0.0346), bones=("head",), color=SKIN
    )
    neck = Cone((0, 1.2, -0.012), (0, 1.33, 0), 0.06, 0.062, bones=("neck", "head"), color=SKIN)
    blush = Ellipsoid((0.1058, 1.3934, 0.1404), (0.0389, 0.0281, 0.054))
    cheeks = Union((blush, blush.mirrored()))
    face = Union((_face(), ear, ear.mirrored()), 0.015)
    return [
        Part(face, 0.03, (Paint(cheeks, BLUSH, 0.03, 0.55),)),
        Part(neck, 0.045, soft_skin=0.02),
        Part(_hair(), 0.0255),
    ]


def face_lines(skeleton: Skeleton) -> list[Mesh]:
    """Return the brows and the mouth, laid on the face."""
    face = _face()
    across = np.linspace(-0.058, 0.058, 7)
    smile = _laid_on(face, across, 1.361 + 4.8 * across**2)
    lines = [
        cord(
            smile, [0.003, 0.006, 0.0075, 0.008, 0.0075, 0.006, 0.003], LIP, "head", skeleton, 6, 11
        )
    ]
    for sign in (1.0, -1.0):
        x = np.linspace(0.026, 0.11, 5)
        brow = _laid_on(face, sign * x, 1.571 - 5.0 * (x - 0.062) ** 2 - 0.02 * (x - 0.062))
        lines.append(cord(brow, [0.009, 0.012, 0.0115, 0.009, 0.005], HAIR, "head", skeleton, 7, 9))
    return lines


def cowlick(skeleton: Skeleton) -> list[Mesh]:
    """Return the pointed locks on the crown."""
    locks = (
        [(0.0, 1.63, -0.03), (0.0, 1.7, -0.045), (-0.03, 1.745, -0.06), (-0.07, 1.765, -0.065)],
        [(0.04, 1.63, -0.0), (0.055, 1.69, 0.0), (0.06, 1.73, 0.02), (0.045, 1.755, 0.055)],
    )
    return [cord(line, [0.075, 0.05, 0.027, 0.003], HAIR, "head", skeleton, 9, 9) for line in locks]


def _face() -> Shape:
    bones = ("head",)
    skull = Ellipsoid((0, 1.5014, -0.0054), (0.1793, 0.1728, 0.1728), bones=bones, color=SKIN)
    cheeks = Ellipsoid((0, 1.4074, 0.0324), (0.1534, 0.108, 0.1318), bones=bones, color=SKIN)
    nose = Ellipsoid((0, 1.4226, 0.175), (0.0227, 0.0194, 0.0216), bones=bones, color=SKIN)
    return Union((Union((skull, cheeks), 0.08), nose), 0.02)


def _laid_on(surface: Shape, x: Array, y: Array) -> Array:
    """Return points on the front of a head at x, y, (n, 3)."""
    return np.stack([x, y, [_front(surface, *at) for at in zip(x, y, strict=True)]], axis=-1)


def _front(surface: Shape, x: float, y: float) -> float:
    """Return the z of the foremost point of a shape at x, y, by bisection [m]."""
    low, high = 0.0, 0.4
    for _ in range(40):
        middle = (low + high) / 2
        inside = surface.distance(np.array([[x, y, middle]]))[0] < 0
        low, high = (middle, high) if inside else (low, middle)
    return low


def _hair() -> Shape:
    bones, color = ("head",), HAIR

    def lock(a: Vector, b: Vector, ra: float, rb: float) -> Cone:
        return Cone(a, b, ra, rb, bones=bones, color=color)

    cap = Ellipsoid((0, 1.5284, -0.027), (0.2009, 0.1858, 0.1922), bones=bones, color=color)
    nape = Ellipsoid((0, 1.4204, -0.0918), (0.1458, 0.1134, 0.108), bones=bones, color=color)
    brow_line = Ellipsoid((0, 1.4096, 0.1836), (0.1858, 0.1944, 0.216))
    cap_cut = Cut(Union((cap, nape), 0.054), brow_line, 0.0216)
    fringe = [
        lock((-0.054, 1.6742, 0.0864), (0.0918, 1.6094, 0.1674), 0.0562, 0.0216),
        lock((0.0, 1.6688, 0.0972), (0.1598, 1.5824, 0.108), 0.054, 0.0194),
        lock((-0.0756, 1.6688, 0.0864), (-0.108, 1.5878, 0.1534), 0.0497, 0.0173),
        lock((-0.108, 1.6472, 0.054), (-0.1706, 1.55, 0.0918), 0.0486, 0.0173),
    ]
    tufts = [
        lock((0.0, 1.6256, -0.1404), (0.0216, 1.6472, -0.243), 0.0648, 0.019),
        lock((0.0864, 1.5176, -0.1404), (0.1188, 1.4744, -0.2214), 0.0648, 0.019),
        lock((-0.0864, 1.5176, -0.1404), (-0.108, 1.4528, -0.216), 0.0648, 0.019),
        lock((0.1674, 1.496, 0.0216), (0.1858, 1.4042, 0.0486), 0.0367, 0.017),
        lock((-0.1674, 1.496, 0.0216), (-0.1858, 1.4042, 0.0486), 0.0367, 0.017),
    ]
    return Union((cap_cut, *fringe, *tufts), 0.022)


def eyes(skeleton: Skeleton) -> list[Mesh]:
    """Return both eyeballs with iris, pupil and highlight."""
    meshes = []
    for side in ("Left", "Right"):
        center = joint_places(skeleton)[f"{side}Eyelid"]
        place = np.column_stack([np.diag(EYE_RADII), center])
        tilt = np.concatenate([np.linspace(np.pi, 0.7, 7), [0.62, 0.60, 0.36, 0.34, 0.2, 0.0]])
        ball = np.stack([np.sin(tilt), np.cos(tilt)], axis=1)
        white, iris, pupil = EYE_WHITE, BROWN, INK
        colors = [white] * 7 + [INK] + [iris] + [pupil] * 3
        meshes.append(lathe(ball, colors, place, "head", skeleton, 18))
        meshes.append(_highlight(center, skeleton))
    return meshes


def eyelids(skeleton: Skeleton) -> list[Mesh]:
    """Return the lids above the eyes."""
    places = joint_places(skeleton)
    return [_lid(places[f"{side}Eyelid"], side, skeleton) for side in ("Left", "Right")]


def _highlight(center: Array, skeleton: Skeleton) -> Mesh:
    spot = center + np.array(EYE_RADII) * [0.2, 0.28, 0.93]
    place = np.column_stack([np.diag([0.0125, 0.015, 0.008]), spot])
    tilt = np.linspace(np.pi, 0, 6)
    rings = np.stack([np.sin(tilt), np.cos(tilt)], axis=1)
    return lathe(rings, [(1.0, 1.0, 1.0)] * 5, place, "head", skeleton, 8)


def _lid(center: Array, side: str, skeleton: Skeleton) -> Mesh:
    """Return a half shell that rests above the eye; about +x it closes."""
    inner, outer = np.linspace(0, 1.45, 5), np.array([1.45, 1.36, 1.1, 0.8, 0.5, 0.2, 0.0])
    tilt = np.concatenate([inner, outer])
    radius = np.repeat([1.0, 1.07], [len(inner), len(outer)])
    rings = np.stack([radius * np.sin(tilt), radius * np.cos(tilt)], axis=1)
    up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # its axis points up and a little back
    angle = -0.6
    c, s = np.cos(angle), np.sin(angle)
    tip = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    place = np.column_stack([np.diag(EYE_RADII) @ tip @ up, center])
    colors = [SKIN] * 4 + [INK] * 2 + [SKIN] * 5  # lashes along the rim
    return lathe(rings, colors, place, f"{side}Eyelid", skeleton, 14)
