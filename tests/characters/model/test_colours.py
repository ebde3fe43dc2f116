"""Two characters of one file are told apart by other colours."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, colours_of, with_colours
from cubeling.characters.model.mesh import Material

HAIR, TEAL = "#7c391d", "#12b3b3"


def linear(code):
    value = np.array([int(code[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


def test_a_colour_takes_the_place_of_another_one_and_of_no_other(human):
    dressed = with_colours(human, colours_of(f"{HAIR}=#c9c4ba {TEAL}=#7d1b34"))
    before, after = human.meshes[0].colors, dressed.meshes[0].colors
    assert before is not None
    assert after is not None
    for old, new in ((HAIR, "#c9c4ba"), (TEAL, "#7d1b34")):
        had = np.linalg.norm(before[:, :3] - linear(old), axis=1) < 0.01
        assert had.sum() > 500
        assert np.allclose(after[had, :3], linear(new), atol=1e-6)
    changed = (before != after).any(axis=1)
    assert changed.sum() < 0.4 * len(before), "skin, trousers and shoes stay"
    assert dressed.meshes[1] is human.meshes[1], "the iris is no hair"
    assert dressed.meshes[0].positions is human.meshes[0].positions


def test_a_mesh_without_colours_of_its_own_has_that_of_its_material(human):
    mesh = replace(human.meshes[0], colors=None, material=Material((*linear(TEAL), 1.0)))
    stranger = replace(human, meshes=(mesh,))
    (dressed,) = with_colours(stranger, {TEAL: "#7d1b34"}).meshes
    assert dressed.colors is not None
    shown = dressed.colors[:, :3] * np.array(dressed.material.base_color[:3])
    assert np.allclose(shown, linear("#7d1b34"), atol=1e-5)


def test_what_a_character_does_not_have_is_refused_with_what_it_has(human):
    with pytest.raises(CharacterError, match=f"human has no #123456; it has .*{HAIR}"):
        with_colours(human, {"#123456": "#000000"})


@pytest.mark.parametrize("text", ["red", "#12b3b3", "#12b3b3=red", "#12b3b3=#12", "a=b=c"])
def test_colours_are_refused_that_are_written_in_another_way(text):
    with pytest.raises(CharacterError, match="write #7c391d=#b9b3a8"):
        colours_of(text)
