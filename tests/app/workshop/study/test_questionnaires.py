"""Bundled questionnaires, scored by their published keys, and what an item takes as an answer."""

import pytest

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.protocols.forms import (
    FORM_FOLDER,
    bundled_questionnaire,
    names_in,
    read_questionnaire,
)
from cubeling.app.workshop.study.protocols.questionnaires import Item


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
    assert set(names_in(FORM_FOLDER)) == {
        *("affective-slider", "nasa-tlx", "nasa-tlx-weighted", "sus")
    }
    assert all(bundled_questionnaire(name).source for name in names_in(FORM_FOLDER))


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


def differential(folder, count, text=""):
    """Write a questionnaire of opposites, as a researcher brings it, and return its file."""
    pairs = [[f"left {number}", f"right {number}"] for number in range(1, count + 1)]
    path = folder / "mine.toml"
    path.write_text(f'name = "mine"\ntitle = "Your impression"\nopposites = {pairs}\n{text}')
    return path


# By hand from the publications: each answer of an item is its number's last digit, brought into
# range, and the scale is the mean of its items.
def test_godspeed_is_scored_by_the_published_key_from_words_that_are_brought(tmp_path):
    found = read_questionnaire(differential(tmp_path, 24, 'key = "godspeed"'))
    answers = {each.name: float(1 + number % 5) for number, each in enumerate(found.item)}
    assert found.scores(answers) == {
        "anthropomorphism": (1 + 2 + 3 + 4 + 5) / 5,
        "animacy": (1 + 2 + 3 + 4 + 5 + 1) / 6,
        "likeability": (2 + 3 + 4 + 5 + 1) / 5,
        "perceived_intelligence": (2 + 3 + 4 + 5 + 1) / 5,
        "perceived_safety": (2 + 3 + 4) / 3,
    }
    assert found.source.startswith("C. Bartneck")
    assert found.item[0].words == "left 1 / right 1"


def test_the_user_experience_questionnaire_is_turned_where_the_better_word_is_on_the_left(tmp_path):
    found = read_questionnaire(differential(tmp_path, 26, 'key = "ueq"'))
    assert (found.item[0].low, found.item[0].high) == (-3, 3)
    # Who always ticks the right-most circle: 3 for an item, −3 for one that is turned.
    scores = found.scores({each.name: 3.0 for each in found.item})
    assert scores == {
        "attractiveness": 0.0,  # 3 of 6 are turned
        "perspicuity": 0.0,  # 2 of 4, as in all the others
        "efficiency": 0.0,
        "dependability": 0.0,
        "stimulation": 0.0,
        "novelty": 0.0,
    }
    best = {f"item_{number}": -3.0 if number in UEQ_TURNED else 3.0 for number in range(1, 27)}
    assert set(found.scores(best).values()) == {3.0}
    counted = sorted(name for score in found.score for name in score.items)
    assert counted == sorted(best)  # each item in one scale


UEQ_TURNED = {3, 4, 5, 9, 10, 12, 17, 18, 19, 21, 23, 24, 25}


@pytest.mark.parametrize(
    ("count", "text", "words"),
    [
        (25, 'key = "ueq"', "the key is for 26 items, and there are 25"),
        (4, 'key = "ueqq"', "no key 'ueqq' is bundled: choose from godspeed, ueq"),
        (4, 'file = "mine.toml"', "own file holds its items"),
        (4, 'bundled = "sus"', "needs one of"),
        (4, "each = { low = 9 }", "must end above"),
        (0, "", "at least one"),
    ],
)
def test_a_questionnaire_that_is_none_is_refused_in_one_line(tmp_path, count, text, words):
    path = differential(tmp_path, count, text)
    with pytest.raises(AppError, match=words) as caught:
        read_questionnaire(path)
    assert "mine.toml" in str(caught.value)
    assert str(caught.value).isprintable()
