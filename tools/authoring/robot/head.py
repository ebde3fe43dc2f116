"""The robot's head: skull, snout, jaw, mouth, eyes, lids and lamps."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import circle_profile, frame_toward, lathe
from tools.authoring.modelling.meshes import bound_mesh
from tools.authoring.modelling.rig import rest_positions
from tools.authoring.modelling.sculpt import BodyPart, sculpt
from tools.authoring.modelling.shapes import (
    WHITE,
    Array,
    Difference,
    Ellipsoid,
    Shape,
    Solid,
    Union,
    Vector,
    linear_rgb,
)
from tools.authoring.modelling.surface import normals_of, project
from tools.authoring.robot.parts import (
    GLASS,
    MAROON,
    PANEL,
    ROSE,
    RUBBER,
    SHELL,
    TRIM,
    Complement,
    lens,
    panel,
    socket,
)
from tools.authoring.robot.rig import EYE_CENTRE_M, LID_YAW_RAD

SKULL = Ellipsoid(
    (0.0, 0.2470, 0.1460), (0.0600, 0.0480, 0.0570), power=2.3, bones=("head",), color=SHELL
)
SNOUT = Ellipsoid(
    (0.0, 0.2235, 0.1940), (0.0430, 0.0270, 0.0390), power=2.5, bones=("head",), color=SHELL
)
TEMPLE_LAMP_RADIUS_M = 0.0195
"""Radius of the lamps at the temples [m]."""
HEAD = Union((SKULL, SNOUT), 0.030)
PUPIL, CELL_M = linear_rgb("#0b0e16"), 0.0088
REST_GAZE = np.array([0.16, 0.12, 1.0]) / np.linalg.norm([0.16, 0.12, 1.0])
EYE_RADIUS_M = 0.0222
"""Of an eye [m]."""
UPPER_LID_OPEN_RAD, LOWER_LID_OPEN_RAD = 1.22, 1.20
"""Elevation of the rim of an open lid above and below straight ahead [rad]."""


@dataclass(frozen=True)
class JawRegion(Solid):
    """The volume of the jaw: below the line of the lips and ahead of the hinge."""

    gap: float = 0.0
    """Distance below the line at which it begins [m]."""

    def distance(self, points: Array) -> Array:
        """Return the approximate signed distance, (n,) [m]."""
        return np.maximum(points[:, 1] - lip_height(points[:, 2]) + self.gap, 0.150 - points[:, 2])


def lip_height(forward: Array) -> Array:
    """Return the height of the line between the lips at z, (n,) [m]."""
    return np.asarray(0.2105 + 0.10 * np.maximum(0.0, 0.205 - forward))


def head(bound: Skeleton) -> list[Mesh]:
    """Return the head without lit lamps and glossy eyes."""
    upper = Difference(HEAD, JawRegion(-0.0006), 0.003)
    # The jaw is the lower part of the head, moved by its own joint.
    lower = Difference(_held(HEAD, "jaw"), Complement(JawRegion(0.0006)), 0.003)
    return [
        sculpt("", [BodyPart(upper, CELL_M, soft_skin=0.0)], bound),
        sculpt("", [BodyPart(lower, CELL_M, soft_skin=0.0)], bound),
        _tongue(bound),
        panel(HEAD, _along((0.0, 0.320, 0.150)), (0.021, 0.050), PANEL, "head", bound),
        _lip(bound),
        _lining("jaw", 0.0004, bound),
        _lining("head", -0.0004, bound),
        *_nostrils(bound),
        *(piece for side in (1.0, -1.0) for piece in _paired_parts(side, bound)),
    ]


def _held(shape: Union, bone: str) -> Shape:
    """Return the same shape with another joint."""
    solids = [each for each in shape.shapes if isinstance(each, Ellipsoid)]
    moved = (
        Ellipsoid(s.center, s.radii, s.turn, s.power, bones=(bone,), color=s.color) for s in solids
    )
    return Union(tuple(moved), shape.blend)


def _lip(bound: Skeleton) -> Mesh:
    """Return the dark line of the mouth, skinned to its middle and its two corners."""
    across = np.linspace(-1.0, 1.0, 33)
    line = _around(across * 1.95)
    corner = np.clip((np.abs(across) - 0.06) / 0.60, 0, 1) ** 1.6
    bones = np.zeros((len(across), len(bound)))
    bones[:, bound.index("lips")] = 1 - corner
    bones[:, bound.index("LeftMouthCorner")] = corner * (across > 0)
    bones[:, bound.index("RightMouthCorner")] = corner * (across < 0)
    thick = 0.0021 * np.minimum(1.0, 3.2 * (1.02 - np.abs(across)))
    return _tube(line, thick, bones, bound)


def _lining(joint: str, proud: float, bound: Skeleton) -> Mesh:
    """Return the floor of the mouth on the jaw, facing up, or its roof on the head, facing down."""
    rim = _around(np.linspace(-1.95, 1.95, 27))
    middle = rim.mean(axis=0)
    out = rim - middle
    out *= 1 - 0.0030 / np.linalg.norm(out, axis=1, keepdims=True)
    points = middle + np.vstack([np.zeros((1, 3)), 0.5 * out, out])
    points[:, 1] = lip_height(points[:, 2]) + proud
    up = 1.0 if proud > 0 else -1.0
    ring, after = np.arange(27) + 1, (np.arange(27) + 1) % 27 + 1
    fan = np.stack([0 * ring, ring, after], axis=1)
    rest = np.stack([ring, ring + 27, after + 27, ring, after + 27, after], axis=1)
    triangles = np.vstack([fan, rest.reshape(-1, 3)])
    bones = np.zeros((len(points), len(bound)))
    bones[:, bound.index(joint)] = 1.0
    normals = np.tile([0.0, up, 0.0], (len(points), 1))
    colors = np.tile(np.array(MAROON), (len(points), 1))
    return bound_mesh(points, normals, triangles[:, :: int(up)], bones, colors, bound)


def _tongue(bound: Skeleton) -> Mesh:
    profile = np.array([[0, -0.6], [0.86, -0.5], [1, 0], [0.86, 0.6], [0.5, 0.92], [0, 1]])
    place = frame_toward((0.0, 1.0, 0.10), rest_positions(bound)["tongue"])
    place[:3, :3] = place[:3, :3] @ np.diag([0.0185, 0.0225, 0.0044])
    return lathe(profile, [ROSE] * 5, place, "tongue", bound, 18)


def _around(turn: Array) -> Array:
    """Return points of the line of the lips at azimuths around the snout [rad], (n, 3)."""
    way = np.stack([np.sin(turn), 0 * turn, np.cos(turn)], axis=1) * [0.72, 1.0, 1.0]
    near, far = np.full(len(turn), 0.01), np.full(len(turn), 0.09)
    points = np.zeros((len(turn), 3))
    for _ in range(40):  # bisection outwards
        middle = 0.5 * (near + far)
        points = np.array([0.0, 0.0, 0.170]) + middle[:, None] * way
        points[:, 1] = lip_height(points[:, 2]) + 0.0004
        within = HEAD.distance(points) < 0
        near, far = np.where(within, middle, near), np.where(within, far, middle)
    return points


def _tube(line: Array, radius: Array, bones: Array, bound: Skeleton, sides: int = 5) -> Mesh:
    """Return a dark tube along points (n, 3) on the head, with one row of weights each."""
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = normals_of(HEAD.distance, line, 0.006)
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)[None, :, None]
    ring = np.cos(angle) * out[:, None] + np.sin(angle) * np.cross(along, out)[:, None]
    points = (line[:, None] + radius[:, None, None] * ring).reshape(-1, 3)
    i, k = np.meshgrid(np.arange(len(line) - 1), np.arange(sides), indexing="ij")
    k2 = (k + 1) % sides
    a, b, c, d = i * sides + k, i * sides + k2, (i + 1) * sides + k2, (i + 1) * sides + k
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    weights, colors = np.repeat(bones, sides, axis=0), np.tile(np.array(RUBBER), (len(points), 1))
    return bound_mesh(points, ring.reshape(-1, 3), triangles, weights, colors, bound)


def _on_head(near: Vector | Array, sunk: float = 0.0) -> Array:
    """Return the frame on the head near a point, with +z outward."""
    place = project(HEAD.distance, np.asarray([near], float), 0.05, 8)
    normal = normals_of(HEAD.distance, place, 0.005)[0]
    return frame_toward(normal, place[0] - sunk * normal)


def _along(near: Vector) -> Array:
    """Return the frame on the head near a point, with +z outward and +y forward."""
    frame = _on_head(near)
    frame[:3, 0] = [1.0, 0.0, 0.0]  # it lies on the middle of the head
    frame[:3, 1] = np.cross(frame[:3, 2], frame[:3, 0])
    return frame


def _nostrils(bound: Skeleton) -> list[Mesh]:
    rings = np.array([[0, -2], [4.2, -1.5], [4.6, 0.3], [2.6, 0.9], [0, 0.7]]) * 1e-3
    places = [_on_head((side * 0.0150, 0.2400, 0.2260)) for side in (1.0, -1.0)]
    return [lathe(rings, [RUBBER] * 4, place, "head", bound, 12) for place in places]


def _paired_parts(side: float, bound: Skeleton) -> list[Mesh]:
    """Return the parts of one side: bezel and lids of the eye, and the unlit temple lamp."""
    name = "Left" if side > 0 else "Right"
    center, gaze = np.array(EYE_CENTRE_M) * [side, 1, 1], REST_GAZE * [side * 1.5, 1, 1]
    bezel = np.array([[0, 0], [25.6, 0], [26.6, 5], [25.2, 8.2], [22.6, 8.6], [0, 7]]) * 1e-3
    ring = frame_toward(gaze, center - 0.0050 * gaze)
    upper = _lid(UPPER_LID_OPEN_RAD + np.pi / 2, 1.075, f"{name}UpperLid", center, bound)
    lower = _lid(-LOWER_LID_OPEN_RAD - np.pi / 2, 1.050, f"{name}LowerLid", center, bound)
    bezel_mesh = lathe(bezel, [TRIM, TRIM, TRIM, RUBBER, RUBBER], ring, "head", bound, 28)
    return [bezel_mesh, upper, lower, socket(temple(side), TEMPLE_LAMP_RADIUS_M, "head", bound)]


def _lid(elevation: float, size: float, joint: str, center: Array, bound: Skeleton) -> Mesh:
    """Return a half-shell around an eye with a dark rim; its pole is at `elevation` [rad]."""
    dome = circle_profile(np.radians([90, 79, 60, 40, 20, 0]))
    rings = EYE_RADIUS_M * size * np.vstack([[0.0, 0.0], dome])
    yaw = LID_YAW_RAD * (1 if joint.startswith("Left") else -1)
    ahead = np.cos(elevation)
    pole = np.array([ahead * np.sin(yaw), np.sin(elevation), ahead * np.cos(yaw)])
    bands = [RUBBER, RUBBER, *[PANEL] * 4]
    return lathe(rings, bands, frame_toward(pole, center), joint, bound, 24)


def eyes(bound: Skeleton) -> list[Mesh]:
    """Return the two eyeballs of black glass, with two highlights on each."""
    pieces = []
    for side, name in ((1.0, "LeftEye"), (-1.0, "RightEye")):
        center, gaze = np.array(EYE_CENTRE_M) * [side, 1, 1], REST_GAZE * [side, 1, 1]
        rings = EYE_RADIUS_M * circle_profile(np.radians([180, 120, 90, 70, 66, 48, 24, 0]))
        bands = [GLASS, GLASS, WHITE, RUBBER, GLASS, PUPIL, PUPIL]
        pieces.append(lathe(rings, bands, frame_toward(gaze, center), name, bound, 28))
        for across, up, radius in ((-0.30, 0.40, 0.0064), (0.26, -0.30, 0.0030)):
            shine = gaze + np.array([across, up, 0.0])  # on the same side in both eyes
            wide = radius / EYE_RADIUS_M * np.array([0.0, 1.0, 0.5, 0.0])
            cap = EYE_RADIUS_M * 1.022 * circle_profile(wide)
            cap[0, 1] *= 0.95
            pieces.append(lathe(cap, [WHITE] * 3, frame_toward(shine, center), "head", bound, 14))
    return pieces


def temple(side: float) -> Array:
    """Return the frame of the lamp at a temple, with +z outward."""
    return _on_head((side * 0.08, 0.2330, 0.1420), 0.001)


def lit_lenses(mood: str, color: Vector, bound: Skeleton) -> list[Mesh]:
    """Return the lit lamps of the temples and of the rings of the eyes."""
    pieces = [
        lens(temple(side), TEMPLE_LAMP_RADIUS_M, color, f"head_{mood}", bound)
        for side in (1.0, -1.0)
    ]
    size = EYE_RADIUS_M * np.array([0.90, 0.99, 1.018, 1.018, 0.99, 0.90])[:, None]
    rings = size * circle_profile(np.radians([180, 66, 60, 53, 48, 0]))
    for side, name in ((1.0, "LeftIris"), (-1.0, "RightIris")):
        place = frame_toward(REST_GAZE * [side, 1, 1], np.array(EYE_CENTRE_M) * [side, 1, 1])
        pieces.append(lathe(rings, [color] * 5, place, f"{name}_{mood}", bound, 28))
    return pieces
