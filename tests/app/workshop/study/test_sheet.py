"""Questions in a window: answers by keys and mouse, room for all, what a light sensor sees."""

import numpy as np
import pytest

from cubeling.app.workshop.study.participants.stimulus_files import pictures_of
from cubeling.app.workshop.study.protocols.protocol_file import bundled_protocols, load_protocol
from cubeling.app.workshop.study.protocols.questionnaires import FACES, Item
from cubeling.app.workshop.study.window.fields import CHOSEN, SHEET_HEIGHT, SHEET_WIDTH
from cubeling.app.workshop.study.window.sheet import BUTTON, Sheet

SCALE = Item("a", "A?", anchors=("no", "yes"))
CHOICE = Item("b", "B?", "choice", options=("red", "green", "blue"))
SLIDER = Item("c", "C?", "slider", 0, 100)
TEXT = Item("d", "D?", "text")


def operated(item, keys="", typed="", **more):
    """Return a sheet on which keys were pressed, and a text was typed."""
    sheet = Sheet("Title", item=item, **more)
    for key in keys.split():
        sheet.press(key)
    for character in typed:
        sheet.type(character)
    return sheet


@pytest.mark.parametrize(
    ("item", "keys", "typed", "answer"),
    [
        (SCALE, "4", "", 4.0),
        (SCALE, "→ → →", "", 3.0),
        (Item("n", "N?", low=-1, high=1, anchors=("less", "same", "more")), "3", "", 1.0),
        (SCALE, "← ←", "", 4.0),
        (CHOICE, "2", "", "green"),
        (CHOICE, "↓ ↓ ↓ ↓", "", "blue"),
        (SLIDER, "→ →", "", 52.0),
        (SLIDER, "End ←", "", 99.0),
        (TEXT, "", "Ünï F q", "Ünï F q"),
        (TEXT, "", "", None),
        (Item("e", "", low=-3, high=3, anchors=("fake", "natural")), "→", "", -3.0),
    ],
)
def test_keys_give_the_answer_and_enter_goes_on(item, keys, typed, answer):
    sheet = operated(item, keys, typed)
    sheet.press("Enter")
    assert (sheet.done, sheet.answer) == (True, answer)


@pytest.mark.parametrize("item", [SCALE, CHOICE, SLIDER])
def test_a_question_without_an_answer_stays_and_says_what_is_needed(item):
    sheet = operated(item)
    before = sheet.draw(0.5)
    sheet.press("Enter")
    assert not sheet.done
    assert sheet.changed
    assert (sheet.draw(0.5) != before).any()
    for optional in (Item("e", "E?", optional=True), TEXT):
        sheet = operated(optional)
        sheet.press("Enter")
        assert sheet.done


@pytest.mark.parametrize(
    ("item", "keys"),
    [
        (SCALE, "→ →"),
        (CHOICE, "↓ ↓"),
        (SLIDER, "→ → → →"),
        (Item("e", "", low=-3, high=3, anchors=("a", "b")), "← ←"),
        (Item("w", "W?", "choice", options=tuple("abcdefgh")), "6"),
    ],
)
def test_a_click_on_what_keys_chose_chooses_it(item, keys):
    by_keys, empty = operated(item, keys).draw(1.0), operated(item).draw(1.0)
    rows, columns = np.nonzero((by_keys == CHOSEN).all(axis=2) & ~(empty == CHOSEN).all(axis=2))
    sheet = operated(item)
    sheet.click(float(columns.mean()), float(rows.mean()))
    sheet.press("Enter")
    other = operated(item, keys)
    other.press("Enter")
    wanted = pytest.approx(other.answer, abs=0.1) if item is SLIDER else other.answer
    assert sheet.answer == wanted
    left, top, width, height = BUTTON
    sheet = operated(item, keys)
    sheet.click(left + width / 2, top + height / 2)
    assert sheet.done


def test_a_handle_follows_the_mouse():
    sheet = operated(SLIDER, "→")
    top = next(y for y in range(200, 600) if _moves(SLIDER, y))
    sheet.click(140, top)
    sheet.drag(140 + 250, top)
    sheet.press("Enter")
    assert sheet.answer == pytest.approx(25.0)


def _moves(item, y):
    sheet = operated(item)
    sheet.click(300, y)
    sheet.press("Enter")
    return sheet.done


@pytest.mark.parametrize("name", bundled_protocols())
def test_every_bundled_question_has_room_for_all_it_shows(name):
    picture = np.full((300, 400, 3), (0, 0, 255), np.uint8)
    for questionnaire in load_protocol(name)[0].questionnaires.values():
        for item in questionnaire.item:
            sheet = Sheet(questionnaire.title, item=item, captions=("left", "right"))
            drawn = sheet.draw(0.5, (picture, picture))
            assert drawn.shape == (SHEET_HEIGHT / 2, SHEET_WIDTH / 2, 3)
            assert sheet._field_top >= sheet._question_top + 8
            assert sheet._field_top + sheet._field_height <= BUTTON[1]
            shown = np.nonzero((drawn == (0, 0, 255)).all(axis=2))[0]
            assert np.ptp(shown) > 60  # of 360


def test_a_long_text_gets_smaller_letters_until_it_fits():
    ink = [
        np.nonzero((Sheet("T", "word " * count).draw(0.5)[:300] < 100).all(axis=2))[0]
        for count in (5, 100, 500)
    ]
    assert all(each.max() < BUTTON[1] / 2 for each in ink)


def test_the_square_for_a_light_sensor_is_white_while_something_is_shown():
    picture = np.zeros((8, 8, 3), np.uint8)
    sheet = operated(SCALE, patch=True, captions=("",))
    assert sheet.draw(1.0, (picture,))[-1, -1].tolist() == [255] * 3
    assert sheet.draw(1.0)[-1, -1].tolist() == [0] * 3


def test_children_see_faces_instead_of_numbers(tmp_path):
    item = Item("f", "How was it?", pictures=(FACES,))
    faces = pictures_of(item, tmp_path)
    assert len(faces) == 5
    red, green = (np.median(each.reshape(-1, 3), axis=0) for each in (faces[0], faces[-1]))
    assert red[2] > red[1]
    assert green[1] > green[2]
    with_faces = operated(item, pictures=faces).draw(0.5)
    assert (with_faces != operated(item).draw(0.5)).mean() > 0.02
