"""Pieces built once for each expression become one mesh with morphs."""

import numpy as np
import pytest

from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import loft
from tools.authoring.modelling.meshes import join, mirrored_mesh, morphed
from tools.authoring.modelling.rig import build_skeleton

pytestmark = pytest.mark.full


@pytest.fixture(scope="module")
def skeleton() -> Skeleton:
    joints = {"root": ("", (0.0, 0.0, 0.0)), "LeftEye": ("root", (1.0, 0.0, 0.0))}
    return build_skeleton({name: (parent, at) for name, (parent, at) in joints.items()})


def drum(skeleton: Skeleton, height: float) -> Mesh:
    """Return a drum whose upper rim lies so high."""
    angle = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    up = np.array([0.0, 0.0, height])
    rings = np.stack([0 * circle, circle, circle + up, 0 * circle + up])
    return loft(rings, np.ones((4, 8, 3)), "LeftEye", skeleton)


def test_a_morph_is_what_an_expression_moves(skeleton: Skeleton) -> None:
    mesh = morphed(lambda h: drum(skeleton, h), 1.0, {"low": 0.2, "same": 1.0})
    assert [morph.name for morph in mesh.morphs] == ["low"]
    rest = skeleton.rest.globals(skeleton)
    assert np.allclose(skin(mesh, rest, {"low": 1.0}), drum(skeleton, 0.2).positions, atol=1e-6)
    assert len(mesh.morphs[0].vertices) == 16


def test_joined_meshes_move_together_by_the_name_of_a_morph(skeleton: Skeleton) -> None:
    one = morphed(lambda h: drum(skeleton, h), 1.0, {"low": 0.2})
    two = morphed(lambda h: drum(skeleton, h), 1.0, {"high": 2.0, "low": 0.4})
    mesh = join("both", [one, two])
    assert [morph.name for morph in mesh.morphs] == ["low", "high"]
    assert all((np.diff(morph.vertices.astype(int)) > 0).all() for morph in mesh.morphs)
    moved = skin(mesh, skeleton.rest.globals(skeleton), {"low": 1.0})
    assert moved[: len(one.positions), 2].max() == pytest.approx(0.2)
    assert moved[len(one.positions) :, 2].max() == pytest.approx(0.4)


def test_a_reflected_mesh_faces_outward_and_hangs_on_the_other_side(skeleton: Skeleton) -> None:
    mesh = mirrored_mesh(drum(skeleton, 1.0), skeleton)
    corners = mesh.positions[mesh.triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((flat * mesh.normals[mesh.triangles].mean(axis=1)).sum(axis=1) > 0).all()
    assert {skeleton.names[joint] for joint in mesh.joints[:, 0]} == {"RightEye"}
