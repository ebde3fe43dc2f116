"""Vleo's mouth: surrounding skin, lips, cavity and tongue."""

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import loft
from tools.authoring.modelling.meshes import blend_normals, morphed
from tools.authoring.modelling.shapes import Array, linear_rgb
from tools.authoring.modelling.surface import normals_of
from tools.authoring.vleo.body import MAROON, ROSE
from tools.authoring.vleo.expressions import (
    EXPRESSIONS,
    JAW_HINGE_M,
    NEUTRAL,
    VleoExpression,
    cheek_displacement,
    rotate_with_jaw,
)
from tools.authoring.vleo.head import HEAD_AXIS_Z_M, head_shape, lip_line
from tools.authoring.vleo.skin import jaw_share, skin_colors

TEETH = linear_rgb("#fbf7ee")
LIP = linear_rgb("#ff7d8c")
POINTS_PER_RING = 40
"""Points around the mouth."""
MOUTH_SKIN_EXTENT = (1.10, 0.0140, 0.0155)
"""Half width [rad], upward and downward extent [m] of the skin around the mouth."""
_SKIN_RING_SHARES = (0.0, 0.16, 0.40, 0.70, 1.0)
"""Positions of the rings between the lips (0) and the border of the skin around them (1)."""
_ANGLE = np.linspace(0, 2 * np.pi, POINTS_PER_RING, endpoint=False)


def mouth(bound: Skeleton) -> list[Mesh]:
    """Return mouth, teeth and tongue with the morph targets of expressions and visemes."""
    return [
        morphed(lambda face: _mouth(face, bound), NEUTRAL, EXPRESSIONS),
        morphed(lambda face: _teeth(face, bound), NEUTRAL, EXPRESSIONS),
        morphed(lambda face: _tongue(face, bound), NEUTRAL, EXPRESSIONS),
    ]


def _mouth(face: VleoExpression, bound: Skeleton) -> Mesh:
    """Return a closed surface from a pole in the head over skin and lips to the throat."""
    line, edge = _lip_lines(_ANGLE, face)
    outer = np.stack([MOUTH_SKIN_EXTENT[0] * np.cos(_ANGLE), _outer_height()], axis=-1)
    away = (outer - edge) * [0.060, 1.0]
    step = face.lips / np.linalg.norm(away, axis=1, keepdims=True) * (outer - edge)
    full = np.abs(np.sin(_ANGLE)) ** 0.6
    skin, held = [], []
    for s in _SKIN_RING_SHARES:
        flat, rest = (start + (outer - start) * s for start in (edge + step, line + step))
        lift = 0.0007 + (0.0006 + 0.45 * face.lips + face.pout) * (1 - s) ** 2.5
        skin.append(_on_skin(flat, rest, lift + 0 * full))
        held.append(_lip_share() * (1 - s) + s * jaw_share(skin[-1]))
    crest = _on_skin(edge + 0.5 * step, line + 0.5 * step, 0.0008 + 0.95 * face.lips + face.pout)
    rim = _on_skin(edge, line, 0.3 * face.lips + face.pout + 0 * full)
    drawn_in = face.tuck * np.clip(-np.sin(_ANGLE), 0.0, 1.0)[:, None] ** 0.5
    rim -= drawn_in * _outward(rim)
    crest -= 0.6 * drawn_in * _outward(crest)
    skin = [
        rotate_with_jaw(p + cheek_displacement(p, face), h, face)
        for p, h in zip(skin, held, strict=True)
    ]
    lips = [
        rotate_with_jaw(p + cheek_displacement(p, face), _lip_share(), face) for p in (crest, rim)
    ]
    inside, inside_held = _cavity(lips[1])
    under = skin[-1] - 0.006 * _outward(skin[-1])
    behind = np.tile([0.0, 0.2200, 0.150], (POINTS_PER_RING, 1))
    outside = [behind, under, *skin[::-1], skin[0], *lips]
    rings = np.stack([*outside, lips[1], *inside])
    shares = [0 * full, held[-1], *held[::-1], held[0], *[_lip_share()] * 3, *inside_held]
    mesh = loft(rings, _colors(rings), _bones(np.stack(shares), bound), bound)
    fixed = normals_of(head_shape().distance, mesh.positions.astype(float), 0.006)
    far = [0, 0, *_SKIN_RING_SHARES[::-1], *[0.0] * (len(rings) - 2 - len(_SKIN_RING_SHARES))]
    return blend_normals(mesh, fixed, np.repeat(np.array(far) ** 1.5, POINTS_PER_RING))


def _lip_lines(angle: Array, face: VleoExpression) -> tuple[Array, Array]:
    """Return the line where closed lips meet, and their edges: azimuth [rad], height [m]."""
    side, height = face.width * np.cos(angle), np.sin(angle)
    line = lip_line(side, face.smile, face.width)
    bow = np.abs(height) ** face.square
    y = line + np.where(height >= 0, face.rise, -face.drop) * bow
    return np.stack([side, line], axis=-1), np.stack([side, y], axis=-1)


def _outer_height() -> Array:
    """Return the height of the border of the skin around the mouth, (points,) [m]."""
    height = np.sin(_ANGLE)
    reach = np.where(height >= 0, MOUTH_SKIN_EXTENT[1], MOUTH_SKIN_EXTENT[2])
    return np.asarray(lip_line(MOUTH_SKIN_EXTENT[0] * np.cos(_ANGLE)) + reach * height)


def _lip_share(angle: Array = _ANGLE) -> Array:
    """Return the share of the jaw's rotation that moves the lips, (points,), 0…1."""
    return np.asarray(np.clip(0.5 - 0.6 * np.sin(angle), 0.0, 1.0))


