"""The loop of a session: frames in, pictures and emotions out, all of it recorded if asked for."""

import time
from collections.abc import Callable, Iterator

from app.errors import AppError
from app.pipeline.scenario import Inputs
from app.pipeline.step import ReplayInputs, Step
from app.running.interrupts import uninterrupted
from app.running.opening import OpenedSession
from app.running.summary import Summary
from app.session import START_OVER_EVENT, Recorder, frame_encoder
from app.ui.notice import lens_notice, notice
from robot import RobotError
from tracking import Frame, Health, LiveFrames, TrackingError

Progress = Callable[[Step], None]
"""Called after every frame."""

SCREEN_UPDATE_INTERVAL_S = 0.05
"""While no frame comes, the screen is updated at least this often."""

ATTENDED_RECONNECT_TIMEOUT_S = 30.0
"""How long a camera may be lost while a user at the window can plug it in again."""

UNATTENDED_RECONNECT_TIMEOUT_S = 3.0
"""How long it may be lost without a window: long enough for a network's short stalls."""

CAMERA_LOST = "camera lost"
CAMERA_BACK = "camera back"
"""The events of a recording between which there are no pictures."""


def run(session: OpenedSession, progress: Progress | None = None) -> Summary:
    """Run a session to its end, until the player closes the window, or until Ctrl-C.

    Parameters
    ----------
    session
        From `open_session`.
    progress
        Called after every frame with its step.

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
    try:
        loop = _FrameLoop(session, summary)
        gaps = _CameraGaps(summary, session.recorder)
        for frame in _frames(session, summary):
            if isinstance(frame, Health):
                message = notice(frame)
                if message is not None:
                    gaps.begin()
                session.screen.wait(message)
            else:
                gaps.end(frame)
                if session.pace is not None and not session.pace.wait(frame.timestamp):
                    loop.leave_out(frame)
                    continue
                if session.wire is not None:
                    session.wire.align(frame.timestamp - session.robot.clock())
                with uninterrupted():
                    step = loop.step(frame)
                if progress is not None:
                    progress(step)
            if session.screen.closed:
                break
        # A lost robot does not end the session and its link keeps retrying: report it at the end.
        try:
            session.robot.check()
        except RobotError as error:
            summary.lost = summary.lost or error
    except KeyboardInterrupt:
        summary.interrupted = True
    summary.robot_log = session.robot.log()
    summary.lens = lens_notice(session.playground.lens, session.playground.intrinsics)
    if isinstance(session.source, LiveFrames):
        summary.camera = session.source.health
    return summary


class _FrameLoop:
    """Processes, shows and records one frame after the other."""

    def __init__(self, session: OpenedSession, summary: Summary) -> None:
        self._session, self._summary = session, summary
        self._inputs = Inputs()
        self._start_over = False
        self._replay: ReplayInputs | None = None
        self._encode = None
        if session.recorder is not None:
            source = session.source
            self._encode = frame_encoder(session.options.codec, source.size, source.rate)

    def step(self, frame: Frame) -> Step:
        """Process one frame."""
        session = self._session
        began = time.perf_counter()
        self._read_recorded(frame)
        inputs = Inputs(clear=True) if self._start_over else self._inputs
        self._start_over = False
        session.change_scenario(inputs.scenario)
        if self._encode is not None:
            frame = self._encode(frame)
        step = session.playground.step(frame, inputs, self._replay)
        # Read the view first: after `feel`, the link's thread holds the robot's lock for a moment.
        view = session.robot.view()
        session.robot.feel(step.emotion)
        if session.player is not None:
            session.player.publish(step.command, step.emotion)
        seconds = time.perf_counter() - began
        self._record(step, inputs)
        self._inputs = session.screen.show(step, view)
        if session.sound is not None:
            session.sound.play(step, session.playground.character, started_over=inputs.clear)
        self._summary.add(step, view, seconds)
        return step

    def leave_out(self, frame: Frame) -> None:
        """Process nothing; a player who started over in this frame does so in the next one."""
        self._read_recorded(frame)
        self._summary.left_out += 1

    def _read_recorded(self, frame: Frame) -> None:
        """Read what a replay knows of a frame."""
        session = self._session
        self._start_over |= frame.timestamp in session.start_overs
        if session.replay_inputs is not None:
            self._replay = next(session.replay_inputs, None)

    def _record(self, step: Step, inputs: Inputs) -> None:
        recorder = self._session.recorder
        if recorder is None:
            return
        now = step.frame.timestamp
        if inputs.clear:
            recorder.event(START_OVER_EVENT, now)
        if self._summary.frames == 0:
            recorder.camera(self._session.playground.intrinsics, now)
        recorder.write(step)
        if step.controls.placed:
            recorder.event(f"placed {step.controls.top_face}", now)
        for gesture in step.controls.gestures:
            recorder.event(gesture, now)
        if recorder.problem is not None:
            raise AppError(recorder.problem)


class _CameraGaps:
    """Notes when the camera was lost and when it came back, in the summary and the recording."""

    def __init__(self, summary: Summary, recorder: Recorder | None) -> None:
        self._summary, self._recorder = summary, recorder
        self._start: float | None = None

    def begin(self) -> None:
        """Begin a gap at the last frame; further calls within the gap do nothing."""
        if self._start is None:
            self._start = self._summary.last
            self._record(CAMERA_LOST, self._start)

    def end(self, frame: Frame) -> None:
        """End the gap, if there is one, at this frame."""
        if self._start is not None:
            self._summary.gaps.append((self._start, frame.timestamp - self._start))
            self._start = None
            self._record(CAMERA_BACK, frame.timestamp)

    def _record(self, event: str, timestamp: float) -> None:
        if self._recorder is not None:
            self._recorder.event(event, timestamp)


def _frames(session: OpenedSession, summary: Summary) -> Iterator[Frame | Health]:
    """Yield the frames; those of a recording without a pace drive the session's clock.

    While a live source has no frame, yield its health instead, again and again.
    """
    start: float | None = None
    for frame in _readable_frames(session, summary):
        if isinstance(frame, Health):
            yield frame
            continue
        start = frame.timestamp if start is None else start
        if not session.source.live and session.pace is None:
            session.clock.drive(frame.timestamp - start)
        yield frame


def _readable_frames(session: OpenedSession, summary: Summary) -> Iterator[Frame | Health]:
    """Yield what can be read; a live camera that fails ends the session and keeps the recording."""
    try:
        yield from _source_frames(session)
    except TrackingError as error:
        if session.options.salvage:
            return
        if not session.source.live or not summary.frames:
            raise
        summary.lost = error


def _source_frames(session: OpenedSession) -> Iterator[Frame | Health]:
    source = session.source
    if not isinstance(source, LiveFrames):
        yield from source
        return
    attended = session.options.windowed
    timeout = ATTENDED_RECONNECT_TIMEOUT_S if attended else UNATTENDED_RECONNECT_TIMEOUT_S
    while source.health.state != "closed":
        yield source.wait(SCREEN_UPDATE_INTERVAL_S, timeout) or source.health
