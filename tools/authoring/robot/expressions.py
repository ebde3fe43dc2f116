"""The robot's expressions as morph targets, from its lids, jaw and lips in bind pose."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh, Morph
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.quadruped import AnimationTracks, solve_poses
from tools.authoring.robot.rig import set_lids, set_mouth

MIN_DISPLACEMENT_M = 2e-6
"""Vertices that move less are not part of a morph target [m]."""


def _surprised(face: AnimationTracks) -> None:
    set_lids(face, -0.16)
    set_mouth(face, 0.62, -0.35, 0.8)


def _relaxed(face: AnimationTracks) -> None:
    set_lids(face, 0.45, 0.2)
    set_mouth(face, 0.0, 0.45)


def _happy(face: AnimationTracks) -> None:
    set_lids(face, 0.0, 1.0)
    set_mouth(face, 0.45, 1.0)


def _angry(face: AnimationTracks) -> None:
    set_lids(face, 0.0, 0.3, 1.0)
    set_mouth(face, 0.12, -1.0)


def _sad(face: AnimationTracks) -> None:
    set_lids(face, 0.0, 0.15, -0.75)
    set_mouth(face, 0.0, -0.9)


EXPRESSIONS: dict[str, Callable[[AnimationTracks], None]] = {
    "blink": lambda face: set_lids(face, 1.0),
    "blinkLeft": lambda face: set_lids(face, 1.0, sides=("Left",)),
    "blinkRight": lambda face: set_lids(face, 1.0, sides=("Right",)),
    "happy": _happy,
    "angry": _angry,
    "sad": _sad,
    "surprised": _surprised,
    "relaxed": _relaxed,
    "aa": lambda face: set_mouth(face, 1.0),
}
"""Poses of the face, by VRM's name of the expression."""


def with_expressions(mesh: Mesh, bound: Skeleton) -> Mesh:
    """Return a bound mesh with a morph target for every expression."""
    morphs = [_morph(name, mesh, bound) for name in EXPRESSIONS]
    return replace(mesh, morphs=tuple(morph for morph in morphs if len(morph.vertices)))


def _morph(name: str, mesh: Mesh, bound: Skeleton) -> Morph:
    face = AnimationTracks(1)
    EXPRESSIONS[name](face)
    globals_ = solve_poses(face, bound, ()).globals(bound)[0]
    moved = skin(mesh, globals_) - mesh.positions
    # A normal rotates like the vector between its vertex and a point above it.
    needle = replace(mesh, positions=mesh.positions + mesh.normals)
    turned = skin(needle, globals_) - needle.positions - moved
    vertices = np.flatnonzero(np.abs(moved).max(axis=1) > MIN_DISPLACEMENT_M)
    return Morph(
        name,
        vertices.astype(np.uint32),
        moved[vertices].astype(np.float32),
        turned[vertices].astype(np.float32),
    )


def expression_names(meshes: Sequence[Mesh]) -> tuple[str, ...]:
    """Return the expressions for which a mesh has a morph target."""
    there = {morph.name for mesh in meshes for morph in mesh.morphs}
    return tuple(name for name in EXPRESSIONS if name in there)
