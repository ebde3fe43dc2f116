"""Edits of a gesture: whatever is done, the gesture can be performed."""

from dataclasses import replace

import pytest
from hypothesis import given, strategies as st

from cubeling.app.workshop.gesture_editor.editing import edits
from cubeling.app.workshop.gesture_editor.editing.document import (
    EMPTY,
    ROWS,
    GestureDocument,
    moves,
)
from cubeling.app.workshop.gesture_editor.editing.state import (
    EditorState,
    commit,
    redo,
    undo,
    with_document,
)
from cubeling.app.workshop.gesture_editor.editing.timing import (
    duration,
    nearest_moment,
    phase_spans,
    stroke_for,
)
from cubeling.characters.behaviour import DIRECTIONS
from cubeling.characters.behaviour.gestures.checking import check_gesture
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.symbolic_gesture import SECTORS_X, SECTORS_Y, HandKey, Place

shares = st.floats(-0.5, 1.5)
seconds = st.floats(-1.0, 20.0)
directions = st.sampled_from([*DIRECTIONS, "up-in"])
EDITS = st.one_of(
    shares.map(lambda at: lambda each: edits.add_key(each, at)),
    shares.map(lambda at: lambda each: edits.move_key(each, at)),
    st.just(edits.remove_key),
    st.just(edits.mirror),
    st.tuples(st.sampled_from(SECTORS_X), st.sampled_from(SECTORS_Y)).map(
        lambda xy: lambda each: edits.change_place(each, x=xy[0], y=xy[1])
    ),
    st.sampled_from(["", "chin", "hip"]).map(
        lambda name: lambda each: edits.change_place(each, contact=name)
    ),
    directions.map(lambda words: lambda each: edits.change_direction(each, "palm", words)),
    directions.map(lambda words: lambda each: edits.change_direction(each, "fingers", words)),
    st.tuples(st.sampled_from(edits.PHASES), seconds).map(
        lambda each: lambda document: edits.change_phase(document, *each)
    ),
    st.sampled_from(["right", "left", "both", "either"]).map(
        lambda who: lambda each: edits.with_hands(each, who)
    ),
    st.sampled_from(ROWS).map(lambda row: lambda each: each.select(row, each.index)),
    st.integers(-2, 2).map(lambda step: lambda each: edits.neighbour(each, step)),
    st.tuples(st.integers(-1, 1), st.integers(-1, 1)).map(
        lambda step: lambda each: edits.move_sector(each, *step)
    ),
)


@given(st.lists(EDITS, max_size=15))
def test_after_any_edits_a_gesture_can_be_performed(steps):
    document = edits.change_gesture(EMPTY, name="ANY")
    for step in steps:
        document = step(document)
        if moves(document.gesture):
            check_gesture(document.gesture)


@given(st.lists(EDITS, max_size=12))
def test_undo_goes_back_to_each_gesture_and_redo_returns(steps):
    state, seen = EditorState(), [EMPTY.gesture]
    for step in steps:
        state = commit(state, with_document(state, step(state.document)))
        if state.document.gesture != seen[-1]:
            seen.append(state.document.gesture)
    for gesture in reversed(seen):
        assert state.document.gesture == gesture
        state = undo(state)
    assert not state.past
    for gesture in seen:
        assert state.document.gesture == gesture
        state = redo(state)


def test_a_new_edit_forgets_what_was_undone():
    state = EditorState()
    state = commit(state, with_document(state, edits.add_key(state.document, 0.0)))
    state = undo(state)
    state = commit(state, with_document(state, edits.with_hands(state.document, "either")))
    assert redo(state) is state


@pytest.mark.parametrize("name", ["WAVE", "CLAP", "BOW"])
def test_mirroring_twice_gives_the_same_gesture(name):
    document = GestureDocument(GestureCollection.load_bundled().get(name))
    assert edits.mirror(edits.mirror(document)) == document


def test_a_key_stays_between_its_neighbours():
    keys = (HandKey(0.0), HandKey(0.4), HandKey(1.0))
    document = GestureDocument(replace(EMPTY.gesture, right=keys)).select("right", 1)
    assert edits.move_key(document, 2.0).hand_key == replace(keys[1], at=1.0 - edits.MIN_KEY_GAP)
    assert edits.move_key(document, -1.0).hand_key == replace(keys[1], at=edits.MIN_KEY_GAP)


def test_fingers_turn_when_the_palm_would_be_along_them():
    document = edits.change_direction(edits.add_key(EMPTY, 0.0), "fingers", "up")
    turned = edits.change_direction(document, "palm", "down").hand_key
    assert turned is not None
    assert (turned.palm, turned.fingers) == ("down", "forward")


def test_a_sector_ends_a_contact():
    document = edits.add_key(EMPTY, 0.0)
    touching = edits.change_place(document, contact="chin")
    assert touching.hand_key is not None
    assert touching.hand_key.place.contact == "chin"
    away = edits.change_place(touching, x="XP", y="YCC")
    assert away.hand_key is not None
    assert (away.hand_key.place.x, away.hand_key.place.contact) == ("XP", "")


def test_an_offset_stays_along_the_axes_that_do_not_change():
    placed = replace(HandKey(0.0), place=Place("XC", "YCC", "ZMiddle", (0.1, 0.2, 0.3)))
    document = GestureDocument(replace(EMPTY.gesture, right=(placed,)))
    farther = edits.change_place(document, z="ZFar").hand_key
    assert farther is not None
    assert farther.place == Place("XC", "YCC", "ZFar", (0.1, 0.2, 0.0))


def test_each_hand_alone_keeps_its_own_keys():
    gesture = replace(EMPTY.gesture, right=(HandKey(0.0),), left=(HandKey(0.5),))
    both = GestureDocument(gesture)
    assert edits.with_hands(both, "left").gesture.left == gesture.left
    assert edits.with_hands(both, "right").gesture.right == gesture.right


def test_a_left_key_makes_a_gesture_two_handed():
    document = edits.with_hands(edits.add_key(EMPTY, 0.0), "either")
    document = edits.add_key(document.select("left", 0), 0.0)
    assert not document.gesture.one_handed
    assert edits.hands_of(document.gesture) == "both"


@pytest.mark.parametrize("repeats", [1, 3])
def test_a_dragged_stroke_ends_where_it_was_dragged_to(repeats):
    gesture = replace(GestureCollection.load_bundled().get("WAVE"), repeats=repeats)
    start, _ = phase_spans(gesture)["stroke"]
    longer = replace(gesture, stroke=stroke_for(gesture, 4.2))
    assert phase_spans(longer)["stroke"] == pytest.approx((start, start + 4.2))
    assert duration(longer) == pytest.approx(start + 4.2 + gesture.hold + gesture.retraction)


def test_a_key_is_added_where_the_preview_is():
    gesture = replace(EMPTY.gesture, preparation=0.5, stroke=0.4)
    assert nearest_moment(gesture, 0.6) == pytest.approx(0.25)
    assert nearest_moment(gesture, 0.0) == 0.0
    assert nearest_moment(gesture, 5.0) == 1.0
