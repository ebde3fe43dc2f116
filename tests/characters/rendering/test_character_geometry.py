"""What the graphics card needs of a character is prepared once while the character lives."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.rendering.geometry import character_geometry
from cubeling.characters.rendering.geometry.character_geometry import CharacterGeometry


@pytest.fixture
def robot() -> Character:
    """A character of the test's own."""
    return replace(Character.load("robot"))


def test_copies_and_stages_share_what_was_prepared(robot):
    assert CharacterGeometry.of(robot) is CharacterGeometry.of(robot)
    plain = CharacterGeometry.of(robot, ())
    assert plain is CharacterGeometry.of(robot, ())
    assert len(plain.levels) == 1 < len(CharacterGeometry.of(robot).levels)


def test_another_character_with_the_same_meshes_is_prepared_alike_but_apart(robot):
    one, other = CharacterGeometry.of(robot), CharacterGeometry.of(replace(robot))
    assert one is not other
    np.testing.assert_array_equal(one.indices, other.indices)
    np.testing.assert_array_equal(one.caster_indices, other.caster_indices)


def test_nothing_is_kept_of_a_character_that_is_gone():
    character = replace(Character.load("robot"))
    CharacterGeometry.of(character)
    number = id(character)
    assert number in character_geometry._prepared
    del character
    assert number not in character_geometry._prepared
