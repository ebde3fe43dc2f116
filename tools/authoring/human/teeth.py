"""The bundled explorer's teeth and tongue, which move with the lips and hide behind them."""

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.face import EXPRESSIONS, NEUTRAL, HumanExpression
from tools.authoring.human.mouth import lip_lines
from tools.authoring.human.skull import on_face
from tools.authoring.modelling.lathe import loft
from tools.authoring.modelling.meshes import blend_normals, morphed
from tools.authoring.modelling.shapes import linear_rgb

TONGUE = linear_rgb("#d9636a")
TONGUE_TIP = linear_rgb("#e8828a")
TEETH = linear_rgb("#fbf7ee")

TEETH_BEHIND_M, TEETH_THICK_M = 0.0045, 0.003
"""How far the teeth are behind the edge of the lips, and their thickness [m]."""

_COVERED_M = 0.005  # how far a row that does not show is behind its lip [m]
_ROW_M = {1.0: 0.006, -1.0: 0.001}  # height that the upper and the lower lip cover [m]
_HIDDEN_ROW_M = 0.001  # that of a row that does not show [m]
_ARC = np.sin(np.linspace(-0.5, 0.5, 13) * np.pi)


def teeth_and_tongue(skeleton: Skeleton) -> list[Mesh]:
    """Return both rows of teeth and the tongue with the morph targets of all expressions."""
    return [
        morphed(lambda face: _teeth(face, 1.0, skeleton), NEUTRAL, EXPRESSIONS),
        morphed(lambda face: _teeth(face, -1.0, skeleton), NEUTRAL, EXPRESSIONS),
        morphed(lambda face: _tongue(face, skeleton), NEUTRAL, EXPRESSIONS),
    ]


def _teeth(face: HumanExpression, up: float, skeleton: Skeleton) -> Mesh:
    """Return a row of teeth, a strip that hangs behind the upper lip or stands behind the lower."""
    angle = np.arccos(0.8 * _ARC)  # of the lip's points in front of them
    line, edge = lip_lines(angle * up, face)
    round_end = np.sqrt(1.0 - _ARC**2)
    shown = face.teeth if up > 0 else face.lower_teeth
    depth = on_face(edge[:, 0], line[:, 1])[:, 2] + 0.003 + 0.7 * face.pout - TEETH_BEHIND_M
    depth -= 0.006 * _ARC**2  # the arch of the teeth
    if up < 0:
        depth -= 0.006 + face.tuck
    middle = edge[:, 1] + up * (_COVERED_M if shown == 0 else 0.0)
    row = _ROW_M[up] if shown else _HIDDEN_ROW_M
    tip = middle - up * shown * round_end
    root = middle + up * row * round_end
    ends = [np.where(_ARC**2 == 1.0, middle, y) for y in (root, tip)]
    thick = TEETH_THICK_M * round_end
    front = [np.stack([edge[:, 0], y, depth], axis=-1) for y in ends]
    back = [np.stack([edge[:, 0], y, depth - thick], axis=-1) for y in ends[::-1]]
    rings = np.stack([*front, *back], axis=1)
    if up < 0:
        rings = rings[:, ::-1]
    mesh = loft(rings, np.tile(TEETH, (*rings.shape[:2], 1)), "head", skeleton)
    # No light glances off the ends of the front.
    ahead = np.tile([0.0, 0.0, 1.0], (len(mesh.positions), 1))
    front_side = [0.9, 0.9, 0.0, 0.0] if up > 0 else [0.0, 0.0, 0.9, 0.9]
    return blend_normals(mesh, ahead, np.tile(front_side, len(_ARC)))


def _tongue(face: HumanExpression, skeleton: Skeleton) -> Mesh:
    """Return the tongue, from its root to its tip."""
    line, edges = lip_lines(np.array([-0.5, 0.5]) * np.pi, face)
    floor, opening = edges[0, 1], float(edges[1, 1] - edges[0, 1])
    lips = float(on_face(np.zeros(()), line[0, 1])[2]) + 0.003 + face.pout
    along = np.array([0.0, 0.3, 0.6, 0.85, 1.0])
    depth = lips - 0.045 + (0.045 + face.tongue_out) * along
    height = floor - 0.006 + face.tongue * opening * np.array([0.8, 1.0, 0.9, 0.75, 0.7])
    height = height + face.tongue_tip * opening * along**3
    wide = 0.62 * face.width * np.array([0.7, 1.0, 0.95, 0.7, 0.0])
    thick = np.array([0.004, 0.006, 0.0055, 0.004, 0.0])
    turn = np.linspace(0, 2 * np.pi, 10, endpoint=False)
    x, y = wide[:, None] * np.cos(turn), height[:, None] + thick[:, None] * np.sin(turn)
    groove = 0.25 * thick[:, None] * np.exp(-((np.cos(turn) / 0.25) ** 2)) * (np.sin(turn) > 0)
    rings = np.stack([x, y - groove, np.broadcast_to(depth[:, None], x.shape)], axis=-1)
    root = np.tile([0.0, height[0], depth[0] - 0.004], (1, len(turn), 1))
    rings = np.concatenate([root, rings])
    colors = TONGUE + np.linspace(0, 1, len(rings))[:, None, None] ** 2 * np.subtract(
        TONGUE_TIP, TONGUE
    )
    colors = np.broadcast_to(colors, rings.shape)
    return loft(rings, colors, "head", skeleton)
