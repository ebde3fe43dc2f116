"""Textures of a material: a uniform one equals the corresponding factor or normal."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.model.mesh import Material, Mesh, ToonShading
from cubeling.characters.rendering import SceneCharacter
from cubeling.characters.rendering.camera_picture.light import TO_LIGHT, Light, LightEstimator
from cubeling.characters.rendering.geometry.surfaces import surface_features
from cubeling.characters.rendering.geometry.vertices import CharacterVertices

RED = Material(base_color=(0.6, 0.1, 0.08, 1.0), roughness=0.5)


def even(*channels):
    """Return a map of 8×8 texels of one value."""
    return np.tile(np.array(channels, np.uint8), (8, 8, 1))


@pytest.fixture(scope="module")
def tile(pawn):
    """Make a square that lies on the table, one metre wide, with the joints of the pawn."""

    def make(material, normal=(0.0, 1.0, 0.0), uv_of_xz=((1.0, 0.0), (0.0, 1.0)), alpha=1.0):
        corners = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)]) / 2
        bind = pawn.meshes[0].inverse_bind
        mesh = Mesh(
            name="tile",
            positions=np.insert(corners, 1, 0.02, axis=1).astype(np.float32),
            normals=np.tile(normal, (4, 1)).astype(np.float32),
            triangles=np.array([(0, 1, 2), (0, 2, 3)], np.uint32),
            joints=np.zeros((4, 4), np.uint16),
            weights=np.tile([1.0, 0.0, 0.0, 0.0], (4, 1)).astype(np.float32),
            inverse_bind=bind,
            colors=np.tile([1.0, 1.0, 1.0, alpha], (4, 1)).astype(np.float32),
            uvs=(corners @ np.array(uv_of_xz).T + 0.5).astype(np.float32),
            material=material,
        )
        return replace(pawn, meshes=(mesh,))

    return make


@pytest.fixture
def shown(stage, view, pawn):
    """Draw a character at a place of its own, as whole numbers with a sign."""

    def draw(character):
        return stage.draw(view, [SceneCharacter(character, pawn.posed().posed)]).astype(int)

    return draw


def test_a_plain_material_has_no_features():
    assert surface_features(RED) == frozenset()


def test_maps_of_roughness_and_metalness_multiply_the_factors(shown, tile):
    factors = shown(tile(replace(RED, metallic=0.4, roughness=0.3)))
    mapped = replace(
        RED, metallic=0.8, roughness=0.6, metallic_roughness_texture=even(77, 128, 128)
    )
    assert np.abs(shown(tile(mapped)) - factors).max() <= 1
    assert np.abs(shown(tile(RED)) - factors).max() > 10


def test_a_map_of_emission_multiplies_it(shown, tile):
    glow = shown(tile(replace(RED, emissive=(0.2, 0.2, 0.05))))
    mapped = replace(RED, emissive=(0.8, 0.4, 0.1), emissive_texture=even(137, 188, 188))
    assert np.abs(shown(tile(mapped)) - glow).max() <= 1
    assert np.abs(shown(tile(RED)) - glow).max() > 10
    dark = replace(RED, emissive=(0.8, 0.4, 0.1), emissive_texture=even(0, 0, 0))
    assert np.array_equal(shown(tile(dark)), shown(tile(RED)))


def test_a_map_of_occlusion_takes_light_from_all_around_alone(shown, tile, monkeypatch):
    plain, none = shown(tile(RED)), even(255, 0, 0)
    assert np.array_equal(shown(tile(replace(RED, occlusion_texture=none))), plain)
    closed = replace(RED, occlusion_texture=even(0, 0, 0))
    half = shown(tile(replace(closed, occlusion_strength=0.5)))
    assert (shown(tile(closed)).sum(), half.sum()) < (half.sum(), plain.sum())
    assert np.array_equal(shown(tile(replace(closed, occlusion_strength=0.0))), plain)
    light = Light(np.ones(3), np.zeros(3), np.zeros(3), TO_LIGHT)
    monkeypatch.setattr(LightEstimator, "update", lambda *given: light)
    assert np.array_equal(shown(tile(closed)), shown(tile(RED)))


MAPPINGS = {
    "straight": ((1.0, 0.0), (0.0, 1.0)),
    "a quarter turn": ((0.0, -1.0), (1.0, 0.0)),
    "mirrored": ((-1.0, 0.0), (0.0, 1.0)),
    "stretched": ((3.0, 0.0), (0.0, 3.0)),
}


@pytest.mark.parametrize("mapping", MAPPINGS)
@pytest.mark.parametrize("lean", [(0.0, 0.0), (0.5, 0.0), (0.0, 0.5), (-0.3, -0.4)])
def test_a_normal_map_tilts_normals_along_the_texture(shown, tile, mapping, lean):
    uv_of_xz = np.array(MAPPINGS[mapping])
    right, up = lean
    rise = float(np.sqrt(1.0 - right**2 - up**2))
    coded = np.rint(127.5 * (np.array([right, up, rise]) + 1.0)).astype(int)
    xz_of_uv = np.linalg.inv(uv_of_xz)
    xz_of_uv /= np.linalg.norm(xz_of_uv, axis=0)
    x, z = xz_of_uv @ [right, -up]  # up in a picture is against v
    expected = shown(tile(RED, normal=(x, rise, z)))
    mapped = tile(replace(RED, normal_texture=even(*coded)), uv_of_xz=uv_of_xz)
    assert np.abs(shown(mapped) - expected).max() <= 3


def test_the_scale_of_a_normal_map_tilts_normals_more(shown, tile):
    lean = replace(RED, normal_texture=even(178, 128, 238))
    steep = np.array([2.0 * 0.4, np.sqrt(1.0 - 0.4**2), 0.0])
    expected = shown(tile(RED, normal=steep / np.linalg.norm(steep)))
    assert np.abs(shown(tile(replace(lean, normal_scale=2.0))) - expected).max() <= 3
    assert np.array_equal(shown(tile(replace(lean, normal_scale=0.0))), shown(tile(RED)))


def test_degenerate_texture_coordinates_keep_the_normals(shown, tile):
    mapped = tile(replace(RED, normal_texture=even(200, 128, 238)), uv_of_xz=np.zeros((2, 2)))
    assert np.abs(shown(mapped) - shown(tile(RED))).max() <= 1


def test_emission_is_visible_without_light(shown, tile, view):
    black = replace(RED, base_color=(0.0, 0.0, 0.0, 1.0), roughness=1.0)
    dark, bright = shown(tile(black)), shown(tile(replace(black, emissive=(0.0, 0.5, 0.0))))
    where = np.abs(dark - view.image).sum(axis=2) > 150
    assert where.sum() > 500
    assert (bright - dark)[where][:, 1].mean() > 80
    assert np.abs((bright - dark)[where][:, [0, 2]]).max() <= 2


def test_holes_show_the_background(shown, tile, view):
    solid = tile(replace(RED, base_color_texture=even(255, 255, 255, 40)))
    holes = tile(replace(RED, base_color_texture=even(255, 255, 255, 40), alpha_cutoff=0.5))
    shut = tile(replace(RED, base_color_texture=even(255, 255, 255, 140), alpha_cutoff=0.5))
    assert np.array_equal(shown(shut), shown(solid))
    red = shown(solid)[..., 2] - shown(solid)[..., 1] > 40
    seen = shown(holes)
    assert red.sum() > 1000
    assert (seen[..., 2] - seen[..., 1]).max() < 20
    faint = replace(RED, alpha_cutoff=0.5)
    assert np.array_equal(shown(tile(faint, alpha=0.4)), seen)
    assert np.array_equal(shown(tile(faint, alpha=0.6)), shown(solid))


def test_materials_with_different_textures_are_drawn_separately(tile):
    bumps = even(128, 128, 255)
    one, other = replace(RED, normal_texture=bumps), replace(RED, normal_texture=bumps.copy())
    meshes = [tile(material).meshes[0] for material in (one, other, one)]
    assert len(CharacterVertices.of(meshes).materials) == 2


SHADE = (0.3, 0.05, 0.2)
ALONG = np.cross(TO_LIGHT, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(TO_LIGHT, [0.0, 0.0, 1.0]))


def toon(color=SHADE, **changes):
    """RED in MToon's shading, with ambient light that is the same from everywhere."""
    return replace(RED, toon=ToonShading(color, **{"evenness": 1.0} | changes))


