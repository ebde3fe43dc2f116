"""Upper bodies that reach: torso, shoulders, elbows, wrists (Huang 2013, sections 8.6 and 8.7)."""

import math
from typing import TypedDict

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Pose
from cubeling.characters.ik.reaching import HandTarget, ReachKind, ReachStyle
from cubeling.characters.ik.reaching.arms import MAX_ELBOW_BEND_RAD
from cubeling.characters.ik.reaching.torso import (
    EASY_EXTENSION,
    FOUR_LEGS,
    MAX_LEAN_RAD,
    MAX_TURN_RAD,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from tests.characters.ik.reaching.bodies import BUNDLED, PERSON_M, Body, bundled, stick
from tests.examples import some

SIDES = ("left", "right")
AHEAD, OUT = np.array([0.1, -0.2, 0.95]), np.array([0.95, -0.2, 0.2])


def target(body: Body, side: str, direction: Array, extension: float) -> Array:
    """Return a place in a direction from the shoulder, x outward, in arm lengths from there."""
    sign = 1.0 if side == "left" else -1.0
    unit = direction / np.linalg.norm(direction)
    return body.shoulder(side) + extension * body.reach_of(side) * unit * [sign, 1.0, 1.0]


class Hands(TypedDict, total=False):
    """The hands that reach."""

    left: HandTarget
    right: HandTarget


def hand(side: str, goal: HandTarget) -> Hands:
    """Return one hand that reaches."""
    return {"left": goal} if side == "left" else {"right": goal}


def reached(body: Body, side: str, where: Array, style: ReachStyle | None = None) -> Pose:
    """Return the rest pose with a palm at a place."""
    return body.upper.reach(body.rest, style=style or ReachStyle(), **hand(side, HandTarget(where)))


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", BUNDLED)
def test_a_hand_is_within_a_centimetre_of_all_that_it_can_reach(name: str, side: str) -> None:
    body, seed = bundled(name), np.random.default_rng(5)
    within = 0
    for _ in range(80):
        direction = seed.normal(size=3) * [1.0, 1.0, 0.5] + [0.0, 0.0, 0.8]
        where = target(body, side, direction, seed.uniform(0.45, 1.3))
        found = body.upper.reach_for(body.rest, **hand(side, HandTarget(where)))
        if found.effort < 1.0:
            within += 1
            assert body.person_mm(body.palm(side, found.pose) - where) < 10.0
    assert within > 40


def test_a_torso_stays_upright_for_what_is_near() -> None:
    body = bundled("human")
    pose = reached(body, "left", target(body, "left", AHEAD, 0.95 * EASY_EXTENSION))
    assert body.lean(pose) < 1e-6


@pytest.mark.parametrize("name", ["human", "stick"])
def test_a_torso_leans_for_what_is_beyond_the_arm_and_the_hand_gets_there(name: str) -> None:
    body = stick() if name == "stick" else bundled(name)
    where = target(body, "left", AHEAD, 1.15)
    found = body.upper.reach_for(body.rest, left=HandTarget(where))
    assert 0.0 < found.effort < 1.0
    assert math.radians(5.0) < body.lean(found.pose) <= MAX_LEAN_RAD
    assert body.person_mm(body.palm("left", found.pose) - where) < 10.0


@pytest.mark.parametrize("extension", [1.0, 1.1, 1.2])
def test_a_lean_is_between_those_of_a_straight_and_of_a_bent_arm(extension: float) -> None:
    """For a trunk of one joint the law of cosines tells both (Huang 2013, Fig. 8.5)."""
    body = stick()
    shoulders = [body.shoulder(side) for side in SIDES]
    base, top = body.place(body.rest, 1), 0.5 * (shoulders[0] + shoulders[1])
    full = body.reach_of("left")
    places = [shoulder + [0.0, 0.0, extension * full] for shoulder in shoulders]
    pose = body.upper.reach(body.rest, HandTarget(places[0]), HandTarget(places[1]))
    way = 0.5 * (places[0] + places[1]) - base
    trunk, far = float(np.linalg.norm(top - base)), float(np.linalg.norm(way))
    wanted = []
    for arm in (full, EASY_EXTENSION * full):
        open_angle = math.acos((trunk**2 + far**2 - arm**2) / (2 * trunk * far))
        wanted.append(math.radians(angle_deg(top - base, way)) - open_angle)
    assert max(wanted[0], 0.0) <= body.lean(pose) + 1e-9 <= wanted[1]


@pytest.mark.parametrize("side", SIDES)
def test_a_torso_turns_to_what_is_far_to_the_side(side: str) -> None:
    body, sign = bundled("human"), 1.0 if side == "left" else -1.0
    pose = reached(body, side, target(body, side, OUT, 1.4))
    assert math.radians(10.0) < sign * body.turn(pose) <= MAX_TURN_RAD


@pytest.mark.parametrize("direction", [AHEAD, OUT, np.array([-0.5, 0.2, 0.8]), [0.3, 0.8, 0.6]])
@pytest.mark.parametrize("name", BUNDLED)
def test_an_arm_is_straight_and_aligned_with_what_is_beyond(name: str, direction: Array) -> None:
    body = bundled(name)
    where = target(body, "left", np.asarray(direction), 6.0)
    found = body.upper.reach_for(body.rest, left=HandTarget(where))
    pose = found.pose
    shoulder, elbow = body.shoulder("left", pose), body.elbow("left", pose)
    palm = body.palm("left", pose)
    assert found.effort > 1.0
    assert angle_deg(elbow - shoulder, palm - elbow) < 5.0
    assert angle_deg(palm - shoulder, where - shoulder) < 3.0


@pytest.mark.parametrize("extension", [0.6, 0.95, 1.1])
def test_a_shoulder_follows_the_further_the_more_power(extension: float) -> None:
    body = bundled("human")
    where, moves = target(body, "left", np.array([0.2, 0.3, 0.9]), extension), []
    collar = body.upper.arms["left"].joints[0]
    for power in np.linspace(0.0, 1.0, 6):
        pose = reached(body, "left", where, ReachStyle(power=float(power)))
        turn = rotations.multiply(
            rotations.conjugate(body.rest.rotations[collar]), pose.rotations[collar]
        )
        moves.append(float(np.linalg.norm(rotations.to_rotation_vector(turn))))
        assert body.person_mm(body.palm("left", pose) - where) < 10.0
    assert (np.diff(moves) > math.radians(0.3)).all()
    assert moves[-1] < math.radians(25.0)


def test_power_moves_the_torso() -> None:
    body = bundled("human")
    where = target(body, "left", AHEAD, 0.95)
    leans = [body.lean(reached(body, "left", where, ReachStyle(power=p))) for p in (0.0, 0.5, 1.0)]
    assert leans[0] < leans[1] < leans[2]


@pytest.mark.parametrize("extension", [0.55, 0.75, 0.95])
@pytest.mark.parametrize("direction", [AHEAD, [0.4, -0.7, 0.5], [0.5, 0.4, 0.7]])
@pytest.mark.parametrize("name", BUNDLED)
def test_openness_moves_the_elbow_from_the_trunk_and_not_the_wrist(
    name: str, direction: Array, extension: float
) -> None:
    body = bundled(name)
    where = target(body, "left", np.asarray(direction), extension * EASY_EXTENSION)
    apart, wrists = [], []
    for openness in np.linspace(0.0, 1.0, 6):
        style = ReachStyle(openness=float(openness))
        pose = reached(body, "left", where, style)
        apart.append(body.from_trunk(body.elbow("left", pose), pose))
        wrists.append(body.wrist("left", pose))
        assert body.person_mm(body.palm("left", pose) - where) < 1.0
    assert (np.diff(apart) > 0.0).all()
    assert max(body.person_mm(wrist - wrists[0]) for wrist in wrists) < 1.0


def test_the_elbow_swivels_from_20_degrees_inward_to_70_degrees_outward() -> None:
    body = bundled("human")
    where = target(body, "left", np.array([0.0, 0.0, 1.0]), 0.6)
    angles = []
    for openness in (0.0, 0.5, 1.0):
        pose = reached(body, "left", where, ReachStyle(openness=openness))
        shoulder, wrist = body.shoulder("left", pose), body.wrist("left", pose)
        along = (wrist - shoulder) / np.linalg.norm(wrist - shoulder)
        side = body.elbow("left", pose) - shoulder
        side -= along * (along @ side)
        down = np.array([0.0, -1.0, 0.0]) + along * along[1]
        angles.append(math.degrees(math.atan2(np.cross(down, side) @ along, down @ side)))
    # Between them is what people do with a hand ahead of the shoulder, at 0.6 of the arm.
    assert angles == pytest.approx([-20.0, 18.0, 70.0], abs=5.0)
    assert angles[::2] == pytest.approx([-20.0, 70.0], abs=0.5)


@pytest.mark.parametrize("extension", [0.6, 1.05, 1.3])
def test_a_more_open_torso_turns_no_less(extension: float) -> None:
    body = bundled("human")
    where, turns = target(body, "right", OUT, extension), []
    for openness in np.linspace(0.0, 1.0, 6):
        chest = body.chest(reached(body, "right", where, ReachStyle(openness=float(openness))))
        turns.append(math.acos(min((np.trace(chest) - 1.0) / 2.0, 1.0)))
    assert (np.diff(turns) > -1e-9).all()


@pytest.mark.parametrize("name", some(["human", "vleo"]))
def test_no_joint_jumps_while_a_place_moves_smoothly(name: str) -> None:
    """Over the table, from near to far, no joint turns by 5° a centimetre of a person's size.

    Where torso and arm are stretched, the last of the reach is gained by turns that are faster.
    """
    body, step = bundled(name), 0.005
    size = body.reach_of("left")
    rates: list[float] = []
    at_the_end: list[float] = []
    for out, height in [(-0.4, -0.5), (0.0, -0.2), (0.0, 0.1), (0.5, -0.4), (0.8, 0.0)]:
        before = None
        for ahead in np.arange(0.4, 2.5, step / size * body.height / PERSON_M):
            place = body.shoulder("left") + size * np.array([out, height, ahead])
            found = body.upper.reach_for(body.rest, HandTarget(place))
            turns = found.pose.rotations
            if before is not None:
                cosine = np.clip(np.abs((before * turns).sum(-1)), 0.0, 1.0)
                rate = float(np.degrees(2 * np.arccos(cosine)).max()) / (100 * step)
                (at_the_end if 0.35 < found.effort < 1.05 else rates).append(rate)
            before = turns
    assert max(rates) < 5.0
    assert max(at_the_end) < 35.0


@given(
    where=st.tuples(*3 * [st.floats(allow_nan=False, allow_infinity=False)]),
    other=st.tuples(*3 * [st.floats(-3.0, 3.0)]),
    openness=st.floats(0.0, 1.0),
    power=st.floats(0.0, 1.0),
    kind=st.sampled_from(["reach", "touch", "point", "grasp"]),
    name=st.sampled_from(["human", "vleo", "stick"]),
)
def test_any_place_gives_a_pose_within_the_limits(
    where: tuple[float, float, float],
    other: tuple[float, float, float],
    openness: float,
    power: float,
    kind: ReachKind,
    name: str,
) -> None:
    body = stick() if name == "stick" else bundled(name)
    pose = body.upper.reach(
        body.rest,
        HandTarget(where, kind),
        HandTarget(other, palm=other, fingers=(0.0, 0.0, 1.0)),
        ReachStyle(openness, power),
    )
    assert np.isfinite(pose.rotations).all()
    assert np.linalg.norm(pose.rotations, axis=-1) == pytest.approx(1.0, abs=1e-6)
    bend = angle_deg(
        body.elbow("left", pose) - body.shoulder("left", pose),
        body.wrist("left", pose) - body.elbow("left", pose),
    )
    assert bend <= math.degrees(MAX_ELBOW_BEND_RAD) + 20.0  # to the palm it is the limit
    chest = body.chest(pose)
    turned = math.acos(np.clip((np.trace(chest) - 1.0) / 2.0, -1.0, 1.0))
    assert turned <= MAX_LEAN_RAD + MAX_TURN_RAD


@pytest.mark.parametrize("arms", [(), ("left",), ("right",)])
def test_a_body_reaches_with_the_arms_that_it_has(arms: tuple[str, ...]) -> None:
    body = stick(arms=arms)
    where = (0.1, 1.2, 0.4)
    pose = body.upper.reach(body.rest, HandTarget(where), HandTarget(where))
    assert np.isfinite(pose.rotations).all()
    for side in arms:
        assert body.palm(side, pose) == pytest.approx(where, abs=1e-6)
    assert (body.upper.effort(body.rest, where) == math.inf) == (not arms)


def test_an_arm_without_length_is_none() -> None:
    body = stick(bone=0.0)
    assert not body.upper.arms
    assert body.upper.reach(body.rest, HandTarget((0.0, 1.0, 1.0))) is body.rest


@pytest.mark.parametrize("side", SIDES)
def test_a_hand_faces_as_it_is_asked_to(side: str) -> None:
    body, sign = bundled("human"), 1.0 if side == "left" else -1.0
    where = target(body, side, AHEAD, 0.7)
    asked = [
        ((0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
        ((-sign, 0.0, 0.0), (0.0, 0.3, 1.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    ]
    for palm, fingers in asked:
        goal = HandTarget(where, palm=palm, fingers=fingers)
        pose = body.upper.reach(body.rest, **hand(side, goal))
        axes = hand_axes(body, side, pose)
        assert angle_deg(axes[2], np.array(palm)) < 12.0
        assert angle_deg(axes[0], np.array(fingers)) < 12.0
        assert body.person_mm(body.palm(side, pose) - where) < 1.0


def test_a_wrist_that_bends_too_far_stops_and_the_palm_is_still_there() -> None:
    body = bundled("human")
    where = target(body, "left", AHEAD, 0.7)
    goal = HandTarget(where, palm=(0.0, 0.0, -1.0), fingers=(0.0, 0.0, -1.0))
    pose = body.upper.reach(body.rest, left=goal)
    forearm = body.wrist("left", pose) - body.elbow("left", pose)
    assert angle_deg(forearm, hand_axes(body, "left", pose)[0]) < 90.0
    assert body.person_mm(body.palm("left", pose) - where) < 1.0


@pytest.mark.parametrize("direction", [AHEAD, OUT, [-0.4, 0.1, 0.9], [0.2, 0.7, 0.7]])
@pytest.mark.parametrize("extension", [0.8, 1.5, 8.0])
def test_the_line_of_the_index_finger_goes_to_what_is_pointed_to(
    direction: Array, extension: float
) -> None:
    body = bundled("human")
    where = target(body, "right", np.asarray(direction), extension)
    pose = body.upper.reach(body.rest, right=HandTarget(where, "point"))
    knuckle, joint = (
        body.place(pose, body.anatomy.joints[f"rightIndex{part}"])
        for part in ("Proximal", "Intermediate")
    )
    assert angle_deg(joint - knuckle, where - knuckle) < 3.0
    assert body.lean(pose) < 1e-6


def test_both_hands_get_to_what_is_beyond_both_arms() -> None:
    body = bundled("human")
    middle = 0.5 * (body.shoulder("left") + body.shoulder("right"))
    size = body.reach_of("left")
    places = [middle + [x * size, -0.2 * size, 1.0 * size] for x in (0.15, -0.15)]
    found = body.upper.reach_for(body.rest, HandTarget(places[0]), HandTarget(places[1]))
    assert 0.0 < found.effort < 1.0
    for side, where in zip(SIDES, places, strict=True):
        assert body.person_mm(body.palm(side, found.pose) - where) < 10.0


def test_the_pose_stays_as_it_is_without_weight_and_changes_smoothly_with_it() -> None:
    body = bundled("human")
    where = target(body, "left", AHEAD, 1.2)
    assert body.upper.reach(body.rest, left=HandTarget(where, weight=0.0)) is body.rest
    before, worst = body.rest.rotations, 0.0
    for weight in np.linspace(0.0, 1.0, 51)[1:]:
        after = body.upper.reach(body.rest, left=HandTarget(where, weight=float(weight))).rotations
        worst = max(worst, float(np.arccos(np.clip(np.abs((before * after).sum(-1)), 0, 1)).max()))
        before = after
    assert worst < math.radians(4.0)


@pytest.mark.parametrize("name", ["vleo", "robot"])
def test_the_other_front_paw_stays_on_the_ground(name: str) -> None:
    body = bundled(name)
    where = target(body, "left", AHEAD, 1.1)
    pose = reached(body, "left", where)
    assert 0.0 < body.lean(pose) <= FOUR_LEGS * MAX_LEAN_RAD
    assert body.person_mm(body.wrist("right", pose) - body.wrist("right", body.rest)) < 1.0
    paw = body.upper.arms["right"].hand.joint
    turns = [each.globals(body.skeleton)[paw, :3, :3] for each in (pose, body.rest)]
    assert turns[0] == pytest.approx(turns[1], abs=1e-6)


def test_fingertips_touch() -> None:
    body = bundled("human")
    where = target(body, "left", AHEAD, 0.8)
    pose = body.upper.reach(body.rest, left=HandTarget(where, "touch"))
    last = body.place(pose, body.anatomy.joints["leftMiddleIntermediate"])
    knuckle = body.place(pose, body.anatomy.joints["leftMiddleProximal"])
    assert last + 0.8 * (last - knuckle) == pytest.approx(where, abs=1e-4)


def hand_axes(body: Body, side: str, pose: Pose) -> Array:
    """Return the axes of a hand in a pose, as `Hand.axes`."""
    hand = body.upper.arms[side].hand
    rest, now = (each.globals(body.skeleton)[hand.joint, :3, :3] for each in (body.rest, pose))
    return np.asarray(hand.axes @ (now @ np.linalg.inv(rest)).T)


def angle_deg(a: Array, b: Array) -> float:
    """Return the angle between two vectors [degrees]."""
    cosine = float(a @ b) / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-12)
    return math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
