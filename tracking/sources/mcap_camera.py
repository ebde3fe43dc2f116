"""The camera channels of an MCAP file, read forwards as far as the file is intact."""

import itertools
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import BinaryIO

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.message import DecodeError
from mcap.exceptions import EndOfFile, InvalidMagic, RecordLengthLimitExceeded
from mcap.records import Channel, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import MAGIC_SIZE, StreamReader

from cubeling.mcap_index import IndexedMessage, McapIndex
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.sources.base import nanoseconds_of, seconds_of
from cubeling.tracking.sources.decoding import BrokenFileError, EncodedImage

IMAGE_TOPIC = "/camera/image"
CALIBRATION_TOPIC = "/camera/calibration"

LENS_RECORD, FOCAL_DEVIATION = "cubeling lens", "focal_deviation"
"""Name of the metadata before the calibration, and their key: `Intrinsics.focal_deviation`, which
Foxglove's calibration has no field for."""

IMAGE_SCHEMAS: dict[str, type[CompressedImage] | type[CompressedVideo]] = {
    "foxglove.CompressedImage": CompressedImage,
    "foxglove.CompressedVideo": CompressedVideo,
}
ENCODING_OF_FORMAT = {"jpeg": "jpeg", "jpg": "jpeg", "h264": "h264"}
"""`Frame.encoding` of each format that Foxglove names."""


class CameraChannels:
    """Images and calibration of the camera, from an open MCAP file."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self.intrinsics: Intrinsics | None = None
        """The last calibration that `images` has read."""

    @cached_property
    def _index(self) -> McapIndex | None:
        """The file's index; None if it was cut off or is damaged: `images` reports where."""
        try:
            return McapIndex(self._file)
        except Exception:  # each kind of damage raises its own class
            return None

    @property
    def duration(self) -> float | None:
        """Length of the recording [s]; None if the file has no index."""
        times = None if self._index is None else self._index.summary.statistics
        if times is None:
            return None
        return seconds_of(times.message_end_time - times.message_start_time)

    def images_from(self, number: int, time: float | None = None) -> Iterator[EncodedImage]:
        """Return the images from a number on, after those that they build on, which are not seen.

        Its time, where it is known [s], spares counting. Raises BrokenFileError as `images` does.
        """
        if self._index is None:
            yield from _from(number, self.images())
            return
        try:
            wanted = (
                self._index.time_of(IMAGE_TOPIC, number) if time is None else nanoseconds_of(time)
            )
            if wanted is None:
                return
            first = wanted
            for each in self._index.back_from(IMAGE_TOPIC, wanted):
                first = each[2].log_time
                if _image_in(each).alone:
                    break
            for each in self._index.messages((IMAGE_TOPIC,), since=first):
                yield replace(_image_in(each), seen=each[2].log_time >= wanted)
        except BrokenFileError:
            raise
        except Exception as error:  # each kind of damage raises its own class
            raise BrokenFileError("is damaged") from error

    def images(self) -> Iterator[EncodedImage]:
        """Return the images in the order of the file.

        Raises
        ------
        BrokenFileError
            The file is not MCAP, truncated or damaged; all images before were returned.
        """
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        deviation = ""
        for record in _records(self._file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Metadata) and record.name == LENS_RECORD:
                deviation = record.metadata.get(FOCAL_DEVIATION, "")
            elif isinstance(record, Message) and record.channel_id in channels:
                channel = channels[record.channel_id]
                if channel.topic == IMAGE_TOPIC:
                    yield _image_in((schemas.get(channel.schema_id), channel, record))
                elif channel.topic == CALIBRATION_TOPIC:
                    self.intrinsics = _intrinsics(record, deviation)


class _ExactReads:
    """A file that never returns less than requested.

    The reader of `mcap` mistakes a truncated record for a short one.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file

    def read(self, length: int) -> bytes:
        data = self._file.read(length)
        if len(data) < length:
            raise EndOfFile
        return data


def _records(file: BinaryIO) -> Iterator[McapRecord]:
    size = file.seek(0, 2)
    file.seek(0)
    exact = _ExactReads(file)
    # No record is longer than the file, so a damaged length never allocates too much memory.
    reader = StreamReader(exact, validate_crcs=True, record_size_limit=size)  # type: ignore[arg-type]  # only `read` is called
    records = reader.records
    while True:
        try:
            record = next(records, None)
        except (EndOfFile, RecordLengthLimitExceeded) as error:
            raise BrokenFileError("is not MCAP" if size < MAGIC_SIZE else "is truncated") from error
        except InvalidMagic as error:
            at_start = file.tell() == MAGIC_SIZE
            raise BrokenFileError("is not MCAP" if at_start else "is damaged") from error
        except Exception as error:  # each compression raises its own class
            raise BrokenFileError("is damaged") from error
        if record is None:
            return
        yield record


def _from(number: int, images: Iterator[EncodedImage]) -> Iterator[EncodedImage]:
    """Leave out images before a number, except for those that it builds on, which are not seen."""
    needed: list[EncodedImage] = []
    for image in itertools.islice(images, number):
        if image.alone:
            needed.clear()
        needed.append(replace(image, seen=False))
    yield from needed
    yield from images


def _image_in(found: IndexedMessage) -> EncodedImage:
    schema, _, message = found
    name = schema.name if schema else "no schema"
    if name not in IMAGE_SCHEMAS:
        raise BrokenFileError(f"has images of schema {name}, not {' or '.join(IMAGE_SCHEMAS)}")
    try:
        image = IMAGE_SCHEMAS[name].FromString(message.data)
    except DecodeError as error:
        raise BrokenFileError("is damaged") from error
    if image.format not in ENCODING_OF_FORMAT:
        raise BrokenFileError(f"has images in '{image.format}', not jpeg or h264")
    stamped = image.HasField("timestamp")
    time = image.timestamp.ToNanoseconds() if stamped else message.log_time
    return EncodedImage(image.data, ENCODING_OF_FORMAT[image.format], seconds_of(time))


def _intrinsics(message: Message, deviation: str) -> Intrinsics | None:
    try:
        calibration = CameraCalibration.FromString(message.data)
        if not any(calibration.K):  # Foxglove: all zeros mean an uncalibrated camera
            return None
        matrix = np.array(calibration.K).reshape(3, 3)
        size = (calibration.width, calibration.height)
        stated = float(deviation) if deviation else None
        return Intrinsics(matrix, np.array(calibration.D or [0.0] * 5), size, stated)
    except (DecodeError, ValueError, TrackingError) as error:
        raise BrokenFileError(f"has a calibration that cannot be used ({error})") from error
