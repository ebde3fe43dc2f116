"""Whole bodies that reach as one tree: knees, hips, trunk and head for hands, over planted feet."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cubeling.characters import Character, Pose
from cubeling.characters.ik.reaching import HandTarget, ReachStyle
from cubeling.characters.ik.reaching.tree import FIRST_STEPS, FOOT_AHEAD, UPPER_MASS, UPPER_MIDDLE
from cubeling.characters.ik.reaching.whole_body import WholeBody
from cubeling.characters.model.standing import idle_clips
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.natural_limits import natural_limits
from cubeling.characters.skeleton.pose import Array
from tests.characters.ik.reaching.bodies import PERSON_M, bundled, stick

PLACES = {
    "low": (0.12, 0.08, 0.25),
    "far": (0.1, 0.5, 0.45),
    "crossing": (-0.2, 0.5, 0.25),
    "behind": (0.25, 0.5, -0.2),
}
"""Places in body heights: left, up, ahead."""


@cache
def human() -> tuple[Character, WholeBody, Pose]:
    """Return the bundled human, and how it stands."""
    character = Character.load("human")
    assert character.whole_body is not None
    return character, character.whole_body, idle_clips(character.clips)[0].poses[0]


def at(place: tuple[float, float, float] | Array) -> Array:
    """Return a place in body heights [m]."""
    return human()[0].height * np.asarray(place, float)


def joint(pose: Pose, part: str) -> Array:
    """Return where a part of the human is, (3,) [m]."""
    character = human()[0]
    where: Array = pose.globals(character.skeleton)[character.anatomy.joints[part], :3, 3]
    return where


def person_mm(length: Array) -> float:
    """Return the length of a vector of the human, scaled to a person [mm]."""
    return float(np.linalg.norm(length)) / human()[0].height * PERSON_M * 1e3


def palm_misses_by(pose: Pose, place: Array, side: str = "left") -> float:
    """Return how far a palm is from a place, scaled to a person [mm]."""
    return person_mm(np.asarray(human()[0].upper_body.palm(pose, side)) - place)


@pytest.mark.parametrize("name", PLACES)
def test_a_place_that_torso_and_arm_miss_is_reached_with_hips_and_knees(name: str) -> None:
    character, whole, pose = human()
    target = HandTarget(at(PLACES[name]))
    alone = character.upper_body.reach(pose, target)
    together = whole.reach(pose, target)
    assert palm_misses_by(together, at(PLACES[name])) < 10.0
    if name in ("low", "far"):
        assert palm_misses_by(alone, at(PLACES[name])) > 100.0


@pytest.mark.parametrize("name", [*PLACES, "high"])
def test_feet_stay_as_they_are_and_the_mass_over_them(name: str) -> None:
    character, whole, pose = human()
    reached = whole.reach(pose, HandTarget(at(PLACES.get(name, (0.1, 1.3, 0.3)))))
    before, after = (each.globals(character.skeleton) for each in (pose, reached))
    balls = [character.anatomy.joints[side + "Toes"] for side in SIDES]
    assert np.allclose(before[balls], after[balls], atol=1e-9)
    hip = joint(reached, "leftUpperLeg") - joint(pose, "leftUpperLeg")
    top = joint(reached, "neck") - joint(pose, "neck")
    mass = hip + UPPER_MASS * UPPER_MIDDLE * (top - hip)
    assert mass[2] < (FOOT_AHEAD + 0.03) * character.height


@pytest.mark.parametrize(
    ("place", "lifted"), [((0.15, 0.05, 0.3), True), ((0.12, 0.45, 0.3), False)]
)
def test_a_heel_lifts_where_an_ankle_bends_no_further(
    place: tuple[float, float, float], lifted: bool
) -> None:
    character, whole, pose = human()
    reached = whole.reach(pose, HandTarget(at(place)))
    foot = character.anatomy.joints["leftFoot"]
    raised = joint(reached, "leftFoot")[1] - joint(pose, "leftFoot")[1]
    assert raised > 0.005 * character.height if lifted else abs(raised) < 1e-9
    limits = natural_limits(character.skeleton, character.anatomy)
    assert np.degrees(limits.excess(reached.rotations)[foot]) < 1.0


def test_no_ankle_or_hip_turns_beyond_its_range_while_the_pelvis_turns() -> None:
    character, whole, pose = human()
    limits = natural_limits(character.skeleton, character.anatomy)
    legs = [character.anatomy.joints[s + part] for s in SIDES for part in ("Foot", "UpperLeg")]
    for place in ((-0.5, 0.2, 0.15), (-0.5, 0.4, 0.45), (0.5, 0.2, 0.15)):
        reached = whole.reach(pose, HandTarget(at(place)))
        # Knees that go with the pelvis turn ankles 54 degrees beyond it, knees of feet hips 16.
        assert np.degrees(limits.excess(reached.rotations)[legs]).max() < 12.0


def test_a_near_place_moves_the_arm_only() -> None:
    character, whole, pose = human()
    place = at((0.12, 0.6, 0.15))
    reached = whole.reach(pose, HandTarget(place))
    turned = rotations.multiply(reached.rotations, rotations.conjugate(pose.rotations))
    angles = np.degrees(np.linalg.norm(rotations.to_rotation_vector(turned), axis=-1))
    arm = character.upper_body.arms["left"]
    fingers = [each for finger in arm.hand.fingers.values() for each in finger]
    others = np.setdiff1d(np.arange(len(angles)), [*arm.joints, *fingers])
    assert palm_misses_by(reached, place) < 1.0
    assert angles[others].max() < 1.0


def test_the_tree_rests_where_it_settles_so_that_nothing_trembles() -> None:
    _, whole, pose = human()
    random = np.random.default_rng(4)
    for _ in range(25):
        place = at(random.uniform((-0.4, 0.05, -0.1), (0.5, 1.2, 0.5)))
        placed = whole.place(pose, left=HandTarget(place))
        assert placed is not None
        settled = placed.settle(steps=5 * FIRST_STEPS)
        for steps in (1, 2):
            again = placed.settle(start=settled, steps=steps)
            assert np.abs(np.subtract(again, settled)).max() < 0.003


def test_a_shoulder_follows_the_further_the_harder_its_arm_pulls() -> None:
    _, whole, pose = human()
    turns = []
    for power in (0.0, 0.5, 1.0):
        placed = whole.place(pose, left=HandTarget(at((0.15, 0.75, 0.3))))
        assert placed is not None
        turns.append(float(np.linalg.norm(placed.settle(ReachStyle(power=power)).left)))
    assert turns[0] < turns[1] < turns[2]


@pytest.mark.parametrize("height", [0.15, 0.45, 0.7])
def test_two_palms_face_the_sides_of_a_box(height: float) -> None:
    character, whole, pose = human()
    places = {side: at((sign * 0.15, height, 0.28)) for side, sign in (("left", 1), ("right", -1))}
    reached = whole.reach(
        pose,
        HandTarget(places["left"], "hold", palm=(-1.0, 0.0, 0.0)),
        HandTarget(places["right"], "hold", palm=(1.0, 0.0, 0.0)),
    )
    rest = character.skeleton.rest.globals(character.skeleton)
    for side, inward in (("left", -1.0), ("right", 1.0)):
        assert palm_misses_by(reached, places[side], side) < 10.0
        hand = character.upper_body.arms[side].hand
        moved = reached.globals(character.skeleton)[hand.joint] @ np.linalg.inv(rest[hand.joint])
        assert moved[0, :3] @ hand.axes[2] * inward > 0.95


def test_the_head_stays_level_while_the_trunk_bows() -> None:
    _, whole, pose = human()
    reached = whole.reach(pose, HandTarget(at((0.1, 0.2, 0.35))))
    character = human()[0]
    head, chest = (character.anatomy.joints[part] for part in ("head", "chest"))
    before, after = (each.globals(character.skeleton)[:, :3, :3] for each in (pose, reached))
    bows = [np.degrees(np.arccos((after[j] @ before[j].T)[1, 1])) for j in (chest, head)]
    assert bows[0] > 35.0
    assert bows[1] < 0.5 * bows[0]


def test_a_body_without_legs_to_stand_on_keeps_its_pelvis() -> None:
    body = stick()
    parts = {**body.anatomy.joints, "head": 2}  # its chest is all that it looks with
    upper = type(body.upper)(body.skeleton, Anatomy("humanoid", parts))
    whole = WholeBody.of(upper)
    assert whole is not None
    pose = whole.reach(body.rest, HandTarget(np.array([0.3, 1.0, 0.8])))
    assert np.array_equal(pose.translations, body.rest.translations)
    assert np.array_equal(pose.rotations[0], body.rest.rotations[0])


def test_a_body_on_four_legs_reaches_with_torso_and_front_legs() -> None:
    assert WholeBody.of(bundled("vleo").upper) is None


@pytest.mark.parametrize("detached", [False, True])
def test_feet_without_toes_stay_where_they_are_also_beside_their_legs(detached: bool) -> None:
    character, _, standing = human()
    joints, parents = character.anatomy.joints, list(character.skeleton.parents)
    feet = [joints[f"{side}Foot"] for side in SIDES]
    for foot in feet if detached else ():
        parents[foot] = parents[joints["hips"]]
    skeleton = replace(character.skeleton, parents=tuple(parents))
    toeless = {part: joint for part, joint in joints.items() if "Toes" not in part}
    whole = WholeBody.of(type(character.upper_body)(skeleton, Anatomy("humanoid", toeless)))
    assert whole is not None
    before = standing.globals(skeleton)[feet]
    pose = whole.reach(standing, HandTarget(at(PLACES["low"])))
    assert not np.array_equal(pose.rotations, standing.rotations)
    assert np.abs(pose.globals(skeleton)[feet] - before).max() < 0.002 * character.height


@pytest.mark.parametrize("place", [(0.128, 0.693, 0.347), (-0.071, 0.777, 0.184)])
def test_hips_do_not_snap_while_both_legs_are_straight(place: tuple[float, float, float]) -> None:
    """Along a way of 4 cm of a person's size, they turn by less than 3° a centimetre.

    A straight leg that pulled at the pelvis held it tilted until it snapped, by 12°.
    """
    _, whole, pose = human()
    step, settled, turned = np.array([0.0, 0.0, 2e-3 / PERSON_M]), None, []
    for number in range(20):
        placed = whole.place(pose, left=HandTarget(at(np.array(place) + (number - 10) * step)))
        assert placed is not None
        for _ in range(3):
            settled = placed.settle(start=settled)
        assert settled is not None
        turned.append(settled.pelvis)
    assert np.degrees(np.abs(np.diff(turned, axis=0)).max()) < 0.2 * 3.0


def test_a_trunk_does_not_tremble_where_an_arm_that_carries_is_at_ease() -> None:
    """Both hands carry a box to and fro, 25 times a second; a spine trembled by 3° a frame."""
    _, whole, pose = human()
    settled, spines = None, []
    for number in range(80):
        turn = 1.8 * number / 25
        x, y = 0.12 * np.sin(turn), 0.5 - 0.1 * (1.0 - np.cos(turn))
        hands = (HandTarget(at((x + side, y, 0.26)), "hold") for side in (0.1, -0.1))
        placed = whole.place(pose, *hands)
        assert placed is not None
        settled = placed.settle(start=settled, steps=FIRST_STEPS if settled is None else 1)
        spines.append(settled.spine)
    assert np.degrees(np.abs(np.diff(spines, axis=0)).max()) < 1.0
