"""The whole editor: preview, files, and what is left after a crash."""

import numpy as np
import pytest

from cubeling.app.workshop.gesture_editor.editing.actions import (
    ACTIONS,
    drop_file,
    read_recording,
    save,
)
from cubeling.app.workshop.gesture_editor.editing.edits import change_key, change_place
from cubeling.app.workshop.gesture_editor.editing.state import (
    EditorState,
    Open,
    Save,
    with_document,
    with_request,
)
from cubeling.app.workshop.gesture_editor.preview import Preview, PreviewedGesture
from cubeling.app.workshop.gesture_editor.session import KEEP_INTERVAL_S, EditorSession
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.files import load_gesture
from cubeling.characters.errors import CharacterError
from tools.gesture_tour import Hand, draw_tour

PICTURE_PX = 240, 180
"""Size of pictures of the character [px]."""


def make_fist(state: EditorState) -> EditorState:
    """Change the selected key."""
    return with_document(state, change_key(state.document, shape="fist"))


def hand_height(preview: Preview, previewed: PreviewedGesture, time: float) -> float:
    """Return the height of the right hand over the table [m]."""
    posed = preview.pose(previewed, time)
    character = preview.character(previewed.character)
    joint = character.anatomy.joint("rightHand")
    if joint is None:
        joint = character.anatomy.joint("rightFrontFoot")
    assert joint is not None
    placed = posed.table_from_character @ posed.pose.globals(character.skeleton)[joint]
    return float(placed[1, 3])


@pytest.mark.slow(reason="each change is drawn")
def test_a_gesture_is_made_from_empty_to_saved(opened, tmp_path):
    pictures = draw_tour(tmp_path, tmp_path / "gestures", (620, 370))
    assert len(pictures) == 7
    assert all(path.stat().st_size > 20_000 for path in pictures)
    saved = load_gesture(tmp_path / "gestures" / "big_hello.toml")
    assert saved.name == "BIG_HELLO"
    assert saved.one_handed
    assert saved.expressivity.power == 0.5
    assert [key.path for key in saved.right] == ["line", "wave"]
    again = opened("big hello").state
    assert again.document.gesture == saved
    assert not again.changed
    assert "BIG_HELLO" in again.names


def test_every_gesture_of_the_library_survives_the_editor(opened, tmp_path):
    session, library = opened(), GestureCollection.load_bundled()
    for gesture in library:
        session.settle(with_request(session.state, Open(gesture.name)))
        session.do(save)
        saved = load_gesture(tmp_path / "gestures" / f"{gesture.name.lower()}.toml")
        assert saved == session.state.document.gesture == gesture


def test_the_preview_shows_what_is_edited(editing):
    editor = editing("STOP", "human")
    hand, session = Hand(editor), editor.session
    preview, heights = session._preview, []
    for sector in ("YLowerC", "YUpperEP"):
        hand.click(f"key:right:{len(session.state.document.gesture.right) - 1}")
        hand.put_hand("XP", sector)
        session.advance(0.0)
        previewed = PreviewedGesture.of(session.state.document, "human")
        heights.append(hand_height(preview, previewed, session.state.time))
    assert heights[1] > heights[0] + 0.02


def test_a_time_shows_the_same_pose_however_it_was_reached(context):
    preview = Preview(context)
    previewed = PreviewedGesture(GestureCollection.load_bundled().get("WAVE"), "right", "human")
    first = preview.pose(previewed, 0.9).pose.rotations
    preview.pose(previewed, 0.2)
    np.testing.assert_allclose(preview.pose(previewed, 0.9).pose.rotations, first, atol=1e-9)


def test_the_picture_changes_while_it_plays_and_rests_in_a_pause(opened):
    session = opened("WAVE")
    session.advance(0.5)
    first = session.picture(PICTURE_PX)
    session.advance(0.5)
    assert not np.array_equal(session.picture(PICTURE_PX), first)
    session.do(ACTIONS["Space"])
    paused = session.picture(PICTURE_PX)
    session.advance(0.5)
    np.testing.assert_array_equal(session.picture(PICTURE_PX), paused)


def test_the_sector_of_the_hand_glows(editing):
    editor = editing("WAVE", "human")
    editor.press("Space")
    plain = editor.picture()
    Hand(editor).click("sectors")
    editor.move(5.0, 365.0)
    left, top, width, height = (round(each) for each in editor.places["stage"])
    inside = np.s_[top + 20 : top + height, left : left + width]
    changed = np.abs(editor.picture()[inside].astype(int) - plain[inside]) > 20
    assert changed.any(2).sum() > 100


@pytest.mark.parametrize("size", [(620, 370), (1000, 600)])
def test_the_picture_has_the_size_of_the_window(editing, size):
    picture = editing(size=size).picture()
    assert picture.shape == (size[1], size[0], 3)
    assert np.ptp(picture) > 200


