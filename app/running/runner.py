"""The loop of a session: frames in, pictures and emotions out, all of it recorded if asked for."""

import gc
import time
from collections.abc import Callable

from cubeling.app.interrupts import defer_interrupts
from cubeling.app.pipeline.step import Step
from cubeling.app.running.clock import Pace
from cubeling.app.running.frame_loop import WAITING, FrameLoop
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.playback.player_controls import PlayerControls
from cubeling.app.running.playback.transport import Transport
from cubeling.app.running.summary.gap_watch import GapWatch, Say
from cubeling.app.running.summary.summary import Summary
from cubeling.app.ui.notice import lens_notice, notice
from cubeling.robot import RobotError
from cubeling.tracking import Frame, Health, LiveFrames, TrackingError

Progress = Callable[[Step], None]
"""Called after every frame."""

IDLE_INTERVAL_S = 0.02
"""While a session is paused, the player's requests are read so often."""

PREVIEW_INTERVAL_S = 0.25
"""While it seeks, a picture on the way is shown so often."""


def run(
    session: OpenedSession, progress: Progress | None = None, say: Say = lambda line: None
) -> Summary:
    """Run a session to its end, until the player closes the window, or until Ctrl-C.

    Parameters
    ----------
    session
        From `open_session`.
    progress
        Called after every frame with its step.
    say
        Called with a line when camera, robot or recording are lost, and when they are back.

    Returns
    -------
    Summary
        The figures of the session. Its `check` raises the error of a robot or a live camera that
        was lost.

    Raises
    ------
    TrackingError, RobotError, AppError
        The source, the robot or the disk failed; what was recorded until then is complete.
    """
    summary = Summary(session.playground.scenario.name)
    runner = _Runner(session, summary, progress, say)
    try:
        runner.run()
        # A lost robot does not end the session and its link keeps retrying: report it at the end.
        try:
            for robot, _ in session.robots:
                robot.check()
        except RobotError as error:
            summary.lost = summary.lost or error
    except KeyboardInterrupt:
        summary.interrupted = True
    finally:
        runner.close()
    for robot in (session.robot, session.second_robot):
        if robot.name in summary.robots:
            summary.robots[robot.name].log = robot.log()
    summary.lens = lens_notice(
        session.playground.tracked.lens, session.playground.tracked.measured_intrinsics
    )
    if isinstance(session.source, LiveFrames):
        summary.camera = session.source.health
    return summary


class _Runner:
    """Runs a session: what the player asks for, then the next frame, again and again."""

    def __init__(
        self, session: OpenedSession, summary: Summary, progress: Progress | None, say: Say
    ) -> None:
        self._session, self._summary, self._progress, self._say = session, summary, progress, say
        self._transport = Transport(session)
        self._controls = PlayerControls(session, self._transport)
        self._loop = FrameLoop(session, summary)
        self._gaps = GapWatch(session, summary, say)
        self._times = session.monitor.times
        self._start: float | None = None
        self._shown_at = 0.0
        self._told = 0  # of why acts were refused
        self._freezes = not gc.get_freeze_count()  # else somebody does who knows more
        self._frozen = False

    def run(self) -> None:
        screen = self._session.screen
        while True:
            self._controls.update()
            for told in self._session.notices():
                screen.notify(told)
                self._say(told)
            if screen.closed:
                return
            if self._transport.idle:
                screen.wait(None)
                time.sleep(IDLE_INTERVAL_S)
                self._times.drop_frame()
            elif not self._advance():
                self._controls.report()  # a video ends with a card
                return

    def close(self) -> None:
        if self._frozen:
            gc.unfreeze()
        self._gaps.close()
        self._controls.close()
        self._transport.close()

    def _advance(self) -> bool:
        """Take the next frame; return False at the end of the session."""
        found = self._read()
        self._times.lap(WAITING if self._session.source.live else "capture")
        if isinstance(found, Frame):
            self._gaps.camera_back(found.timestamp)
            self._process(found)
        elif isinstance(found, Health):
            message = notice(found)
            if message is not None:
                self._gaps.camera_lost(found.problem)
            self._session.screen.wait(message)
        else:
            self._loop.show_skipped()
            return self._transport.finish()
        return True

    def _read(self) -> Frame | Health | None:
        """Read a frame; a live camera that fails ends the session and keeps the recording."""
        try:
            return self._transport.next()
        except TrackingError as error:
            session = self._session
            if session.options.salvage:
                return None
            if not session.source.live or not self._summary.frames:
                raise
            self._summary.lost = error
            return None

    def _process(self, frame: Frame) -> None:
        """Process a frame, or leave it out."""
        session, loop = self._session, self._loop
        if not session.source.live and session.pace is None:  # then the frames drive the clock
            self._start = frame.timestamp if self._start is None else self._start
            session.clock.drive(frame.timestamp - self._start)
        acted, drawn, scenario = False, True, session.playground.scenario
        if not self._transport.is_shown(frame):
            if session.recording is not None:  # which begins with the first frame that is shown
                loop.leave_out(frame)
                return
            with defer_interrupts():
                step = loop.skip(frame)
            self._preview()
        else:
            # A frame that is late is not drawn, and all else is as if it were.
            drawn = self._is_in_time(frame)
            acted = loop.asked_by_player
            for robot, wire in session.robots:
                wire.align(frame.timestamp - robot.clock())
            with defer_interrupts():
                step = loop.step(frame, drawn=drawn)
            self._shown_at = time.monotonic() if drawn else self._shown_at
            self._gaps.watch_robot(loop.robot, frame.timestamp)
            for reason in session.refused[self._told :]:
                self._say(reason)
            self._told = len(session.refused)
            if session.check_recording():
                self._say(session.recording_problem)
        exchanged = session.playground.scenario is not scenario
        self._transport.save_state(acted=acted, exchanged=exchanged)
        if self._progress is not None:
            self._progress(step)
        self._times.lap("other")
        if drawn:
            if self._freezes and not self._frozen:
                # What is loaded stays: to search all of it for cycles takes as long as frames.
                gc.freeze()
                self._frozen = True
            self._times.end_frame()
        else:  # the times are those of the frames that are shown
            self._times.drop_frame()

    def _is_in_time(self, frame: Frame) -> bool:
        """Wait until a frame is due; return False if it is too late to be drawn."""
        pace = self._session.pace
        if pace is None:
            waited = time.monotonic() - self._shown_at
            return not self._transport.is_behind or waited >= Pace.MAX_LEFT_OUT_S
        in_time = pace.wait(frame.timestamp)
        self._session.taken_from_timestamp = pace.due_from_timestamp
        self._times.lap(WAITING)
        return in_time

    def _preview(self) -> None:
        """Let the player see how far a seek is, and ask for something else."""
        now = time.monotonic()
        if self._session.screen.attended and now - self._shown_at >= PREVIEW_INTERVAL_S:
            self._loop.preview()
            self._shown_at = time.monotonic()
