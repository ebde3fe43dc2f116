"""Keys and mouse of the player, without a window: what they ask for, and what is shown."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.app.output_path import dated_file, short_path
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.ui.cards.hint_reader import HintReader
from cubeling.app.ui.cards.layout import HINT_ROOM, are_apart
from cubeling.app.ui.playback import timeline
from cubeling.app.ui.playback.announcements import NOTICE_S
from cubeling.app.ui.playback.cards import draw_pills
from cubeling.app.ui.playback.keys import BINDINGS, key_rows, key_table
from cubeling.app.ui.playback.requests import (
    ListChoices,
    OpenCube,
    Pause,
    PlayScenario,
    Seek,
    SeekTo,
    StartOver,
    WindowRequest,
)
from cubeling.app.ui.playback.status import EndCard, PlaybackMark, Position
from tests.app.ui.playback_desk import NOW, PICTURE, WIDTH, Desk, desk as desk

HERE = Path(__file__).parent
POSITION = Position(3.0, 20.0, 0.0, 20.0, marks=(PlaybackMark(10.0, "placed front"),))


def test_every_key_of_the_table_does_what_it_says(desk):
    for binding in BINDINGS:
        desk.press(binding.key)
        made = desk.layer.take_requests()
        match binding.request:
            case WindowRequest.MENU:
                assert made == (ListChoices(),)
            case WindowRequest() | StartOver() | PlayScenario() | OpenCube():
                assert made == ()
            case request:
                assert made == (request,), binding
        desk.press("Esc")
    assert {WindowRequest.PANELS, WindowRequest.FULL_SCREEN} <= set(desk.asked)


def test_no_key_is_there_twice():
    assert len({binding.key for binding in BINDINGS}) == len(BINDINGS)
    assert {key for row in key_rows() for key in row.keys} >= {"Space", "?", "…"}


def test_the_documents_have_the_table_of_keys():
    assert key_table() in (HERE.parents[2] / "docs/playing.md").read_text()


def test_the_scenario_is_told_once_what_it_is_asked(desk):
    desk.press("C", "2")
    assert desk.layer.take_inputs() == Inputs(clear=True, scenario="sketch")
    assert desk.layer.take_inputs() == Inputs()
    desk.press("I")
    assert desk.layer.take_inputs() == Inputs(inside=True)
    desk.press("I", "I")  # in the same frame: as it was
    assert desk.layer.take_inputs() == Inputs()
    before = desk.shown()
    desk.press("7")
    assert desk.layer.take_inputs() == Inputs()
    assert (desk.shown() != before).any(), "nothing says that there is no such scenario"


def test_holding_a_key_repeats_only_what_can_go_on(desk):
    desk.layer.press("→", repeated=True)
    desk.layer.press("Space", repeated=True)
    assert desk.layer.take_requests() == (Seek(5.0),)


def test_a_notice_is_shown_for_some_seconds(desk):
    plain = desk.shown()
    desk.layer.notify("Something happened")
    assert desk.layer.changed
    assert (desk.shown() != plain).any()
    assert not desk.layer.changed
    desk.time = NOTICE_S + 0.1
    assert desk.layer.changed
    np.testing.assert_array_equal(desk.shown(), plain)


def test_escape_closes_a_card_before_the_window(desk):
    plain = desk.shown()
    desk.press("?")
    assert (desk.shown() != plain).any()
    desk.press("Esc")
    np.testing.assert_array_equal(desk.shown(), plain)
    assert desk.asked == []
    desk.press("Esc")
    assert desk.asked == [WindowRequest.QUIT]


def test_the_card_at_the_end_waits_for_a_key(desk):
    plain = desk.shown()
    desk.report(ending=EndCard("The end", (("Again", "Space"),)))
    assert (desk.shown() != plain).any()
    desk.press("Space")
    assert desk.layer.take_requests() == (Pause(),)
    assert desk.asked == []
    desk.press("Enter")
    assert desk.asked == [WindowRequest.QUIT]


def test_a_snapshot_is_the_picture_without_what_only_the_player_needs(desk, tmp_path):
    desk.press("?")
    desk.report(position=POSITION)
    desk.shown()
    desk.press("S", "S")
    names = sorted(path.name for path in (tmp_path / "kept").iterdir())
    assert names == ["follow-2026-05-04-150309-2.png", "follow-2026-05-04-150309.png"]
    kept = cv2.imread(str(tmp_path / "kept" / names[1]))
    np.testing.assert_array_equal(kept, PICTURE)


def test_a_snapshot_that_cannot_be_kept_is_said(tmp_path):
    (tmp_path / "file").write_text("")
    desk = Desk(tmp_path / "file")
    plain = desk.shown()
    desk.press("S")
    assert (desk.shown() != plain).any()


def test_the_timeline_lies_under_the_picture_and_changes_nothing_of_it(desk):
    plain = desk.shown()
    desk.report(position=POSITION)
    shown = desk.shown()
    assert shown.shape == (360 + round(timeline.STRIP_HEIGHT / 2), 640, 3)
    np.testing.assert_array_equal(shown[:360], plain)


def test_the_mouse_seeks_on_the_timeline(desk):
    desk.report(position=POSITION)
    desk.shown()
    track = timeline.TRACK_LEFT, WIDTH - timeline.TRACK_RIGHT
    desk.layer.click(30.0, 748.0)
    assert desk.layer.take_requests() == (Pause(),)
    desk.layer.click(track[0], 748.0)
    desk.layer.point((track[0] + track[1]) / 2, 748.0)
    assert desk.layer.take_requests() == (SeekTo(10.0),), "only the last place counts"
    desk.layer.point(track[1] + 90.0, 300.0)
    assert desk.layer.take_requests() == (SeekTo(20.0),)
    desk.layer.release()
    desk.layer.point(track[0], 748.0)
    assert desk.layer.take_requests() == ()
    desk.layer.click(600.0, 300.0)
    assert desk.layer.take_requests() == ()


def test_a_part_is_all_that_the_timeline_reaches():
    part = Position(8.0, 20.0, 5.0, 15.0)
    assert timeline.position_at(timeline.TRACK_LEFT, part, WIDTH) == 5.0
    assert timeline.position_at(WIDTH, part, WIDTH) == 15.0


def test_the_corner_has_buttons_for_keys_and_menu(desk):
    plain = desk.shown()
    desk.layer.click(1190.0, 42.0)
    keys = desk.shown()
    desk.layer.click(1190.0, 42.0)
    np.testing.assert_array_equal(desk.shown(), plain)
    desk.layer.click(1234.0, 42.0)
    assert desk.layer.take_requests() == (ListChoices(),)
    assert (desk.shown() != keys).any()


def test_after_the_end_every_key_works_or_says_why_not(desk):
    desk.report(ending=EndCard("The end"))
    for key, asked in (("C", Inputs(clear=True)), ("2", Inputs(scenario="sketch"))):
        desk.press(key)
        assert desk.layer.take_requests() == (Pause(),), "it begins again"
        assert desk.layer.take_inputs() == asked
    desk.time += NOTICE_S + 1.0
    before = desk.shown()
    desk.press("I")
    assert (desk.layer.take_requests(), desk.layer.take_inputs()) == ((), Inputs())
    assert (desk.shown() != before).any()


def test_a_notice_lies_over_no_card():
    taken = (300.0, 60.0, 616.0, 362.0)
    pills = draw_pills((("Recorded 12 s", None), ("Paused", None)), 960.0, 1.0, [taken])
    assert [are_apart(pill.box(1.0), [taken]) for pill in pills] == [True, True]
    assert pills[0].box(1.0)[3] < pills[1].box(1.0)[1]


def test_a_hint_that_was_read_goes_while_the_cube_is_in_view(a_step):
    reader, step = HintReader(), a_step(None)

    def at(time, words="Move the cube", visible=True):
        shown = replace(
            step,
            frame=replace(step.frame, timestamp=time),
            state=replace(step.state, visible=visible),
            outcome=replace(step.outcome, hint=words),
        )
        return reader.update(shown).outcome.hint

    assert [at(time) for time in (0.0, 4.0, 6.0)] == ["Move the cube", "Move the cube", ""]
    assert at(7.0, "Turn it") == "Turn it"
    assert at(20.0, visible=False) == at(40.0, visible=False) == "Move the cube"
    assert at(41.0) == "Move the cube"
    assert at(60.0) == ""


def test_what_goes_on_is_shown(desk):
    pictures = [desk.shown()]
    for status in ({"paused": True}, {"recording": 12.0}, {"recording": 13.0}):
        desk.report(**status)
        assert desk.layer.changed
        pictures.append(desk.shown())
    desk.report(seeking=True)
    desk.shown()
    desk.time += 1.0
    pictures.append(desk.shown())
    for place, picture in enumerate(pictures):
        for other in pictures[:place]:
            assert (picture != other).any()


def test_files_made_by_keys_have_names_that_a_shell_takes(tmp_path, monkeypatch):
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    path = dated_file(tmp_path / "Cubeling", "follow", ".mcap", NOW)
    assert short_path(path) == "~/Cubeling/follow-2026-05-04-150309.mcap"
    assert short_path(tmp_path / "my films" / "a.mcap") == f"'{tmp_path}/my films/a.mcap'"


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_a_long_notice_stays_in_the_room_of_the_hint(scale):
    words = "Recorded 12 s. Play it: cubeling replay ~/Cubeling/companion-2026-05-04-150309.mcap"
    (notice,) = draw_pills(((words, None),), 1280.0, scale)
    picture = np.zeros((round(720 * scale), round(1280 * scale), 3), np.uint8)
    notice.blend_over(picture)
    columns = np.flatnonzero(picture.any(axis=(0, 2))) / scale
    assert columns[0] > (1280 - HINT_ROOM) / 2
    assert columns[-1] < (1280 + HINT_ROOM) / 2
    assert columns[-1] - columns[0] > 300
