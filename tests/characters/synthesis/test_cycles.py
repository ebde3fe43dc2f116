"""Cycles of short takes, balance, and what a set of motions can do."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.model.mirroring import mirror_of
from cubeling.characters.motion.balance import hips_beyond_feet, trunk_lean
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.synthesis.balance import unsupported_lean, velocity_lean
from cubeling.characters.synthesis.behaviours import Behaviours, Travel, held_behaviours
from cubeling.characters.synthesis.capabilities import capabilities, falling
from cubeling.characters.synthesis.cycles import with_cycles
from cubeling.characters.synthesis.library import MotionLibrary

ANATOMY = Anatomy(
    "humanoid",
    {"hips": 0, "neck": 1, "leftFoot": 2, "leftToes": 3, "rightFoot": 4, "rightToes": 5},
)
STANDING = np.array(
    [(0, 1, 0), (0, 1.5, 0), (0.1, 0, 0), (0.1, 0, 0.2), (-0.1, 0, 0), (-0.1, 0, 0.2)]
)


def _take(library: MotionLibrary, name: str, first: int, count: int) -> MotionLibrary:
    """Return a part of a looping clip as a take that does not loop."""
    frames = library.clip(name)
    frames = np.take(frames, np.arange(first, first + count), mode="wrap")
    return replace(
        library.only([library.names.index(name)]),
        starts=np.array([0, count]),
        loops=np.array([False]),
        poses=library.poses[frames],
        steps=library.steps[frames],
        contacts=library.contacts[frames],
    )


def test_a_trunk_leans_as_far_as_it_is_tilted() -> None:
    tilted = STANDING.copy()
    tilted[1] = 0.3, 1.4, 0.4
    lean = trunk_lean(np.stack([STANDING, tilted]), ANATOMY)
    assert lean[0].tolist() == [0, 0]
    assert lean[1].tolist() == pytest.approx([np.pi / 4, np.arctan2(0.3, 0.4)])


@pytest.mark.parametrize(
    ("x", "z", "beyond"),
    [(0, 0.1, 0), (0.09, 0.19, 0), (0.3, 0.1, 0.2), (0, -0.25, 0.25), (0.4, 0.6, 0.5)],
)
def test_hips_are_beyond_the_feet_by_their_distance_from_the_hull(
    x: float, z: float, beyond: float
) -> None:
    moved = STANDING.copy()
    moved[:2] += x, 0, z
    assert hips_beyond_feet(moved[None], ANATOMY)[0] == pytest.approx(beyond)


def test_who_speeds_up_may_lean_ahead_by_what_it_takes() -> None:
    moved = STANDING.copy()
    moved[:2] += 0, 0, 0.5  # 0.3 m beyond the toes, at a height of 1 m
    positions, needed = moved[None], 9.81 * 0.4
    assert hips_beyond_feet(positions, ANATOMY, np.array([needed]))[0] == 0.0
    assert hips_beyond_feet(positions, ANATOMY, np.array([-needed]))[0] == pytest.approx(0.7)


def test_a_run_of_half_a_second_is_closed_to_a_cycle_by_its_mirror_image(
    human: Character, library: MotionLibrary
) -> None:
    take = _take(library, "Run", 3, 33)
    assert len(take) / take.rate < 0.6
    assert with_cycles(take) is take  # it has no whole cycle
    closed = with_cycles(take, mirror_of(human))
    assert closed.names == ("Run", "Run cycle")
    loop = closed.clip("Run cycle")
    assert len(loop) == pytest.approx(len(library.clip("Run")), abs=2)
    steps = closed.steps[loop] * closed.rate
    own = library.steps[library.clip("Run"), 1].mean() * library.rate
    assert steps[:, 1] == pytest.approx(own, rel=0.1)
    assert steps[:, 2].mean() == pytest.approx(0.0, abs=1e-9)


def test_a_cycle_passes_over_its_seam_as_smoothly_as_the_take_moves(library: MotionLibrary) -> None:
    closed = with_cycles(_take(library, "Walk", 0, 2 * len(library.clip("Walk")) - 9))
    loop = closed.clip("Walk cycle")
    assert len(loop) == pytest.approx(len(library.clip("Walk")), abs=2)
    around = closed.positions[np.concatenate([loop, loop[:2]])]
    jumps = np.linalg.norm(np.diff(around, 2, axis=0), axis=-1).max(1)
    assert jumps[-2:].max() < 1.05 * jumps[:-2].max()


def test_a_cell_in_which_a_clip_loops_needs_no_cycle(library: MotionLibrary) -> None:
    assert with_cycles(library) is library


def test_who_steps_aside_or_speeds_up_neither_walks_nor_runs(library: MotionLibrary) -> None:
    walk = _take(library, "Walk", 0, 120)
    aside = replace(walk, steps=walk.steps[:, [1, 0, 2]])
    assert Travel.of(aside).speed == pytest.approx(Travel.of(walk).speed)
    assert Travel.of(walk).goes_ahead.all()
    assert not Travel.of(aside).goes_ahead.any()
    ramp = np.linspace(0.2, 1.8, 120)[:, None]
    faster = replace(walk, steps=walk.steps.mean(0) * ramp)
    change = 1.6 / 119 * walk.steps[:, 1].mean() * walk.rate**2
    middle = slice(30, -31)
    assert Travel.of(faster).acceleration[middle] == pytest.approx(change, rel=0.02)
    assert not Travel.of(faster).is_steady[30]


def test_who_lifts_a_foot_on_the_spot_does_not_stand(library: MotionLibrary) -> None:
    walk = _take(library, "Walk", 0, 120)
    in_place = replace(walk, steps=np.zeros_like(walk.steps))
    down = np.arange(120) < 50
    kicking = replace(in_place, contacts=np.stack([np.ones(120, bool), down], axis=1))
    assert np.array_equal(Travel.of(kicking).stands, down)
    assert not Travel.of(kicking).goes_ahead.any()


def test_only_frames_that_hold_a_speed_ahead_are_a_behaviour(library: MotionLibrary) -> None:
    walk = _take(library, "Walk", 0, 120)
    steps = walk.steps.mean(0) * np.ones((120, 1))
    steps[60:] = steps[60:, [1, 0, 2]]  # from here on aside, at the same speed
    mixed = replace(walk, steps=steps)
    found = Behaviours.of(mixed, np.ones(120, bool))
    speeds = found.nearest(float(steps[0, 1]) * walk.rate, 0.0)
    assert np.flatnonzero(found.goals(speeds)).max() < 60


def test_a_behaviour_is_held_and_goes_on_through_a_short_change(library: MotionLibrary) -> None:
    walk = _take(library, "Walk", 0, 120)
    assert Behaviours.of(replace(walk, loops=np.array([False])), np.ones(120, bool)).goals(0).all()
    members = np.zeros(120, np.intp)
    members[40:48], members[70:75] = -1, 1  # a short gap, and a short patch of another one
    held = held_behaviours(replace(walk, loops=np.array([False])), members, np.ones(120, bool))
    assert set(held[:70]) == {0}
    assert set(held[70:75]) == {-1}


def test_what_a_set_can_do_and_what_is_nearest_to_what_it_lacks(library: MotionLibrary) -> None:
    left = library.only([0, 2])  # Walk, WalkLeftMedium
    found = {each.name: each for each in capabilities(left, np.ones(len(left), bool))}
    assert {name for name, each in found.items() if each.there} == {"walk", "turn left"}
    assert found["turn left"].clip == "WalkLeftMedium"
    assert found["turn right"].clip == "Walk"
    own = library.steps[library.clip("Walk"), 1].mean() * library.rate
    assert found["walk"].most == pytest.approx(own, rel=0.1)


def test_a_jump_to_another_speed_costs_the_lean_that_it_takes(library: MotionLibrary) -> None:
    walk, run = library.clip("Walk")[:1], library.clip("Run")[:1]
    apart = (library.steps[run, :2] - library.steps[walk, :2]) * library.rate
    expected = np.arctan(np.linalg.norm(apart) / 0.3 / 9.81)
    assert velocity_lean(library, walk, run) == pytest.approx(expected)
    assert velocity_lean(library, walk, walk) == 0.0


def test_a_clip_that_falls_is_named(library: MotionLibrary) -> None:
    fallen = replace(library)
    hips = library.anatomy.joints["hips"]
    moved = library.positions.copy()
    own = library.clip("Walk")
    feet = [
        joint for joint, part in library.anatomy.parts.items() if "Foot" in part or "Toes" in part
    ]
    others = np.setdiff1d(np.arange(moved.shape[1]), feet)
    moved[own[:, None], others] += 0, 0, 0.8
    fallen.__dict__["positions"] = moved
    assert hips in others
    assert list(falling(fallen)) == ["Walk"]
    assert falling(library) == {}
    assert (unsupported_lean(fallen)[own] > 0.1).all()
