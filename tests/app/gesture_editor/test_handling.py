"""Mouse and keyboard, without a preview."""

from dataclasses import replace
from itertools import combinations

import pytest

from cubeling.app.gesture_editor.editing.document import GestureDocument
from cubeling.app.gesture_editor.editing.state import EditorState, Import, Quit, Save
from cubeling.app.gesture_editor.handling import (
    Dropped,
    KeyPressed,
    Moved,
    Pressed,
    Released,
    Typed,
    handle,
)
from cubeling.app.gesture_editor.panels.fields import Slider
from cubeling.app.gesture_editor.panels.layout import widget_named, widgets_of
from cubeling.app.gesture_editor.panels.time_line_parts import Handle, KeyMark, KeyRow, Phases
from cubeling.app.gesture_editor.panels.widgets import Button, Label, fitting
from cubeling.app.ui.canvas import text_width
from cubeling.characters.behaviour.gestures.collection import GestureCollection

CARDS = ("", "open", "import", "save as", "replace", "unsaved", "contact", "keys")
SMALLEST_TEXT = 11.0
"""Size of text that can be read on a window of 1280×720 [px]."""


@pytest.fixture
def state():
    collection = GestureCollection.load_bundled()
    document = GestureDocument(collection.get("WAVE")).select("right", 1)
    names = ("human", "robot", "vleo")
    return EditorState(document, document, characters=names, names=collection.names)


def middle(state, name):
    widget = widget_named(state, name)
    assert widget is not None, name
    left, top, width, height = widget.rect
    return Moved(left + width / 2, top + height / 2)


def after(state, *events):
    for event in events:
        state = handle(event, state)
    return state


def click(state, name, *, shift=False):
    return after(state, middle(state, name), Pressed(shift), Released())


def test_a_drag_is_one_step_of_undo(state):
    x = middle(state, "power").x
    moves = [Moved(x + 5 * step, middle(state, "power").y) for step in range(10)]
    dragged = after(state, middle(state, "power"), Pressed(), *moves, Released())
    assert dragged.document.gesture.expressivity.power > 0.5
    assert len(dragged.past) == 1
    assert after(dragged, KeyPressed("Z", control=True)).document == state.document


def test_a_click_that_changes_nothing_is_no_step(state):
    assert click(state, f"shape:{state.document.hand_key.shape}").past == ()


def test_a_button_acts_only_if_it_is_released_on_it(state):
    left = after(state, middle(state, "shape:fist"), Pressed(), Moved(10, 300), Released())
    assert left.document == state.document
    assert click(state, "shape:fist").document.hand_key.shape == "fist"


def test_shift_combines_two_directions(state):
    palm = click(click(state, "palm:down"), "palm:in", shift=True).document.hand_key.palm
    assert sorted(palm.split("-")) == ["down", "in"]
    opposite = click(click(state, "palm:down"), "palm:up", shift=True)
    assert opposite.document.hand_key.palm == "up"


def test_a_border_of_phases_is_dragged(state):
    x, y = middle(state, "end:hold").x, middle(state, "end:hold").y
    dragged = after(state, Moved(x, y), Pressed(), Moved(x + 60, y), Released())
    assert dragged.document.gesture.hold > state.document.gesture.hold + 0.1
    assert dragged.document.gesture.stroke == state.document.gesture.stroke


def test_the_time_line_keeps_its_scale_while_a_border_is_dragged(state):
    x, y = middle(state, "end:retraction").x, middle(state, "end:retraction").y
    dragged = after(state, Moved(x, y), Pressed(), Moved(1250, y))
    assert middle(dragged, "end:retraction").x == pytest.approx(1250, abs=4)


def test_keys_are_added_selected_moved_and_deleted(state):
    added = after(replace(state, time=1.0), KeyPressed("A"))
    assert len(added.document.gesture.right) == 3
    assert added.document.index == 1
    at = added.document.hand_key.at
    moved = after(added, KeyPressed("→", shift=True))
    assert moved.document.hand_key.at > at
    assert after(moved, KeyPressed("←")).document.index == 0
    deleted = after(moved, KeyPressed("Delete"))
    assert deleted.document.gesture == state.document.gesture


def test_arrows_with_control_move_the_hand_as_it_is_seen(state):
    place = state.document.hand_key.place
    lower = after(state, KeyPressed("↓", control=True)).document.hand_key.place
    assert (lower.x, lower.y != place.y) == (place.x, True)
    inward = after(state, KeyPressed("→", control=True)).document.hand_key.place
    assert inward.x == "XC"


