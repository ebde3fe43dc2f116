from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.characters import Character
from cubeling.characters.synthesis.idle.bridges import (
    EASED_S,
    NEAR_RAD,
    bridge,
    nearest_balance,
    shortest_way,
)
from cubeling.characters.synthesis.idle.database import BalanceShift, IdleDatabase, RestingPosture
from cubeling.characters.synthesis.idle.idle_motion import IdleMotion
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors
from tests.examples import examples

RATE = 25.0
BALANCES = "left", "both", "right"
PLACES = {"left": 1.0, "both": 0.0, "right": -1.0}
PAIRS = [(a, b) for a, b in product(BALANCES, BALANCES) if a != b]


@pytest.fixture(scope="module")
def kind() -> PostureVectors:
    human = Character.load("human")
    return PostureVectors.of(human.skeleton, human.anatomy)


def stander(kind: PostureVectors, pairs: list[tuple[str, str]], seed: int = 1) -> IdleDatabase:
    """Return one who shifts between these balances only."""
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=kind.size) / 3.0

    def near(name: str) -> np.ndarray:
        return PLACES[name] * direction + 0.02 * rng.normal(size=kind.size)

    sway = 0.02 * np.sin(np.arange(200) / 9.0)[:, None] * rng.normal(size=kind.size)
    postures = tuple(RestingPosture(near(n), n, 2.0 + k, cut=False, frames=sway)
                     for n in BALANCES for k in range(2))  # fmt: skip
    shifts = tuple(
        BalanceShift(np.linspace(near(a), near(b), 21 + 5 * n), a, b)
        for n, (a, b) in enumerate(pairs)
    )
    rows = np.concatenate([sway, *(shift.vectors for shift in shifts)])
    return IdleDatabase(kind, RATE, PostureSpace.of(rows), postures, shifts)


def fewest_shifts(pairs: list[tuple[str, str]], start: str, end: str) -> int | None:
    """Try every way of up to four shifts."""
    for count in range(1, 5):
        for inner in product(BALANCES, repeat=count - 1):
            way = [start, *inner, end]
            if all(step in pairs for step in pairwise(way)):
                return count
    return None


@given(st.sets(st.sampled_from(PAIRS), min_size=1), st.sampled_from(BALANCES),
       st.sampled_from(BALANCES), st.integers(0, 99))  # fmt: skip
def test_the_way_is_as_short_as_the_shortest_of_all(
    kind: PostureVectors, pairs: set[tuple[str, str]], start: str, end: str, seed: int
) -> None:
    database = stander(kind, sorted(pairs))
    way = shortest_way(database, start, end, np.random.default_rng(seed))
    assert (len(way) or None) == fewest_shifts(sorted(pairs), start, end)
    assert all(step in pairs for step in zip([start, *way], way, strict=False))


def test_ways_of_one_length_are_all_taken(kind: PostureVectors) -> None:
    database = stander(kind, PAIRS)
    ways = {tuple(shortest_way(database, "both", "both", np.random.default_rng(n)))
            for n in range(30)}  # fmt: skip
    assert ways == {("left", "both"), ("right", "both")}


@settings(max_examples=examples(60))
@given(st.sampled_from(BALANCES), st.floats(0.0, 8.0), st.floats(0.12, 20.0), st.integers(0, 999))
def test_it_is_there_exactly_and_in_time(
    kind: PostureVectors, goal: str, before: float, within: float, seed: int
) -> None:
    database = stander(kind, PAIRS)
    end = PLACES[goal] * database.shifts[0].vectors[0] + 0.1
    motion = IdleMotion(database, seed)
    for time in np.arange(0.0, before + 1e-9, 1 / 30).tolist():
        motion.sample(time)
    wait = motion.lead_to(end, within)
    assert 0.0 < wait <= within + 1e-6
    there = motion.sample(time + wait)
    assert kind.vectors(there[None])[0] == pytest.approx(end, abs=1e-9)
    later = motion.sample(time + wait + 3.0)
    assert later.rotations == pytest.approx(there.rotations, abs=1e-9)
    motion.go_on()
    moved = [motion.sample(time + wait + 3.0 + n).rotations for n in range(10)]
    assert not np.array_equal(moved[-1], there.rotations)


@given(st.sampled_from(BALANCES), st.integers(0, 99))
def test_unhurried_it_goes_as_fast_as_it_shifts(kind: PostureVectors, goal: str, seed: int) -> None:
    database = stander(kind, PAIRS)
    end = next(p.vector for p in database.postures if p.balance == goal) + 0.01
    motion = IdleMotion(database, seed)
    motion.begin_at(database.postures[0].vector)
    shown = [motion.sample(0.0)]
    wait = motion.lead_to(end)
    shown += [motion.sample(t) for t in np.arange(0.04, wait + 1.0, 0.04)]
    recorded = max(np.abs(np.diff(s.vectors, axis=0)).max() for s in database.shifts)
    steps = np.diff([kind.vectors(pose[None])[0] for pose in shown], axis=0)
    assert np.abs(steps).max() < 1.5 * recorded


def test_it_begins_exactly_where_it_is_told(kind: PostureVectors) -> None:
    database = stander(kind, PAIRS)
    motion = IdleMotion(database, 3)
    motion.sample(4.0)
    posture = database.postures[0].vector + 0.3
    motion.begin_at(posture)
    begun = [motion.sample(4.0 + n / RATE) for n in range(60)]
    first = kind.vectors(begun[0][None])[0]
    assert np.abs(first - posture).max() < 0.02  # small variations have begun
    steps = np.abs(np.diff([pose.rotations for pose in begun], axis=0))
    assert steps.max() < 0.05


def test_near_postures_of_one_balance_need_no_shift(kind: PostureVectors) -> None:
    database = stander(kind, PAIRS)
    start = database.postures[0]
    aside = start.vector + 0.5 * NEAR_RAD * database.space.components[:, 3]
    assert nearest_balance(database, aside) == start.balance
    rng = np.random.default_rng(0)
    assert len(bridge(database, start, aside, rng)) == round(EASED_S * RATE) + 1
    far = start.vector + 2.0 * NEAR_RAD * database.space.components[:, 3]
    assert len(bridge(database, start, far, rng)) > 40  # there and back again


def test_one_who_cannot_shift_goes_straight(kind: PostureVectors) -> None:
    database = replace(stander(kind, PAIRS), shifts=())
    motion = IdleMotion(database, 1)
    motion.sample(1.0)
    assert motion.lead_to(database.postures[-1].vector) < EASED_S + 0.2
    motion.feel(Emotion(0.6, 0.6))
    motion.sample(9.0)
