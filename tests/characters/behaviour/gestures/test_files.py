"""Files and collections of gestures."""

import pytest
from hypothesis import given, settings, strategies as st

from cubeling.characters import CharacterError
from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.files import load_gesture, save_gesture
from cubeling.characters.behaviour.symbolic_gesture import (
    SECTORS_X,
    SECTORS_Y,
    SECTORS_Z,
    BodyKey,
    HandKey,
    Place,
    SymbolicGesture,
)
from tests.examples import examples

OFFSETS = st.tuples(*[st.floats(-2.0, 2.0)] * 3)
PLACES = st.builds(
    Place,
    st.sampled_from(SECTORS_X),
    st.sampled_from(SECTORS_Y),
    st.sampled_from(SECTORS_Z),
    OFFSETS,
    st.sampled_from(["", "chin", "other hand"]),
)
HAND_KEYS = st.builds(
    HandKey,
    st.floats(0.0, 1.0),
    PLACES,
    st.sampled_from(["flat", "fist"]),
    st.just("down-in"),
    st.sampled_from(["forward", "up-in"]),
    st.sampled_from(["line", "arc", "circle", "wave", "keys"]),
    OFFSETS,
    st.floats(0.0, 20.0),
)
BODY_KEYS = st.builds(BodyKey, st.floats(0.0, 1.0), st.floats(-90.0, 90.0), shrug=st.floats(0, 1))


def _ordered(keys):
    times = {key.at: key for key in keys}
    return tuple(times[at] for at in sorted(times))


@settings(max_examples=examples(40))
@given(
    st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), min_size=1, max_size=20),
    st.text(max_size=30),
    st.lists(HAND_KEYS, min_size=1, max_size=4).map(_ordered),
    st.lists(HAND_KEYS, max_size=3).map(_ordered),
    st.lists(BODY_KEYS, max_size=3).map(_ordered),
    st.floats(0.0, 60.0),
    st.integers(1, 100),
    st.builds(GestureExpressivity, spatial=st.floats(-1, 1), power=st.floats(0, 1)),
)
def test_a_saved_gesture_is_read_back_exactly(
    tmp_path_factory, name, summary, right, left, body, stroke, repeats, style
):
    gesture = SymbolicGesture(
        name, summary, right, left, body, stroke=stroke, repeats=repeats, expressivity=style
    )
    path = tmp_path_factory.getbasetemp() / "gesture.toml"
    save_gesture(gesture, path)
    assert load_gesture(path) == gesture


GOOD = '[[right]]\nat = 0.0\npalm = "in"\n'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("right = 3", "right"),
        ("[[right", "end of document"),
        ("summary = 'nothing'", "nothing moves"),
        (GOOD + 'shape = "fits"', "did you mean 'fist'"),
        (GOOD + 'shpe = "fist"', "did you mean 'shape'"),
        (GOOD + "at_ = 2", "at_"),
        ("[[right]]\nat = 2.0", "at is 2; give 0 to 1"),
        ("[[right]]\nat = nan", "nan"),
        (GOOD + 'place = { x = "XQ" }', "XQ"),
        (GOOD + 'place = { contact = "foot" }', "foot"),
        (GOOD + 'fingers = "in"', "not across"),
        (GOOD + 'path = "zigzag"', "zigzag"),
        (GOOD + GOOD, "not in the order of time"),
        (f"repeats = 0\n{GOOD}", "repeats"),
        (f"one_handed = true\n{GOOD}[[left]]\nat = 0.0", "one_handed"),
        (f"expressivity = {{ power = 3.0 }}\n{GOOD}", "power is 3"),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, text, says):
    path = tmp_path / "bad.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(CharacterError) as refused:
        load_gesture(path)
    assert says in str(refused.value)
    assert str(refused.value).startswith(str(path))
    assert "\n" not in str(refused.value)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(CharacterError, match="cannot read "):
        load_gesture(tmp_path / "none.toml")


def test_a_folder_that_cannot_be_made_is_refused_and_leaves_no_draft(tmp_path):
    (tmp_path / "file").write_text("")
    gesture = GestureCollection.load_bundled().get("WAVE")
    with pytest.raises(CharacterError, match="cannot write"):
        save_gesture(gesture, tmp_path / "file" / "wave.toml")


def test_at_least_forty_gestures_are_bundled():
    gestures = GestureCollection.load_bundled()
    assert len(gestures) >= 40
    assert all(gesture.summary for gesture in gestures)
    for name in ("BEAT", "POINT_LEFT", "CIRCLE", "OPEN_ARMS", "FAR_REACH", "WAVE", "SHRUG", "BOW"):
        assert name in gestures


@pytest.mark.parametrize("name", ["wave", "Wave", "WAVE", " thumbs-up ", "Thumbs up"])
def test_names_are_found_in_any_case(name):
    assert name in GestureCollection.load_bundled()
    assert GestureCollection.load_bundled().get(name).name in ("WAVE", "THUMBS_UP")


def test_an_unknown_name_suggests_the_nearest():
    with pytest.raises(CharacterError, match="did you mean WAVE"):
        GestureCollection.load_bundled().get("WAFE")


def test_gestures_of_the_user_go_first_and_are_kept(tmp_path):
    own = SymbolicGesture("WAVE", "mine", right=(HandKey(0.0),))
    GestureCollection.load_bundled(tmp_path / "gestures").save(own)
    again = GestureCollection.load_bundled(tmp_path / "gestures")
    assert again.get("wave") == own
    assert len(again) == len(GestureCollection.load_bundled())


def test_a_name_is_never_a_way_out_of_the_folder(tmp_path):
    collection = GestureCollection.load_bundled(tmp_path / "gestures")
    path = collection.save(SymbolicGesture("../../x", right=(HandKey(0.0),)))
    assert path.parent == tmp_path / "gestures"
    assert GestureCollection.load_bundled(tmp_path / "gestures").get("../../x").name == "../../x"
