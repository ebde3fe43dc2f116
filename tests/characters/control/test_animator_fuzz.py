"""Whatever a character is told, and whenever: its pose is sound, and it neither jumps nor leaps."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import Animator, Character, CharacterError
from cubeling.characters.control.animator import MAX_TIME_STEP_S
from cubeling.characters.motion.motion import RootDelta
from tests.characters.commands import command
from tests.examples import examples, some

DATA = Path(__file__).parents[3].parent / "shared" / "data" / "gltf"
CAST = ("human", "Fox.glb", "vleo", "robot", "RobotExpressive.glb")
MAX_JOINT_SPEED = 75.0  # [rad/s]: eyes jump at 25, the fastest punch of the cast has 54
MAX_TABLE_SPEED = 0.6  # [m/s] on the table: a walker of 17 cm


def points(count, reach):
    numbers = st.lists(st.floats(-reach, reach), min_size=count, max_size=count)
    return st.none() | numbers.map(np.array)


@pytest.fixture(scope="module", params=some(CAST, 2))
def someone(request):
    """A character, and all that it answers to."""
    if request.param.endswith(".glb") and not (DATA / request.param).exists():
        pytest.skip("needs ../shared/data")
    bundled = not request.param.endswith(".glb")
    character = Character.load(request.param if bundled else DATA / request.param)
    ends = {name.rpartition("_")[0] for name in character.clips} - {""}
    return character, ["idle", "move", *sorted({*character.clips, *ends} - {"idle"})]


@st.composite
def stories(draw):
    """Commands for a while each: how long, how many, which action, and the rest of them."""
    told = []
    for _ in range(draw(st.integers(1, 3))):
        gap = draw(st.sampled_from([1 / 30, 1 / 30, 1 / 60, 0.0, 0.2, -3.0, 1e5]))
        told.append(
            (
                gap,
                draw(st.integers(1, 12)),
                draw(st.integers(0, 20)),
                {
                    "speed": draw(st.sampled_from([0.0, 0.4, 1.0, 2.9, 3.1, 5.0, -1.0, 1e3])),
                    "target": draw(points(2, 3.0)),
                    "facing": draw(points(2, 3.0)),
                    "gaze": draw(points(3, 3.0)),
                    "weight": draw(st.sampled_from([-1.0, 0.0, 0.3, 1.0, 9.0])),
                    "stop": draw(st.booleans()),
                },
            )
        )
    return told


def played(someone, story):
    """Play a story; what is not known is refused, and time goes on."""
    character, actions = someone
    animator, time, elapsed = Animator(character, place=RootDelta()), 0.0, 0.0
    for gap, count, number, said in story:
        asked = command(time, actions[number % len(actions)], **said)
        for _ in range(count):
            time += gap
            elapsed += min(max(gap, 0.0), MAX_TIME_STEP_S)
            try:
                yield elapsed, animator.update(replace(asked, timestamp=time))
                elapsed = 0.0
            except CharacterError as error:
                assert "does not know" in str(error)  # noqa: PT017 (only some are refused)
                break


@settings(max_examples=examples(12))
@given(story=stories())
def test_no_command_breaks_a_character(someone, story):
    before = None
    for seconds, posed in played(someone, story):
        pose, placed = posed.pose, posed.table_from_character
        for numbers in (pose.translations, pose.scales, pose.morphs, placed):
            assert numbers is None or np.isfinite(numbers).all()
        assert np.abs(np.linalg.norm(pose.rotations, axis=-1) - 1.0).max() < 1e-5
        if before is not None:
            cosine = np.abs((pose.rotations * before.pose.rotations).sum(-1))
            turned = 2 * np.arccos(np.minimum(cosine, 1.0)).max()
            assert turned < MAX_JOINT_SPEED * seconds + 0.1
            went = np.linalg.norm((placed - before.table_from_character)[:3, 3])
            assert went < MAX_TABLE_SPEED * seconds + 1e-3
        before = posed


@settings(max_examples=examples(2))
@given(story=stories())
def test_the_same_story_twice(someone, story):
    first, second = (
        [(posed.pose.rotations.tobytes(), posed.table_from_character.tobytes())
         for _, posed in played(someone, story)] for _ in range(2)
    )  # fmt: skip
    assert first == second
