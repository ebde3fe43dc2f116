"""The bundled explorer: skeleton and body. A young person in a hoodie, with a backpack.

Toy proportions, four heads high, so that head, shoulders and shoes read at a hand's height on the
table; colours that stand out from wood and paper alike.
"""

import numpy as np

from characters.authoring.rig import build_skeleton
from characters.authoring.sculpt import Paint, Part, join, lathe, sculpt
from characters.authoring.shapes import (
    Array,
    Cone,
    Cut,
    Ellipsoid,
    HalfSpace,
    Shape,
    Union,
    Vector,
    chain,
    rgb,
)
from characters.mesh import Material, Mesh
from characters.pose import Skeleton

SKIN = rgb("#e8a878")
BLUSH = rgb("#e0705a")
HAIR = rgb("#6e3119")
TEAL = rgb("#0fa3a6")
DEEP_TEAL = rgb("#0a7c86")
CREAM = rgb("#fff3dc")
MUSTARD = rgb("#f5b02e")
LEATHER = rgb("#a8611f")
INDIGO = rgb("#323a6e")
PALE_INDIGO = rgb("#6d78b8")
CORAL = rgb("#f0563f")
INK = rgb("#1b1020")
BROWN = rgb("#6a3a17")
LIP = rgb("#9c3b34")

UP = np.array([0.0, 1.0, 0.0])

JOINTS: dict[str, tuple[str, Vector]] = {
    "root": ("", (0.0, 0.0, 0.0)),
    "hips": ("root", (0.0, 0.84, 0.0)),
    "spine1": ("hips", (0.0, 0.92, -0.01)),
    "spine2": ("spine1", (0.0, 1.01, -0.015)),
    "chest": ("spine2", (0.0, 1.10, -0.015)),
    "neck": ("chest", (0.0, 1.225, -0.01)),
    "head": ("neck", (0.0, 1.295, 0.0)),
    "LeftEyelid": ("head", (0.066, 1.462, 0.115)),
    "LeftShoulder": ("chest", (0.045, 1.185, -0.01)),
    "LeftArm": ("LeftShoulder", (0.15, 1.175, -0.012)),
    "LeftForeArm": ("LeftArm", (0.30, 0.985, -0.02)),
    "LeftHand": ("LeftForeArm", (0.43, 0.815, 0.005)),
    "LeftUpLeg": ("hips", (0.092, 0.805, 0.0)),
    "LeftLeg": ("LeftUpLeg", (0.104, 0.45, 0.012)),
    "LeftFoot": ("LeftLeg", (0.11, 0.095, -0.015)),
    "LeftToe": ("LeftFoot", (0.118, 0.03, 0.10)),
}
"""Parent and place of each joint [m]; the right side is the mirror image."""

EYE_RADII = (0.048, 0.06, 0.06)
"""Of an eyeball, a solid of revolution about x, so that an eyelid can turn over it [m]."""


def build_human_skeleton() -> Skeleton:
    """Return the skeleton in its relaxed A-pose, facing +z."""
    return build_skeleton(JOINTS)


def build_human_meshes(skeleton: Skeleton) -> tuple[Mesh, ...]:
    """Return the body, matt, and the eyes, glossy."""
    parts = [*_head_parts(), *_torso_parts()]
    for side in (_arm_parts, _leg_parts):
        for part in side():
            parts += [part, _mirrored(part)]
    body = sculpt("explorer", parts, skeleton, Material(roughness=0.75))
    return body, join("eyes", _eyes(skeleton), Material(roughness=0.15))


def _mirrored(part: Part) -> Part:
    return Part(part.shape.mirrored(), part.cell, (), part.soft_skin, part.soft_color)


def _both(shape: Shape) -> Union:
    return Union((shape, shape.mirrored()))


def _face() -> Shape:
    bones = ("head",)
    skull = Ellipsoid((0, 1.5014, -0.0054), (0.1793, 0.1728, 0.1728), bones=bones, color=SKIN)
    cheeks = Ellipsoid((0, 1.4074, 0.0324), (0.1534, 0.108, 0.1318), bones=bones, color=SKIN)
    nose = Ellipsoid((0, 1.4226, 0.175), (0.0227, 0.0194, 0.0216), bones=bones, color=SKIN)
    return Union((Union((skull, cheeks), 0.08), nose), 0.02)


