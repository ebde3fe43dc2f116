"""Bodies on four legs that sit up."""

import numpy as np
import pytest

from cubeling.characters import Character, Pose
from cubeling.characters.ik.sitting_up import PITCH_RAD, SittingUp
from cubeling.characters.model.character import skin
from cubeling.characters.skeleton.pose import Array

SHARES = np.linspace(0.0, 1.0, 21)


@pytest.fixture(params=["vleo", "robot"])
def body(request: pytest.FixtureRequest) -> Character:
    return Character.load(request.param)


def idle(body: Character) -> Pose:
    return next(clip for name, clip in body.clips.items() if "idle" in name.lower()).poses[0]


def sitting(body: Character, share: float) -> Pose:
    found = SittingUp.of(body.skeleton, body.anatomy)
    assert found is not None
    return found.sit_up(idle(body), share)


def turns(body: Character, pose: Pose, part: str) -> Array:
    placed: Array = pose.globals(body.skeleton)[body.anatomy.joints[part]]
    return placed


def test_hind_paws_stay_where_they_are(body: Character) -> None:
    for side in ("left", "right"):
        before = turns(body, idle(body), f"{side}Foot")
        after = turns(body, sitting(body, 1.0), f"{side}Foot")
        assert np.abs(before[:3, 3] - after[:3, 3]).max() < 0.001 * body.height
        assert np.abs(before[:3, :3] - after[:3, :3]).max() < 1e-6


def test_front_paws_rise_and_the_head_stays_upright(body: Character) -> None:
    pose = sitting(body, 1.0)
    for side in ("left", "right"):
        low = turns(body, idle(body), f"{side}FrontFoot")[1, 3]
        assert turns(body, pose, f"{side}FrontFoot")[1, 3] > low + 0.15 * body.height
    tilt = turns(body, idle(body), "head")[:3, :3].T @ turns(body, pose, "head")[:3, :3]
    angle = np.arccos((np.trace(tilt) - 1.0) / 2.0)
    assert angle < 0.1 * PITCH_RAD


def test_nothing_sinks_into_the_ground(body: Character) -> None:
    placed = sitting(body, 1.0).globals(body.skeleton)
    lowest = min(float(skin(mesh, placed)[:, 1].min()) for mesh in body.meshes)
    assert lowest > -0.005 * body.height


def test_a_body_sits_up_without_a_jump(body: Character) -> None:
    places = np.stack(
        [sitting(body, float(share)).globals(body.skeleton)[:, :3, 3] for share in SHARES]
    )
    steps = np.linalg.norm(np.diff(places, axis=0), axis=-1)
    assert steps.max() < 0.08 * body.height
    assert (places[0] == idle(body).globals(body.skeleton)[:, :3, 3]).all()


def test_a_person_does_not_sit_up() -> None:
    person = Character.load("human")
    assert SittingUp.of(person.skeleton, person.anatomy) is None
