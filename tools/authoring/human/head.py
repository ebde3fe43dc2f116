"""The bundled explorer's head: skull, hair and brows."""

from dataclasses import replace
from functools import partial

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.eyes import eyelids
from tools.authoring.human.face import (
    EXPRESSIONS,
    MOUTH_CENTRE_M,
    NEUTRAL,
    HumanExpression,
    skin_displacement,
)
from tools.authoring.human.face_map import mapped
from tools.authoring.human.hair import HAIR, cowlick, hair_parts
from tools.authoring.human.mouth import MOUTH_SKIN_EXTENT_M, mouth
from tools.authoring.human.skull import (
    SKIN,
    complexion,
    face_normals,
    head_shape,
    lining,
    on_face,
    skin_normals,
)
from tools.authoring.human.teeth import teeth_and_tongue
from tools.authoring.modelling.curves import smoothstep
from tools.authoring.modelling.meshes import averaged_normals, morphed
from tools.authoring.modelling.sculpt import BodyPart, sculpt
from tools.authoring.modelling.shapes import Array, RoundCone
from tools.authoring.modelling.tube import tube

BROW_LINE_M = ((0.032, 1.541), (0.060, 1.550), (0.094, 1.547), (0.136, 1.524))
"""x and y of the left brow from its inner to its outer end [m]."""

SKULL_DEPTH_M = 0.014
"""How far the skull is drawn back behind the skin of the mouth, so that it never shows [m]."""

BROW_RADII_M = (0.0105, 0.0145, 0.013, 0.006)


def head_pieces(skeleton: Skeleton) -> list[Mesh]:
    """Return the head without the eyeballs, with the morph targets of its face."""
    skull = sculpt(
        "", [BodyPart(head_shape(), 0.024, (*complexion(), *lining()), soft_skin=0.0)], skeleton
    )
    rest = _behind_the_mouth(skull.positions.astype(float))
    skull = replace(
        skull,
        positions=rest.astype(np.float32),
        normals=skin_normals(skull.positions.astype(float)).astype(np.float32),
    )

    def moved(face: HumanExpression) -> Mesh:
        shifted = rest + skin_displacement(rest, face)
        return replace(skull, positions=shifted.astype(np.float32))

    neck = RoundCone(
        (0, 1.15, -0.014), (0, 1.29, 0.0), 0.062, 0.066, bones=("neck", "head"), color=SKIN
    )
    locks = sculpt("", hair_parts(), skeleton)
    # The gradient jumps where locks meet, which would glint; the mesh's own normals do not.
    even = averaged_normals(locks.positions.astype(float), locks.triangles.astype(np.int64))
    brows = [
        morphed(partial(_brow, sign=sign, skeleton=skeleton), NEUTRAL, EXPRESSIONS)
        for sign in (1.0, -1.0)
    ]
    return [
        mapped(morphed(moved, NEUTRAL, EXPRESSIONS)),
        sculpt("", [BodyPart(neck, 0.04, soft_skin=0.02)], skeleton),
        replace(locks, normals=even.astype(np.float32)),
        *cowlick(skeleton),
        *map(mapped, eyelids(skeleton)),
        mapped(mouth(skeleton)),
        *teeth_and_tongue(skeleton),
        *brows,
    ]


def _behind_the_mouth(points: Array) -> Array:
    """Return points of the skull, drawn back where the skin of the mouth lies over them."""
    off = points[:, :2] - MOUTH_CENTRE_M
    wide, up, down = MOUTH_SKIN_EXTENT_M
    off /= np.column_stack([np.full(len(off), wide), np.where(off[:, 1] > 0, up, down)])
    covered = smoothstep((0.95 - np.linalg.norm(off, axis=1)) / 0.25) * (points[:, 2] > 0.05)
    return np.asarray(points - SKULL_DEPTH_M * covered[:, None] * face_normals(points))


def _brow(face: HumanExpression, sign: float, skeleton: Skeleton) -> Mesh:
    """Return one brow, a tube on the forehead."""
    x, y = np.array(BROW_LINE_M).T
    inner = np.array([1.0, 0.55, 0.15, 0.0])
    arch = np.array([0.0, 0.7, 1.0, 0.0])
    flat_x = x - face.knit * (0.4 + 0.6 * inner)
    flat_y = y + face.brow + face.brow_inner * inner + face.brow_arch * arch
    line: Array = on_face(flat_x, flat_y)
    line += 0.004 * face_normals(line)
    return tube(line * [sign, 1.0, 1.0], BROW_RADII_M, HAIR, "head", skeleton, 7, 10)
