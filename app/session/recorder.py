"""Recording a session: append-only, on a thread of its own, so that no frame waits for the disk."""

import json
import os
import queue
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from datetime import datetime
from functools import cache, partial
from pathlib import Path
from typing import Any

from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from foxglove_schemas_protobuf.RawAudio_pb2 import RawAudio
from mcap.writer import Writer
from mcap_protobuf.schema import register_schema

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.pipeline.table.stage_sounds import SoundClip
from cubeling.app.session.encoding import (
    APPEARANCE_TOPIC,
    CLOCK_RECORD,
    CLOCK_ZERO,
    FORMAT_KEY,
    IMAGE_TOPIC,
    INPUTS_TOPIC,
    PLAYED_RECORD,
    SESSION_FORMAT,
    SESSION_RECORD,
    WIRE_TOPIC,
    encode,
    encode_sound,
    line_topic,
    message_type,
    schema,
    sound_topic,
)
from cubeling.app.session.inputs import RecordedInputs
from cubeling.robot import Closeable
from cubeling.tracking import FOCAL_DEVIATION, LENS_RECORD, Frame, Intrinsics, nanoseconds_of
from cubeling.tracking.appearance import Appearance

CHUNK_BYTES = 128 * 1024
"""Size at which a chunk is written at the latest [B]: about that of one JPEG picture."""

CHUNK_S = 0.5
"""Time after which a chunk is written at the latest [s], however small it is: what a kill loses."""

MAX_QUEUED_WRITES = 2048
"""Writes that may wait for a slow disk; with more, recording stops instead of delaying frames. They
are some seconds of a session, as a disk may take that long to sync."""

OTHER_SCHEMAS = {
    INPUTS_TOPIC: ("cubeling.RecordedInputs", schema(RecordedInputs)),
    WIRE_TOPIC: (
        "cubeling.Wire",
        b'{"type":"object","properties":{"direction":{"enum":["tx","rx"]},"hex":{"type":"string"}}}',
    ),
    "/events": (
        "cubeling.Event",
        b'{"type":"object","properties":{"event":{"type":"string"}}}',
    ),
}
"""Name and text of the JSON Schema of each topic that is not between camera and picture."""


@cache
def json_schema(topic: str) -> tuple[str, bytes]:
    """Return name and text of the JSON Schema of a topic."""
    kind = message_type(topic)
    if topic.startswith("/robots/") and topic.endswith("/wire"):
        topic = WIRE_TOPIC
    return OTHER_SCHEMAS[topic] if kind is None else (f"cubeling.{kind.__name__}", schema(kind))


def calibration_message(intrinsics: Intrinsics, timestamp: float) -> CameraCalibration:
    """Return a camera's calibration as Foxglove reads it, at a time [s]."""
    message = CameraCalibration(
        frame_id="camera",
        width=intrinsics.size[0],
        height=intrinsics.size[1],
        distortion_model="plumb_bob",
        D=intrinsics.distortion.ravel().tolist(),
        K=intrinsics.matrix.ravel().tolist(),
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[float(v) for row in intrinsics.matrix for v in (*row, 0.0)],
    )
    message.timestamp.FromNanoseconds(nanoseconds_of(timestamp))
    return message


