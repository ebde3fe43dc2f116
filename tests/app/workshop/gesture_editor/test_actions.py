"""What buttons and keys do, without panels and preview."""

from dataclasses import replace

import pytest

from cubeling.app.workshop.gesture_editor.editing import actions
from cubeling.app.workshop.gesture_editor.editing.actions import ACTIONS
from cubeling.app.workshop.gesture_editor.editing.document import GestureDocument
from cubeling.app.workshop.gesture_editor.editing.edits import change_gesture
from cubeling.app.workshop.gesture_editor.editing.state import (
    EditorState,
    Import,
    New,
    Open,
    Quit,
    Save,
    end_frame,
    undo,
    with_document,
    with_text,
)
from cubeling.characters.behaviour.gestures.collection import GestureCollection


@pytest.fixture
def state():
    collection = GestureCollection.load_bundled()
    document = GestureDocument(collection.get("WAVE")).select("right", 1)
    return EditorState(document, document, names=collection.names)


def after(state, *keys):
    for key in keys:
        state = ACTIONS[key](state)
    return state


def with_summary(state, words):
    return with_document(state, change_gesture(state.document, summary=words))


def test_what_is_done_while_a_widget_is_held_is_one_step_of_undo(state):
    now = state
    for number in range(3):
        now = end_frame(now, with_summary(now, f"{number}"), held=7)
        assert now.past == ()
    now = end_frame(now, now, held=0)
    assert len(now.past) == 1
    assert undo(now).document == state.document


def test_a_widget_that_takes_over_begins_another_step(state):
    clicked = end_frame(state, state, held=7)
    typed = end_frame(clicked, with_summary(clicked, "typed"), held=7)
    dragged = end_frame(typed, with_summary(typed, "dragged"), held=8)
    ended = end_frame(dragged, dragged, held=0)
    assert [each.gesture.summary for each in ended.past] == [
        "typed",
        state.document.gesture.summary,
    ]


def test_undo_by_a_button_that_is_held_is_no_step(state):
    changed = end_frame(state, with_summary(state, "changed"), held=0)
    pressed = end_frame(changed, changed, held=7)
    undone = end_frame(pressed, undo(pressed), held=0)
    assert undone.document == state.document
    assert (undone.past, len(undone.future)) == ((), 1)


def test_keys_are_added_selected_moved_and_deleted(state):
    added = after(replace(state, time=1.0), "A")
    assert len(added.document.gesture.right) == 3
    assert added.document.index == 1
    at = added.document.hand_key.at
    moved = after(added, "Shift+Right")
    assert moved.document.hand_key.at > at
    assert after(moved, "Left").document.index == 0
    assert after(moved, "Delete").document.gesture == state.document.gesture


def test_arrows_with_control_move_the_hand_as_it_is_seen(state):
    place = state.document.hand_key.place
    lower = after(state, "Ctrl+Down").document.hand_key.place
    assert (lower.x, lower.y != place.y) == (place.x, True)
    assert after(state, "Ctrl+Right").document.hand_key.place.x == "XC"


def test_frames_are_stepped_within_the_gesture(state):
    stepped = after(state, ".", ".")
    assert stepped.time == pytest.approx(2 * actions.STEP_S)
    assert not stepped.playing
    assert after(stepped, *[","] * 5).time == 0.0


def test_a_path_that_was_a_line_gets_a_radius_that_can_be_seen(state):
    line = actions.choose_path(after(state, "Left"), "line")
    circle = actions.choose_path(line, "circle")
    radii = [key.radius for each in (line, circle) for key in each.document.gesture.right[:1]]
    assert [any(radius) for radius in radii] == [False, True]


def test_a_gesture_without_a_name_is_asked_for_one():
    asked = after(EditorState(), "Ctrl+S")
    assert (asked.card, asked.requests) == ("save as", ())
    named = actions.save_under_name(with_text(asked, "new name", "hi"))
    assert named.document.gesture.name == "HI"
    assert named.requests == (Save(),)
    assert actions.save_under_name(with_text(asked, "new name", " ! ")).alarming


def test_changes_are_never_lost_without_a_question(state):
    changed = with_summary(state, "changed")
    for leave in ("Escape", "Ctrl+N"):
        assert after(changed, leave).card == "unsaved"
    asked = after(changed, "Escape")
    assert after(asked, "Escape").requests == ()
    assert actions.go_on(asked).requests == (Quit(),)
    assert actions.save_and_go_on(asked).requests == (Save(), Quit())
    assert after(state, "Escape").requests == (Quit(),)
    assert after(state, "Ctrl+N").requests == (New(),)


def test_a_gesture_without_a_name_is_named_before_what_was_put_off(state):
    nameless = with_document(state, change_gesture(state.document, name=""))
    asked = actions.save_and_go_on(after(nameless, "Escape"))
    assert asked.card == "save as"
    named = actions.save_under_name(with_text(asked, "new name", "hi"))
    assert named.requests == (Save(), Quit())


def test_the_first_gesture_that_is_found_is_opened(state):
    assert actions.open_first(with_text(state, "find", "lap")).requests == (Open("CLAP"),)
    assert actions.open_first(with_text(state, "find", "no such")) == with_text(
        state, "find", "no such"
    )


def test_a_span_is_read_as_people_write_it(state):
    dropped = actions.drop_file(state, "/recordings/hello.bvh")
    assert dropped.card == "import"
    spanned = actions.read_recording(with_text(dropped, "start", "1,5"))
    assert spanned.requests == (Import("/recordings/hello.bvh", 1.5, float("inf")),)
    wrong = actions.read_recording(with_text(dropped, "start", "soon"))
    assert wrong.alarming
    assert wrong.requests == ()
    assert actions.read_recording(with_text(dropped, "recording", " ")).alarming
