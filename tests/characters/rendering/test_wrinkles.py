"""Wrinkles and blood of a face: exact at rest, each in its own place, true to displaced skin."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.face_maps import LAYER_NAMES, WRINKLE_LAYERS
from cubeling.characters.model.mesh import FaceMaps, ToonShading
from cubeling.characters.rendering import FULL, Quality, SceneCharacter
from cubeling.characters.rendering.geometry.face_texture import WrinkleMixer
from tests.characters.rendering.wrinkle_reference import agreement
from tests.examples import some

LAYERS = len(LAYER_NAMES)
MORPHS = tuple(
    f"AU{unit}{side}"
    for unit, layers in WRINKLE_LAYERS.items()
    for side in ("", "Left", "Right")[len(layers) - 1 :][: len(layers)]
)
CELL_PX = 24
"""Every layer of the tile has a cell of its own, 4 × 3, with a groove in its middle."""


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


@pytest.fixture(scope="module")
def human_maps(human):
    return next(mesh.material.face for mesh in human.meshes if mesh.material.face is not None)


@pytest.fixture(scope="module")
def cells():
    heights = np.zeros((LAYERS, 3 * CELL_PX, 4 * CELL_PX), np.float32)
    for layer in range(LAYERS):
        top, left = CELL_PX * (layer // 4), CELL_PX * (layer % 4)
        heights[layer, top + 8 : top + 16, left + 8 : left + 16] = -1.0
    blood = np.zeros(heights.shape[1:], np.float32)
    blood[2 : CELL_PX - 2, 2 : CELL_PX - 2] = 1.0
    return FaceMaps(heights, blood, 0.05)


@pytest.fixture(scope="module")
def tile(pawn, cells):
    """Return a square on the table, one metre wide, with a morph for each layer."""
    corners = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)]) / 2
    base = pawn.meshes[0]
    mesh = replace(
        base,
        positions=np.insert(corners, 1, 0.02, axis=1).astype(np.float32),
        normals=np.tile([0.0, 1.0, 0.0], (4, 1)).astype(np.float32),
        triangles=np.array([(0, 1, 2), (0, 2, 3)], np.uint32),
        joints=np.zeros((4, 4), np.uint16),
        weights=np.tile([1.0, 0.0, 0.0, 0.0], (4, 1)).astype(np.float32),
        uvs=(corners + 0.5).astype(np.float32),
        material=replace(base.material, face=cells),
    )
    return replace(pawn, meshes=(mesh,), morphs=MORPHS)


@pytest.fixture
def shown(stage, view, pawn, tile):
    def draw(character=tile, blood=0.0, wrinkles=True, **weights):
        posed: PosedCharacter = pawn.posed().posed
        morphs = np.array([weights.get(name, 0.0) for name in character.morphs])
        posed = replace(posed, pose=replace(posed.pose, morphs=morphs))
        drawn = SceneCharacter(character, posed, wrinkles, blood)
        return stage.draw(view, [drawn]).astype(int)

    return draw


def changed_cells(view, before, after):
    """Return the numbers of the cells of the tile in which two pictures differ."""
    rows, columns = np.nonzero(np.abs(after - before).max(axis=2))
    pixels = np.stack([columns, rows, np.ones_like(rows)]).astype(float)
    rays = np.linalg.inv(view.matrix) @ pixels
    table = view.camera_from_table
    ways, eye = table[:3, :3].T @ rays, -table[:3, :3].T @ table[:3, 3]
    height = 0.12  # of the pawn on the table [m]; the tile lies at 0.02 of it
    points = eye[:, None] + ways * ((0.02 * height - eye[1]) / ways[1])
    u, v = points[0] / height + 0.5, points[2] / height + 0.5
    return set((np.floor(3 * v) * 4 + np.floor(4 * u)).astype(int).tolist())


def test_without_intensity_the_picture_is_the_same_bit_for_bit(shown, tile):
    material = replace(tile.meshes[0].material, face=None)
    plain = replace(tile, meshes=(replace(tile.meshes[0], material=material),))
    assert np.array_equal(shown(tile), shown(plain))
    assert np.array_equal(shown(tile, wrinkles=False, AU1=1.0), shown(plain))


def test_the_bundled_human_at_rest_is_the_same_bit_for_bit(stage, view, human):
    smooth = [replace(m, material=replace(m.material, face=None)) for m in human.meshes]
    at_rest = replace(human.skeleton.rest, morphs=np.zeros(len(human.morphs)))
    place = np.diag([0.09, 0.09, 0.09, 1.0])
    posed = PosedCharacter(at_rest, place, True, "", 0.0, 0.0, 0.0, 0.0)
    pictures = [
        stage.draw(view, [SceneCharacter(each, posed)])
        for each in (human, replace(human, meshes=tuple(smooth)))
    ]
    assert np.array_equal(*pictures)


@pytest.mark.parametrize("layer", some(range(LAYERS), 3))
def test_a_unit_changes_the_pixels_of_its_layer_alone(shown, view, layer):
    assert changed_cells(view, shown(), shown(**{MORPHS[layer]: 1.0})) == {layer}


def test_raised_brows_change_the_three_layers_of_the_forehead(shown, view):
    raised = shown(AU1=1.0, AU2Left=1.0, AU2Right=1.0)
    assert changed_cells(view, shown(), raised) == {0, 1, 2}


def test_deferred_shading_draws_the_same_face(stage, view, shown):
    forward = [shown(), shown(AU4=1.0, blood=1.0)]
    stage.quality = Quality("deferred", FULL.fineness, FULL.matched, deferred=True)
    for picture, weights in zip(forward, ({}, {"AU4": 1.0, "blood": 1.0}), strict=True):
        assert np.abs(shown(**weights) - picture).max() <= 1
    assert changed_cells(view, *forward) == {0, 3}


def test_blood_changes_the_pixels_of_its_mask_alone(shown, view):
    for blood in (-1.0, 1.0):
        assert changed_cells(view, shown(), shown(blood=blood)) == {0}


def test_wrinkles_grow_with_their_intensity(ctx, human_maps):
    bends = [
        agreement(ctx, human_maps, share * np.ones(LAYERS), grid=(240, 120)).bumped_deg
        for share in (0.0, 0.3, 0.6, 1.0)
    ]
    assert bends[0] < 1e-3
    assert np.all(np.diff(bends) > 0.5)


def test_layers_are_composed_again_only_for_a_visible_change(human_maps):
    mixer = WrinkleMixer(human_maps)
    assert mixer.compose(np.full(LAYERS, 0.5)) is not None
    before = mixer.texels.copy()
    assert mixer.compose(np.full(LAYERS, 0.503)) is None
    assert np.array_equal(mixer.texels, before)
    assert mixer.compose(np.full(LAYERS, 0.52)) is not None


@pytest.mark.parametrize("yaw_deg", some([40.0, -60.0]))
def test_normals_are_those_of_displaced_skin(ctx, human_maps, yaw_deg):
    found = agreement(ctx, human_maps, np.ones(LAYERS), np.deg2rad(yaw_deg), shifted=False)
    assert found.bend_deg > 8.0  # the wrinkles are there to be seen
    assert found.mean_deg < 1.0


@pytest.mark.parametrize("units", some([[4, 6, 12], [1, 2], [10, 20]]))
def test_pixels_are_those_of_displaced_skin_seen_from_in_front(ctx, human_maps, units):
    intensities = np.zeros(LAYERS)
    intensities[[layer for unit in units for layer in WRINKLE_LAYERS[unit]]] = 1.0
    assert agreement(ctx, human_maps, intensities).mean_deg < 3.0


def test_furrows_that_cross_are_hardly_deeper_than_one():
    """Two straight furrows of two units cross in the middle of the map."""
    across = np.abs(np.arange(96) - 47.5)
    furrow = -np.exp(-0.5 * (across / 3.0) ** 2).astype(np.float32)
    heights = np.zeros((LAYERS, 96, 96), np.float32)
    heights[0], heights[3] = furrow[:, None], furrow[None, :]
    mixer = WrinkleMixer(FaceMaps(heights, np.zeros((96, 96), np.float32), 0.001))
    shares = np.zeros(LAYERS)
    shares[[0, 3]] = 1.0
    mixer.compose(shares)
    slopes = mixer.texels[..., :2] / 96.0
    # Depth along the first furrow, by the slopes from its end to the crossing.
    along = slopes[47, :48, 0].cumsum()
    assert along[-1] == pytest.approx(1.0 - 2.0**0.25, abs=0.03)
    beside = slopes[:48, 10, 1].cumsum()  # across it, away from the crossing
    assert beside[-1] == pytest.approx(-1.0, abs=0.06)


MATERIALS: dict[str, dict[str, Any]] = {
    "textured": {"base_color_texture": np.full((4, 4, 4), 200, np.uint8)},
    "bumped": {"normal_texture": np.full((4, 4, 3), (128, 128, 255), np.uint8)},
    "cut": {"alpha_cutoff": 0.5},
    "toon": {"toon": ToonShading((0.5, 0.4, 0.3), toony=0.2)},
}


@pytest.mark.parametrize("kind", some(MATERIALS, 2))
def test_any_material_can_have_a_face(shown, view, tile, kind):
    mesh = tile.meshes[0]
    changed = replace(mesh, material=replace(mesh.material, **MATERIALS[kind]))
    other = replace(tile, meshes=(changed,))
    assert changed_cells(view, shown(other), shown(other, AU4=1.0)) == {3}
    assert changed_cells(view, shown(other), shown(other, blood=1.0)) == {0}


def test_wrinkles_narrower_than_a_pixel_are_left_out(shown, tile, cells):
    mesh = tile.meshes[0]
    face = replace(cells, depth=0.1 * cells.depth)  # of the tile, whose pixels are a hundredth wide
    shallow = replace(tile, meshes=(replace(mesh, material=replace(mesh.material, face=face)),))
    assert not np.array_equal(shown(AU4=1.0), shown())
    assert np.array_equal(shown(shallow, AU4=1.0), shown(shallow))


def test_blood_reddens_and_pales_in_steps(shown):
    reds = []
    for blood in (-1.0, -0.5, 0.0, 0.5, 1.0):
        picture = shown(blood=blood)
        reds.append(float((picture[..., 2] - picture[..., 1]).mean()))
    assert np.all(np.diff(reds) > 0.0)