def test_a_folder_that_cannot_be_written_loses_nothing(opened, tmp_path):
    session = opened("WAVE")
    session.do(make_fist)
    (tmp_path / "gestures").mkdir()
    (tmp_path / "gestures").rename(tmp_path / "elsewhere")
    (tmp_path / "gestures").write_text("not a folder")
    before = session.state.document
    session.do(save)
    assert session.state.alarming
    assert "\n" not in session.state.message
    assert session.state.document == before
    assert session.state.changed
    session.advance(2 * KEEP_INTERVAL_S)
    assert "not safe yet" in session.state.message


def test_a_failed_save_does_not_close_the_editor(editing, tmp_path):
    editor = editing()
    (tmp_path / "gestures").write_text("not a folder")
    hand = Hand(editor)
    hand.put_hand("XP", "YCC")
    hand.write("name", "mine")
    editor.press("Escape")
    hand.click("answer:save")
    assert editor.session.state.alarming
    assert not editor.session.closed


def test_changes_survive_a_crash(opened):
    session = opened("WAVE")
    session.do(make_fist)
    session.advance(KEEP_INTERVAL_S)
    again = opened()  # the first one was never closed
    assert again.state.document.gesture == session.state.document.gesture
    assert again.state.changed
    again.do(save)
    assert again.state.card == "replace"
    again.settle(with_request(again.state, Save(overwrite=True)))
    assert not opened().state.changed
    assert opened().state.document.gesture.name == ""


def test_a_gesture_without_a_name_survives_a_crash(opened):
    session = opened()
    session.do(
        lambda state: with_document(state, change_place(state.document, x="XEP", y="YUpperP"))
    )
    session.close()
    again = opened()
    assert again.state.document.gesture == session.state.document.gesture


def test_discarded_changes_do_not_come_back(editing, opened):
    editor = editing("WAVE")
    Hand(editor).click("shape:fist")
    editor.session.advance(KEEP_INTERVAL_S)
    editor.press("Escape")
    Hand(editor).click("answer:discard changes")
    assert editor.session.closed
    editor.session.close()
    assert opened().state.document.gesture.name == ""


def test_another_gesture_is_replaced_only_if_asked(editing, tmp_path):
    editor = editing("WAVE")
    hand, session = Hand(editor), editor.session
    hand.click("shape:fist")
    hand.write("name", "clap")
    editor.press("Ctrl+S")
    assert session.state.card == "replace"
    assert not (tmp_path / "gestures" / "clap.toml").exists()
    hand.click("answer:replace it")
    assert load_gesture(tmp_path / "gestures" / "clap.toml") == session.state.document.gesture


def test_an_import_that_fails_changes_nothing(editing):
    editor = editing("WAVE")
    hand, session = Hand(editor), editor.session
    before = session.state.document
    hand.click("import")
    hand.write("recording", "nowhere.bvh")
    assert session.state.alarming
    assert session.state.document == before


def test_a_recording_is_imported_and_waits_for_a_name(opened, context, tmp_path):
    preview, human = Preview(context), Character.load("human")
    previewed = PreviewedGesture(GestureCollection.load_bundled().get("CHEER"), "right", "human")
    times = np.arange(0.0, previewed.cycle, 1 / 30)
    poses = Pose.of_frames([preview.pose(previewed, float(time)).pose for time in times])
    clip = Clip("cheer", 30.0, poses, loop=False)
    Character("cheers", human.skeleton, {"cheer": clip}, human.meshes, morphs=human.morphs).save(
        tmp_path / "cheers.glb"
    )
    session = opened()
    session.do(lambda state: drop_file(state, str(tmp_path / "cheers.glb")))
    session.do(read_recording)
    assert not session.state.alarming
    gesture = session.state.document.gesture
    assert gesture.right
    assert gesture.left
    assert session.state.changed


def test_a_character_of_the_users_can_perform(opened, tmp_path):
    path = tmp_path / "mine.glb"
    Character.load("robot").save(path)
    session = opened("CLAP", str(path))
    assert session.state.characters[-1] == str(path)
    session.advance(0.4)
    assert session.picture(PICTURE_PX).shape == (*PICTURE_PX[::-1], 3)


def test_a_broken_file_in_the_folder_is_named(context, tmp_path):
    (tmp_path / "bad.toml").write_text("[[right]]\nat = 'soon'")
    with pytest.raises(CharacterError, match=r"bad\.toml"):
        EditorSession(context, tmp_path)


def test_a_press_without_a_release_elsewhere_does_not_stay_held(editing):
    editor = editing("WAVE")
    Hand(editor).drag("shape:fist", 1.0)
    assert editor.session.state.held == 0
    assert editor.session.state.grip is None
