"""Deferred shading: the same picture as the forward pass, lit once for each texel."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.model.mesh import Material, ToonShading
from cubeling.characters.rendering import QUALITIES, Stage
from cubeling.characters.rendering.deferred.buffers import surface_records
from cubeling.characters.rendering.passes.deferred import lighting
from cubeling.tracking.appearance import HandMask
from tests.characters.rendering.shapes import Still, plate
from tests.characters.rendering.watch import WatchPass


@pytest.fixture
def deferred(ctx):
    """Return a stage that lights later, without any effect."""
    stage = Stage(ctx, (320, 180))
    stage.quality = replace(QUALITIES["rich"], effects=frozenset())
    yield stage
    stage.release()


def with_material(pawn, **changes):
    (mesh,) = pawn.meshes
    return replace(pawn, meshes=(replace(mesh, material=replace(mesh.material, **changes)),))


SPOTS = np.random.default_rng(5).integers(0, 256, (8, 8, 3), np.uint8)

TOON = ToonShading((0.3, 0.05, 0.1), shift=0.1, toony=0.6, evenness=0.5)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"metallic": 0.8, "roughness": 0.25},
        {"emissive": (0.0, 0.3, 0.1)},
        {"toon": TOON},
        {"emissive": (0.6, 0.3, 0.1), "emissive_texture": SPOTS, "occlusion_texture": SPOTS},
    ],
    ids=["plain", "metal", "glow", "toon", "maps"],
)
def test_lit_later_the_picture_is_the_same(stage, deferred, view, pawn, cube, changes):
    actors = [
        with_material(pawn, **changes).posed(bend=0.4, at=(-0.02, 0.0)),
        pawn.posed(at=(0.08, -0.02), height=0.09),
    ]
    seen = replace(view, occluders=(cube,))
    forward, later = stage.draw(seen, actors), deferred.draw(seen, actors)
    assert (forward != view.image).any(axis=2).sum() > 1000
    assert np.abs(forward.astype(int) - later).max() <= 1


def test_the_hand_hides_what_is_lit_later(deferred, view, pawn):
    cover = HandMask(150, 0, np.full((180, 60), 255, np.uint8), np.array([0.0, 0.0, 0.3]))
    hidden = deferred.draw(replace(view, hand=cover), [pawn.posed()])
    assert np.array_equal(hidden[:, 151:209], view.image[:, 151:209])


def test_a_camera_that_looks_along_the_table_draws_who_stands_on_it(ctx, view, pawn):
    along = np.diag([1.0, -1.0, -1.0, 1.0])
    along[2, 3] = 0.45
    stage = Stage(ctx, (320, 180))
    stage.quality = QUALITIES["rich"]
    picture = stage.draw(replace(view, camera_from_table=along), [pawn.posed()])
    stage.release()
    assert (picture != view.image).any(axis=2).sum() > 1000


def test_surfaces_beyond_the_last_record_are_lit_too(stage, deferred, view, monkeypatch):
    monkeypatch.setattr(lighting, "MAX_SURFACES", 3)
    deferred.quality = replace(deferred.quality, name="with few records")
    plates = tuple(
        plate(Material(base_color=(0.6, 0.3, 0.2, 1.0), roughness=0.5 + 0.1 * number), side=side)
        for number, side in enumerate([0.01, 0.01, 0.01, 0.12])
    )
    actors = [Still(plates).posed()]
    forward, later = stage.draw(view, actors), deferred.draw(view, actors)
    assert (forward != view.image).any(axis=2).sum() > 1000
    assert np.abs(forward.astype(int) - later).max() <= 1


def test_each_surface_has_its_record(deferred, view, pawn):
    watch = WatchPass()
    deferred.passes.append(watch)
    deferred.draw(
        view,
        [
            with_material(pawn, toon=TOON).posed(),
            with_material(pawn, scattering=2.0).posed(height=0.2),
        ],
    )
    toon, plain = surface_records(watch.frame.characters)
    assert np.allclose(toon, np.array([[1, 0.1, 0.6, 0.5], [0, 0.12, 0, 0]]))
    assert np.allclose(plain, np.array([[0, 0, 0, 0], [0.4, 0.2, 0, 0]]))
