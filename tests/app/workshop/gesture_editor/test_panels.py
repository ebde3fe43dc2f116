"""The panels, used by the mouse and the keyboard of Dear ImGui."""

from dataclasses import replace
from itertools import combinations

import pytest
from imgui_bundle import imgui

from cubeling.app.workshop.gesture_editor.editing.actions import drop_file
from cubeling.app.workshop.gesture_editor.editing.state import Open
from cubeling.app.workshop.gesture_editor.panels import ui
from cubeling.app.workshop.gesture_editor.panels.view import MIN_SIZE
from cubeling.characters.behaviour import NEUTRAL
from tools.gesture_tour import Hand

pytestmark = pytest.mark.usefixtures("kept_previews")

CARDS = ("", "open", "import", "save as", "replace", "unsaved", "keys")
FULL_SIZE = round(MIN_SIZE[0]), round(MIN_SIZE[1])
LAYERED = ("stage", "time", "end:", "apex", "row:", "key:")
"""What lies over or under something else."""


@pytest.fixture
def editor(editing):
    return editing("WAVE")


@pytest.fixture
def hand(editor):
    return Hand(editor)


def test_a_drag_is_one_step_of_undo(editor, hand):
    before = editor.session.state
    left, _, width, _ = editor.places["power"]
    hand.drag("power", left + 0.9 * width)
    dragged = editor.session.state
    assert dragged.document.gesture.expressivity.power > 0.5
    assert len(dragged.past) == 1
    editor.press("Ctrl+Z")
    assert editor.session.state.document == before.document
    editor.press("Ctrl+Shift+Z")
    assert editor.session.state.document == dragged.document


def test_a_number_is_typed_into_a_slider(editor, hand):
    hand.set_slider("turns", 3.5)
    hand.set_slider("spatial", -7.0)
    assert editor.session.state.document.hand_key.turns == 3.5
    assert editor.session.state.document.gesture.expressivity.spatial == -1.0


def test_a_click_that_changes_nothing_is_no_step(editor, hand):
    hand.click(f"shape:{editor.session.state.document.hand_key.shape}")
    assert editor.session.state.past == ()


def test_a_button_acts_only_if_it_is_released_on_it(editor, hand):
    before = editor.session.state.document
    hand.drag("shape:fist", 10)
    assert editor.session.state.document == before
    hand.click("shape:fist")
    assert editor.session.state.document.hand_key.shape == "fist"


def test_shift_combines_two_directions(editor, hand):
    hand.click("palm:down")
    hand.click("palm:in", held="Shift")
    assert sorted(editor.session.state.document.hand_key.palm.split("-")) == ["down", "in"]
    hand.click("palm:down")
    hand.click("palm:up", held="Shift")
    assert editor.session.state.document.hand_key.palm == "up"


def test_distance_and_contact_are_chosen(editor, hand):
    hand.click("z:ZFar")
    assert editor.session.state.document.hand_key.place.z == "ZFar"
    hand.click("contact")
    editor.press("Escape")
    assert not editor.session.closed
    assert "touch:chin" not in editor.places
    hand.click("contact")
    hand.click("touch:chin")
    assert editor.session.state.document.hand_key.place.contact == "chin"


def test_a_hand_is_dragged_over_the_map(editor, hand):
    x, _, width, _ = editor.places["sector:XC:YCC"]
    hand.put_hand("XEP", "YCC")
    hand.drag("sector:XEP:YCC", x + width / 2)
    place = editor.session.state.document.hand_key.place
    assert (place.x, place.y) == ("XC", "YCC")
    assert len(editor.session.state.past) == 2


def test_trunk_and_head_have_sliders_once_there_is_a_key(editor, hand):
    hand.click("row:body")
    for _ in range(2):
        hand.click("delete key")
    assert "nod_deg" not in editor.places
    hand.click("add key")
    hand.set_slider("nod_deg", 20)
    assert editor.session.state.document.body_key.nod_deg == 20.0


def test_borders_of_phases_and_the_apex_are_dragged(editor, hand):
    before = editor.session.state.document.gesture
    hand.drag("end:hold", editor.places["end:hold"][0] + 60)
    longer = editor.session.state.document.gesture
    assert longer.hold > before.hold + 0.1
    assert longer.stroke == before.stroke
    hand.drag("end:hold", 0)
    assert editor.session.state.document.gesture.hold == 0.0
    hand.drag("end:hold", editor.places["end:hold"][0] + 40)
    assert editor.session.state.document.gesture.hold > 0.1
    hand.drag("apex", editor.places["key:right:0"][0] + 30)
    assert editor.session.state.document.gesture.apex != before.apex


def test_the_time_line_keeps_its_scale_while_a_border_is_dragged(editor, hand):
    left, _, width, _ = editor.places["time"]
    hand.drag("end:retraction", left + 0.98 * width, released=False)
    x, _, wide, _ = editor.places["end:retraction"]
    assert x + wide / 2 == pytest.approx(left + 0.98 * width, abs=4)
    editor.button(pressed=False)


def test_a_key_is_dragged_in_time(editor, hand):
    at = editor.session.state.document.hand_key.at
    hand.drag("key:right:1", editor.places["key:right:1"][0] - 20)
    assert editor.session.state.document.hand_key.at < at


