from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Character, CharacterError, Clip, Mesh, Pose, Skeleton
from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Morph
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import build_arm
from tests.examples import examples


def load(tmp_path, build):
    (tmp_path / "arm.glb").write_bytes(build.bytes())
    return Character.load(tmp_path / "arm.glb")


def with_targets(*targets, names=None, weights=None):
    """The arm, with a morph target for each array of displacements, (3 vertices, 3)."""
    build = build_arm()
    mesh = build.document["meshes"][0]
    mesh["primitives"][0]["targets"] = [{"POSITION": build.floats(s, "VEC3")} for s in targets]
    if names:
        mesh["extras"] = {"targetNames": names}
    if weights:
        mesh["weights"] = weights
    return build


def lift(vertex, height):
    displacements = np.zeros((3, 3))
    displacements[vertex, 2] = height
    return displacements


def test_morph_targets_are_read_by_name_in_the_characters_frame(tmp_path):
    character = load(tmp_path, with_targets(lift(2, 100), lift(1, 50), names=["aa", "oh"]))
    assert character.morphs == ("aa", "oh")
    aa, oh = character.meshes[0].morphs
    assert aa.vertices.tolist() == [2]
    assert np.allclose(aa.displacements, [[0, 0.1, 0]], atol=1e-6)
    assert oh.vertices.tolist() == [1]
    rest = character.skeleton.rest.globals(character.skeleton)
    assert np.allclose(skin(character.meshes[0], rest, {"aa": 0.5})[2], [0, 0.65, 0], atol=1e-6)


def test_morph_targets_without_a_name_get_that_of_their_mesh(tmp_path):
    build = with_targets(lift(2, 1), lift(1, 1))
    assert load(tmp_path, build).morphs == ("mesh0.0", "mesh0.1")
    build.document["meshes"][0]["name"] = "Face"
    assert load(tmp_path, build).morphs == ("Face.0", "Face.1")


def test_meshes_with_equal_names_share_a_weight(tmp_path):
    build = with_targets(lift(2, 1), names=["blink"])
    build.document["nodes"].append({"name": "lid", "mesh": 0, "skin": 0})
    character = load(tmp_path, build)
    assert character.morphs == ("blink",)
    assert [mesh.morphs[0].name for mesh in character.meshes] == ["blink", "blink"]


def test_weights_are_animated_and_rest_at_what_the_mesh_says(tmp_path):
    build = with_targets(lift(2, 1), lift(1, 1), names=["a", "b"], weights=[0.25, 0])
    build.animate("LINEAR", [0.0, 1.0], [0, 0, 1, 0.5], "weights", node=3)
    character = load(tmp_path, build)
    assert character.skeleton.rest.morphs is not None
    assert character.skeleton.rest.morphs.tolist() == [0.25, 0]
    morphs = character.clips["a"].sample(0.5).morphs
    assert morphs is not None
    assert np.allclose(morphs, [0.5, 0.25])
    build.animate("LINEAR", [0.0, 1.0], np.tile([0, 0, 0, 1], (2, 1)))
    assert np.allclose(load(tmp_path, build).clips["a"].poses.morphs, [0.25, 0])


def test_cubic_weights_keep_their_tangents_apart(tmp_path):
    build = with_targets(lift(2, 1), lift(1, 1), names=["a", "b"])
    keys = [[0, 0], [0, 1], [0, 0], [0, 0], [1, 0], [0, 0]]  # in, value, out: of two keys
    build.animate("CUBICSPLINE", [0.0, 1.0], np.ravel(keys), "weights", node=3)
    morphs = load(tmp_path, build).clips["a"].poses.morphs
    assert morphs is not None
    assert np.allclose(morphs[[0, -1]], [[0, 1], [1, 0]])
    assert np.allclose(morphs.sum(1), 1)


def test_a_target_of_another_size_is_refused(tmp_path):
    build = with_targets(lift(2, 1)[:2], names=["aa"])
    with pytest.raises(
        CharacterError,
        match="morph target 'aa': has 2 displacements for 3 vertices",
    ):
        load(tmp_path, build)


def with_morphs(walker, *morphs):
    meshes = (replace(walker.meshes[0], morphs=morphs), *walker.meshes[1:])
    names = tuple(dict.fromkeys(morph.name for mesh in meshes for morph in mesh.morphs))
    return Character("m", walker.skeleton, {}, meshes, names)


