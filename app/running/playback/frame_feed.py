"""The frames of a session's source, one after the other."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

from cubeling.app.running.opened_session import OpenedSession
from cubeling.tracking import Frame, Health, LiveFrames, StoredFrames, Timeline, open_source

SCREEN_UPDATE_INTERVAL_S = 0.05
"""While no frame comes, the screen is updated at least this often."""


class FrameFeed:
    """Returns the frames of the session's present source; live ones without gaps by pauses."""

    def __init__(self, session: OpenedSession) -> None:
        self._session = session
        self.last: Frame | None = None
        """The frame that was returned last."""
        self._frames: Iterator[Frame] | None = None
        self._shift = 0.0
        self._timeline = Timeline()  # a recording stores the shifted times exactly
        self._close_gap = False

    def next(self) -> Frame | Health | None:
        """Return the next frame, a live source's health while it has none, or None at the end."""
        source = self._session.source
        found: Frame | Health | None
        if isinstance(source, LiveFrames):
            found = self._next_live(source)
        else:
            if self._frames is None:
                self._frames = iter(source)
            found = next(self._frames, None)
        if isinstance(found, Frame):
            self.last = found
        return found

    def close_gap(self) -> None:
        """Let the next live frame follow the last one: after a pause, or in another source."""
        self._close_gap = True

    def rewind(self, index: int) -> None:
        """Read a recording again, from a frame on."""
        session, options = self._session, self._session.options
        session.source.close()
        session.source = open_source(options.source)
        assert isinstance(session.source, StoredFrames), "only recordings are read again"
        session.source.skip(index)
        self._frames = iter(session.source)
        if options.stage != "camera" and session.replayed is not None:
            replay_inputs = session.replayed.replay_inputs(options.stage)
            session.replay_inputs = islice(replay_inputs, index, None)

    def _next_live(self, source: LiveFrames) -> Frame | Health | None:
        if source.health.state == "closed":
            return None
        frame = source.wait(SCREEN_UPDATE_INTERVAL_S, self._session.options.patience_s)
        if frame is None:
            return source.health
        if self._close_gap and self.last is not None:
            self._shift = frame.timestamp - (self.last.timestamp + 1.0 / source.rate)
        self._close_gap = False
        if self._shift:
            frame = replace(frame, timestamp=self._timeline.stamp(frame.timestamp - self._shift))
        return frame
