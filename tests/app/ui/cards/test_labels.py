"""Labels of a cast, and the cards of two robots: what is on them, and that they hide nobody."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.pipeline.step import Performance, PlayerStep, RobotView
from cubeling.app.ui.cards.labels import label
from cubeling.app.ui.cards.layout import (
    LABEL_STAY_S,
    CardLayout,
    LabelLayout,
    are_apart,
)
from cubeling.app.ui.cards.overlay import cards_over

WIDTH, SIZE = 1280.0, (110.0, 40.0)
FIGURE = 600.0, 300.0, 700.0, 500.0
ABOVE = 595.0, 252.0, 705.0, 292.0


def placed(layout, figures, now, taken=()):
    """Return where the labels of figures are, with nothing else but `taken` in the picture."""
    everything = [*figures.values(), *taken]
    return layout.update(figures, dict.fromkeys(figures, SIZE), everything, WIDTH, now)


def test_a_label_is_above_its_character():
    assert placed(LabelLayout(), {"vleo": FIGURE}, 0.0) == {"vleo": ABOVE}


def test_a_label_leaves_a_place_at_once_and_comes_back_after_a_while():
    layout, frames = LabelLayout(), np.arange(0.0, 2.0, 1 / 30).round(9).tolist()
    assert placed(layout, {"vleo": FIGURE}, 0.0)["vleo"] == ABOVE
    away = placed(layout, {"vleo": FIGURE}, 0.1, [ABOVE])["vleo"]
    assert are_apart(away, [ABOVE, FIGURE], 0.0)
    back = [now for now in frames if placed(layout, {"vleo": FIGURE}, 0.2 + now)["vleo"] == ABOVE]
    assert min(back) == pytest.approx(LABEL_STAY_S, abs=0.04)


def test_a_label_without_a_place_is_left_out():
    all_over = 500.0, 150.0, 900.0, 700.0
    assert not placed(LabelLayout(), {"vleo": FIGURE}, 0.0, [all_over])
    assert not placed(LabelLayout(), {"vleo": (-300.0, 300.0, -200.0, 500.0)}, 0.0)


RECTS = st.builds(
    lambda x, y, w, h: (x, y, x + w, y + h),
    st.floats(-100, 1200),
    st.floats(-100, 650),
    st.floats(20, 200),
    st.floats(20, 300),
)


@given(st.lists(st.tuples(st.lists(RECTS, min_size=1, max_size=5), st.lists(RECTS, max_size=3))))
def test_no_label_hides_anybody_whatever_moves(moments):
    layout = LabelLayout()
    for number, (rects, taken) in enumerate(moments):
        figures = {f"c{at}": rect for at, rect in enumerate(rects)}
        labels = placed(layout, figures, number / 30, taken)
        for name, box in labels.items():
            beside = [*(each for each in figures.values()), *taken]
            beside += [each for who, each in labels.items() if who != name]
            assert are_apart(box, beside, 0.0)
            assert 0.0 <= box[0] < box[2] <= WIDTH


def test_a_label_shows_mood_and_speech():
    calm, glad, speaks = (
        label("vleo_2", *what, 1.0).color for what in ((0.0, False), (0.9, False), (0.0, True))
    )
    assert not np.array_equal(calm, glad)
    assert speaks.shape[1] > calm.shape[1]


def test_a_card_slides_over_nobody():
    layout, size = CardLayout(), (200.0, 300.0)
    start, end = (1056.0, 396.0, 1256.0, 696.0), (24.0, 82.0, 224.0, 382.0)
    layout.slide("bottom right", start, 0.0)
    on_way = (
        layout.slide("bottom right", end, 0.1, [start]),
        layout.slide("bottom right", end, 0.2, [start]),
    )
    assert on_way[1] not in (start[:2], end[:2]), "it slides off what it hides"
    other = CardLayout()
    other.slide("bottom right", start, 0.0)
    assert other.slide("bottom right", end, 0.1, [(600.0, 300.0, 650.0, 400.0)]) == end[:2]
    assert size == (end[2] - end[0], end[3] - end[1])


def test_each_robot_has_a_card_and_each_of_the_cast_a_label(a_step):
    step = a_step(None)
    calm = EmotionTarget(Emotion(0.0, 0.0, "neutral"), step.frame.timestamp)
    other = Performance("vleo", replace(step.outcome, emotion=calm), step.posed)
    player = PlayerStep("companion-2", step.state, step.controls, 0.06, "tim")
    first = RobotView("ready", 0.5, "happy")
    both = replace(first, second=RobotView("ready", -0.5, "angry", name="tim"))
    size, rest = (1280, 720), {"subjects": (), "figures": (FIGURE, None)}
    alone = cards_over(replace(step, **rest), first, size)
    two = replace(step, name="human", others=(other,), **rest)
    labelled = cards_over(two, first, size)
    assert len(labelled) == len(alone) + 1, "the second one is not seen"
    everything = cards_over(replace(two, players=(player,)), both, size)
    assert len(everything) == len(labelled) + 1
    boxes = [each.box(1.0) for each in everything]
    for number, box in enumerate(boxes):
        assert are_apart(box, boxes[:number], 0.0)
