"""Characters that walk: arrival, gaits, feet that hold, and commands that are refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    LocomotionIntent,
)
from cubeling.characters.control.controllers.walk import WalkController
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.locomotion.gaits import Gaits
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from tests.characters.commands import command
from tests.characters.control.played import RATE_HZ, heading, place, play, velocities
from tests.examples import examples, some


def arrival(character, speed, target, place=None, seconds=40):
    animator = Animator(character, place=place)
    for number in range(seconds * RATE_HZ):
        posed = animator.update(CharacterCommand(number / RATE_HZ, LocomotionIntent(speed, target)))
        if number and posed.state == "idle":
            assert np.hypot(*(posed.table_from_character[[0, 2], 3] - target)) < ARRIVAL_DISTANCE_M
            return number / RATE_HZ
    return math.inf


@pytest.fixture(scope="module")
def human():
    return Character.load("human")


@pytest.fixture(scope="module", params=some(["walker", "human"]))
def anyone(request, walker, human):
    return walker if request.param == "walker" else human


def test_the_first_frame_stands_at_rest(anyone):
    posed = Animator(anyone).update(
        CharacterCommand(100.0, LocomotionIntent(5.0, np.array([1.0, 0.0])))
    )
    assert np.allclose(place(posed), 0)
    assert posed.timestamp == 100.0


def test_a_walker_is_seventeen_centimetres_tall(anyone):
    posed = Animator(anyone).update(CharacterCommand(0.0))
    top = posed.table_from_character @ [0, anyone.height, 0, 1]
    assert top[1] == pytest.approx(0.17)


@settings(deadline=None, max_examples=examples(25))
@given(
    st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-math.pi, math.pi), st.floats(0.6, 5.0)
)
def test_it_always_arrives(walker, x, z, yaw, speed):
    start = RootDelta(0.0, 0.0, yaw)
    assert arrival(walker, speed, np.array([x, z]), start) < 30


NEAR = [(0.055, 135), (0.1, -90)]
NEAR += [(m, way) for m in (0.055, 0.07, 0.1) for way in (135, -90, 30, 90, 180)]


@pytest.mark.parametrize(("distance", "degrees"), some(dict.fromkeys(NEAR), 2))
def test_it_does_not_orbit_a_near_target(human, degrees, distance):
    angle = math.radians(degrees)
    target = distance * np.array([math.sin(angle), math.cos(angle)])
    for speed in (1.0, 3.0, 5.0):
        assert arrival(human, speed, target) < 6


@pytest.mark.parametrize("degrees", some([180, 60, 0]))
def test_the_faster_the_sooner_and_running_before_walking(anyone, degrees):
    target = 0.4 * np.array([math.sin(math.radians(degrees)), math.cos(math.radians(degrees))])
    times = [arrival(anyone, speed, target) for speed in (0.7, 1.5, 2.7, 3.5, 5.0)]
    assert (np.diff(times) < 0).all()


def test_a_target_that_is_left_behind_is_turned_to_on_one_side(human):
    animator = Animator(human)
    play(animator, 1.0, activity="move", speed=2.0, target=np.array([0.0, 9.0]))
    frames = play(animator, 2.0, 1.0, activity="move", speed=2.0, target=np.array([0.0, -9.0]))
    turned = np.unwrap([heading(posed) for posed in frames])
    assert abs(turned[-1]) > math.radians(150)
    around = turned[np.abs(turned) < math.radians(150)]
    assert (np.diff(around) * np.sign(turned[-1]) > -1e-3).all()


@pytest.mark.parametrize(
    ("speed", "state"), [(0.0, "idle"), (0.5, "idle"), (1.0, "walk"), (2.9, "walk"), (4.0, "run")]
)
def test_the_state_follows_speed(anyone, speed, state):
    target = np.array([0.0, 50.0])
    frames = play(Animator(anyone), 2.0, activity="move", speed=speed, target=target)
    assert frames[-1].state == state
    assert frames[-1].speed == pytest.approx(0.0 if state == "idle" else speed, abs=1e-3)


def test_angular_is_positive_to_the_right(anyone):
    frames = play(Animator(anyone), 0.5, activity="move", speed=2.0, target=np.array([-9.0, 0.0]))
    assert frames[-1].angular > 1.0
    assert heading(frames[-1]) < 0.0  # +x is to the left of a character that looks along +z


def test_a_walk_straight_on_covers_the_ground_at_the_pace_of_its_speed(walker):
    animator = Animator(walker)
    frames = play(animator, 3.0, activity="move", speed=2.0, target=np.array([0.0, 99.0]))
    moved = np.linalg.norm(place(frames[-1]) - place(frames[-31]))
    assert moved == pytest.approx(animator.scale * 1.39, rel=0.05)


def test_planted_feet_do_not_slide(human):
    from cubeling.characters.skeleton.feet import foot_joints_by_side

    left, _ = foot_joints_by_side(human.skeleton)
    animator = Animator(human)
    frames = play(animator, 4.0, rate=60, activity="move", speed=2.0, target=np.array([0.0, 99.0]))
    feet = np.array(
        [(f.table_from_character @ f.pose.globals(human.skeleton))[left] for f in frames]
    )
    feet = feet[90:, :, :3, 3] / animator.scale
    speed = np.linalg.norm(np.diff(feet[..., [0, 2]], axis=0), axis=-1) * 60
    slowest = speed.min(axis=1)  # of ankle and toes: the one that it stands on
    standing = slowest < 0.3
    assert 0.45 < standing.mean() < 0.75
    assert np.median(slowest[standing]) < 0.02  # [m/s] of a person 1.7 m tall


@pytest.mark.parametrize("count", some([6, 25]))
def test_no_joint_jumps_whatever_is_asked(human, count):
    rng = np.random.default_rng(3)
    stiff = replace(human, springs=())  # hair may jump
    rate, animator, frames, time = 60, Animator(stiff), [], 0.0
    for _ in range(count):
        length, speed = rng.uniform(0.1, 1.5), rng.choice([0.0, 1.0, 2.8, 3.2, 5.0])
        target = rng.uniform(-0.4, 0.4, 2)
        frames += play(
            animator,
            length,
            time,
            rate,
            activity="move",
            speed=speed,
            target=target,
            facing=np.array([0.0, 2.0]),
        )
        time += round(length * rate) / rate
    running = human.clips["Run"].in_place.rotations
    steps = rotations.multiply(running[1:], rotations.conjugate(running[:-1]))
    fastest = np.linalg.norm(rotations.to_rotation_vector(steps), axis=-1).max() * 60 * 1.25
    speeds = velocities(frames, rate)
    assert np.linalg.norm(speeds, axis=-1).max() < 1.75 * fastest  # between walking and running
    ways = np.array([place(frame) for frame in frames])
    assert np.linalg.norm(np.diff(ways, axis=0), axis=1).max() * rate < 1.1 * 4.25 * animator.scale


def test_standing_it_turns_to_what_it_is_to_look_at(anyone):
    frames = play(Animator(anyone), 6.0, facing=np.array([-1.0, -1.0]))
    assert abs(math.remainder(heading(frames[-1]) + 3 * math.pi / 4, math.tau)) < 0.12
    assert np.linalg.norm(place(frames[-1])) < 0.01
    assert {frame.state for frame in frames} == {"idle"}


def test_all_that_walk_as_a_character_share_its_gaits(human):
    """They take 0.2 s to find; a key that changes the scenario would be felt."""
    for _ in range(2):
        controller = Animator(human).controller
        assert isinstance(controller, WalkController)
        assert controller.gaits is human.gaits


def test_the_same_commands_give_the_same_frames(human):
    rng = np.random.default_rng(0)
    commands = [
        CharacterCommand(i / 30, LocomotionIntent(rng.uniform(0, 5), rng.uniform(-0.3, 0.3, 2)))
        for i in range(60)
    ]
    one, two = ([a.update(c) for c in commands] for a in (Animator(human), Animator(human)))
    for a, b in zip(one, two, strict=True):
        assert np.array_equal(a.pose.rotations, b.pose.rotations)
        assert np.array_equal(a.table_from_character, b.table_from_character)


def test_the_frame_rate_hardly_matters(walker):
    target = np.array([0.3, 0.3])
    ends = [
        place(play(Animator(walker), 2.0, 0.0, rate, activity="move", speed=2.0, target=target)[-1])
        for rate in (30, 60, 120)
    ]
    assert np.linalg.norm(ends[0] - ends[2]) < 0.02
    assert np.linalg.norm(ends[1] - ends[2]) < 0.01


@pytest.mark.parametrize("gap", [0.0, -5.0, 100.0])
def test_gaps_in_time_make_no_leap(anyone, gap):
    animator = Animator(anyone)
    far = np.array([0.0, 9.0])
    before = play(animator, 2.0, activity="move", speed=5.0, target=far)[-1]
    after = animator.update(CharacterCommand(before.timestamp + gap, LocomotionIntent(5.0, far)))
    assert np.linalg.norm(place(after) - place(before)) <= 0.25 * 4.3 * animator.scale


def test_a_point_that_runs_ahead_is_not_stopped_at(walker):
    animator = Animator(walker)
    posed = animator.update(CharacterCommand(0.0))
    for number in range(1, 120):
        x, z = place(posed)
        posed = animator.update(
            CharacterCommand(
                number / 30, LocomotionIntent(speed=2.0, target=np.array([x, z + 0.03]), stop=False)
            )
        )
    assert posed.state == "walk"
    assert posed.speed == pytest.approx(2.0, abs=0.01)


def test_a_walker_knows_no_actions(anyone):
    with pytest.raises(CharacterError, match="does not know 'kiss'; it knows idle, move"):
        Animator(anyone).update(CharacterCommand(0.0, action=ActionIntent("kiss")))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_numbers_that_are_none_are_refused_and_leave_no_trace(anyone, bad):
    animator, target = Animator(anyone), np.array([0.0, 1.0])
    play(animator, 0.5, activity="move", speed=2.0, target=target)
    for asked in (
        CharacterCommand(0.6, LocomotionIntent(2.0, np.array([bad, 0.0]))),
        CharacterCommand(0.6, LocomotionIntent(bad, target)),
        CharacterCommand(bad, LocomotionIntent(2.0, target)),
    ):
        with pytest.raises(CharacterError, match="not finite"):
            animator.update(asked)
    assert np.isfinite(place(animator.update(command(0.6, "move", 2.0, target)))).all()


def test_a_walker_can_also_be_asked_to_hide(anyone):
    assert not Animator(anyone).update(CharacterCommand(0.0, visible=False)).visible


def test_a_walker_does_what_its_other_clips_are_once(human):
    animator = Animator(human)
    assert set(animator.actions) == {"wave", "cheer", "jump", "nod", "shake"}
    frames = play(animator, 6.0, activity="jump")
    states = [frame.state for frame in frames]
    ended = states.index("jump") + states.count("jump")
    assert states.count("jump") / RATE_HZ == pytest.approx(human.clips["jump"].duration, abs=0.1)
    assert set(states[ended:]) == {"idle"}
    toes = human.skeleton.index("LeftToe")
    heights = [frame.pose.globals(human.skeleton)[toes, 1, 3] for frame in frames]
    assert max(heights) > min(heights) + 0.1
    again = play(animator, 0.5, start=7.0, activity="idle") + play(
        animator, 1.0, 8.0, activity="jump"
    )
    assert again[-1].state == "jump"


def test_a_walker_that_is_called_away_from_an_action_goes_without_a_jump(human):
    animator = Animator(human, layers=FOOT_LAYERS)
    frames = play(animator, 0.9, rate=60, activity="cheer")
    frames += play(animator, 1.0, 0.9, 60, activity="move", speed=2.0, target=np.array([9.0, 0.0]))
    assert frames[-1].state == "walk"
    assert np.abs(velocities(frames, 60)).max() < 40
    assert np.ptp([place(frame) for frame in frames[:54]], axis=0).max() < 1e-9


def in_other_units(character, factor):
    """Return the same body, written in a unit of which a metre has so many."""
    rest, clips = character.skeleton.rest, {}
    for name, clip in character.clips.items():
        poses = replace(clip.poses, translations=clip.poses.translations * factor, morphs=None)
        clips[name] = replace(clip, poses=poses)
    binds = np.diag([factor, factor, factor, 1.0])
    meshes = [
        replace(
            mesh,
            positions=(mesh.positions * factor).astype(np.float32),
            inverse_bind=binds @ mesh.inverse_bind @ np.linalg.inv(binds),
            morphs=(),
        )
        for mesh in character.meshes
    ]
    skeleton = replace(
        character.skeleton, rest=replace(rest, translations=rest.translations * factor)
    )
    body = replace(character, skeleton=skeleton, clips=clips, meshes=tuple(meshes), morphs=())
    # It was recorded on the other skeleton, as its springs were measured on that.
    return replace(body, standing=None, springs=())


@pytest.mark.parametrize("factor", [0.01, 100.0, 1000.0])
def test_it_does_not_matter_in_which_unit_a_body_is(walker, factor):
    def ways(character):
        animator, target = Animator(character), np.array([0.3, 0.4])
        told = [("idle", 0.0), ("move", 2.0), ("move", 5.0), ("idle", 0.0)]
        return [
            place(animator.update(command(frame / 15, *told[frame // 15], target)))
            for frame in range(60)
        ]

    # To 2 mm: of two phases that are as good, roundings choose.
    assert np.allclose(ways(in_other_units(walker, factor)), ways(walker), atol=2e-3)


def test_feet_hold_alike_in_whatever_unit_a_body_is(human):
    def turns(factor):
        animator, target = Animator(in_other_units(human, factor)), np.array([0.3, 0.4])
        told = ["idle"] * 30 + ["move"] * 30  # a foot steps over as it sets off
        commands = [command(n / 30, do, 2.0, target) for n, do in enumerate(told)]
        return np.array([animator.update(each).pose.rotations for each in commands])

    assert np.abs((turns(0.01) * turns(1.0)).sum(-1)).min() > 1 - 1e-5


def test_a_run_that_is_slower_than_the_walk_does_not_slow_it_down(walker):
    clips = {**walker.clips, "Run": replace(walker.clips["Walk"], name="Run", rate=20.0)}
    gaits = Gaits(clips, walker.skeleton, walker.skeleton.rest)
    paces = [gaits.pace(speed) for speed in np.linspace(0.5, 5.0, 19)]
    assert (np.diff(paces) >= 0).all()
