"""Keys that are letters: names of marks, and lines that are said."""

import pytest

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.ui.cards.layout import HINT_ROOM
from cubeling.app.ui.playback.requests import NameMark, Record, WindowRequest
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.app.ui.playback.typing_field import MAX_TYPED, TypingField
from tests.app.ui.playback_desk import WIDTH, Desk, desk as desk


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        ("2", ["2"]),
        (["Enter", "F", "E", "L", "L", "Enter"], ["fell"]),
        (["Enter", "F", "Esc"], []),
        (["Tab"], []),
        (["R", "2"], []),
    ],
)
def test_a_mark_gets_a_name_by_the_next_keys(tmp_path, keys, names):
    desk = Desk(tmp_path)
    desk.layer.press("B")
    desk.layer.press("2")  # nothing is recorded: the key plays a scenario
    assert desk.layer.take_inputs().scenario == "sketch"
    desk.layer.report(SessionStatus(recorded=True))
    desk.layer.press("B")
    for key in keys:
        desk.layer.press(key)
    asked = [each.name for each in desk.layer.take_requests() if isinstance(each, NameMark)]
    assert asked == names
    desk.layer.take_inputs()
    desk.layer.press("B")
    desk.time += 10.0
    desk.layer.press("2")
    assert desk.layer.take_inputs().scenario == "sketch"


def test_after_a_mark_letters_are_keys(tmp_path):
    desk = Desk(tmp_path)
    desk.layer.report(SessionStatus(recorded=True))
    desk.layer.press("B")
    desk.layer.press("R")
    assert isinstance(desk.layer.take_requests()[-1], Record)


def test_what_is_typed_is_text_while_the_field_is_open(desk):
    desk.layer.shows_scenarios = True
    desk.report(listens=True)
    assert not desk.layer.shows_scenarios, "who has come to talk can type at once"
    for key, character in (("H", "h"), ("Q", "q"), ("Space", " "), ("1", "1"), ("", "ñ")):
        desk.press(key)
        assert desk.layer.type(character)
    assert not desk.asked, "Q ends nothing"
    assert desk.layer.take_inputs() == Inputs(hush=True), "who begins to type interrupts"
    desk.press("Backspace", "Enter")
    assert desk.layer.take_inputs() == Inputs(typed="hq 1")
    desk.press("Enter")
    assert desk.layer.take_inputs() == Inputs(), "an empty line says nothing"


def test_the_keys_are_keys_once_the_field_is_closed(desk):
    desk.report(listens=True)
    assert desk.layer.type("a")
    desk.press("Esc")
    assert not desk.asked, "the first Esc closes the field"
    assert not desk.layer.type("?")
    desk.press("Q")
    assert desk.asked == [WindowRequest.QUIT]
    desk.press("Enter")
    assert desk.layer.type("b"), "Enter opens it again"
    desk.press("Tab")
    assert not desk.layer.type("c"), "the menu lies over it"


def test_other_scenarios_have_no_field(desk):
    desk.report(listens=False)
    plain = desk.shown()
    assert not desk.layer.type("a")
    desk.report(listens=True)
    assert (desk.shown() != plain).any()


def test_a_long_line_fits_into_the_field():
    field = TypingField()
    for _ in range(400):
        field.type("w")
    assert len(field.text) == MAX_TYPED
    card = field.draw(WIDTH, 1.0)
    assert card.opacity.shape[1] <= HINT_ROOM + 1
