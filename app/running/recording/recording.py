"""A recording of a session, from its first frame or from a later one on."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.running.recording.provenance import played
from cubeling.app.running.recording.wire_tap import WireTap
from cubeling.app.session import (
    Recorder,
    SessionOptions,
    frame_encoder,
)
from cubeling.robot import Closeable
from cubeling.tracking import Frame, FrameSource


class SessionRecording(Closeable):
    """Records a session whose scenario has just begun, so that a replay makes the same messages.

    Parameters
    ----------
    path
        The .mcap file.
    options
        The settings as they are now.
    playground
        The pipeline; its scenario, cube and character stay until `close`.
    source
        Where the frames come from.
    wires
        The bytes of the robots; those of the first one may be exchanged.
    language
        Code of the language in which the first character speaks; "" for silence.
    from_within
        Whether it begins after the first frame of the source.

    Raises
    ------
    AppError
        The file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        options: SessionOptions,
        playground: Playground,
        source: FrameSource,
        wires: Sequence[WireTap],
        *,
        language: str,
        from_within: bool = False,
    ) -> None:
        self.path = path
        self._playground, self._wires = playground, list(wires)
        self._from_within = from_within
        self._first: float | None = None
        self._last = 0.0
        self._encode = frame_encoder(options.codec, source.size, source.rate)
        own = tuple(each.cube.name for each in playground.players)
        named = replace(options, cubes=(*options.cubes, *own[len(options.cubes) :]))
        self._recorder = Recorder(
            path,
            {**named.metadata(), "rate": f"{source.rate:g}"},
            played(options, playground, source, language),
        )
        self._live = source.live
        if not from_within:  # with the bytes before the first frame
            self._record_wires(self._recorder)

    @property
    def seconds(self) -> float:
        """From the first to the last recorded frame [s]."""
        return 0.0 if self._first is None else self._last - self._first

    def encode(self, frame: Frame) -> Frame:
        """Return a frame with the bytes to record, and the picture that they decode to."""
        if self._from_within and frame.encoding == "h264":
            # Its packet builds on others, before the recording.
            frame = replace(frame, encoded=None, encoding="")
        return self._encode(frame)

    def write(self, step: Step, inputs: Inputs) -> None:
        """Record a step, whose frame `encode` returned, and what came in with it."""
        now = self._last = step.frame.timestamp
        if self._first is None:
            self._first = now
            self._recorder.camera(self._playground.intrinsics, now)
            if self._live:  # its frames are shown as they come, and pauses shift their timestamps
                self._recorder.clock(datetime.now(UTC) - timedelta(seconds=now))
            if self._from_within:
                self._record_wires(self._recorder, now)
        self._recorder.write(step, inputs)

    @property
    def problem(self) -> str | None:
        """Why recording stopped before its end, in one line, or None."""
        return self._recorder.problem

    def follow_wire(self, wire: WireTap, since: float) -> None:
        """Record the bytes of another robot from a timestamp on [s]."""
        self._wires[0] = wire
        wire.record_to(self._recorder, since)

    def event(self, name: str, timestamp: float) -> None:
        """Record an event by its name, at a time of the session [s]."""
        self._recorder.event(name, timestamp)

    def flush(self) -> None:
        """Wait until everything is written."""
        self._recorder.flush()

    def close(self) -> None:
        """Complete the file; without a frame, leave none. A second call does nothing."""
        self._record_wires(None)
        self._recorder.close()

    def _record_wires(self, recorder: Recorder | None, since: float = 0.0) -> None:
        for wire in self._wires:
            wire.record_to(recorder, since)
