"""Bundled questionnaires, scored by their published keys, and what an item takes as an answer."""

import pytest

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.protocols.questionnaires import (
    Item,
    bundled_questionnaire,
    bundled_questionnaires,
)


def test_sus_is_scored_as_published():
    sus = bundled_questionnaire("sus")
    # Odd items count from 1 up, even ones from 5 down, times 2.5 (Brooke, 1996).
    answers = {
        f"sus_{number}": value for number, value in enumerate([4, 2, 5, 1, 3, 3, 4, 2, 4, 2], 1)
    }
    assert sus.scores(answers) == {"sus": 2.5 * (3 + 3 + 4 + 4 + 2 + 2 + 3 + 3 + 3 + 3)}
    assert sus.scores({item.name: 5.0 for item in sus.item}) == {"sus": 50.0}
    assert sus.scores({**answers, "sus_3": None}) == {}


def test_the_task_load_index_is_scored_as_published():
    index = bundled_questionnaire("nasa-tlx-weighted")
    scales = ["mental", "physical", "temporal", "performance", "effort", "frustration"]
    ratings = dict(zip(scales, [60.0, 10.0, 45.0, 30.0, 70.0, 20.0], strict=True))
    # The first of each pair is chosen: weights 5, 4, 3, 2, 1, 0 of 15.
    chosen = {item.name: item.options[0] for item in index.item if item.kind == "choice"}
    assert len(chosen) == 15
    scores = index.scores({**ratings, **chosen})
    assert scores["tlx_raw"] == pytest.approx(235 / 6)
    assert scores["tlx_weighted"] == pytest.approx((5 * 60 + 4 * 10 + 3 * 45 + 2 * 30 + 70) / 15)
    assert bundled_questionnaire("nasa-tlx").scores(ratings) == {"tlx_raw": pytest.approx(235 / 6)}


def test_every_bundled_one_names_its_source():
    assert set(bundled_questionnaires()) == {
        *("affective-slider", "nasa-tlx", "nasa-tlx-weighted", "sus")
    }
    assert all(bundled_questionnaire(name).source for name in bundled_questionnaires())


SCALE = Item("a", "A?", anchors=("no", "yes"))
CHOICE = Item("b", "B?", "choice", options=("red", "green"))


@pytest.mark.parametrize(
    ("item", "typed", "answer"),
    [
        (SCALE, " 5 ", 5.0),
        (CHOICE, "2", "green"),
        (CHOICE, "red", "red"),
        (Item("c", "C?", "slider", 0, 1), "0.25", 0.25),
        (Item("d", "D?", "text"), "", None),
        (Item("e", "E?", optional=True), "", None),
    ],
)
def test_an_answer_is_parsed(item, typed, answer):
    assert item.parse(typed) == answer


@pytest.mark.parametrize(
    ("item", "typed"),
    [(SCALE, ""), (SCALE, "6"), (SCALE, "1.5"), (SCALE, "nan"), (CHOICE, "3"), (CHOICE, "blue")],
)
def test_what_is_no_answer_is_asked_again(item, typed):
    with pytest.raises(AppError):
        item.parse(typed)