@st.composite
def meshes_of_morphs(draw):
    """Some names in any order, and for each of two meshes the morphs out of them it has."""
    names = draw(st.lists(st.sampled_from(["aa", "oh", "blink", "happy"]), min_size=1, unique=True))
    numbers = st.floats(-1, 1, width=32).filter(lambda x: abs(x) > 1e-6)
    own: list[tuple[Morph, ...]] = []
    for chosen in (names, draw(st.lists(st.sampled_from(names), unique=True))):
        morphs = []
        for name in chosen:
            where = draw(st.lists(st.integers(0, 7), unique=True, max_size=8).map(sorted))
            rows = st.tuples(numbers, numbers, numbers)
            displacements = np.reshape([draw(rows) for _ in where], (-1, 3)).astype(np.float32)
            turns = displacements[::-1] if draw(st.booleans()) else None
            morphs.append(Morph(name, np.array(where, np.uint32), displacements, turns))
        own.append(tuple(morphs))
    return tuple(draw(st.permutations(names))), own


def block(names, own):
    """A block on one joint, once a row of morphs, with a clip that moves all of them."""
    shape = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1]), -1).reshape(8, 3).astype(np.float32)
    mesh = Mesh(
        name="block",
        positions=shape,
        normals=np.tile(np.array([0, 1, 0], np.float32), (8, 1)),
        triangles=np.array([[0, 1, 2], [3, 4, 5], [6, 7, 0]], np.uint32),
        joints=np.zeros((8, 4), np.uint16),
        weights=np.tile(np.array([1, 0, 0, 0], np.float32), (8, 1)),
        inverse_bind=np.eye(4)[None],
    )
    frames = Pose(np.zeros((5, 1, 3)), np.tile(rotations.IDENTITY, (5, 1, 1)))
    waves = np.sin(np.arange(5 * len(names))).reshape(5, -1)
    clip = Clip("talk", 30.0, replace(frames, morphs=waves))
    rest = replace(frames[0], morphs=np.linspace(1, 0, len(names)))
    meshes = tuple(replace(mesh, morphs=morphs) for morphs in own)
    return Character("block", Skeleton(("root",), (-1,), rest), {"talk": clip}, meshes, names)


@given(meshes_of_morphs())
@settings(max_examples=examples(25))
def test_morphs_survive_saving_and_loading(drawn):
    character = block(*drawn)
    names, own = drawn
    with TemporaryDirectory() as folder:
        path = Path(folder) / "block.glb"
        character.save(path)
        first, again = path.read_bytes(), Character.load(path)
        again.save(path)
        assert path.read_bytes() == first
    waves, rest = character.clips["talk"].poses.morphs, character.skeleton.rest.morphs
    assert again.morphs == names
    assert again.clips["talk"].poses.morphs == pytest.approx(waves, abs=1e-6)
    assert again.skeleton.rest.morphs == pytest.approx(rest, abs=1e-6)
    for mesh, morphs in zip(again.meshes, own, strict=True):
        assert same(mesh.morphs, morphs)


def same(loaded: tuple[Morph, ...], saved: tuple[Morph, ...]) -> bool:
    return len(loaded) == len(saved) and all(
        a.name == b.name
        and np.array_equal(a.vertices, b.vertices)
        and np.array_equal(a.displacements, b.displacements)
        and np.array_equal(np.array(a.normal_displacements), np.array(b.normal_displacements))
        for a, b in zip(loaded, saved, strict=True)
    )


def test_morphs_that_do_not_fit_are_not_written(tmp_path, walker):
    shift = np.ones((1, 3), np.float32)
    beyond = with_morphs(walker, Morph("aa", np.array([8], np.uint32), shift))
    with pytest.raises(CharacterError, match="'box': the arrays of its morph 'aa' do not fit"):
        beyond.save(tmp_path / "m.glb")
    unknown = replace(with_morphs(walker, Morph("aa", np.array([1], np.uint32), shift)), morphs=())
    with pytest.raises(CharacterError, match=r"'box': .* out of Character\.morphs"):
        unknown.save(tmp_path / "m.glb")
    idle = replace(walker, morphs=("aa",))
    with pytest.raises(CharacterError, match=r"aa: each must be .* a morph of some mesh"):
        idle.save(tmp_path / "m.glb")


def test_primitives_that_share_vertices_keep_their_own(tmp_path):
    build = with_targets(lift(2, 100), lift(0, 50), names=["aa", "oh"])
    mesh = build.document["meshes"][0]
    rows = [[0, 1, 0], [1, 2, 1]]  # edges seen as triangles: who uses which vertex is what counts
    mesh["primitives"] = [
        mesh["primitives"][0] | {"indices": build.add(np.array(row, np.uint16), "SCALAR", 5123)}
        for row in rows
    ]
    first, second = load(tmp_path, build).meshes
    assert [len(first.positions), len(second.positions)] == [2, 2]
    assert second.triangles.tolist() == [[0, 1, 0]]
    assert np.allclose(second.positions[1], [0, 0.6, 0], atol=1e-6)
    aa, oh = second.morphs
    assert (aa.vertices.tolist(), oh.vertices.tolist()) == ([1], [])
    assert first.morphs[1].vertices.tolist() == [0]
