"""What sits on Vleo's skin with a crisp edge: eyes, lids, brows, lips, spots, spines and claws."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.authoring.sculpt import Part, lathe, sculpt
from characters.authoring.shapes import Array, Vector, chain, rgb
from characters.authoring.surface import normals_of, project
from characters.authoring.vleo_body import (
    CLAW,
    MAROON,
    ORANGE,
    PINK,
    SPOT,
    Body,
    Smile,
    face_weights,
    lip_line,
    spine_line,
    whole,
)
from characters.authoring.vleo_rig import LID_YAW
from characters.mesh import Mesh
from characters.pose import Skeleton

WHITE, IRIS, PUPIL, LASH = rgb("#fdfdf8"), rgb("#7a4423"), rgb("#140d10"), rgb("#0d3f42")
LIP, LID, BROW = rgb("#ff5f86"), rgb("#2fae97"), rgb("#0f4a50")
EYE = np.array([0.0300, 0.2575, 0.1475])
EYE_RADIUS = 0.0215
GAZE = np.array([0.22, 0.30, 1.0]) / np.linalg.norm([0.22, 0.30, 1.0])
LID_OPEN, LOWER_LID_OPEN = 1.25, 1.20
"""Elevation of the rim of an open lid above and below straight ahead [rad]."""

SPOTS = (  # half a back: side, height, forward, radius [mm]; those at 0 have no twin
    (0, 300, 100, 11), (23, 292, 88, 8), (17, 280, 62, 9), (0, 262, 55, 8),
    (30, 200, 78, 7), (21, 176, 62, 8), (33, 150, 40, 9),
    (35, 166, 14, 10), (52, 132, 22, 7), (47, 148, -14, 11), (26, 172, -8, 7),
    (33, 158, -38, 9), (53, 118, -32, 8), (40, 128, -62, 9), (22, 138, -72, 7),
    (26, 112, -94, 7), (17, 104, -124, 6), (13, 96, -156, 5), (10, 96, -188, 4),
)  # fmt: skip
SPINES = 12


def face(body: Body, bound: Skeleton) -> list[Mesh]:
    """Return all crisp pieces, bound to the skeleton."""
    pieces = [*_mouth_rims(body, bound), _lips(bound)]
    for side in (1.0, -1.0):
        pieces += _eye(side, bound)
        pieces += [_brow(side, bound), *_claws(side, bound)]
    return [*pieces, *_patches(body), *_spines(body, bound)]


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
        rims.append(_tube(line, radius, hold, MAROON, body))
    return rims


def _lip(x: Array, sign: float) -> Array:
    """Return where the upper (+1) or lower (−1) lip meets the outside, for sides x, (n, 3)."""
    near, far = np.full(len(x), 0.135), np.full(len(x), 0.215)
    for _ in range(40):  # bisection along z
        middle = 0.5 * (near + far)
        points = np.stack([x, np.zeros(len(x)), middle], axis=1)
        forward = np.clip((middle - 0.134) / 0.055, 0, 1)
        center = 1 - np.clip(np.abs(x) / 0.040, 0, 1) ** 2
        half = (0.0026 + 0.0056 * forward * center) * (0.45 if sign > 0 else 1.0)
        points[:, 1] = lip_line(points) + sign * half
        inside = whole().distance(points) < 0
        near, far = np.where(inside, middle, near), np.where(inside, far, middle)
    return points


def _corner_side(corner: float) -> float:
    """Return how far to the side the corners of the mouth are [m]."""
    x = np.linspace(0.0, 0.06, 400)
    return float(x[np.argmax(_lip(x, 1.0)[:, 2] < corner)])


def _patches(body: Body) -> list[Mesh]:
    """Return the round patches of colour: cheeks, nostrils and the spots on the back."""
    cheek = (60.0, 236.5, 146.0, 10.0)
    nostril = (13.0, 247.0, 193.0, 3.4)
    rows = [(cheek, PINK), (nostril, LASH), *((spot, SPOT) for spot in SPOTS)]
    both = [
        ((side * x, *rest), color)
        for (x, *rest), color in rows
        for side in (1, -1)
        if x or side > 0
    ]
    places = np.array([row for row, _ in both]) / 1000
    return _decals(places[:, :3], places[:, 3], [color for _, color in both], body)


def _spines(body: Body, bound: Skeleton) -> list[Mesh]:
    """Return a row of soft orange spines from the neck to the tail."""
    line = spine_line(200)
    along = np.gradient(line[:, :3], axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    spines = []
    for share in np.linspace(0.06, 0.90, SPINES):
        i = round(share * 199)
        up = np.array([0.0, along[i, 2], -along[i, 1]])
        size = 0.0045 + 0.0085 * np.sin(np.pi * share) ** 0.8
        profile = size * np.array(
            [[0, -0.5], [1, -0.45], [0.86, 0.35], [0.5, 1.0], [0.2, 1.38], [0, 1.5]]
        )
        lean = up - 0.35 * along[i]
        place = facing(lean / np.linalg.norm(lean), line[i, :3] + up * (line[i, 3] - 0.001))
        cone = lathe(profile, [ORANGE] * 5, place, "hips", bound, 9)
        base = np.tile(line[i, :3] + up * line[i, 3], (len(cone.positions), 1))
        spines.append(_carried(cone, base, body))
    return spines


def _claws(side: float, bound: Skeleton) -> list[Mesh]:
    name = "Left" if side > 0 else "Right"
    claws = []
    for which, x, z in (("Front", 0.043, 0.060), ("Hind", 0.045, -0.048)):
        for across, ahead in ((-0.0150, 0.0205), (0.0, 0.0268), (0.0150, 0.0205)):
            angle = np.radians([180, 120, 75, 40, 0])
            rings = 0.0066 * np.stack([np.sin(angle), np.cos(angle)], axis=1)
            place = facing(
                np.array([across * 20, -0.1, 1.0]),
                np.array([side * (x + across), 0.0072, z + ahead]),
            )
            claws.append(lathe(rings, [CLAW] * 4, place, f"{name}{which}Foot", bound, 8))
    return claws


def _decals(near: Array, radii: Array, colors: list[Vector], body: Body) -> list[Mesh]:
    """Return round patches on the skin next to points (n, 3), half a millimetre proud of it."""
    field, sides = whole().distance, 12
    centers = project(field, near, 0.05, 8)
    frames = np.stack(
        [facing(n, c) for n, c in zip(normals_of(field, centers, 0.006), centers, strict=True)]
    )
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides)], axis=1)
    flat = np.vstack([np.zeros((1, 3)), 0.6 * circle, circle]) * radii[:, None, None]
    points = flat @ frames[:, :3, :3].swapaxes(1, 2) + centers[:, None]
    points = project(field, points.reshape(-1, 3), 0.01, 4)
    normals = normals_of(field, points, 0.006)
    lift = np.where(np.arange(1 + 2 * sides) <= sides, 0.0007, 0.0003)
    proud = points + np.tile(lift, len(near))[:, None] * normals
    i = np.arange(sides)
    j = (i + 1) % sides
    fan = np.stack([0 * i, 1 + i, 1 + j], axis=1)
    strip = np.stack([1 + i, 1 + sides + i, 1 + sides + j, 1 + i, 1 + sides + j, 1 + j], axis=1)
    triangles = np.vstack([fan, strip.reshape(-1, 3)])
    patches = []
    for rows, color in zip(np.split(np.arange(len(points)), len(near)), colors, strict=True):
        bare = _mesh(proud[rows], normals[rows], triangles, color, body)
        patches.append(_carried(bare, points[rows], body))
    return patches


def _tube(line: Array, radius: float, weights: Array, color: Vector, body: Body) -> Mesh:
    """Return a tube around points (n, 3), pointed at its ends, with one row of weights each."""
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = normals_of(whole().distance, line, 0.006)
    across = np.cross(along, out)
    sides = 6
    angle = np.linspace(0, 2 * np.pi, sides, endpoint=False)[None, :, None]
    ring = np.cos(angle) * out[:, None] + np.sin(angle) * across[:, None]
    thick = radius * np.minimum(1.0, np.sin(np.linspace(0, np.pi, len(line))) * 4)
    points = (line[:, None] + thick[:, None, None] * ring).reshape(-1, 3)
    i, k = np.meshgrid(np.arange(len(line) - 1), np.arange(sides), indexing="ij")
    k2 = (k + 1) % sides
    a, b, c, d = i * sides + k, i * sides + k2, (i + 1) * sides + k2, (i + 1) * sides + k
    triangles = np.stack([a, c, b, a, d, c], axis=-1).reshape(-1, 3)
    mesh = _mesh(points, ring.reshape(-1, 3), triangles, color, body)
    return _skinned(mesh, np.repeat(weights, sides, axis=0))


def _mesh(
    points: Array, normals: Array, triangles: NDArray[np.int64], color: Vector, body: Body
) -> Mesh:
    """Return an unskinned piece of one colour."""
    return Mesh(
        name="",
        positions=points.astype(np.float32),
        normals=normals.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        joints=np.zeros((len(points), 4), np.uint16),
        weights=np.tile(np.array([1, 0, 0, 0], np.float32), (len(points), 1)),
        inverse_bind=np.zeros((body.weights.shape[1], 4, 4)),
        colors=np.tile(np.array([*color, 1.0], np.float32), (len(points), 1)),
    )


def _carried(mesh: Mesh, points: Array, body: Body) -> Mesh:
    """Return a piece that moves with the skin at points (one a vertex)."""
    away = np.linalg.norm(points[:, None] - body.points[None], axis=2)
    nearest = np.argsort(away, axis=1, kind="stable")[:, :4]
    share = 1 / (np.take_along_axis(away, nearest, axis=1) + 1e-4)
    share /= share.sum(axis=1, keepdims=True)
    return _skinned(mesh, np.einsum("vk,vkj->vj", share, body.weights[nearest]))


def _skinned(mesh: Mesh, weights: Array) -> Mesh:
    """Return a piece with the four largest of weights (vertices, joints)."""
    joints = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    four = np.take_along_axis(weights, joints, axis=1)
    four[four < 0.01] = 0.0
    four /= four.sum(axis=1, keepdims=True)
    joints = np.where(four > 0, joints, 0)
    return replace(mesh, joints=joints.astype(np.uint16), weights=four.astype(np.float32))


def skin_mesh(body: Body, bound: Skeleton) -> Mesh:
    """Return the skin itself as a mesh bound to the skeleton."""
    bare = _mesh(body.points, body.normals, body.triangles, (1.0, 1.0, 1.0), body)
    colors = np.column_stack([body.colors, np.ones(len(body.colors))]).astype(np.float32)
    inverse_bind = np.asarray(np.linalg.inv(bound.rest.globals(bound)), np.float64)
    return replace(_skinned(bare, body.weights), colors=colors, inverse_bind=inverse_bind)


def facing(axis: Array, place: Array) -> Array:
    """Return the (4, 4) frame at a place whose +z is the axis and whose +y is as high as can be."""
    z = axis / np.linalg.norm(axis)
    hint = np.array([0.0, 1.0, 0.0]) if abs(z[1]) < 0.95 else np.array([0.0, 0.0, -1.0])
    x = np.cross(hint, z)
    x /= np.linalg.norm(x)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    frame[:3, 3] = place
    return frame