def _head_parts() -> list[Part]:
    face = _face()
    ear = Ellipsoid(
        (0.1814, 1.4366, -0.0108), (0.0259, 0.0454, 0.0346), bones=("head",), color=SKIN
    )
    neck = Cone((0, 1.2, -0.012), (0, 1.33, 0), 0.06, 0.062, bones=("neck", "head"), color=SKIN)
    blush = Ellipsoid((0.1058, 1.3934, 0.1404), (0.0389, 0.0281, 0.054))
    smile = [(x, 1.364 + 4.5 * x * x) for x in np.linspace(-0.05, 0.05, 7)]
    brow = [
        (x, 1.562 - 5.0 * (x - 0.062) ** 2 - 0.1 * (x - 0.062)) for x in (0.026, 0.05, 0.08, 0.106)
    ]
    return [
        Part(Union((face, _both(ear)), 0.015), 0.023, (Paint(_both(blush), BLUSH, 0.03, 0.55),)),
        Part(neck, 0.033, soft_skin=0.02),
        Part(_line_on(face, smile, 0.0065, LIP), 0.007),
        Part(_both(_line_on(face, brow, 0.01, HAIR)), 0.0105),
        Part(_hair(), 0.0235),
    ]


def _line_on(
    surface: Shape, line: list[tuple[float, float]], radius: float, color: Vector
) -> Union:
    """Return a cord laid on the front of a head along x, y."""
    points = [(x, y, _front(surface, x, y)) for x, y in line]
    bones = ("head",) * (len(points) - 1)
    return chain(points, (radius,) * len(points), bones, color)


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
        lock((0.0, 1.6796, -0.0324), (-0.0594, 1.7714, -0.054), 0.0594, 0.013),
        lock((0.0432, 1.6796, -0.0216), (0.054, 1.7552, 0.0216), 0.054, 0.013),
        lock((0.0, 1.6256, -0.1404), (0.0216, 1.6472, -0.243), 0.0648, 0.0151),
        lock((0.0864, 1.5176, -0.1404), (0.1188, 1.4744, -0.2214), 0.0648, 0.0151),
        lock((-0.0864, 1.5176, -0.1404), (-0.108, 1.4528, -0.216), 0.0648, 0.0151),
        lock((0.1674, 1.496, 0.0216), (0.1858, 1.4042, 0.0486), 0.0367, 0.013),
        lock((-0.1674, 1.496, 0.0216), (-0.1858, 1.4042, 0.0486), 0.0367, 0.013),
    ]
    return Union((cap_cut, *fringe, *tufts), 0.022)


def _torso_parts() -> list[Part]:
    spine = ("hips", "spine1", "spine2", "chest")
    trunk = Cone(
        (0, 0.93, 0), (0, 1.105, -0.005), 0.15, 0.148, (1, 1, 0.78), bones=spine, color=TEAL
    )
    hem_line = HalfSpace((0, 0.84, 0), (0, 1, 0))
    yoke = Cone(
        (0.06, 1.165, -0.01), (0.15, 1.17, -0.012), 0.075, 0.07, bones=("LeftShoulder",), color=TEAL
    )
    sleeve = chain(
        [JOINTS[f"Left{n}"][1] for n in ("Arm", "ForeArm", "Hand")],
        (0.072, 0.063, 0.057),
        ("LeftArm", "LeftForeArm"),
        TEAL,
        0.02,
    )
    hoodie = Union((Cut(trunk, hem_line, 0.02), _both(yoke), _both(sleeve)), 0.05)
    hem = Ellipsoid(
        (0, 0.845, 0), (0.152, 0.036, 0.12), power=3.0, bones=("hips",), color=DEEP_TEAL
    )
    pocket = Ellipsoid(
        (0, 0.935, 0.088), (0.085, 0.05, 0.04), power=3.5, bones=("spine1", "hips"), color=DEEP_TEAL
    )
    return [
        Part(hoodie, 0.030, soft_skin=0.045),
        Part(hem, 0.028, soft_skin=0.03),
        Part(pocket, 0.024, soft_skin=0.03),
        Part(_hood(), 0.024, soft_skin=0.02),
        Part(_both(_strings()), 0.0115),
        *_backpack(),
    ]


def _hood() -> Shape:
    bones, color = ("chest",), TEAL
    back = Ellipsoid(
        (0, 1.235, -0.085), (0.12, 0.07, 0.062), (0.35, 0, 0), bones=bones, color=color
    )
    collar = chain(
        [(0.0, 1.25, -0.1), (0.085, 1.25, -0.055), (0.092, 1.235, 0.015), (0.03, 1.185, 0.1)],
        (0.045, 0.04, 0.034, 0.026),
        ("chest",) * 3,
        color,
        0.02,
    )
    return Union((back, _both(collar)), 0.02)