def _on_skin(flat: Array, rest: Array, lift: Array | float) -> Array:
    """Return points of the skin at their rest depth, lifted off it [m]."""
    points = on_snout(flat[:, 0], rest[:, 1])
    points += np.reshape(lift, (-1, 1)) * _outward(points)
    points[:, 1] += flat[:, 1] - rest[:, 1]
    return points


def on_snout(side: Array, height: Array) -> Array:
    """Return the points on the front of the head at azimuths [rad] and heights [m], (n, 3)."""
    way = np.stack([np.sin(side), 0 * side, np.cos(side)], axis=-1)
    start = np.stack([0 * side, height, np.full(len(side), HEAD_AXIS_Z_M)], axis=-1)
    low, high = np.zeros(len(side)), np.full(len(side), 0.10)
    for _ in range(15):
        middle = 0.5 * (low + high)
        inside = head_shape().distance(start + way * middle[:, None]) < 0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.asarray(start + way * low[:, None])


def _outward(points: Array) -> Array:
    """Return the horizontal direction away from the axis of the head, (n, 3)."""
    away = (points - [0.0, 0.0, HEAD_AXIS_Z_M]) * [1.0, 0.0, 1.0]
    return np.asarray(away / np.linalg.norm(away, axis=1, keepdims=True))


def _cavity(edge: Array) -> tuple[list[Array], list[Array]]:
    """Return the rings from the lips to the throat, and the jaw's skin weight on each."""
    low = np.clip(-np.sin(_ANGLE), 0, 1)[:, None] ** 0.5
    high = np.clip(np.sin(_ANGLE), 0, 1)[:, None] ** 0.5
    deep = np.array([0.0, 1.0, 0.0]) * (0.003 * high - 0.0055 * low)
    gum = edge + (JAW_HINGE_M - edge) * 0.09
    inner = edge + (JAW_HINGE_M - edge) * 0.22 + deep
    throat = edge + (JAW_HINGE_M - edge) * 0.72 + 0.8 * deep
    end = np.tile(JAW_HINGE_M, (POINTS_PER_RING, 1))
    lip = _lip_share()
    return [gum, inner, throat, end], [lip, lip, 0.5 * lip, 0 * lip]


def _teeth(face: VleoExpression, bound: Skeleton) -> Mesh:
    """Return the upper teeth, a strip that hangs behind the lip and hides there."""
    arc = np.sin(np.linspace(-0.5, 0.5, 13) * np.pi)
    angle = np.arccos(0.8 * arc)
    line, edge = _lip_lines(angle, face)
    round_end = np.sqrt(1.0 - arc**2)
    middle = edge[:, 1] + (0.0014 if face.teeth == 0 else 0.0)
    tip = middle - face.teeth * round_end
    root = middle + (0.0016 if face.teeth else 0.0005) * round_end
    lip = on_snout(edge[:, 0], line[:, 1])
    lip += (0.7 * face.pout - 0.0016 - 0.002 * arc[:, None] ** 2) * _outward(lip)
    behind = lip - 0.0012 * round_end[:, None] * _outward(lip)
    ways = [(lip, root), (lip, tip), (behind, tip), (behind, root)]
    rings = np.stack([np.column_stack([p[:, 0], y, p[:, 2]]) for p, y in ways], axis=1)
    share = np.repeat(_lip_share(angle), 4)
    moved = rotate_with_jaw(rings.reshape(-1, 3), share, face).reshape(rings.shape)
    mesh = loft(moved, np.tile(TEETH, (*rings.shape[:2], 1)), "head", bound)
    # No light glances off the ends of the front.
    ahead = np.tile([0.0, 0.0, 1.0], (len(mesh.positions), 1))
    return blend_normals(mesh, ahead, np.tile([0.9, 0.9, 0.0, 0.0], len(arc)))


def _tongue(face: VleoExpression, bound: Skeleton) -> Mesh:
    """Return the tongue, which lies on the jaw and has a groove."""
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    polar = np.linspace(0, np.pi, 9)[:, None]
    x, z = np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn)
    ball = np.stack([x, np.cos(polar) + 0 * x, z], axis=-1)[::-1, ::-1]
    points = ball * [0.0180, 0.0060, 0.0195] + [0.0, 0.2082, 0.1560]
    groove = np.clip(ball[..., 1], 0, 1) * np.exp(-((points[..., 0] / 0.004) ** 2))
    points[..., 1] -= 0.0014 * groove
    flat = points.reshape(-1, 3)
    tip = np.clip((flat[:, 2] - 0.148) / 0.026, 0.0, 1.0)[:, None] ** 1.5
    flat = flat + tip * [0.0, face.tongue_up, face.tongue_out]
    moved = rotate_with_jaw(flat, 1.0 - 0.25 * np.clip((0.165 - flat[:, 2]) / 0.025, 0, 1), face)
    color = np.tile(ROSE, (*x.shape, 1))
    return loft(moved.reshape(points.shape), color, "jaw", bound)


def _bones(jaw: Array, bound: Skeleton) -> Array:
    weights = np.zeros((*jaw.shape, len(bound)))
    weights[..., bound.index("jaw")] = jaw
    weights[..., bound.index("head")] = 1 - jaw
    return weights


def _colors(rings: Array) -> Array:
    """Return the colour of each point: skin, lips, and the dark inside."""
    flat = rings.reshape(-1, 3)
    rest = np.asarray(skin_colors(flat, normals_of(head_shape().distance, flat, 0.003)))
    colors = rest.reshape(rings.shape).copy()
    first = 2 + len(_SKIN_RING_SHARES)
    colors[first : first + 3] = LIP
    colors[first + 3 :] = MAROON
    return colors
