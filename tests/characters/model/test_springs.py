"""The table [springs] of a character's sidecar file."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, CharacterError, RootDelta
from cubeling.characters.control.command import LocomotionIntent
from cubeling.characters.control.layers import layers_of
from cubeling.characters.control.layers.springs import SpringLayer
from cubeling.characters.model.springs import REFERENCE_HEIGHT_M
from tests.examples import some


@pytest.fixture
def beside(tmp_path):
    """Loads Vleo with a text beside it."""
    vleo = Character.load("vleo")
    vleo.save(tmp_path / "vleo.glb")

    def load(text):
        (tmp_path / "vleo.toml").write_text(text)
        return Character.load(tmp_path / "vleo.glb")

    return load


def test_named_joints_and_what_hangs_on_them_swing(beside):
    character = beside(
        """
        [springs.tail]
        joints = ["tail3"]
        stiffness = 2.0
        gravity = 0.5
        colliders = [{ joint = "hips", offset = [0, 0, 0.1], radius = 0.2 }]

        [springs.ears]
        joints = ["LeftEye"]
        """
    )
    names = [bone.joint for bone in character.springs]
    assert names == ["tail3", "tail4", "tail5", "LeftEye"]
    first, *_, leaf, eye = character.springs
    child = character.skeleton.index("tail4")
    assert first.tail == pytest.approx(character.skeleton.rest.translations[child])
    # As much less as it is smaller than a person.
    size = character.height / REFERENCE_HEIGHT_M
    assert size < 0.25
    assert first.stiffness == pytest.approx(2.0 * size)
    assert first.gravity == pytest.approx((0.0, -0.5 * size, 0.0))
    assert first.colliders[0].joint == "hips"
    assert first.colliders[0].start == first.colliders[0].end == (0.0, 0.0, 0.1)
    assert 0.001 < np.linalg.norm(leaf.tail) < 0.3  # the middle of the skin that it moves
    assert eye.stiffness == pytest.approx(size)
    assert eye.drag == 0.4


def test_only_characters_with_spring_bones_have_the_layer(beside):
    assert SpringLayer not in layers_of(Character.load("vleo"))
    assert layers_of(beside('[springs.tail]\njoints = ["tail3"]'))[-1] is SpringLayer


def test_a_tail_follows_later_than_the_body_turns(beside):
    swinging = beside('[springs.tail]\njoints = ["tail3"]\nstiffness = 0.3')
    tail = swinging.skeleton.index("tail3")
    others = [joint for joint in range(len(swinging.skeleton)) if not tail <= joint < tail + 3]
    animator, plain = (Animator(each, place=RootDelta()) for each in (swinging, beside("")))
    angles = []
    for frame in range(90):
        going = LocomotionIntent(facing=np.array([1.0, 0.0]))
        asked = CharacterCommand(frame / 30, locomotion=going)
        one, other = (each.update(asked).pose.rotations for each in (animator, plain))
        angles.append(2 * np.degrees(np.arccos(min(abs(np.dot(one[tail], other[tail])), 1.0))))
        assert np.array_equal(one[others], other[others])
    assert max(angles) > 3.0
    assert np.isfinite(angles).all()


def scaled(character, size):
    """The character in another unit of length."""
    rest = character.skeleton.rest
    skeleton = replace(
        character.skeleton, rest=replace(rest, translations=rest.translations * size)
    )
    meshes = tuple(
        replace(
            mesh,
            positions=mesh.positions * np.float32(size),
            inverse_bind=np.diag([size, size, size, 1.0])
            @ mesh.inverse_bind
            @ np.diag([1 / size, 1 / size, 1 / size, 1.0]),
        )
        for mesh in character.meshes
    )
    return replace(character, skeleton=skeleton, meshes=meshes, clips={}, plan=None)


def test_the_same_numbers_swing_alike_in_any_unit_of_length(beside, tmp_path):
    text = '[springs.tail]\njoints = ["tail3"]\nstiffness = 0.3\ngravity = 0.2'
    vleo = beside(text)
    scaled(replace(vleo, springs=()), 100.0).save(tmp_path / "large.glb")
    (tmp_path / "large.toml").write_text(text)
    turns = []
    for character in (scaled(vleo, 1.0), Character.load(tmp_path / "large.glb")):
        animator = Animator(character, place=RootDelta(), layers=(SpringLayer,))
        going = LocomotionIntent(target=np.array([0.3, 0.1]), speed=2.0, stop=False)
        asked = [CharacterCommand(frame / 30, locomotion=going) for frame in range(30)]
        turns.append(np.array([animator.update(each).pose.rotations for each in asked]))
        assert np.ptp(turns[-1], axis=0).max() > 0.02
    assert np.allclose(turns[0], turns[1], atol=1e-3)


@pytest.mark.parametrize(
    ("text", "reason"),
    some(
        [
            ("springs = 1", "springs[.a-z]* must be a table, not"),
            ("[springs]\njoints = ['tail1']", "springs[.a-z]* must be a table, not"),
            ("[springs.tail]", "springs.tail.joints is missing; it must be a list"),
            ("[springs.tail]\njoints = ['tail9']", "no joint 'tail9'; did you mean 'tail[1-5]'"),
            (
                "[springs.tail]\njoints = ['tail1']\nstifness = 1",
                "stifness means nothing here; did you mean 'stiffness'",
            ),
            (
                "[springs.tail]\njoints = ['tail1']\ndrag = 2",
                "drag must be a number from 0",
            ),
            (
                "[springs.tail]\njoints = ['tail1']\ndrag = nan",
                "drag must be a number from 0 to 1, not nan",
            ),
            (
                "[springs.tail]\njoints = ['tail1']\ncolliders = [{joint = 'hips'}]",
                r"colliders\[0\]\.radius is missing; it must be a number from 0 to 1000",
            ),
            (
                "[springs.tail]\njoints = ['tail1']\ncolliders = [{joint = 'hip', radius = 1}]",
                "no joint 'hip'; did you mean 'hips'",
            ),
            (
                "[spring.tail]\njoints = ['tail1']",
                "spring means nothing here; did you mean",
            ),
        ],
        3,
    ),
)
def test_a_wrong_table_is_refused_in_one_line(beside, text, reason):
    with pytest.raises(CharacterError, match=reason) as error:
        beside(text)
    assert "vleo.toml" in str(error.value)
    assert "\n" not in str(error.value)
