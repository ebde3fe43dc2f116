"""Light that scatters in skin: what it keeps, what it softens, and what the adaptive form saves."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import QUALITIES, Effect, Stage
from tests.characters.rendering.shapes import Still, ball, plate
from tests.characters.rendering.watch import WatchPass

SKIN = Material(base_color=(0.6, 0.5, 0.4, 1.0), roughness=0.9, scattering=1.0)
DEEP = replace(SKIN, scattering=8.0)
"""On shapes of a few centimetres, light of human skin would spread over less than a pixel."""


@pytest.fixture
def scattered(ctx, view):
    """Return a function that draws meshes, and gives the light before and after scattering."""
    stages = []

    def draw(*meshes, adaptive=False, shadows=False):
        effects = {Effect.SKIN_SCATTERING}
        effects |= {Effect.AMBIENT_OCCLUSION} if adaptive else set()
        effects |= {Effect.SOFT_SHADOWS} if shadows else set()
        stage = Stage(ctx, (320, 180))
        stages.append(stage)
        stage.quality = replace(QUALITIES["rich"], effects=frozenset(effects))
        watch = WatchPass()
        stage.passes.append(watch)
        stage.draw(view, [Still(meshes).posed()])
        return watch

    yield draw
    for stage in stages:
        stage.release()


def test_even_light_stays_as_it_is(scattered):
    found = scattered(plate(DEEP))
    before, after = found.diffuse[found.skin][:, :3], found.scattered[found.skin][:, :3]
    assert len(before) > 5000
    assert np.abs(after - before).max() < 2e-3 * before.max()


def test_light_at_the_edge_of_a_shadow_is_kept_but_spread(scattered):
    roof = plate(Material(double_sided=True), (0.04, 0.03, 0.0), side=0.06)
    found = scattered(plate(DEEP, side=0.2), roof, shadows=True)
    before, after = found.diffuse[found.skin][:, :3], found.scattered[found.skin][:, :3]
    assert after.mean(axis=0) == pytest.approx(before.mean(axis=0), rel=0.01)
    spread = np.abs(after - before).mean(axis=0) / before.mean(axis=0)
    assert spread[0] > 0.005
    # Red light goes furthest: root mean squares of 3.3, 1.6 and 0.9 mm in skin of scale 1.
    assert spread[0] > 1.7 * spread[1] > 1.7 * 1.5 * spread[2]


def test_light_does_not_cross_to_a_surface_behind(scattered):
    """A plate looks the same before other skin, which is much brighter, as before none."""
    near = plate(replace(DEEP, base_color=(0.1, 0.1, 0.1, 1.0)), (0.0, 0.08, 0.0), side=0.05)
    glass = replace(DEEP, base_color=(1.0, 1.0, 1.0, 1.0), scattering=0.0)
    before, alone = (
        scattered(plate(material, side=0.2), near, shadows=True)
        for material in (replace(glass, scattering=8.0), glass)
    )
    assert alone.skin.sum() > 1000
    assert np.abs(before.scattered - alone.scattered)[alone.skin].max() < 1e-3


def test_the_terminator_of_a_ball_widens(scattered):
    def width(material):
        found = scattered(ball(material))
        light = found.scattered[..., 0] / found.scattered[..., 0].max()
        return ((light > 0.02) & (light < 0.3) & found.skin).sum()

    assert width(DEEP) > 1.03 * width(SKIN)


def test_what_is_not_skin_is_not_touched(scattered):
    found = scattered(plate(replace(SKIN, scattering=0.0)), ball(DEEP, (0.0, 0.08, 0.0), 0.03))
    other = ~found.skin & (found.diffuse[..., 3] > 0.5)
    assert other.sum() > 2000
    assert np.array_equal(found.scattered[other][:, :3], found.diffuse[other][:, :3])


@pytest.mark.full
def test_open_skin_is_filtered_with_fewer_taps(scattered):
    soft = replace(SKIN, scattering=2.0)
    shapes = (plate(soft, side=0.2), ball(soft), ball(soft, (0.07, 0.03, 0.02), 0.03))
    whole = scattered(*shapes, shadows=True)
    adaptive = scattered(*shapes, shadows=True, adaptive=True)
    skin = whole.skin
    assert (whole.scattered[skin][:, 3] == 1.0).all()
    assert adaptive.scattered[skin][:, 3].mean() <= 0.6
    error = (adaptive.scattered - whole.scattered)[skin][:, :3]
    assert 10.0 * np.log10(whole.scattered[skin][:, :3].max() ** 2 / (error**2).mean()) >= 35.0


def test_light_from_behind_reddens_thin_skin_and_not_thick(scattered):
    """A ball is dark where it turns away from the lamp, unless light goes as far as it is wide."""

    def shade(scattering):
        found = scattered(ball(replace(SKIN, scattering=scattering), radius=0.02), shadows=True)
        dark = found.skin & (found.diffuse[..., :3].max(axis=2) < 1e-3)
        assert dark.sum() > 20
        return found.scattered[dark][:, :3].mean(axis=0)

    thin, thick = shade(3.0), shade(0.5)
    assert thin[0] > 2.0 * thin[1] > 2.0 * thin[2]
    assert thin[0] > 10.0 * thick[0]
