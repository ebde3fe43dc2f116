"""The bundled explorer's eyeballs and eyelids."""

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.face import EXPRESSIONS, NEUTRAL, HumanExpression, skin_displacement
from tools.authoring.human.rig import JOINT_POSITIONS
from tools.authoring.human.skull import (
    EYE_WHITE,
    MAROON,
    SKIN,
    complexion,
    face_normals,
    on_face,
    skin_normals,
)
from tools.authoring.modelling.lathe import circle_profile, lathe, loft
from tools.authoring.modelling.meshes import blend_normals, morphed
from tools.authoring.modelling.sculpt import coated
from tools.authoring.modelling.shapes import Array, linear_rgb

INK = linear_rgb("#1b1020")
BROWN, AMBER = linear_rgb("#5d2c0e"), linear_rgb("#b5702a")
FOLD = linear_rgb("#d98f68")

EYE_FRONT_RADIUS_M = 0.138
"""Radius of the front of an eyeball [m]. It rotates about a point in front of the sphere's centre,
so a large, flat eye does not move its iris too far."""

REST_GAZE = np.array([0.37, 0.055, 1.0]) / np.linalg.norm([0.37, 0.055, 1.0])
"""Direction from the centre of that sphere to the centre of the left iris."""

LID_CENTRE_M = np.array([0.087, 1.437])
"""x and y of the centre between the left lids [m]."""

LID_OPENING_M = (0.056, 0.064, 0.052)
"""Half width, upward and downward extent of the lid opening [m]."""

CLOSED_LID_SAG_M = 0.034
"""How far the line of the closed eye sags below its corners [m]."""

POINTS_PER_RING = 36
"""Points around an eye."""

LID_HEIGHT_M = (0.0040, 0.0095)
"""Height of lower and upper lids over the eyeball [m]; morph targets move them linearly."""

_JOINT_TO_FRONT_M = 0.122  # from the joint to the front of the ball [m]


def eyeballs(skeleton: Skeleton) -> list[Mesh]:
    """Return both eyeballs with iris, pupil and highlights."""
    return [piece for sign in (1.0, -1.0) for piece in _eyeball(sign, skeleton)]


def eyelids(skeleton: Skeleton) -> list[Mesh]:
    """Return the lids of both eyes with their morph targets."""
    return [
        morphed(partial(_lids, sign=sign, skeleton=skeleton), NEUTRAL, EXPRESSIONS)
        for sign in (1.0, -1.0)
    ]


def _centre(sign: float) -> Array:
    """Return the centre of the sphere of an eyeball's front, (3,) [m]."""
    flip = np.array([sign, 1.0, 1.0])
    return np.asarray(
        (
            np.array(JOINT_POSITIONS["LeftEye"][1])
            + (_JOINT_TO_FRONT_M - EYE_FRONT_RADIUS_M) * REST_GAZE
        )
        * flip
    )


def _eyeball(sign: float, skeleton: Skeleton) -> list[Mesh]:
    joint = "LeftEye" if sign > 0 else "RightEye"
    sight = REST_GAZE * [sign, 1.0, 1.0]
    place = np.column_stack([_axes(sight), _centre(sign)])
    tilt = np.array([0.92, 0.72, 0.5, 0.325, 0.305, 0.282, 0.21, 0.158, 0.15, 0.07, 0.0])
    ball = circle_profile(tilt)
    rings = EYE_FRONT_RADIUS_M * np.vstack([[0.0, 0.5], ball])
    bands = [EYE_WHITE] * 4 + [INK] * 2 + [BROWN] * 2 + [INK] * 3
    whole = lathe(rings, bands, place, joint, skeleton, 26)
    whole = replace(whole, colors=_lit_from_below(whole, _centre(sign)[1]))
    lights = [((-0.10, 0.13), 0.112), ((0.11, -0.13), 0.05)]  # on the same side in both eyes
    return [whole, *(_light(sign, at, wide, joint, skeleton) for at, wide in lights)]


def _lit_from_below(ball: Mesh, middle: float) -> NDArray[np.float32]:
    """Return the colours of an eyeball with an iris that is lighter at the bottom, (n, 4)."""
    colors = np.array(ball.colors)
    iris = np.abs(colors[:, :3] - BROWN).max(axis=1) < 1e-4
    below = np.clip(0.5 - (ball.positions[iris, 1] - middle - 0.007) / 0.06, 0.0, 1.0)
    colors[iris, :3] += below[:, None] * np.subtract(AMBER, BROWN)
    return colors.astype(np.float32)


def _light(
    sign: float, at: tuple[float, float], wide: float, joint: str, skeleton: Skeleton
) -> Mesh:
    """Return a highlight, `at` (across, up) from the centre of the iris and `wide` [rad]."""
    axes = _axes(REST_GAZE * [sign, 1.0, 1.0])
    toward = axes @ [at[0], at[1], 1.0]
    place = np.column_stack([_axes(toward / np.linalg.norm(toward)), _centre(sign)])
    tilt = wide * np.array([0.0, 1.0, 0.55, 0.0])
    rings = EYE_FRONT_RADIUS_M * 1.003 * circle_profile(tilt)
    rings[:2, 1] -= 0.004
    return lathe(rings, [(1.0, 1.0, 1.0)] * 3, place, joint, skeleton, 12)


