"""Vleo's eyeballs, eyelids and brows."""

from functools import partial

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.lathe import circle_profile, frame_toward, lathe, loft
from tools.authoring.modelling.meshes import blend_normals, morphed
from tools.authoring.modelling.shapes import Array, linear_rgb
from tools.authoring.modelling.surface import normals_of
from tools.authoring.vleo.body import BACK_TEAL, LASH
from tools.authoring.vleo.expressions import EXPRESSIONS, NEUTRAL, VleoExpression
from tools.authoring.vleo.head import (
    EYE_AXES,
    EYE_RADIUS_M as EYE_RADIUS_M,
    LID_OPENING_RAD,
    REST_GAZE,
    head_shape,
)
from tools.authoring.vleo.rig import EYE_CENTRE_M
from tools.authoring.vleo.skin import skin_colors

WHITE, RIM = linear_rgb("#fdfdf8"), linear_rgb("#2e150c")
IRIS, PUPIL, BROW = linear_rgb("#8a4a22"), linear_rgb("#140d10"), linear_rgb("#14706f")
CLOSED_LID_RAD, CLOSED_LID_SAG_RAD = np.radians(-6.0), np.radians(8.5)
"""Elevation of the corners of the closed eye, and the sag of its middle below them [rad]."""
LID_HEIGHT_RADII = (0.075, 0.130)
"""Height of lower and upper lids over the eyeball, in radii; they move along chords of it."""
POINTS_PER_RING = 32
"""Points around an eye."""
_ANGLE = np.linspace(0, 2 * np.pi, POINTS_PER_RING, endpoint=False)


def eyes(bound: Skeleton) -> list[Mesh]:
    """Return eyeballs, lids and brows with their morph targets."""
    pieces = []
    for side in (1.0, -1.0):
        pieces += _ball(side, bound)
        for build in (_lids, _brow):
            pieces.append(morphed(partial(build, side=side, bound=bound), NEUTRAL, EXPRESSIONS))
    return pieces


def _ball(side: float, bound: Skeleton) -> list[Mesh]:
    """Return an eyeball and its highlights."""
    joint = "LeftEye" if side > 0 else "RightEye"
    center, sight = EYE_CENTRE_M * [side, 1, 1], REST_GAZE * [side, 1, 1]
    rings = EYE_RADIUS_M * circle_profile(
        np.radians([180, 110, 75, 54, 41.5, 40, 37, 31, 28, 14, 0])
    )
    bands = [WHITE] * 4 + [RIM] * 2 + [IRIS] * 2 + [PUPIL] * 2
    pieces = [lathe(rings, bands, frame_toward(sight, center), joint, bound, 26)]
    frame = frame_toward(sight, center)[:3, :3]
    for across, up, radius in ((-0.24, 0.30, 0.0052), (0.20, -0.27, 0.0024)):
        toward = frame @ [across, up, 1.0]  # on the same side in both eyes
        wide = radius / EYE_RADIUS_M * np.array([0.0, 1.0, 0.55, 0.0])
        rings = EYE_RADIUS_M * 1.024 * circle_profile(wide)
        rings[:2, 1] *= 0.96
        pieces.append(lathe(rings, [WHITE] * 3, frame_toward(toward, center), joint, bound, 16))
    return pieces


def _lids(face: VleoExpression, side: float, bound: Skeleton) -> Mesh:
    """Return the ring of skin around an eye, from inside the head into the eyeball.

    It is built for the left eye and mirrored for the right.
    """
    up = np.clip(np.sin(_ANGLE), 0, 1) ** 0.7
    edge, outer = _edge(face, side), _outer()
    away = outer - edge
    lash = edge + away / np.linalg.norm(away, axis=1, keepdims=True) * (0.03 + 0.065 * up)[:, None]
    lift = LID_HEIGHT_RADII[0] + (LID_HEIGHT_RADII[1] - LID_HEIGHT_RADII[0]) * up
    rows = [
        _on_eye_sphere(edge, 0.99 + 0 * lift),
        _on_eye_sphere(edge, 1 + 0.94 * lift),
        _on_eye_sphere(lash, 1 + lift),
    ]
    skin = _skin_radius(outer)
    for s in (0.16, 0.36, 0.6, 0.82, 1.0):
        flat, sunk = lash + (outer - lash) * s, smoothstep((s - 0.15) / 0.85)
        covered = smoothstep((np.linalg.norm(flat / LID_OPENING_RAD[:2], axis=1) - 1.05) / 0.15)
        over = np.maximum(1 + lift + (skin - 1 - lift) * sunk, _skin_radius(flat) * covered)
        rows.append(_on_eye_sphere(flat, over))
    rows.insert(2, rows[2])  # a crisp border between lash and skin
    under = _on_eye_sphere(outer, skin - 0.2)
    start, end = (
        np.tile(EYE_CENTRE_M + depth * EYE_RADIUS_M * REST_GAZE, (POINTS_PER_RING, 1))
        for depth in (0.0, 0.3)
    )
    rings = np.stack([start, under, *rows[::-1], end]) * [side, 1.0, 1.0]
    rings = rings if side > 0 else rings[:, ::-1]
    mesh = loft(rings, _lid_colors(rings), "head", bound)
    fixed = normals_of(head_shape().distance, mesh.positions.astype(float), 0.006)
    share = np.repeat([0, 0, 1.0, 1.0, 0.85, 0.6, 0.3, *[0.0] * (len(rings) - 7)], POINTS_PER_RING)
    return blend_normals(mesh, fixed, share)


