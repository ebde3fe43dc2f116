"""The bundled explorer's mouth: lips and cavity."""

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.face import (
    EXPRESSIONS,
    MOUTH_CENTRE_M,
    NEUTRAL,
    HumanExpression,
    skin_displacement,
)
from tools.authoring.human.skull import (
    MAROON,
    SKIN,
    complexion,
    face_normals,
    on_face,
    skin_normals,
)
from tools.authoring.modelling.lathe import loft
from tools.authoring.modelling.meshes import blend_normals, morphed
from tools.authoring.modelling.sculpt import coated
from tools.authoring.modelling.shapes import Array, linear_rgb

LIP = linear_rgb("#a8443c")
LIP_LINE = linear_rgb("#64201f")

POINTS_PER_RING = 40
"""Points around the mouth."""

MOUTH_SKIN_EXTENT_M = (0.112, 0.038, 0.054)
"""Half width, upward and downward extent of the skin around the mouth [m]."""

CAVITY_RINGS = 5
"""Rings of points behind the lips."""

_LIP_WIDTH_M = 0.0085  # how broad they are [m]


def mouth(skeleton: Skeleton) -> Mesh:
    """Return the mouth with the morph targets of expressions and visemes."""
    neutral = _mouth(NEUTRAL, skeleton)
    normals = skin_normals(neutral.positions.astype(float))
    normals[-CAVITY_RINGS * POINTS_PER_RING :] = [0.0, 0.0, 1.0]  # no light glances off the inside
    return morphed(
        lambda face: blend_normals(_mouth(face, skeleton), normals, _skin_share()),
        NEUTRAL,
        EXPRESSIONS,
    )


def _skin_share() -> Array:
    """Return how far each point has the normal of the face, 0…1: wholly at the rim."""
    share = np.repeat(
        [[0], [0], [1.0], [0.9], [0.5], [0.15], [0], [0], [0], *[[0.6]] * CAVITY_RINGS],
        POINTS_PER_RING,
        axis=1,
    )
    # The rings meet at the corners, where triangles are slivers that would glint.
    corner = np.cos(np.linspace(0, 2 * np.pi, POINTS_PER_RING, endpoint=False)) ** 6
    share[2:9] += (0.9 - share[2:9]).clip(0.0) * corner
    return share.ravel()


def _mouth(face: HumanExpression, skeleton: Skeleton) -> Mesh:
    """Return a closed surface from a pole in the head over skin and lips to the throat."""
    angle = np.linspace(0, 2 * np.pi, POINTS_PER_RING, endpoint=False)
    edge, lips, *skin = _skin_rings(angle, face)
    under = skin[-1] - [0.0, 0.0, 0.006]
    behind = np.tile([0.0, MOUTH_CENTRE_M[1], 0.05], (POINTS_PER_RING, 1))
    rings = np.stack([behind, under, *skin[::-1], lips, lips, edge, *_cavity(edge, angle)])
    return loft(rings, _colors(rings), "head", skeleton)


def _skin_rings(angle: Array, face: HumanExpression) -> list[Array]:
    """Return the edge of the lips, their border, and the skin around out to the rim."""
    height = np.sin(angle)
    line, edge = lip_lines(angle, face)
    reach = np.where(height >= 0, MOUTH_SKIN_EXTENT_M[1], MOUTH_SKIN_EXTENT_M[2])
    outer = MOUTH_CENTRE_M + np.stack(
        [MOUTH_SKIN_EXTENT_M[0] * np.cos(angle), reach * height], axis=-1
    )
    away = outer - edge
    away[:, 1] -= face.jaw * np.clip(-height, 0.0, 1.0)
    lips = edge + away / np.linalg.norm(away, axis=1, keepdims=True) * (_LIP_WIDTH_M - face.press)
    full = np.abs(height) ** 0.5
    rings = [
        _on_skin(edge, line, 0.002 + 0.002 * full + face.pout, face, 0.0),
        _on_skin(lips, line, 0.0015 + 0.005 * full + face.pout, face, 0.0),
    ]
    drawn_in = face.tuck * np.clip(-height, 0.0, 1.0) ** 0.5
    for ring, share in zip(rings, (1.0, 0.6), strict=True):
        ring[:, 2] -= share * drawn_in
    for s in (0.25, 0.5, 0.75, 1.0):  # the rim dips under the face, so that no step is visible
        flat, rest = lips + (outer - lips) * s, line + (outer - line) * s
        lift = (0.0015 if s < 1 else -0.0015) + face.pout * (1 - s) ** 2 + 0 * full
        rings.append(_on_skin(flat, rest, lift, face, s))
    return rings


def lip_lines(angle: Array, face: HumanExpression) -> tuple[Array, Array]:
    """Return the line where closed lips meet, and their edges, (points, 2) each."""
    x, height = np.cos(angle), np.sin(angle)
    line = MOUTH_CENTRE_M[1] + face.smile * (x * x - 0.4)
    bow = np.abs(height) ** face.square
    y = line + np.where(height >= 0, face.rise, -face.drop) * bow
    across = MOUTH_CENTRE_M[0] + face.width * x
    return np.stack([across, line], axis=-1), np.stack([across, y], axis=-1)


def _on_skin(flat: Array, rest: Array, lift: Array, face: HumanExpression, share: float) -> Array:
    """Return points of the skin at their rest depth, moved by `share` of the jaw's movement."""
    points = on_face(flat[:, 0], rest[:, 1])
    normals = face_normals(points)
    points += lift[:, None] * (normals + [0.0, 0.0, 1.0]) / 2 + share * skin_displacement(
        points, face
    )
    points[:, 1] += flat[:, 1] - rest[:, 1]
    return points


def _cavity(edge: Array, angle: Array) -> list[Array]:
    """Return the rings behind the lips: gums, the throat, and the end."""
    middle = np.array([0.0, edge[:, 1].mean(), 0.0])
    deep = np.zeros_like(edge)  # shallow at the corners, where the skull is near
    deep[:, 2] = 0.25 + 0.75 * np.abs(np.sin(angle)) ** 0.8
    gum = edge - 0.005 * deep
    inner = (edge - middle) * [0.94, 1.0, 1.0] + middle - 0.011 * deep
    throat = (edge - middle) * [0.75, 0.8, 1.0] + middle - 0.034 * deep
    end = np.tile([0.0, edge[:, 1].mean(), edge[:, 2].max() - 0.046], (len(edge), 1))
    return [gum, gum, inner, throat, end]


def _colors(rings: Array) -> Array:
    """Return the colour of each point: skin, lips, the line between them, and the inside."""
    colors = np.tile(SKIN, (*rings.shape[:2], 1))
    coats = coated(rings.reshape(-1, 3), colors.reshape(-1, 3), complexion())
    colors = np.asarray(coats).reshape(colors.shape)
    inside, rim, edge, lip = range(-4, -8, -1)
    colors[inside:] = MAROON
    colors[[rim, edge]] = LIP_LINE
    colors[lip] = LIP
    return np.asarray(colors)