def test_selecting_a_key_shows_it(editor, hand):
    gesture = editor.session.state.document.gesture
    hand.click("key:right:0")
    assert editor.session.state.time == pytest.approx(gesture.preparation)
    assert not editor.session.state.playing
    assert editor.session.state.document.gesture == gesture


def test_repeats_hands_and_sides_are_changed(editor, hand):
    for name in ("more", "more", "fewer", "hand:both", "mirror"):
        hand.click(name)
    gesture = editor.session.state.document.gesture
    assert gesture.repeats == 2
    assert gesture.right
    assert gesture.left
    assert len(editor.session.state.past) == 5
    hand.set_slider("power", 0.5)
    hand.click("neutral")
    assert editor.session.state.document.gesture.expressivity == NEUTRAL


def test_a_name_is_typed_and_is_one_step_of_undo(editor, hand):
    hand.write("name", "big hi!")
    state = editor.session.state
    assert state.document.gesture.name == "BIG_HI"
    assert len(state.past) == 1


def test_escape_takes_back_what_was_typed(editor, hand):
    hand.click("summary")
    editor.type(" and more")
    editor.press("Escape")
    assert not editor.session.state.changed
    assert not editor.session.closed


def test_letters_in_a_text_field_are_no_commands(editor, hand):
    before = editor.session.state
    hand.click("summary")
    editor.type(" a?,.")
    editor.press("A")
    editor.press("Space")
    editor.press("Left")
    state = editor.session.state
    assert (state.card, state.playing, state.time) == ("", before.playing, before.time)
    assert state.document.gesture.right == before.document.gesture.right
    assert state.document.gesture.summary.endswith(" a?,.")


def test_saving_takes_what_stands_in_a_text_field(editor, hand):
    hand.click("summary")
    editor.type("!")
    editor.press("Ctrl+S")
    assert not editor.session.state.changed
    assert editor.session.state.saved.gesture.summary.endswith("!")


def test_the_next_text_field_is_reached_by_tab(editor, hand):
    hand.click("name")
    editor.press("Tab")
    editor.press("End")
    editor.type("!")
    assert editor.session.state.document.gesture.summary.endswith("!")
    editor.press("Enter")
    editor.session.do(lambda state: drop_file(state, "/recordings/hello.bvh"))
    editor.frame()
    editor.press("Tab")
    editor.type("1,5")
    assert editor.session.state.text("start") == "1,5"
    assert editor.session.state.text("recording") == "/recordings/hello.bvh"
    editor.press("Escape")
    assert editor.session.state.card == ""


def test_enter_in_a_card_does_what_it_is_for(editor):
    editor.press("Ctrl+O")
    editor.type("clap")
    editor.press("Enter")
    assert editor.session.state.document.gesture.name == "CLAP"


def test_a_click_beside_a_card_closes_it(editor, hand):
    hand.click("open")
    assert editor.session.state.card == "open"
    hand.click_at(5, editor.size[1] - 5)
    assert editor.session.state.card == ""


def test_an_answer_can_lead_to_another_card(editor, hand):
    hand.click("name")
    editor.press("Ctrl+A")
    editor.press("Delete")
    editor.press("Enter")
    editor.press("Escape")
    hand.click("answer:save")
    assert editor.session.state.card == "save as"
    editor.type("mine")
    editor.press("Enter")
    assert editor.session.closed
    assert editor.session.state.saved.gesture.name == "MINE"


def test_a_message_is_shown_until_something_is_done(editor, hand):
    editor.press("Ctrl+S")
    assert "saved" in editor.session.state.message
    hand.click("row:right")
    assert editor.session.state.message == ""


@pytest.mark.parametrize("row", ["right", "left", "body"])
def test_everything_lies_in_the_window_and_can_be_read(editing, monkeypatch, row):
    editor, cramped = editing("WAVE", size=FULL_SIZE), []
    plain = ui.Ui.button

    def button(self, name, label, width=0.0, **kinds):
        clicked = plain(self, name, label, width, **kinds)
        if imgui.calc_text_size(label).x > self.places[name][2] - 4:
            cramped.append(name)
        return clicked

    monkeypatch.setattr(ui.Ui, "button", button)
    state = editor.session.state
    for card in CARDS:
        wanted = Open("CLAP") if card == "unsaved" else None
        document = state.document.select(row, 0)
        editor.session.settle(replace(state, card=card, document=document, wanted=wanted))
        editor.frame()
        for name, (left, top, width, height) in editor.places.items():
            if name.startswith("open:"):
                continue  # the list of names is scrolled
            assert left >= 0, name
            assert top >= 0, name
            assert left + width <= FULL_SIZE[0], name
            assert top + height <= FULL_SIZE[1], name
        assert not cramped


@pytest.mark.parametrize("row", ["right", "body"])
def test_nothing_that_can_be_clicked_hides_something_else(editing, row):
    editor = editing("WAVE", size=FULL_SIZE)
    editor.session.do(lambda state: replace(state, document=state.document.select(row, 0)))
    editor.frame()
    apart = {name: rect for name, rect in editor.places.items() if not name.startswith(LAYERED)}
    for (one, (left, top, width, height)), (other, (x, y, wide, high)) in combinations(
        apart.items(), 2
    ):
        across = min(left + width, x + wide) - max(left, x)
        down = min(top + height, y + high) - max(top, y)
        assert across <= 0.1 or down <= 0.1, f"{one} and {other}"
