"""A session whose camera is a page: it records the page's own bytes, and replays without error."""

import threading
import time
from contextlib import closing

import cv2
import numpy as np
import pytest

from cubeling.app.running.opening import open_session
from cubeling.app.running.replay_check import check_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.ui.screen import NullScreen
from cubeling.app.ui.web.picture import cut_out
from cubeling.tracking import ImageFeed, PushedSource, open_source

FRAMES = 8


def pushing(feed, jpegs, done):
    """Push pictures as a page does, until there are no more."""
    for number, jpeg in enumerate(jpegs):
        feed.push(jpeg, 100.0 + number / 30)
        if done.wait(0.02):
            return


class Leaving(NullScreen):
    """A screen whose player leaves after so many pictures."""

    def __init__(self, count):
        self.frames, self._count = [], count

    def show(self, step, robot):
        self.frames.append(step.frame)
        self.closed = len(self.frames) >= self._count
        return super().show(step, robot)


@pytest.mark.slow("tracks the frames of a session, live and once more")
def test_a_recording_holds_the_pages_own_bytes_and_replays_without_a_difference(
    bundled_session, tmp_path
):
    with open_source(str(bundled_session)) as frames:
        jpegs = [
            cv2.imencode(".jpg", cv2.resize(frame.image, (640, 360)))[1].tobytes()
            for frame, _ in zip(frames, range(20), strict=False)
        ]
    path, done, feed = tmp_path / "phone.mcap", threading.Event(), ImageFeed()
    thread = threading.Thread(target=pushing, args=(feed, jpegs * 99, done))
    thread.start()
    try:
        options = SessionOptions(
            scenario="companion",
            source="phone:ab12-back",
            record=path,
            robot="none",
            pictures=False,
        )
        with closing(PushedSource(feed, "phone")) as source:
            screen = Leaving(FRAMES)
            with open_session(options, source=source, screen=screen) as session:
                run(session)
    finally:
        done.set()
        thread.join()
    assert len(screen.frames) == FRAMES
    with open_source(str(path)) as recorded:
        kept = [frame.encoded for frame in recorded]
    # A frame that came too late to be drawn is recorded all the same.
    assert {frame.encoded for frame in screen.frames} <= {*kept} <= {*jpegs}
    assert len(kept) >= FRAMES
    with SessionFile(path) as file:
        assert check_session(file, file.info.options).identical


def test_timestamps_are_the_phones_brought_to_our_clock():
    now = [50.0]
    feed = ImageFeed(lambda: now[0])
    jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()
    taken = []
    for number, late in enumerate((0.010, 0.004, 0.300, 0.012)):
        now[0] = 60.0 + number / 10 + late
        assert feed.push(jpeg, 5000.0 + number / 10)
        found = feed.next(number, 0.0)
        assert found is not None
        taken.append(found[2])
    # From the quickest message on, what is late is known to be.
    assert [round(each, 3) for each in taken] == [60.01, 60.104, 60.204, 60.304]


def test_what_was_pushed_before_a_source_opens_is_old():
    feed = ImageFeed()
    jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()
    feed.push(jpeg, 1.0)
    fresh = cv2.imencode(".jpg", np.full((48, 64, 3), 7, np.uint8))[1].tobytes()
    timer = threading.Timer(0.2, lambda: feed.push(fresh, time.monotonic()))
    timer.start()
    with closing(PushedSource(feed, "phone")) as source:
        assert next(iter(source)).encoded == fresh
    timer.join()


def test_what_is_drawn_is_cut_out_of_the_cameras_picture():
    camera = np.full((20, 30, 3), 120, np.uint8)
    picture = camera.copy()
    picture[5:10, 5:15] = 10, 200, 90
    picture[12:14] = 60  # a shadow of half the light
    cut = cut_out(picture, camera)
    assert (cut[5:10, 5:15, 3] == 255).all()
    assert (cut[5:10, 5:15, :3] == (10, 200, 90)).all()
    assert (cut[0:5, :, 3] == 0).all()
    assert (cut[12:14, :, :3] == 0).all(), "a shadow is black"
    assert np.abs(cut[12:14, :, 3].astype(int) - 128).max() <= 2, "and lets half through"


def test_a_feed_that_was_silent_is_read_on_at_once():
    now, pictures = [50.0], [np.full((48, 64, 3), value, np.uint8) for value in (7, 90)]
    jpegs = [cv2.imencode(".jpg", each)[1].tobytes() for each in pictures]
    feed = ImageFeed()
    timer = threading.Timer(0.2, lambda: feed.push(jpegs[0], time.monotonic()))
    timer.start()
    with closing(PushedSource(feed, "phone", lambda: now[0])) as source:
        assert source.wait(0.0) is not None
        now[0] += 1.0
        end = time.monotonic() + 20.0
        while source._capture.state == "running" or source._capture.opening:
            assert time.monotonic() < end, "no time passes: nothing may wait for it"
            time.sleep(0.005)
        feed.push(jpegs[1], time.monotonic())
        while (frame := source.wait(0.0)) is None:
            assert time.monotonic() < end
        assert frame.encoded == jpegs[1]
    timer.join()