def _edge(face: VleoExpression, side: float) -> Array:
    """Return the rim of the lids, to the left and up from the centre of the eyeball [rad]."""
    x, height = np.cos(_ANGLE), np.sin(_ANGLE)
    open_ = 1.0 - face.shut[0 if side > 0 else 1]
    bow = np.abs(height) ** 0.9
    closed = CLOSED_LID_RAD * np.abs(height) ** 0.5 - CLOSED_LID_SAG_RAD * (1 - x * x)
    upper = np.clip(face.upper - face.upper_tilt * x * 0.5, 0.0, 1.35) * open_
    lower = face.lower * open_
    wide = np.where(height >= 0, LID_OPENING_RAD[1] * bow, -LID_OPENING_RAD[2] * bow)
    y = closed + (wide - closed) * np.where(height >= 0, upper, lower)
    return np.stack([LID_OPENING_RAD[0] * x, y], axis=-1)


def _outer() -> Array:
    """Return the outer border of the lids in the head, to the left and up [rad]."""
    height = np.sin(_ANGLE)
    reach = np.radians(np.where(height >= 0, 76.0, 66.0))
    return np.stack([np.radians(72.0) * np.cos(_ANGLE), reach * height], axis=-1)


def _directions_from_eye(angles: Array) -> Array:
    """Return directions from the centre of the left eyeball, (n, 3)."""
    far = np.linalg.norm(angles, axis=1, keepdims=True)
    aside = angles * np.sinc(far / np.pi)
    return np.asarray(np.column_stack([aside, np.cos(far)]) @ EYE_AXES.T)


def _on_eye_sphere(angles: Array, radii: Array) -> Array:
    """Return points around the centre of the left eyeball; radii in units of its radius."""
    return EYE_CENTRE_M + EYE_RADIUS_M * np.reshape(radii, (-1, 1)) * _directions_from_eye(angles)


def _skin_radius(angles: Array) -> Array:
    """Return the distance of the skin from the centre of the eyeball, in its radii."""
    ways = _directions_from_eye(angles)
    low, high = np.zeros(len(angles)), np.full(len(angles), 1.22)
    for _ in range(14):
        middle = 0.5 * (low + high)
        inside = head_shape().distance(EYE_CENTRE_M + EYE_RADIUS_M * middle[:, None] * ways) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(low + 0.4e-3 / EYE_RADIUS_M)


def _lid_colors(rings: Array) -> Array:
    """Return the colours of the lids, with dark lashes at the rim of the upper one."""
    flat = rings.reshape(-1, 3)
    normals = normals_of(head_shape().distance, flat, 0.006)
    colors = np.asarray(skin_colors(flat, normals)).reshape(rings.shape).copy()
    above = np.sin(_ANGLE if rings[-3, 0, 0] > 0 else _ANGLE[::-1]) > -0.05
    colors[-4:] = np.where(above[:, None], LASH, BACK_TEAL)
    return colors


def _brow(face: VleoExpression, side: float, bound: Skeleton) -> Mesh:
    """Return a brow, a soft dark ridge over the eye."""
    along = np.linspace(-1.0, 1.0, 11)  # from the inner end to the outer
    inner = np.clip(-along, -0.4, 1.0)
    height = np.radians(63.0) - np.radians(9.0) * along**2 + face.brow + face.brow_inner * inner
    across = np.radians(-4.0) + np.radians(25.0) * along + 0.25 * np.minimum(face.brow, 0)
    line = np.stack([across, height], axis=-1)
    radius = (
        1
        + LID_HEIGHT_RADII[1]
        + (_skin_radius(line) - 1 - LID_HEIGHT_RADII[1]) * smoothstep((height - 0.75) / 0.55)
    )
    radius = np.maximum(radius, _skin_radius(line)) + 0.05
    thick = 0.0030 * np.sqrt(np.clip(1 - (along / 1.02) ** 2, 0, 1)) * (1 - 0.15 * along)
    turn = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    middle, out = _on_eye_sphere(line, radius), _directions_from_eye(line)
    way = np.gradient(middle, axis=0)
    over = np.cross(out, way)
    over /= np.linalg.norm(over, axis=1, keepdims=True)
    circle = np.cos(turn)[:, None] * over[:, None] + 0.55 * np.sin(turn)[:, None] * out[:, None]
    rings = middle[:, None] + thick[:, None, None] * circle
    ends = [np.tile(middle[i], (len(turn), 1))[None] for i in (0, -1)]
    rings = np.concatenate([ends[0], rings, ends[1]]) * [side, 1.0, 1.0]
    rings = rings[:, ::-1] if side < 0 else rings
    return loft(rings, np.tile(BROW, (*rings.shape[:2], 1)), "head", bound)
