"""Morphs as differences: a piece is built once for each expression, and what moved is kept."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TypeVar

import numpy as np

from characters.model.mesh import Mesh, Morph

Expression = TypeVar("Expression")

_STILL = 2e-4  # [m]: what moves less is left where it is


def morphed(
    build: Callable[[Expression], Mesh],
    neutral: Expression,
    expressions: Mapping[str, Expression],
) -> Mesh:
    """Return the neutral piece with a morph to each expression in which it differs.

    Parameters
    ----------
    build : makes the piece of an expression; always with the same vertices in the same order
    """
    mesh = build(neutral)
    made = ((name, build(expression)) for name, expression in expressions.items())
    morphs = [morph for name, other in made if (morph := difference(name, mesh, other))]
    return replace(mesh, morphs=tuple(morphs))


def difference(name: str, mesh: Mesh, other: Mesh) -> Morph | None:
    """Return the morph from one mesh to another of the same triangles; None if they are alike."""
    displacements = other.positions - mesh.positions
    moved = np.flatnonzero(np.abs(displacements).max(axis=1) > _STILL)
    if not len(moved):
        return None
    turned = (other.normals - mesh.normals)[moved]
    return Morph(
        name,
        moved.astype(np.uint32),
        displacements[moved].astype(np.float32),
        turned.astype(np.float32),
    )
