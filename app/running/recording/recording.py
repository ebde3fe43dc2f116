"""A recording of a session, from its first frame or from a later one on."""

import math
import threading
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.output_path import part_path
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
from cubeling.app.session.encoding import FIRST_PART_KEY, PART_KEY
from cubeling.robot import Closeable
from cubeling.tracking import Frame, FrameSource


class SessionRecording(Closeable):
    """Records a session whose scenario has just begun, so that a replay makes the same messages.

    With `part_s` or `part_bytes` among the options it goes on in further files. Each of them is
    whole, and holds every channel; but as the scenario has not just begun there, a replay from the
    pictures on begins with the first one.

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
        self.paths = [path]
        """The files of its parts, in their order."""
        self._playground, self._wires = playground, list(wires)
        self._from_within = from_within
        self._first: float | None = None
        self._last = 0.0
        self._make_encoder = partial(frame_encoder, options.codec, source.size, source.rate)
        self._encode = self._make_encoder()
        own = tuple(each.cube.name for each in playground.players)
        named = replace(options, cubes=(*options.cubes, *own[len(options.cubes) :]))
        self._metadata = {**named.metadata(), "rate": f"{source.rate:g}"}
        self._played = played(options, playground, source, language)
        self._recorder = Recorder(path, self._metadata, self._played)
        self._part_s = math.inf if options.part_s is None else options.part_s
        self._part_bytes = math.inf if options.part_bytes is None else options.part_bytes
        self._cuts = from_within or min(self._part_s, self._part_bytes) < math.inf
        self._part_first: float | None = None
        self._next: Recorder | None = None
        self._ended: tuple[Recorder, threading.Thread] | None = None
        self._problem: str | None = None
        self._live = source.live
        if not from_within:  # with the bytes before the first frame
            self._record_wires(self._recorder)

    @property
    def seconds(self) -> float:
        """From the first to the last recorded frame [s]."""
        return 0.0 if self._first is None else self._last - self._first

    def encode(self, frame: Frame) -> Frame:
        """Return a frame with the bytes to record, and the picture that they decode to."""
        if self._part_is_full(frame.timestamp):
            self._open_next_part()
        if self._cuts and frame.encoding == "h264":
            # Its packet builds on others, before the recording or the part.
            frame = replace(frame, encoded=None, encoding="")
        return self._encode(frame)

    def write(self, step: Step, inputs: Inputs) -> None:
        """Record a step, whose frame `encode` returned, and what came in with it."""
        now = self._last = step.frame.timestamp
        ended: Recorder | None = None
        if self._next is not None:
            ended, self._recorder, self._next = self._recorder, self._next, None
            self._part_first, self._from_within = None, True
        if self._first is None:
            self._first = now
        if self._part_first is None:
            self._part_first = now
            self._recorder.camera(self._playground.intrinsics, now)
            if self._live:  # its frames are shown as they come, and pauses shift their timestamps
                self._recorder.clock(datetime.now(UTC) - timedelta(seconds=now))
            if self._from_within:
                self._record_wires(self._recorder, now)
        self._recorder.write(step, inputs)
        if ended is not None:  # now that the robots' bytes go to its successor
            self._complete(ended)

    @property
    def path(self) -> Path:
        """The file that it began with."""
        return self.paths[0]

    @property
    def problem(self) -> str | None:
        """Why recording stopped before its end, in one line, or None."""
        return self._problem or self._recorder.problem

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
        self._wait_for_ended()
        self._recorder.close()
        if self._next is not None:  # its first frame has not come
            self._next.close()
            self._next = None
            self.paths.pop()

    def _part_is_full(self, now: float) -> bool:
        if self._part_first is None or self._next is not None or self.problem is not None:
            return False
        elapsed = now - self._part_first
        return elapsed >= self._part_s or self._recorder.written_bytes >= self._part_bytes

    def _open_next_part(self) -> None:
        """Prepare the file of the frame that is encoded next; it is written once that is."""
        number = len(self.paths) + 1
        path = part_path(self.path, number)
        about = {**self._metadata, PART_KEY: str(number), FIRST_PART_KEY: self.path.name}
        try:
            if path.exists():
                raise AppError(f"the recording cannot go on in '{path}', which exists already")
            self._next = Recorder(path, about, self._played)
        except AppError as error:
            self._problem = str(error)
            return
        self.paths.append(path)
        self._encode = self._make_encoder()  # its first picture can be decoded alone

    def _complete(self, recorder: Recorder) -> None:
        """Complete a part on a thread of its own, so that no frame waits for it."""
        self._wait_for_ended()
        thread = threading.Thread(target=recorder.close, name="recorder's end", daemon=True)
        thread.start()
        self._ended = recorder, thread

    def _wait_for_ended(self) -> None:
        if self._ended is not None:
            recorder, thread = self._ended
            thread.join()
            self._problem = self._problem or recorder.problem
            self._ended = None

    def _record_wires(self, recorder: Recorder | None, since: float = 0.0) -> None:
        for wire in self._wires:
            wire.record_to(recorder, since)
