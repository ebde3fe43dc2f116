"""Morphs on the graphics card: they move vertices, and leave no trace at weight zero."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.character import skin
from cubeling.characters.model.mesh import Material, Morph
from cubeling.characters.rendering import SceneCharacter
from cubeling.characters.rendering.geometry.morph_mixer import MorphMixer
from cubeling.characters.rendering.geometry.skinned_character import SkinnedCharacter
from cubeling.characters.rendering.geometry.vertices import CharacterVertices
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.examples import examples

NAMES = ("grin", "absent", "tall")


@pytest.fixture(scope="module")
def jester(pawn):
    """Return a pawn with another of a different colour in it, and morphs on both and on one."""
    mesh = pawn.meshes[0]
    every = np.arange(len(mesh.positions), dtype=np.uint32)
    head = every[mesh.positions[:, 1] > 0.7]
    waves = np.sin(mesh.positions[head] @ np.array([[9.0, 2.0, 4.0], [3, 8, 1], [5, 1, 7]]))
    grin = Morph("grin", head, *np.array([0.1 * waves, 0.6 * waves[:, ::-1]], np.float32))
    tip = every[mesh.positions[:, 1] > 0.9]
    tall = Morph("tall", tip, np.tile([[0.0, 0.4, 0.0]], (len(tip), 1)).astype(np.float32))
    other = replace(mesh, material=Material(base_color=(0.1, 0.1, 0.8, 1.0)), morphs=(grin,))
    return replace(pawn, meshes=(replace(mesh, morphs=(tall, grin)), other), morphs=NAMES)


@pytest.fixture
def on_card(ctx, jester):
    programs = ShaderPrograms(ctx)
    character = SkinnedCharacter(ctx, programs, jester)
    target = ctx.framebuffer([ctx.renderbuffer((4, 4), 4)])
    target.use()
    yield character
    ctx.detect_framebuffer(0).use()
    for owned in (target, character, programs):
        owned.release()


def corners(on_card, geometry):
    """Return position and normal of every corner of every triangle, mesh after mesh."""
    return np.frombuffer(on_card.skinned.read(), np.float32).reshape(-1, 6)[geometry.indices]


@pytest.mark.parametrize("weights", [(0, 0, 0), (1, 0, 0), (0.5, 9, 0.25), (-0.3, 0, 1.2)])
def test_the_card_morphs_and_skins_as_the_processor_does(on_card, jester, weights):
    joints = jester.posed(bend=0.6).posed.pose.globals(jester.skeleton)
    on_card.skin(joints, np.eye(4), np.array(weights, float))
    drawn = corners(on_card, CharacterVertices.of(jester.meshes))[:, :3]
    by_name = dict(zip(NAMES, weights, strict=True))
    placed = [skin(mesh, joints, by_name)[mesh.triangles.ravel()] for mesh in jester.meshes]
    assert np.abs(drawn - np.concatenate(placed)).max() < 1e-5


def test_normals_are_morphed_too(on_card, jester):
    joints = np.tile(np.eye(4), (2, 1, 1))
    binds = jester.meshes[0].inverse_bind
    on_card.skin(np.linalg.inv(binds) @ joints, np.eye(4), np.array([0.8, 0.0, 0.0]))
    mesh = jester.meshes[1]
    leant = mesh.normals.astype(float)
    leant[mesh.morphs[0].vertices] += 0.8 * mesh.morphs[0].normal_displacements
    leant /= np.linalg.norm(leant, axis=1, keepdims=True)
    drawn = corners(on_card, CharacterVertices.of(jester.meshes))[mesh.triangles.size :, 3:]
    assert np.abs(drawn - leant[mesh.triangles.ravel()]).max() < 1e-4


def test_a_morph_that_returns_to_zero_leaves_no_trace(stage, view, jester):
    actor = jester.posed(bend=0.2)

    def shown(weights):
        morphs = None if weights is None else np.array(weights, float)
        posed = replace(actor.posed, pose=replace(actor.posed.pose, morphs=morphs))
        return stage.draw(view, [SceneCharacter(jester, posed)])

    without = shown(None)
    on = shown([0.7, 0.0, 1.0])
    assert np.abs(on.astype(int) - without).max() > 60
    assert np.array_equal(shown([0.0, 0.0, 0.0]), without)
    assert np.array_equal(shown([0.7, 0.0, 1.0]), on)
    assert np.array_equal(shown(None), without)
    assert np.array_equal(shown([np.nan, 0.0, 0.0]), view.image)


def test_only_the_moved_vertices_are_uploaded(jester):
    geometry = CharacterVertices.of(jester.meshes)
    morphing = MorphMixer(geometry.shape_records[: geometry.moved], geometry.morphs, NAMES)
    touched = sum(len(mesh.morphs[-1].vertices) for mesh in jester.meshes)
    assert geometry.moved == touched < 0.4 * len(geometry.positions)
    assert morphing.mix(None) is None
    mixed = morphing.mix(np.array([0.0, 0.0, 0.5]))
    assert mixed is not None
    assert mixed.shape == (touched, 6)
    assert morphing.mix(np.array([0.0, 0.0, 0.5])) is None


def test_weights_of_another_character_are_refused_in_one_line(stage, view, jester):
    actor = jester.posed()
    posed = replace(actor.posed, pose=replace(actor.posed.pose, morphs=np.zeros(2)))
    with pytest.raises(CharacterError, match=r"morphs of shape \(2,\)"):
        stage.draw(view, [SceneCharacter(jester, posed)])


@settings(max_examples=examples(20), deadline=None)
@given(grin=st.floats(0, 1), tall=st.floats(0, 1), bend=st.floats(-1.5, 1.5))
def test_the_extreme_vertices_bound_morphed_shapes_too(jester, grin, tall, bend):
    geometry = CharacterVertices.of(jester.meshes)
    shape = geometry.positions.copy()
    morphing = MorphMixer(geometry.shape_records[: geometry.moved], geometry.morphs, NAMES)
    mixed = morphing.mix(np.array([grin, 0.0, tall]))
    if mixed is not None:
        shape[: geometry.moved] = mixed[:, :3]
    palette = geometry.palette(jester.posed(bend).posed.pose.globals(jester.skeleton))
    outline = geometry.extreme()
    every = geometry.skin(palette, slice(None), shape)
    some = geometry.skin(palette, outline, shape[outline])
    assert np.abs(some.min(axis=0) - every.min(axis=0)).max() < 0.05
    assert np.abs(some.max(axis=0) - every.max(axis=0)).max() < 0.05
