"""Where a session is in its source: it plays, is paused, seeks, or has come to its end."""

import math
from dataclasses import dataclass

from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.playback.frame_feed import FrameFeed
from cubeling.app.running.playback.saved_states import SavedStates
from cubeling.app.running.screens import is_seekable
from cubeling.app.session import START_STAGES, SessionFile
from cubeling.app.ui.playback.status import PlaybackMark, Position
from cubeling.robot import Closeable
from cubeling.tracking import Frame, Health, LiveFrames

LONG_S = 600.0
"""In a longer recording a seek does not process all frames on its way [s]."""

MAX_PROCESSED_FRAMES = 30
"""So many are processed on the way of a seek in a long recording: they take less than half a
second."""


@dataclass(frozen=True)
class _Target:
    """The frame that a seek goes to: the first one that both numbers allow."""

    timestamp: float = -math.inf
    """Its timestamp at least [s]."""

    index: int = 0
    """Its index in the source at least."""

    def is_reached(self, frame: Frame) -> bool:
        return frame.timestamp >= self.timestamp and frame.index >= self.index


class Transport(Closeable):
    """Returns the frames of a session, and moves in them.

    In a recording the state after a seek is that of all frames before it: the pipeline goes on from
    a saved state, or from the start, and draws nothing until it is there. What a player asked of
    the scenario before that frame stays so, and what came later is forgotten.

    In one that is longer than `LONG_S`, where that is far, it shows what was recorded from there
    on, until the player asks for something else.
    """

    def __init__(self, session: OpenedSession) -> None:
        self._session = session
        self._feed = FrameFeed(session)
        self._states = SavedStates()
        self._target: _Target | None = None
        self._first: float | None = None
        self._marks: tuple[PlaybackMark, ...] | None = None
        self._start = session.options.start_s
        self._end = session.options.end_s or math.inf
        self._shows_recorded = False
        self.seekable = is_seekable(session.source)
        """Whether the source is a recording that can be played from within."""
        self.paused = False
        """Whether no frame comes until the player goes on."""
        self.ended = False
        """Whether the recording has come to its end, and the player has not sought since."""

    def close(self) -> None:
        """End what reads ahead; call it before the source is closed. A second call does nothing."""
        self._feed.close()

    @property
    def idle(self) -> bool:
        """Whether nothing happens until the player asks for it."""
        return (self.paused or self.ended) and self._target is None

    @property
    def seeking(self) -> bool:
        """Whether frames are processed and not shown, until the one that is sought."""
        return self._target is not None

    @property
    def timestamp(self) -> float | None:
        """That of the last frame [s]; None before the first one."""
        return None if self._feed.last is None else self._feed.last.timestamp

    @property
    def is_behind(self) -> bool:
        """Whether newer frames of a camera wait already, which is recorded."""
        return self._session.recording is not None and self._feed.is_behind

    def next(self) -> Frame | Health | None:
        """Return the next frame, a live source's health while it has none, or None at the end."""
        frame = self._feed.next()
        if not isinstance(frame, Frame):
            return frame
        if self._first is None:
            self._first = frame.timestamp
            if self._replayed is not None:
                self._replayed.frame_time(0)  # counts frames once, so that no seek has to
            if self._start > 0.0:
                self._go(_Target(self._first + self._start))
                if self._shows_recorded:
                    return self.next()
        return None if frame.timestamp - self._first > self._end else frame

    def is_shown(self, frame: Frame) -> bool:
        """Return whether a frame is to be shown: not if it is before the one that is sought."""
        if self._target is None:
            return True
        if not self._target.is_reached(frame):
            return False
        self._arrive()
        return True

    def finish(self) -> bool:
        """Handle the end of the source; return whether the session goes on all the same."""
        session = self._session
        self._arrive()
        if isinstance(session.source, LiveFrames):
            return False
        self.ended = True
        if session.screen.attended:
            session.end_recording()  # it is complete, whatever happens to the window
            if session.options.loop:
                self.toggle_pause()
        return session.screen.attended

    def pause(self, paused: bool) -> None:
        """Pause, or go on."""
        if paused == self.paused:
            return
        self.paused = paused
        self._restart_pace()
        if self.timestamp is None:
            return
        if paused:
            for _, wire in self._session.robots:
                wire.hold(self.timestamp)
        else:
            self._feed.close_gap()
        self._session.happen("paused" if paused else "resumed", self.timestamp)

    def toggle_pause(self) -> None:
        """Pause or go on; at the end, begin again."""
        if self.ended:
            self.pause(False)
            self.seek(self._start)
        else:
            self.pause(not self.paused)

    def seek(self, position: float) -> None:
        """Go to a time of the recording, from its first frame [s]; within the part that plays."""
        if self._may_seek() and self._first is not None:
            position = min(max(position, self._start), self._end, self._length)
            self._go(_Target(timestamp=self._first + position))

    def seek_by(self, seconds: float) -> None:
        """Go back or ahead from the last frame, or from where a seek goes [s]."""
        now = self.timestamp
        if self._target is not None and math.isfinite(self._target.timestamp):
            now = self._target.timestamp
        self.seek((now or 0.0) - (self._first or 0.0) + seconds)

    def step_frames(self, count: int) -> None:
        """Pause, and show the frame that is so many frames ahead."""
        if self._may_seek() and self._feed.last is not None:
            self.pause(True)
            index = max(0, self._feed.last.index + count)
            self._go(_Target((self._first or 0.0) + self._start, index))

    def save_state(self, *, acted: bool = False, exchanged: bool = False) -> None:
        """Save the pipeline's state now and then, and where the player acted.

        `acted` is whether the player asked something of the scenario that plays, and `exchanged`
        whether a part or a setting is another one: no state from before can be restored then.
        """
        if exchanged:
            self._states.clear()
        if self._shows_recorded and (acted or exchanged):
            self._shows_recorded, self._session.replay_inputs = False, None
        last = self._feed.last
        if last is not None and self._saves_states and not self._shows_recorded:
            self._states.save(self._session.playground, last, acted=acted or exchanged)

    def follow_source(self) -> None:
        """Go on with another camera, without a gap in the timestamps."""
        self._feed.close_gap()

    @property
    def position(self) -> Position | None:
        """Where the session is in its recording; None without one, and before its first frame."""
        if not self.seekable or self._first is None or self.timestamp is None:
            return None
        target = None
        if self._target is not None and math.isfinite(self._target.timestamp):
            target = self._target.timestamp - self._first
        if self._marks is None:
            self._marks = self._read_marks(self._first)
        return Position(
            now=self.timestamp - self._first,
            length=self._length,
            start=self._start,
            end=min(self._end, self._length),
            target=target,
            marks=self._marks,
        )

    @property
    def _saves_states(self) -> bool:
        return self.seekable and self._session.screen.attended

    @property
    def _length(self) -> float:
        return self._session.source.duration or 0.0

    def _may_seek(self) -> bool:
        session = self._session
        if not self.seekable:
            session.screen.notify("Only in a recording there are other places to go to")
        elif session.recording is not None:
            session.screen.notify(f"{session.why_it_stays}: no seeking in it")
        return self.seekable and session.recording is None

    def _go(self, target: _Target) -> None:
        """Seek a frame: from here, or from a saved state before it if that is better."""
        assert self._feed.last is not None, "something was played"
        self.ended, self._target = False, target
        saved = self._states.last_before(target.timestamp, target.index)
        index = 0 if saved is None else saved.index + 1
        here = self._feed.last.index + 1
        goes_back = target.is_reached(self._feed.last) or index > here or self._shows_recorded
        replayed = self._replayed
        number = 0 if replayed is None else self._number_of(target, replayed)
        if replayed is not None and number - (index if goes_back else here) > MAX_PROCESSED_FRAMES:
            self._show_recorded(replayed, number)
        elif goes_back:
            self._shows_recorded = False
            self._feed.rewind(index)
            self._states.go_on_from(saved)
            if saved is None:
                self._session.restart()
            else:
                self._session.playground.restore(saved.checkpoint)

    def _number_of(self, target: _Target, replayed: SessionFile) -> int:
        """Return the number of the frame that is sought."""
        at = replayed.number_at(target.timestamp)
        return min(max(at, target.index), replayed.info.frames - 1)

    @property
    def _replayed(self) -> SessionFile | None:
        """The session if it is shown as it was recorded where a seek is far; else None.

        It must have every channel, and be played with the settings of then.
        """
        options, replayed = self._session.options, self._session.replayed
        if replayed is None or self._length <= LONG_S or options.salvage:
            return None
        if options.stage != "camera" or options.metadata() != replayed.info.options.metadata():
            return None
        return replayed if replayed.has_channels else None

    def _show_recorded(self, replayed: SessionFile, number: int) -> None:
        """Go to a frame by the index of the file, and show what was recorded from there on."""
        since = replayed.frame_time(number)
        self._feed.rewind(number, since)
        self._session.restart()
        self._session.replay_inputs = replayed.replay_inputs(START_STAGES[-1], since)
        self._shows_recorded = True

    def _arrive(self) -> None:
        self._target = None
        self._restart_pace()

    def _restart_pace(self) -> None:
        if self._session.pace is not None:
            self._session.pace.restart()

    def _read_marks(self, first: float) -> tuple[PlaybackMark, ...]:
        """Return what happened in the recording, by its events."""
        replayed = self._session.replayed
        found = [] if replayed is None else replayed.events
        return tuple(PlaybackMark(time - first, event) for time, event in found)