def at_cosine(cosine):
    """A normal at this cosine to the light."""
    return tuple(cosine * TO_LIGHT + np.sqrt(1.0 - cosine**2) * ALONG)


def test_toon_shading_has_one_colour_for_what_is_lit_and_one_for_the_shade(shown, tile):
    plain = [shown(tile(toon(RED.base_color[:3]), at_cosine(c))) for c in (0.9, 0.2, -0.2, -0.9)]
    assert all(np.abs(each - plain[0]).max() <= 1 for each in plain)
    lit, also_lit, shaded, also_shaded = (
        shown(tile(toon(), at_cosine(c))) for c in (0.9, 0.2, -0.2, -0.9)
    )
    assert np.abs(lit - plain[0]).max() <= 1
    assert np.abs(also_lit - lit).max() <= 1
    assert np.abs(also_shaded - shaded).max() <= 1
    assert np.abs(shaded - lit).max() > 20


@pytest.mark.parametrize(
    ("cosine", "shift", "toony", "share"),
    [(0.0, 0.0, 0.9, 0.5), (0.3, -0.3, 0.9, 0.5), (0.2, 0.0, 0.2, 0.625), (-0.5, 0.2, 0.0, 0.35)],
)
def test_toon_shading_changes_linearly_about_its_edge(shown, tile, cosine, shift, toony, share):
    mixed = tuple(
        share * lit + (1.0 - share) * dark
        for lit, dark in zip(RED.base_color[:3], SHADE, strict=True)
    )
    found = shown(tile(toon(shift=shift, toony=toony), at_cosine(cosine)))
    expected = shown(tile(toon(mixed), at_cosine(-0.9)))
    assert np.abs(found - expected).max() <= 1


def test_a_texture_multiplies_the_shade_colour_and_colours_of_vertices_do_not(shown, tile):
    shaded = at_cosine(-0.9)
    mapped = tile(toon(texture=even(128, 255, 188)), shaded)
    linear = [((value / 255 + 0.055) / 1.055) ** 2.4 for value in (128, 255, 188)]
    expected = tile(toon(tuple(np.multiply(SHADE, linear))), shaded)
    assert np.abs(shown(mapped) - shown(expected)).max() <= 2
    assert np.abs(shown(mapped) - shown(tile(toon(), shaded))).max() > 5
    (mesh,) = expected.meshes
    tinted = replace(mesh, colors=mesh.colors * np.array([0.5, 0.2, 0.1, 1.0], np.float32))
    assert np.array_equal(shown(replace(expected, meshes=(tinted,))), shown(expected))
