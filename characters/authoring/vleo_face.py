"""Vleo's face: eyes and lids, brows, puckered lips, and the line of its smile."""

import numpy as np

from characters.authoring.sculpt import Part, lathe, sculpt
from characters.authoring.shapes import Array, chain, rgb
from characters.authoring.surface import normals_of
from characters.authoring.vleo_body import LASH, MAROON, Smile, lip_gap, lip_line, whole
from characters.authoring.vleo_pieces import facing, tube
from characters.authoring.vleo_rig import LID_YAW
from characters.authoring.vleo_skin import Body, face_weights
from characters.mesh import Mesh
from characters.pose import Skeleton

WHITE, IRIS, PUPIL = rgb("#fdfdf8"), rgb("#7a4423"), rgb("#140d10")
LIP, LID, BROW = rgb("#ff5f86"), rgb("#2fae97"), rgb("#0f4a50")
EYE = np.array([0.0300, 0.2575, 0.1475])
EYE_RADIUS = 0.0215
GAZE = np.array([0.22, 0.30, 1.0]) / np.linalg.norm([0.22, 0.30, 1.0])
LID_OPEN, LOWER_LID_OPEN = 1.25, 1.20
"""Elevation of the rim of an open lid above and below straight ahead [rad]."""


def face(body: Body, bound: Skeleton) -> list[Mesh]:
    """Return all crisp pieces of the face, bound to the skeleton."""
    pieces = [*_mouth_rims(body, bound), _lips(bound)]
    for side in (1.0, -1.0):
        pieces += [*_eye(side, bound), _brow(side, bound)]
    return pieces


def _eye(side: float, bound: Skeleton) -> list[Mesh]:
    """Return an eyeball, its two highlights and its two lids."""
    name = "Left" if side > 0 else "Right"
    center, gaze = EYE * [side, 1, 1], GAZE * [side, 1, 1]
    angle = np.radians([180, 120, 85, 57, 54, 35, 17, 0])
    rings = EYE_RADIUS * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    bands = [WHITE] * 3 + [LASH, IRIS, PUPIL, PUPIL]
    ball = lathe(rings, bands, facing(gaze, center), f"{name}Eye", bound, 22)
    lights = []
    for across, up, radius in ((-0.30, 0.40, 0.0058), (0.26, -0.28, 0.0027)):
        toward = gaze + np.array([across, up, 0.0])  # on the same side in both: one sun
        wide = radius / EYE_RADIUS * np.array([0.0, 1.0, 0.5, 0.0])
        rings = EYE_RADIUS * 1.022 * np.stack([np.sin(wide), np.cos(wide)], axis=1)
        rings[0, 1] *= 0.95
        lights.append(lathe(rings, [WHITE] * 3, facing(toward, center), "head", bound, 10))
    upper = _lid(LID_OPEN + np.pi / 2, 1.065, f"{name}UpperLid", center, bound)
    lower = _lid(-LOWER_LID_OPEN - np.pi / 2, 1.045, f"{name}LowerLid", center, bound)
    return [ball, *lights, upper, lower]


def _lid(elevation: float, size: float, joint: str, center: Array, bound: Skeleton) -> Mesh:
    """Return half a shell around an eye with a dark rim; `elevation` is that of its pole."""
    angle = np.radians([90, 80, 60, 40, 20, 0])
    dome = np.stack([np.sin(angle), np.cos(angle)], axis=1)
    rings = EYE_RADIUS * size * np.vstack([[0.0, 0.0], dome])
    yaw = LID_YAW * (1 if joint.startswith("Left") else -1)
    ahead = np.cos(elevation)
    pole = np.array([ahead * np.sin(yaw), np.sin(elevation), ahead * np.cos(yaw)])
    return lathe(rings, [LASH, LASH, *[LID] * 4], facing(pole, center), joint, bound, 18)


def _brow(side: float, bound: Skeleton) -> Mesh:
    """Return an angry brow, hidden in the head but for shouts."""
    name = "Left" if side > 0 else "Right"
    bones = (f"{name}Brow",)
    line = [[0.0130, 0.2700, 0.1680], [0.0290, 0.2790, 0.1650], [0.0420, 0.2835, 0.1540]]
    ridge = chain(np.array(line) * [side, 1, 1], (0.0050, 0.0052, 0.0034), bones * 2, BROW)
    return sculpt("", [Part(ridge, 0.0045, soft_skin=0.0)], bound)


def _lips(bound: Skeleton) -> Mesh:
    """Return a puckered mouth, hidden in the mouth but for kisses."""
    profile = [[0, -4], [11, -3], [13, 1], [11.5, 5], [8, 6.8], [4.5, 4.5], [0, 2]]
    place = facing(
        np.array([0.0, 0.05, 1.0]), bound.rest.globals(bound)[bound.index("lips"), :3, 3]
    )
    bands = [LIP] * 5 + [MAROON]
    return lathe(np.array(profile) / 1000, bands, place, "lips", bound, 20)


def _mouth_rims(body: Body, bound: Skeleton) -> list[Mesh]:
    """Return a thin dark line along each lip: the smile, crisp whatever the triangles."""
    x = _corner_side(Smile().corner - 0.004) * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 33))
    rims = []
    for sign, radius in ((1.0, 0.0011), (-1.0, 0.0010)):
        line = _lip(x, sign)
        hold = face_weights(line + np.array([0.0, 0.004 * sign, 0.0]), bound)
        line -= (0.0004 if sign > 0 else 0.0010) * normals_of(whole().distance, line, 0.006)
        rims.append(tube(line, radius, hold, MAROON, body))
    return rims


def _lip(x: Array, sign: float) -> Array:
    """Return where the upper (+1) or lower (−1) lip meets the outside, for sides x, (n, 3)."""
    near, far = np.full(len(x), 0.135), np.full(len(x), 0.215)
    for _ in range(40):  # bisection along z
        middle = 0.5 * (near + far)
        points = np.stack([x, np.zeros(len(x)), middle], axis=1)
        points[:, 1] = lip_line(points) + sign * lip_gap(points, sign > 0)
        inside = whole().distance(points) < 0
        near, far = np.where(inside, middle, near), np.where(inside, far, middle)
    return points


def _corner_side(corner: float) -> float:
    """Return how far to the side the corners of the mouth are [m]."""
    x = np.linspace(0.0, 0.06, 400)
    return float(x[np.argmax(_lip(x, 1.0)[:, 2] < corner)])