def test_selecting_a_key_shows_it(state):
    shown = click(state, "key:right:0")
    assert shown.time == pytest.approx(state.document.gesture.preparation)
    assert not shown.playing


def test_a_name_is_typed_and_is_one_step_of_undo(state):
    typed = click(state, "name")
    typed = after(typed, *[KeyPressed("Backspace")] * 9, *map(Typed, "big hi!"))
    assert typed.document.gesture.name == "WAVE"
    named = after(typed, KeyPressed("Enter"))
    assert named.document.gesture.name == "BIG_HI"
    assert len(named.past) == 1


def test_letters_in_a_text_field_are_no_commands(state):
    typed = after(click(state, "summary"), *map(Typed, " a?,."), KeyPressed("A"))
    assert typed.card == ""
    assert typed.document == state.document


def test_saving_takes_what_stands_in_a_text_field(state):
    typed = after(click(state, "summary"), Typed("!"), KeyPressed("S", control=True))
    assert typed.document.gesture.summary.endswith("!")
    assert typed.requests == (Save(),)


def test_a_gesture_without_a_name_is_asked_for_one():
    asked = after(EditorState(), KeyPressed("S", control=True))
    assert (asked.card, asked.focus, asked.requests) == ("save as", "new name", ())
    named = after(asked, *map(Typed, "hi"), KeyPressed("Enter"))
    assert named.document.gesture.name == "HI"
    assert named.requests == (Save(),)


def test_changes_are_never_lost_without_a_question(state):
    changed = click(state, "shape:fist")
    for leave in (KeyPressed("Esc"), KeyPressed("N", control=True)):
        assert after(changed, leave).card == "unsaved"
    asked = after(changed, KeyPressed("Esc"))
    assert after(asked, KeyPressed("Esc")).requests == ()
    assert click(asked, "answer:discard changes").requests == (Quit(),)
    assert click(asked, "answer:save").requests == (Save(), Quit())
    assert after(state, KeyPressed("Esc")).requests == (Quit(),)


def test_a_dropped_file_is_imported_with_a_span(state):
    dropped = after(state, Dropped("/recordings/hello.bvh"))
    assert dropped.card == "import"
    spanned = after(dropped, KeyPressed("Tab"), *map(Typed, "1,5"), KeyPressed("Enter"))
    assert spanned.requests == (Import("/recordings/hello.bvh", 1.5, float("inf")),)
    wrong = after(dropped, KeyPressed("Tab"), Typed("soon"), KeyPressed("Enter"))
    assert wrong.alarming
    assert wrong.requests == ()


def test_a_click_beside_a_card_closes_it(state):
    opened = click(state, "open")
    assert opened.card == "open"
    assert after(opened, Moved(5, 700), Pressed(), Released()).card == ""


@pytest.mark.parametrize("card", CARDS)
@pytest.mark.parametrize("row", ["right", "left", "body"])
def test_everything_lies_in_the_window_and_can_be_read(state, card, row):
    shown = replace(state, card=card, document=state.document.select(row, 0))
    widgets = widgets_of(shown)
    names = [widget.name for widget in widgets]
    assert len(set(names)) == len(names)
    for widget in widgets:
        left, top, width, height = widget.rect
        assert left >= 0, widget.name
        assert top >= 0, widget.name
        assert left + width <= 1280, widget.name
        assert top + height <= 720, widget.name
        if isinstance(widget, Label):
            assert fitting(widget.words, widget.size, width) >= SMALLEST_TEXT, widget.name
        if isinstance(widget, Button):
            assert fitting(widget.label, widget.size, width - 10) >= SMALLEST_TEXT, widget.name
        if isinstance(widget, Slider):
            assert text_width(widget.label, 14.5) <= widget.label_width + 4, widget.name


@pytest.mark.parametrize("row", ["right", "body"])
def test_nothing_that_can_be_clicked_hides_something_else(state, row):
    shown = replace(state, document=state.document.select(row, 0))
    apart = [
        each
        for each in widgets_of(shown)
        if each.takes_mouse and not isinstance(each, Handle | KeyMark | KeyRow | Phases)
    ]
    for one, other in combinations(apart, 2):
        (left, top, width, height), (x, y, wide, high) = one.rect, other.rect
        across = min(left + width, x + wide) - max(left, x)
        down = min(top + height, y + high) - max(top, y)
        assert across <= 0 or down <= 0, f"{one.name} and {other.name}"
