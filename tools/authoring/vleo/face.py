"""Vleo's face: eyes, lids, brows and mouth, and the movement of the skin with them."""

from dataclasses import replace

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.meshes import morph_between
from tools.authoring.vleo.expressions import (
    EXPRESSIONS,
    VleoExpression,
    cheek_displacement,
    rotate_with_jaw,
)
from tools.authoring.vleo.eyes import eyes
from tools.authoring.vleo.mouth import mouth
from tools.authoring.vleo.skin import jaw_share


def face(bound: Skeleton) -> list[Mesh]:
    """Return all pieces of the face with their morphs, bound to the skeleton."""
    return [*eyes(bound), *mouth(bound)]


def with_expressions(mesh: Mesh, bound: Skeleton) -> Mesh:
    """Return a mesh of the skin, or of parts attached to it, with the face's morph targets."""
    head = [bound.index(joint) for joint in ("head", "jaw")]
    share = (mesh.weights * np.isin(mesh.joints, head)).sum(axis=1)
    made = ((name, _carried(mesh, expression, share)) for name, expression in EXPRESSIONS.items())
    morphs = [morph for name, other in made if (morph := morph_between(name, mesh, other))]
    return replace(mesh, morphs=tuple(morphs))


def _carried(mesh: Mesh, expression: VleoExpression, share: np.ndarray) -> Mesh:
    """Return the mesh moved by jaw and cheeks, each vertex by its share."""
    points = mesh.positions.astype(float)
    raised = points + cheek_displacement(points, expression) * share[:, None]
    moved = rotate_with_jaw(raised, share * jaw_share(points), expression)
    needles = rotate_with_jaw(raised + mesh.normals, share * jaw_share(points), expression)
    return replace(
        mesh,
        positions=moved.astype(np.float32),
        normals=(needles - moved).astype(np.float32),
    )