class Recorder(Closeable):
    """Records one session to one .mcap file.

    Open it before the first frame, `write` every step, and `close` it at the end; a second `close`
    does nothing. A chunk ends every `CHUNK_S`, and the disk is told to keep it (`fsync`): if the
    program is killed, all but the last second can be read. A second thread waits for the disk, as
    the next chunk would end late otherwise, and a kill would lose what waits for it.

    Parameters
    ----------
    path
        The .mcap file to write; an existing one is overwritten.
    metadata
        What a replay needs: the scenario, its options, the cube …, see `SessionOptions.metadata`.

    played
        What is played, resolved, for a reader of the file; none for a session without it.

    Raises
    ------
    AppError
        The file cannot be written.
    """

    def __init__(
        self, path: Path, metadata: dict[str, str], played: Mapping[str, str] | None = None
    ) -> None:
        self.path = path
        self.problem: str | None = None
        """Why recording stopped before `close`, or None."""
        self._metadata = {SESSION_RECORD: {FORMAT_KEY: f"{SESSION_FORMAT}", **metadata}}
        if played:
            self._metadata[PLAYED_RECORD] = dict(played)
        self._blind = metadata.get("video") == "no"
        self._steps = 0
        self._queue: queue.Queue[Callable[[], None] | None] = queue.Queue(MAX_QUEUED_WRITES)
        self._channels: dict[str, int] = {}
        try:
            self._file = path.open("wb")
            self._writer = Writer(self._file, chunk_size=CHUNK_BYTES)
            self._start()  # here, so that there is no moment at which the file is no session
        except OSError as error:
            raise AppError(f"cannot record to '{path}': {error.strerror}") from error
        self._unsynced, self._ended = threading.Event(), False
        self._threads = [
            threading.Thread(target=run, name=name, daemon=True)
            for name, run in (("recorder", self._run), ("recorder's disk", self._sync_chunks))
        ]
        for thread in self._threads:
            thread.start()
        self._closed = False

    @property
    def written_bytes(self) -> int:
        """Size of the file so far."""
        return 0 if self._closed else os.fstat(self._file.fileno()).st_size

    def camera(self, intrinsics: Intrinsics, timestamp: float) -> None:
        """Record the camera's calibration."""
        if intrinsics.focal_deviation is not None:
            values = {FOCAL_DEVIATION: repr(intrinsics.focal_deviation)}
            self._submit(partial(self._writer.add_metadata, LENS_RECORD, values))
        message = calibration_message(intrinsics, timestamp)
        self._protobuf("/camera/calibration", message, timestamp)

    def clock(self, zero: datetime) -> None:
        """Record when the timestamps were 0; call it before the first frame."""
        values = {CLOCK_ZERO: zero.isoformat(timespec="milliseconds")}
        self._submit(partial(self._writer.add_metadata, CLOCK_RECORD, values))

    def write(self, step: Step, inputs: Inputs | None = None) -> None:
        """Record the camera's frame, what came in with it, and every message after them."""
        self._steps += 1
        now = step.frame.timestamp
        self._frame(step.frame)
        came_in = None if inputs is None else RecordedInputs.of(inputs, now)
        for name, line in () if inputs is None else inputs.lines.items():
            self._sound(line_topic(name), line, now)
        for name, clip in () if inputs is None else inputs.sounds.items():
            self._sound(sound_topic(name), clip, now)
        if came_in is not None:
            self._json(INPUTS_TOPIC, partial(encode, came_in), now)
        news = step.messages()
        if self._steps == 1 and step.appearance is not None:
            news[APPEARANCE_TOPIC] = step.appearance  # what is not news is in no file yet
        for topic, message in news.items():
            if self._blind and isinstance(message, Appearance):
                message = replace(message, room=None)  # it is a picture
            self._json(topic, partial(encode, message), now)
        if self._steps == 1:  # so that a session that is killed at once has a picture
            self._submit(self._end_chunk)

    def wire(self, direction: str, data: bytes, timestamp: float, topic: str = WIRE_TOPIC) -> None:
        """Record bytes that were sent to a robot ("tx") or received from it ("rx")."""
        line = json.dumps({"direction": direction, "hex": data.hex()}).encode()
        self._json(topic, lambda: line, timestamp)

    def event(self, name: str, timestamp: float) -> None:
        """Record an event by its name, at a time of the session [s]."""
        line = json.dumps({"event": name}).encode()
        self._json("/events", lambda: line, timestamp)

    def flush(self) -> None:
        """Wait until everything is written."""
        done = threading.Event()
        for work in (self._end_chunk, self._sync, done.set):
            self._submit(work)
        while self.problem is None and not done.wait(0.1):
            pass

    def close(self) -> None:
        """Write the rest and the index; remove the file if it has no frame."""
        if self._closed:
            return
        self._closed = True
        self._submit(None)
        for thread in self._threads:
            thread.join(timeout=10.0)
        with suppress(OSError):  # a full disk, which `problem` tells
            self._file.close()
        if self._steps == 0:
            self.path.unlink(missing_ok=True)

    def _run(self) -> None:
        chunk_end: float | None = None
        try:
            while True:
                try:
                    wait = None if chunk_end is None else max(0.0, chunk_end - time.monotonic())
                    write = self._queue.get(timeout=wait)
                except queue.Empty:  # nothing more came, as in a pause
                    self._end_chunk()
                    chunk_end = None
                    continue
                if write is None:
                    break
                write()
                self._file.flush()  # write a full chunk now, not with the next one
                if chunk_end is None:
                    chunk_end = time.monotonic() + CHUNK_S
                elif time.monotonic() >= chunk_end:
                    self._end_chunk()
                    chunk_end = None
            self._writer.finish()  # type: ignore[no-untyped-call]  # mcap has no types here
            self._file.flush()
            self._sync()
        except (OSError, ValueError) as error:
            self._stop(error)
        finally:
            self._ended = True
            self._unsynced.set()

    def _end_chunk(self) -> None:
        """Write the chunk in progress, and have it kept whatever happens to the program."""
        self._writer.flush()  # type: ignore[no-untyped-call]  # mcap has no types here
        self._file.flush()
        self._unsynced.set()

    def _sync_chunks(self) -> None:
        while self._unsynced.wait() and not self._ended:
            self._unsynced.clear()  # before the sync: a chunk that ends during it needs another
            try:
                self._sync()
            except (OSError, ValueError) as error:
                self._stop(error)

    def _sync(self) -> None:
        os.fsync(self._file.fileno())

    def _stop(self, error: OSError | ValueError) -> None:
        reason = (error.strerror if isinstance(error, OSError) else None) or error
        self.problem = f"recording to '{self.path}' stopped: {reason}"

    def _submit(self, write: Callable[[], None] | None) -> None:
        if self.problem is not None and write is not None:
            return
        try:
            self._queue.put(write, timeout=5.0 if write is None else 0.0)
        except queue.Full:
            self.problem = f"recording to '{self.path}' stopped: the disk is too slow"

    def _start(self) -> None:
        """Write what the session says of itself."""
        self._writer.start(profile="", library="cubeling")
        for record, values in self._metadata.items():
            # The name of a file need not be UTF-8.
            text = {key: each.encode(errors="replace").decode() for key, each in values.items()}
            self._writer.add_metadata(record, text)
        self._file.flush()

    def _frame(self, frame: Frame) -> None:
        if frame.encoded is None:
            raise AppError("a frame must be encoded before it is recorded")
        kind = CompressedVideo if frame.encoding == "h264" else CompressedImage
        message = kind(frame_id="camera", data=frame.encoded, format=frame.encoding)
        message.timestamp.FromNanoseconds(nanoseconds_of(frame.timestamp))
        self._protobuf(IMAGE_TOPIC, message, frame.timestamp)

    def _sound(self, topic: str, sound: SpokenLine | SoundClip, timestamp: float) -> None:
        message = RawAudio(
            data=encode_sound(sound.samples),
            format="pcm-s16",
            sample_rate=sound.rate,
            number_of_channels=1,
        )
        message.timestamp.FromNanoseconds(nanoseconds_of(timestamp))
        self._protobuf(topic, message, timestamp)

    def _protobuf(self, topic: str, message: Any, timestamp: float) -> None:
        schema_id = partial(register_schema, self._writer, type(message))
        self._message(topic, "protobuf", schema_id, message.SerializeToString, timestamp)

    def _json(self, topic: str, document: Callable[[], bytes], timestamp: float) -> None:
        name, text = json_schema(topic)
        schema_id = partial(self._writer.register_schema, name, "jsonschema", text)
        self._message(topic, "json", schema_id, document, timestamp)

    def _message(
        self,
        topic: str,
        encoding: str,
        schema_id: Callable[[], int],
        document: Callable[[], bytes],
        timestamp: float,
    ) -> None:
        """Write a message on the recorder's thread, and before the first one its channel."""

        def write() -> None:
            if topic not in self._channels:
                channel = self._writer.register_channel(topic, encoding, schema_id())
                self._channels[topic] = channel
            time = nanoseconds_of(timestamp)
            self._writer.add_message(self._channels[topic], time, document(), time)

        self._submit(write)
