"""Characters that walk by a motion graph instead of the movement tree."""

from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
    choose_controller,
)
from cubeling.characters.control.command import ActionIntent, PosedCharacter
from cubeling.characters.synthesis.graphs.building import analyse
from cubeling.characters.synthesis.graphs.storage import save_graph
from cubeling.characters.synthesis.library import MotionLibrary
from tests.examples import some

RATE_HZ = 30
TARGET = np.array([0.2, 0.25])


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module", params=["graph", "parts"])
def factory(request: pytest.FixtureRequest, human: Character):
    return choose_controller(request.param, human)


def _play(animator: Animator, intents: list[tuple[float, str]]) -> list[PosedCharacter]:
    """Play a list of speeds and actions, a frame each."""
    return [
        animator.update(
            CharacterCommand(
                number / RATE_HZ,
                LocomotionIntent(speed, TARGET),
                ActionIntent(action) if action else None,
            )
        )
        for number, (speed, action) in enumerate(intents)
    ]


def test_it_goes_where_it_is_sent_and_stops_there(human: Character, factory) -> None:
    shown = _play(Animator(human, controller=factory), [(2.0, "")] * 200)
    miss = np.linalg.norm(shown[-1].table_from_character[[0, 2], 3] - TARGET)
    assert miss < 0.065
    assert shown[-1].state == "idle"
    assert {each.state for each in shown} == {"idle", "walk"}


@pytest.mark.parametrize("kind", some(["graph", "parts"]))
def test_where_no_motion_stands_it_stands_by_its_own_clip_and_goes_on(
    human: Character, kind: str
) -> None:
    animator = Animator(human, controller=choose_controller(kind, human, ["human#Walk"]))
    time = 0.0
    for x, z in ((0.2, 0.25), (-0.1, 0.1)):
        states = []
        for _ in range(9 * RATE_HZ):
            command = CharacterCommand(time, LocomotionIntent(2.0, np.array([x, z])))
            shown = animator.update(command)
            states.append(shown.state)
            time += 1 / RATE_HZ
        assert np.linalg.norm(shown.table_from_character[[0, 2], 3] - (x, z)) < 0.065
        assert states[-RATE_HZ:] == ["idle"] * RATE_HZ


def test_it_stands_soon_after_it_is_asked_to(human: Character, factory) -> None:
    """A Speed that fades is the Speed of one who stands long before it is 0."""
    target = np.array([0.0, 50.0])
    animator = Animator(human, controller=factory)
    places = []
    for number in range(6 * RATE_HZ):
        goes = number < 2 * RATE_HZ
        going = LocomotionIntent(2.0 if goes else 0.0, target, stop=False)
        action = None if goes else ActionIntent("idle")
        shown = animator.update(CharacterCommand(number / RATE_HZ, going, action))
        places.append(shown.table_from_character[[0, 2], 3])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps[-RATE_HZ:].mean() < 0.2 * steps[RATE_HZ : 2 * RATE_HZ].mean()


def test_the_same_commands_give_the_same_frames(human: Character, factory) -> None:
    intents = [(2.0, "")] * 30 + [(4.5, "")] * 20
    one, two = (_play(Animator(human, controller=factory), intents) for _ in range(2))
    for a, b in zip(one, two, strict=True):
        assert np.array_equal(a.pose.rotations, b.pose.rotations)
        assert np.array_equal(a.table_from_character, b.table_from_character)


def test_it_performs_actions_and_goes_on(human: Character, factory) -> None:
    intents = [(0.0, "wave")] * 40 + [(2.0, "")] * 60
    states = [each.state for each in _play(Animator(human, controller=factory), intents)]
    assert states[20] == "wave"
    assert states[-1] == "walk"


def test_no_joint_jumps(human: Character, factory) -> None:
    intents = [(2.0, "")] * 45 + [(4.5, "")] * 30 + [(0.0, "idle")] * 30
    shown = _play(Animator(human, controller=factory), intents)
    turns = np.array([each.pose.rotations for each in shown])
    speeds = 2 * np.arccos(np.minimum(np.abs((turns[1:] * turns[:-1]).sum(-1)), 1.0)) * RATE_HZ
    own = max(
        float(np.median(np.sort(_joint_speeds(human.clips[name]).max(1))[-3:]))
        for name in ("Run", "RunLeftMedium", "Walk")
    )
    assert speeds.max() < 1.5 * own


def _joint_speeds(clip) -> np.ndarray:
    turns = clip.poses.rotations[:, 1:]
    dots = np.abs((turns[1:] * turns[:-1]).sum(-1))
    return np.asarray(2 * np.arccos(np.minimum(dots, 1.0)) * clip.rate)


def test_a_graph_of_a_file_is_retargeted_to_the_character(human: Character, tmp_path: Path) -> None:
    clips = [human.clips[name] for name in ("idle", "Walk", "Run")]
    path = tmp_path / "my.graph"
    save_graph(analyse(MotionLibrary.of(clips, human.skeleton, human.anatomy)), path)
    factory = choose_controller("graph", human, [str(path)])
    assert _play(Animator(human, controller=factory), [(2.0, "")] * 40)[-1].state == "walk"


@pytest.mark.parametrize(
    ("name", "motions", "message"),
    [
        ("vleo", [], "needs a character that walks"),
        ("human", ["walk.bvh"], "walk.bvh"),
        ("human", ["a.graph", "b.graph"], r"give one .graph file alone"),
        ("human", ["none.graph"], "No such file"),
    ],
)
def test_what_cannot_be_played_is_refused(name: str, motions: list[str], message: str) -> None:
    with pytest.raises(CharacterError, match=message):
        choose_controller("parts", Character.load(name), motions)