def _strings() -> Shape:
    cord = Cone(
        (0.034, 1.18, 0.118), (0.04, 1.09, 0.126), 0.0075, 0.0075, bones=("chest",), color=CREAM
    )
    knot = Cone(
        (0.04, 1.085, 0.126), (0.041, 1.072, 0.126), 0.011, 0.012, bones=("chest",), color=CREAM
    )
    return Union((cord, knot))


def _backpack() -> list[Part]:
    bones = ("chest",)
    bag = Ellipsoid((0, 1.045, -0.19), (0.118, 0.145, 0.075), power=3.2, bones=bones, color=MUSTARD)
    flap = Ellipsoid(
        (0, 1.125, -0.195), (0.124, 0.075, 0.083), (-0.1, 0, 0), 3.2, bones=bones, color=LEATHER
    )
    purse = Ellipsoid((0, 0.985, -0.262), (0.07, 0.05, 0.03), power=3.2, bones=bones, color=LEATHER)
    buckle = Ellipsoid((0, 1.07, -0.275), (0.02, 0.026, 0.014), power=3.0, bones=bones, color=CREAM)
    strap = chain(
        [
            (0.08, 1.19, -0.12),
            (0.098, 1.245, -0.04),
            (0.1, 1.215, 0.05),
            (0.1, 1.12, 0.098),
            (0.11, 1.02, 0.085),
            (0.145, 0.965, 0.0),
            (0.1, 0.965, -0.12),
        ],
        (0.019,) * 7,
        ("chest", "LeftShoulder", "chest", "chest", "spine2", "spine2"),
        LEATHER,
        0.01,
    )
    return [
        Part(bag, 0.034, soft_skin=0.0),
        Part(flap, 0.03, soft_skin=0.0),
        Part(purse, 0.021, soft_skin=0.0),
        Part(buckle, 0.012, soft_skin=0.0),
        Part(_both(strap), 0.0205, soft_skin=0.045),
    ]


def _arm_parts() -> list[Part]:
    elbow, wrist = (np.array(JOINTS[f"Left{n}"][1]) for n in ("ForeArm", "Hand"))
    along = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    start, end = wrist - 0.03 * along, wrist - 0.004 * along
    cuff = Cone(_vector(start), _vector(end), 0.066, 0.062, bones=("LeftForeArm",), color=DEEP_TEAL)
    cuff_cut = Cut(cuff, HalfSpace(_vector(wrist + 0.022 * along), _vector(-along)), 0.012)
    return [Part(cuff_cut, 0.0235, soft_skin=0.0), Part(_hand(wrist, along), 0.0145, soft_skin=0.0)]


def _hand(wrist: Array, along: Array) -> Shape:
    """Return a hand with three fingers and a thumb, a little curled, palm to the thigh."""
    bones, color = ("LeftHand",), SKIN
    front = np.array([0.0, 0.0, 1.0])
    palm_normal = np.cross(along, front)  # towards the body

    def at(reach: float, forward: float, inward: float = 0.0) -> Vector:
        return _vector(wrist + reach * along + forward * front + inward * palm_normal)

    palm = Cone(at(0.0, 0.0), at(0.06, 0.004), 0.036, 0.044, bones=bones, color=color)
    fingers = [
        chain(
            [at(0.075, z), at(0.11, 1.15 * z, 0.008), at(0.138, 1.15 * z, 0.028)],
            (0.019, 0.018, 0.016),
            bones * 2,
            color,
        )
        for z in (-0.028, 0.002, 0.032)
    ]
    thumb = chain(
        [at(0.02, 0.03), at(0.055, 0.064, 0.012), at(0.082, 0.07, 0.018)],
        (0.02, 0.018, 0.016),
        bones * 2,
        color,
    )
    return Union((palm, *fingers, thumb), 0.012)


def _leg_parts() -> list[Part]:
    bones = ("hips",)
    seat = Ellipsoid((0.04, 0.81, -0.005), (0.1, 0.085, 0.108), bones=bones, color=INDIGO)
    hip, knee, ankle = (np.array(JOINTS[f"Left{n}"][1]) for n in ("UpLeg", "Leg", "Foot"))
    shin_end = ankle + 0.07 * (knee - ankle) / np.linalg.norm(knee - ankle)
    leg = chain([hip, knee, shin_end], (0.093, 0.07, 0.07), ("LeftUpLeg", "LeftLeg"), INDIGO, 0.03)
    turn_up = Cone(
        _vector(shin_end - UP * 0.012),
        _vector(shin_end + UP * 0.012),
        0.076,
        0.076,
        bones=("LeftLeg",),
        color=PALE_INDIGO,
    )
    rim = Cut(
        Cut(turn_up, HalfSpace((0, 0.2, 0), (0, -1, 0)), 0.012),
        HalfSpace((0, 0.135, 0), (0, 1, 0)),
        0.012,
    )
    return [
        Part(Union((seat, leg), 0.03), 0.031, soft_skin=0.045),
        Part(rim, 0.025, soft_skin=0.0),
        *_shoe(),
    ]


