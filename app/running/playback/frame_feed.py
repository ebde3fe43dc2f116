"""The frames of a session's source, one after the other."""

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace
from itertools import islice

from cubeling.app.running.opened_session import OpenedSession
from cubeling.robot import Closeable
from cubeling.tracking import (
    BufferedFrames,
    Frame,
    Health,
    LiveFrames,
    StoredFrames,
    Timeline,
)

SCREEN_UPDATE_INTERVAL_S = 0.05
"""While no frame comes, the screen is updated at least this often."""


MAX_WAITING_S = 1.0
"""Frames of a camera wait for so long at most while a session is recorded."""


class FrameFeed(Closeable):
    """Returns the frames of the session's present source; live ones without gaps by pauses.

    The next frame of a recording is decoded on a thread, while the last one is processed. Close it
    before the source; a second call does nothing.
    """

    def __init__(self, session: OpenedSession) -> None:
        self._session = session
        self.last: Frame | None = None
        """The frame that was returned last."""
        self._frames: Iterator[Frame] | None = None
        self._decoder: ThreadPoolExecutor | None = None
        self._ahead: Future[Frame | None] | None = None
        self._shift = 0.0
        self._timeline = Timeline()  # a recording stores the shifted times exactly
        self._close_gap = False

    def next(self) -> Frame | Health | None:
        """Return the next frame, a live source's health while it has none, or None at the end."""
        source = self._session.source
        found = self._next_live(source) if isinstance(source, LiveFrames) else self._next_stored()
        if isinstance(found, Frame):
            self.last = found
        return found

    def close(self) -> None:
        """Wait for the frame that is being decoded, and end its thread."""
        self._wait()
        if self._decoder is not None:
            self._decoder.shutdown()
            self._decoder = None

    @property
    def is_behind(self) -> bool:
        """Whether newer frames of a camera wait already."""
        source = self._session.source
        return isinstance(source, BufferedFrames) and source.waiting > 0

    def close_gap(self) -> None:
        """Let the next live frame follow the last one: after a pause, or in another source."""
        self._close_gap = True

    def rewind(self, index: int, timestamp: float | None = None) -> None:
        """Read a recording again, from a frame on, whose timestamp may be known [s]."""
        session, options = self._session, self._session.options
        self._wait()
        assert isinstance(session.source, StoredFrames), "only recordings are read again"
        session.source.restart(index, timestamp)
        self._frames = iter(session.source)
        session.replay_inputs = None
        if options.stage != "camera" and session.replayed is not None:
            replay_inputs = session.replayed.replay_inputs(options.stage)
            session.replay_inputs = islice(replay_inputs, index, None)

    def _next_stored(self) -> Frame | None:
        """Return the next frame of a recording, and begin to decode the one after it."""
        if self._frames is None:
            self._frames = iter(self._session.source)
        if self._decoder is None:
            self._decoder = ThreadPoolExecutor(1, "decoding")
        frames, ahead, self._ahead = self._frames, self._ahead, None
        found = next(frames, None) if ahead is None else ahead.result()
        if found is not None:
            self._ahead = self._decoder.submit(next, frames, None)
        return found

    def _wait(self) -> None:
        """Wait for the thread, and forget what it has decoded."""
        if self._ahead is not None:
            wait([self._ahead])
            self._ahead = None

    def _next_live(self, source: LiveFrames) -> Frame | Health | None:
        if source.health.state == "closed":
            return None
        if isinstance(source, BufferedFrames):
            # A recording has every frame of the camera, as far as they are decided in time.
            kept = 1 if self._session.recording is None else round(MAX_WAITING_S * source.rate)
            source.max_waiting = 1 if self._close_gap else max(kept, 1)
        frame = source.wait(SCREEN_UPDATE_INTERVAL_S, self._session.options.patience_s)
        if frame is None:
            return source.health
        if self._close_gap and self.last is not None:
            self._shift = frame.timestamp - (self.last.timestamp + 1.0 / source.rate)
        self._close_gap = False
        self._session.taken_from_timestamp = self._shift
        if self._shift:
            frame = replace(frame, timestamp=self._timeline.stamp(frame.timestamp - self._shift))
        return frame
