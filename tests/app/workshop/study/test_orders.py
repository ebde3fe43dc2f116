"""Orders of conditions and stimuli: balanced for carry-over, and the same for the same number."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.app.workshop.study.protocols.orders import (
    MAX_CONDITIONS,
    balanced_order,
    block_draw,
    latin_square,
    random_sides,
)
from cubeling.app.workshop.study.protocols.plan import conditions_of, plan_of
from cubeling.app.workshop.study.protocols.protocol import (
    Instruction,
    Phase,
    Protocol,
    Settings,
)
from cubeling.app.workshop.study.protocols.protocol_file import load_protocol

COUNTS = range(2, MAX_CONDITIONS + 1)


@pytest.mark.parametrize("count", COUNTS)
def test_each_condition_is_in_each_place_and_follows_each_other_equally_often(count):
    rows = latin_square(count)
    assert all(sorted(row) == list(range(count)) for row in rows)
    for place in zip(*rows, strict=True):
        assert len(set(Counter(place).values())) == 1
    follows = Counter(pair for row in rows for pair in pairwise(row))
    assert len(follows) == count * (count - 1)
    assert len(set(follows.values())) == 1


@pytest.mark.parametrize("count", COUNTS)
def test_as_many_participants_as_orders_meet_each_order_once(count):
    orders = [balanced_order(range(count), number) for number in range(len(latin_square(count)))]
    assert len(set(orders)) == len(orders)


def test_orders_of_conditions_and_of_tasks_are_not_confounded():
    names = ("a", "b")
    protocol = Protocol(
        "x",
        "X",
        conditions={"calm": Settings(), "lively": Settings()},
        phases=(Phase("p", names, "latin", each_condition=True),),
        instructions={name: Instruction(name, "") for name in names},
    )
    met = Counter[tuple[str, str]]()
    for number in range(8):
        steps = plan_of(protocol, number)
        met[steps[0].condition, steps[0].part] += 1
    assert met == {(c, p): 2 for c in ("calm", "lively") for p in names}


def test_between_participants_each_block_has_each_condition_once():
    names = {name: Settings() for name in "abc"}
    protocol = Protocol("x", "X", conditions=names, design="between", seed=5)
    for block in range(6):
        met = [conditions_of(protocol, 3 * block + number) for number in range(3)]
        assert sorted(met) == [("a",), ("b",), ("c",)]


@given(size=st.integers(1, 12), each=st.integers(1, 12), seed=st.integers(0, 9), people=st.just(30))
def test_dealt_stimuli_never_repeat_and_are_shown_equally_often(size, each, seed, people):
    if each > size:
        with pytest.raises(ValueError, match="are to be drawn"):
            block_draw({"g": range(size)}, each, 0, seed)
        return
    shown = Counter[int]()
    for number in range(people):
        (drawn,) = block_draw({"g": range(size)}, each, number, seed).values()
        assert len(set(drawn)) == len(drawn) == each
        shown.update(drawn)
    assert max(shown.values()) - min(shown[each] for each in range(size)) <= 1


def test_sides_are_random():
    # χ² of 6200 sides, and of runs of two, with a fixed seed: 3.84 is p = .05.
    sides = np.array(random_sides(6200, np.random.default_rng(1)), int)
    left = sides.sum()
    assert (left - 3100) ** 2 / 3100 * 2 < 3.84
    pairs = np.bincount(2 * sides[:-1:2] + sides[1::2], minlength=4)
    assert ((pairs - 775) ** 2 / 775).sum() < 7.81
    plans = (plan_of(load_protocol("gesture-and-speech")[0], number) for number in range(62))
    first = [step.first_left for plan in plans for step in plan if step.kind == "question"]
    assert len(first) == 744
    assert (sum(first) - 372) ** 2 / 372 * 2 < 3.84


def test_the_faces_are_shown_by_the_published_schedule():
    protocol, _ = load_protocol("single-facial-actions")
    (faces,) = protocol.stimuli.values()
    analysed = [each for each in faces.stimuli if each["wrinkles"] != "distractor"]
    assert (len(faces.stimuli), len(analysed)) == (128, 96)
    shown = Counter[tuple[tuple[str, str], ...]]()
    for number in range(8):
        steps = {s.place: s.stimulus for s in plan_of(protocol, number) if s.stimulus}
        stimuli = [tuple(sorted(each.items())) for each in steps.values()]
        assert len(set(stimuli)) == len(stimuli) == 32
        cells = Counter((each["half"], each["mode"]) for each in steps.values())
        assert set(cells.values()) == {8}
        assert len(cells) == 4
        shown.update(stimuli)
    assert set(shown.values()) == {2}  # eight participants see each of the 128 twice


def test_a_plan_is_the_same_again_and_another_for_another_seed():
    protocol, _ = load_protocol("whose-idle-motion")
    assert plan_of(protocol, 3) == plan_of(protocol, 3)
    assert plan_of(protocol, 3) != plan_of(protocol, 4)
    keys = [step.key for step in plan_of(protocol, 3)]
    assert len(set(keys)) == len(keys) == 49