def _shoe() -> list[Part]:
    bones = ("LeftToe", "LeftFoot")  # in this order: what lies ahead of the ball is the toe's
    ground = HalfSpace((0, 0.0, 0), (0, 1, 0))
    sole = Ellipsoid(
        (0.117, 0.012, 0.052), (0.062, 0.036, 0.148), power=3.0, bones=bones, color=CREAM
    )
    toe = Ellipsoid(
        (0.118, 0.058, 0.095), (0.056, 0.05, 0.095), power=2.4, bones=bones, color=CORAL
    )
    heel = Ellipsoid(
        (0.113, 0.068, -0.02), (0.05, 0.062, 0.068), power=2.4, bones=bones, color=CORAL
    )
    ankle = Cone(
        (0.111, 0.1, -0.018), (0.11, 0.145, -0.016), 0.052, 0.055, bones=("LeftFoot",), color=CORAL
    )
    upper = Cut(Union((toe, heel, ankle), 0.035), HalfSpace((0, 0.025, 0), (0, 1, 0)), 0.01)
    cap = Ellipsoid(
        (0.119, 0.042, 0.15), (0.054, 0.04, 0.048), power=2.4, bones=("LeftToe",), color=CREAM
    )
    laces = [
        Cone(
            (0.09, 0.1 + 0.022 * i, 0.085 - 0.028 * i),
            (0.138, 0.1 + 0.022 * i, 0.085 - 0.028 * i),
            0.01,
            0.01,
            bones=("LeftFoot",),
            color=CREAM,
        )
        for i in range(2)
    ]
    return [
        Part(Cut(sole, ground, 0.008), 0.021, soft_skin=0.025),
        Part(upper, 0.022, soft_skin=0.025),
        Part(Cut(cap, ground, 0.01), 0.020, soft_skin=0.0),
        Part(Union(tuple(laces)), 0.012, soft_skin=0.0),
    ]


def _eyes(skeleton: Skeleton) -> list[Mesh]:
    """Return both eyeballs with iris, pupil and highlight, and the lids over them."""
    meshes = []
    for side in ("Left", "Right"):
        center = skeleton.rest.globals(skeleton)[skeleton.names.index(f"{side}Eyelid"), :3, 3]
        place = np.column_stack([np.diag(EYE_RADII), center])
        tilt = np.concatenate([np.linspace(np.pi, 0.7, 7), [0.62, 0.60, 0.36, 0.34, 0.2, 0.0]])
        ball = np.stack([np.sin(tilt), np.cos(tilt)], axis=1)
        white, iris, pupil = (0.93, 0.93, 0.95), BROWN, INK
        colors = [white] * 7 + [INK] + [iris] + [pupil] * 3
        meshes.append(lathe(ball, colors, place, "head", skeleton))
        meshes.append(_highlight(center, skeleton))
        meshes.append(_lid(center, side, skeleton))
    return meshes


def _highlight(center: Array, skeleton: Skeleton) -> Mesh:
    spot = center + np.array(EYE_RADII) * [0.2, 0.28, 0.93]
    place = np.column_stack([np.diag([0.011, 0.013, 0.007]), spot])
    tilt = np.linspace(np.pi, 0, 6)
    rings = np.stack([np.sin(tilt), np.cos(tilt)], axis=1)
    return lathe(rings, [(1.0, 1.0, 1.0)] * 5, place, "head", skeleton, 12)


def _lid(center: Array, side: str, skeleton: Skeleton) -> Mesh:
    """Return a half shell that rests above the eye; about +x it closes."""
    outer = np.linspace(1.45, 0, 7)
    inner = np.linspace(0, 1.45, 7)
    tilt, radius = np.concatenate([inner, outer]), np.repeat([1.0, 1.07], 7)
    rings = np.stack([radius * np.sin(tilt), radius * np.cos(tilt)], axis=1)
    up = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])  # its axis points up and a little back
    angle = -0.6
    c, s = np.cos(angle), np.sin(angle)
    tip = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    place = np.column_stack([np.diag(EYE_RADII) @ tip @ up, center])
    return lathe(rings, [SKIN] * 13, place, f"{side}Eyelid", skeleton)


def _vector(point: Array) -> Vector:
    x, y, z = np.asarray(point, float).tolist()
    return x, y, z
