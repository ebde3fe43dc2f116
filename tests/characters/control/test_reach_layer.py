"""Hands that reach for places of the table, from frame to frame."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, PosedCharacter, Skeleton
from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.intents import BehaviourIntent, ReachIntent, Times
from cubeling.characters.control.controllers import default_height
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.control.layers.gaze import GazeLayer
from cubeling.characters.control.layers.gestures.sitting_up import SittingUpLayer
from cubeling.characters.control.layers.posture import PostureLayer
from cubeling.characters.control.layers.reach.hands import LEAVE_S, ReachingHand
from cubeling.characters.control.layers.reach.layer import CLEARANCE, ReachLayer, surface_of
from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array, Pose
from tests.examples import some

LAYERS = (*FOOT_LAYERS, SittingUpLayer, PostureLayer, ReachLayer, GazeLayer)
RATE, PERSON_M = 60, 1.7
Reaches = Callable[[float], Sequence[ReachIntent]]


@cache
def human() -> Character:
    """Return the bundled human."""
    return Character.load("human")


def intent(
    place: tuple[float, float, float], start: float, ready: float, **more: object
) -> ReachIntent:
    """Return an intent for a place in body heights on the table, of a human in the origin."""
    height = default_height(human())
    times = Times(start, ready, more.pop("relax", None), more.pop("end", None))  # type: ignore[arg-type]
    found = ReachIntent("it", height * np.array(place), times)
    return replace(found, **more)  # type: ignore[arg-type]


def played(
    reaches: Reaches, seconds: float, character: Character | None = None
) -> list[PosedCharacter]:
    """Return the frames of a character that reaches for what is asked at each time."""
    animator = Animator(character or human(), layers=LAYERS)
    times = np.arange(0.0, seconds, 1 / RATE).tolist()
    asked = (BehaviourIntent(reaches=tuple(reaches(now))) for now in times)
    return [
        animator.update(CharacterCommand(now, behaviour=behaviour))
        for now, behaviour in zip(times, asked, strict=True)
    ]


def palm(posed: PosedCharacter, side: str) -> Array:
    """Return where a palm is on the table, (3,) [m]."""
    where = human().upper_body.palm(posed.pose, side)
    assert where is not None
    return np.asarray(
        posed.table_from_character[:3, :3] @ where + posed.table_from_character[:3, 3]
    )


def person_mm(posed: PosedCharacter, length: Array) -> float:
    """Return the length of a vector on the table [mm], scaled to a person."""
    size = float(posed.table_from_character[1, 1]) * human().height
    return float(np.linalg.norm(length)) / size * PERSON_M * 1e3


def largest_step_deg(frames: Sequence[PosedCharacter]) -> float:
    """Return how far any joint turns from one frame to the next at most [degrees]."""
    turns = np.stack([posed.pose.rotations for posed in frames])
    cosine = np.clip(np.abs((turns[1:] * turns[:-1]).sum(-1)), 0.0, 1.0)
    return float(np.degrees(2 * np.arccos(cosine)).max())


def test_a_hand_arrives_in_time_stays_and_goes() -> None:
    one = intent((0.12, 0.55, 0.25), 0.2, 0.8, hand="left", relax=1.5, end=2.0)
    frames = played(lambda _: [one], 2.6)
    away = [person_mm(posed, palm(posed, "left") - one.target) for posed in frames]
    assert away[int(0.2 * RATE)] > 150.0
    assert max(away[int(0.8 * RATE) + 1 : int(1.5 * RATE)]) < 10.0
    idle = played(lambda _: [], 2.6)
    assert frames[-1].pose.rotations == pytest.approx(idle[-1].pose.rotations, abs=1e-9)
    assert largest_step_deg(frames) < 8.0


@pytest.mark.parametrize("left_at", [0.15, 0.3, 0.45, 0.6])
def test_a_hand_that_is_given_up_on_its_way_leaves_no_faster_than_it_came(left_at: float) -> None:
    hand, asked, weights = ReachingHand(), intent((0.0, 0.5, 0.3), 0.0, 0.6), []
    for frame in range(120):
        now = frame / 60
        if now < left_at:
            hand.follow(asked, (0.0, 0.5, 0.3), now, 1.0)
        else:
            hand.leave(now)
        hand.advance(now)
        weights.append(hand.weight)
    speeds = np.diff(weights)
    assert weights[-1] == 0.0
    assert abs(speeds).max() <= 1.01 * math.pi / 2 / 0.6 / 60, "that of the ease of 0.6 s"


def test_a_moving_place_is_followed_within_a_centimetre() -> None:
    def moving(now: float) -> list[ReachIntent]:
        place = (0.12 + 0.05 * math.sin(4 * now), 0.55 + 0.05 * math.cos(4 * now), 0.28)
        return [intent(place, 0.0, 0.5, hand="left")]

    frames = played(moving, 2.5)
    for number, posed in enumerate(frames[int(0.6 * RATE) :], int(0.6 * RATE)):
        where = moving(number / RATE)[0].target
        assert person_mm(posed, palm(posed, "left") - where) < 10.0


def test_what_is_left_out_fades_within_its_time() -> None:
    one = intent((0.12, 0.55, 0.25), 0.0, 0.5, hand="left")
    frames = played(lambda now: [one] if now < 1.0 else [], 2.0)
    idle = played(lambda _: [], 2.0)
    gone = int((1.0 + LEAVE_S) * RATE) + 2
    assert frames[gone].pose.rotations == pytest.approx(idle[gone].pose.rotations, abs=1e-9)
    assert largest_step_deg(frames) < 10.0


@pytest.mark.parametrize(
    "later",
    some(
        [
            {"hand": "right"},
            {"hand": "left", "kind": "grasp", "key": "other"},
            {"hand": "left", "expressivity": GestureExpressivity(openness=1.0, power=1.0)},
            {"hand": "left", "kind": "point"},
            {"hand": "both"},
        ],
        3,
    ),
)
def test_a_change_of_hand_kind_or_style_has_no_jump(later: dict[str, object]) -> None:
    place = (0.05, 0.55, 0.3)
    one, other = intent(place, 0.0, 0.5, hand="left"), intent(place, 0.0, 0.5, **later)
    frames = played(lambda now: [one] if now < 1.0 else [other], 2.0)
    assert largest_step_deg(frames) < 12.0


def test_a_place_that_jumps_and_times_that_change_have_no_jump() -> None:
    one = intent((0.12, 0.55, 0.25), 0.0, 0.5, hand="left")
    there = intent((0.0, 0.7, 0.25), 0.0, 0.5, hand="left")
    over = intent((0.0, 0.7, 0.25), 0.0, 0.5, hand="left", relax=0.1, end=0.2)
    frames = played(lambda now: [one] if now < 1 else [there] if now < 2 else [over], 2.5)
    assert largest_step_deg(frames) < 15.0  # within the bound of a sixth of a second
    before_end = frames[2 * RATE - 1]
    assert person_mm(before_end, palm(before_end, "left") - there.target) < 10.0


def test_the_nearest_hand_keeps_its_task_over_the_middle() -> None:
    """A place that wanders by 3 cm about the middle does not change hands, a far one does."""

    def wandering(now: float) -> list[ReachIntent]:
        side = 0.1 - 0.12 * min(now, 1.0) + 0.02 * math.sin(20 * now) - 0.3 * max(now - 2.5, 0.0)
        return [intent((side, 0.55, 0.3), 0.0, 0.4)]

    frames = played(wandering, 3.5)
    near = [
        min(("left", "right"), key=lambda s: person_mm(posed, palm(posed, s) - target))
        for posed, target in (
            (posed, wandering(number / RATE)[0].target) for number, posed in enumerate(frames)
        )
    ]
    assert set(near[RATE : int(2.5 * RATE)]) == {"left"}
    assert near[-1] == "right"
    assert largest_step_deg(frames) < 12.0


def test_two_nearest_intents_take_two_hands() -> None:
    ones = [
        intent((0.1, 0.55, 0.3), 0.0, 0.4, key="a"),
        intent((0.06, 0.6, 0.3), 0.0, 0.4, key="b"),
    ]
    last = played(lambda _: ones, 1.0)[-1]
    assert person_mm(last, palm(last, "left") - ones[0].target) < 10.0
    assert person_mm(last, palm(last, "right") - ones[1].target) < 10.0


@pytest.mark.parametrize("name", ["human", "vleo", "robot"])
def test_a_hand_stays_out_of_the_body(name: str) -> None:
    character = Character.load(name)
    surface = surface_of(character, character.skeleton.rest)
    for start, end, radius in surface.capsules:
        for share in (0.0, 0.4, 1.0):
            a, b = np.array(start), np.array(end)
            inside = a + share * (b - a) + 0.2 * radius * np.array([1.0, 0.3, 0.2])
            outside = np.array(surface.outside(tuple(inside.tolist())))
            along = np.clip((outside - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
            away = np.linalg.norm(outside - a - along * (b - a))
            assert away >= radius + CLEARANCE * character.height - 1e-6


def test_an_unreachable_place_is_pointed_at_by_arm_and_torso_and_the_feet_stay() -> None:
    far = intent((0.4, 0.5, 2.0), 0.0, 0.6, hand="left")
    frames = played(lambda _: [far], 1.5)
    body, last = human().upper_body, frames[-1]
    placed = last.pose.globals(human().skeleton)[:, :3, 3]
    _, upper, lower, _ = body.arms["left"].joints
    hand = body.palm(last.pose, "left")
    assert hand is not None
    place = np.linalg.inv(last.table_from_character) @ [*far.target, 1.0]
    for one, other, most in [
        (placed[lower] - placed[upper], hand - placed[lower], 5.0),
        (hand - placed[upper], place[:3] - placed[upper], 3.0),
    ]:
        cosine = one @ other / np.linalg.norm(one) / np.linalg.norm(other)
        assert math.degrees(math.acos(min(cosine, 1.0))) < most
    idle = played(lambda _: [], 1.5)[-1].pose.globals(human().skeleton)[:, :3, 3]
    feet = [human().anatomy.joints[part] for part in ("leftFoot", "rightFoot")]
    assert placed[feet] == pytest.approx(idle[feet], abs=1e-3)
    assert np.linalg.norm(placed[upper] - idle[upper]) > 0.05


def test_a_body_without_arms_is_left_alone() -> None:
    rest = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    box = Character("box", Skeleton(("box",), (-1,), rest), {}, ())
    animator = Animator(box, layers=(ReachLayer,))
    behaviour = BehaviourIntent(reaches=(ReachIntent("it", np.ones(3), Times(0.0, 0.1)),))
    posed = animator.update(CharacterCommand(0.0, behaviour=behaviour))
    assert posed.pose.rotations == pytest.approx(rest.rotations)


def test_a_place_that_is_not_finite_is_refused_in_one_line() -> None:
    wrong = ReachIntent("cube", np.array([0.0, np.nan, 0.0]), Times(0.0, 0.1))
    with pytest.raises(CharacterError, match=r"reach 'cube' at 0.0 s: its target .* is not finite"):
        played(lambda _: [wrong], 0.1)


def test_a_place_that_is_to_be_reached_later_gives_no_jump() -> None:
    place = (-0.2, 0.55, 0.25)

    def peak(later: float) -> float:
        frames = played(lambda now: [intent(place, 0.1, 0.7 if now < 0.4 else later)], 2.5)
        turns = np.stack([posed.pose.rotations for posed in frames])
        return float(np.abs(np.diff(turns, 2, axis=0)).max())

    assert peak(1.5) < 5.0 * peak(0.7)