def _axes(toward: Array) -> Array:
    """Return axes to the left, up and along a direction, as columns, (3, 3)."""
    left = np.cross([0.0, 1.0, 0.0], toward)
    left /= np.linalg.norm(left)
    return np.column_stack([left, np.cross(toward, left), toward])


def _lids(face: HumanExpression, sign: float, skeleton: Skeleton) -> Mesh:
    """Return the ring of skin around an eye, from behind the face into the eyeball."""
    angle = np.linspace(0, 2 * np.pi, POINTS_PER_RING, endpoint=False)
    rings = _lid_rings(angle, face, sign)
    up = np.sin(angle) >= 0
    if sign < 0:  # built for the left eye, and mirrored
        rings, up = rings[:, ::-1] * [-1.0, 1.0, 1.0], up[::-1]
    mesh = loft(rings, _lid_colors(rings, up), "head", skeleton)
    of_the_face = np.repeat(np.array([0, 0, 1.0, 0.75, 0.3, *[0] * 6]), POINTS_PER_RING)
    return blend_normals(mesh, skin_normals(mesh.positions.astype(float)), of_the_face)


def _lid_rings(angle: Array, face: HumanExpression, sign: float) -> Array:
    """Return pole, rim under the skin, skin, lashes twice, edge, edge in the ball, pole."""
    height = np.sin(angle)
    edge = _edge(angle, face, sign)
    reach = np.where(height >= 0, LID_OPENING_M[1] + 0.038, LID_OPENING_M[2] + 0.022)
    outer = LID_CENTRE_M + np.stack(
        [(LID_OPENING_M[0] + 0.028) * np.cos(angle), reach * height], axis=-1
    )
    away = outer - edge
    thick = np.where(height >= 0, 0.0085 + 0.003 * np.cos(angle), 0.0025)  # more at the temple
    lash = edge + away * (thick / np.linalg.norm(away, axis=1))[:, None]
    lift = LID_HEIGHT_M[0] + (LID_HEIGHT_M[1] - LID_HEIGHT_M[0]) * np.clip(height, 0, 1) ** 0.7
    flat = [*(lash + (outer - lash) * s for s in (1.0, 0.8, 0.55, 0.28)), lash, lash, edge, edge]
    lofts = [lift, lift, lift, lift + 0.001, lift + 0.0025, lift + 0.0025, lift, 0 * lift - 0.004]
    share = np.repeat([1.0, 0.9, 0.55, 0.22, 0.0, 0.0, 0.0, 0.0], POINTS_PER_RING)
    rows = _on_eye(np.concatenate(flat), np.concatenate(lofts), share, face)
    rows = rows.reshape(len(flat), POINTS_PER_RING, 3)
    behind, inside = (np.tile([*LID_CENTRE_M, z], (POINTS_PER_RING, 1)) for z in (0.10, 0.14))
    return np.stack([behind, rows[0] - [0.0, 0.0, 0.006], *rows, inside])


def _edge(angle: Array, face: HumanExpression, sign: float) -> Array:
    """Return the rim of the lids, x and y, (points, 2) [m]."""
    x, height = np.cos(angle), np.sin(angle)
    open_ = 1.0 - face.shut[0 if sign > 0 else 1]
    bow = np.abs(height) ** 0.86  # a little boxier than an ellipse
    closed = -CLOSED_LID_SAG_M * (1 - x * x) ** 0.8
    upper = np.clip(face.upper - face.upper_tilt * x * 0.5, 0.0, 1.4) * open_
    upper -= 0.06 * (1 - open_)  # a little over the lower lid
    lower = face.lower * open_
    wide = np.where(height >= 0, LID_OPENING_M[1] * bow, -LID_OPENING_M[2] * bow)
    y = closed + (wide - closed) * np.where(height >= 0, upper, lower)
    return LID_CENTRE_M + np.stack([LID_OPENING_M[0] * x, y], axis=-1)


def _on_eye(flat: Array, lift: Array, share: Array, face: HumanExpression) -> Array:
    """Return points over the eyeball, (n, 3), blended by `share` onto the face."""
    centre = _centre(1.0)
    apart = flat - centre[:2]
    skin = on_face(flat[:, 0], flat[:, 1])
    # The rim dips under the face, so that no step is visible between the two surfaces.
    skin += np.where(share < 1, 0.001, -0.0015)[:, None] * face_normals(skin)
    height = centre[2] + np.sqrt((EYE_FRONT_RADIUS_M + lift) ** 2 - np.sum(apart**2, axis=1))
    height = np.where(lift > 0, np.maximum(height, skin[:, 2] + 0.002), height)
    ball = np.column_stack([flat, height])
    skin += skin_displacement(skin, face)
    return np.asarray(ball + (skin - ball) * share[:, None])


def _lid_colors(rings: Array, up: NDArray[np.bool_]) -> Array:
    """Return the colours of the lids: lashes above, a fold below."""
    colors = np.tile(SKIN, (*rings.shape[:2], 1))
    flat = colors.reshape(-1, 3)
    colors = coated(rings.reshape(-1, 3), flat, complexion()).reshape(colors.shape)
    rim = np.where(up[:, None], INK, FOLD)
    colors[-4:] = rim  # the last ring but the pole lies in the ball
    colors[-1] = MAROON
    return np.asarray(colors)
