"""The camera channels of an MCAP file, read forwards as far as the file is whole."""

from collections.abc import Iterator
from typing import IO

import numpy as np
from foxglove_schemas_protobuf.CameraCalibration_pb2 import CameraCalibration
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from google.protobuf.message import DecodeError
from mcap.exceptions import EndOfFile, InvalidMagic, RecordLengthLimitExceeded
from mcap.reader import make_reader
from mcap.records import Channel, McapRecord, Message, Schema
from mcap.stream_reader import MAGIC_SIZE, StreamReader

from tracking.errors import TrackingError
from tracking.geometry.intrinsics import Intrinsics
from tracking.sources.base import seconds_of
from tracking.sources.pictures import EncodedPicture

IMAGE_TOPIC = "/camera/image"
CALIBRATION_TOPIC = "/camera/calibration"

IMAGE_SCHEMAS: dict[str, type[CompressedImage] | type[CompressedVideo]] = {
    "foxglove.CompressedImage": CompressedImage,
    "foxglove.CompressedVideo": CompressedVideo,
}
ENCODINGS = {"jpeg": "jpeg", "jpg": "jpeg", "h264": "h264"}


class BrokenFileError(Exception):
    """Why a file cannot be read on, as the end of a sentence about it."""


class CameraChannels:
    """Pictures and calibration of the camera, from an open MCAP file."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        self.intrinsics: Intrinsics | None = None
        """The last calibration that `pictures` came across."""

    def duration(self) -> float | None:
        """Length of the recording [s]; None where the file has no closing summary."""
        self._file.seek(0)
        try:
            summary = make_reader(self._file).get_summary()
        except Exception:  # cut short or damaged: `pictures` will say so, and where
            return None
        if summary is None or summary.statistics is None:
            return None
        times = summary.statistics
        return seconds_of(times.message_end_time - times.message_start_time)

    def pictures(self) -> Iterator[EncodedPicture]:
        """Give out the pictures in the order of the file.

        Raises
        ------
        BrokenFileError
            The file is not MCAP, ends too early, or is damaged; all before that was given out.
        """
        schemas: dict[int, Schema] = {}
        channels: dict[int, Channel] = {}
        for record in _records(self._file):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                channels[record.id] = record
            elif isinstance(record, Message) and record.channel_id in channels:
                channel = channels[record.channel_id]
                if channel.topic == IMAGE_TOPIC:
                    schema = schemas.get(channel.schema_id)
                    yield _picture(record, schema.name if schema else "no schema")
                elif channel.topic == CALIBRATION_TOPIC:
                    self.intrinsics = _intrinsics(record)


class _WholeReads:
    """A file that never gives less than it was asked for.

    The reader of `mcap` takes a record whose end is missing for a short one.
    """

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file

    def read(self, length: int) -> bytes:
        data = self._file.read(length)
        if len(data) < length:
            raise EndOfFile
        return data


def _records(file: IO[bytes]) -> Iterator[McapRecord]:
    size = file.seek(0, 2)
    file.seek(0)
    whole = _WholeReads(file)
    # No record is longer than the file, unless its end is missing; so a damaged length never asks
    # for more memory than there is.
    reader = StreamReader(whole, validate_crcs=True, record_size_limit=size)  # type: ignore[arg-type]  # it only calls read
    records = reader.records
    while True:
        try:
            record = next(records, None)
        except (EndOfFile, RecordLengthLimitExceeded) as error:
            raise BrokenFileError("is not MCAP" if size < MAGIC_SIZE else "is cut short") from error
        except InvalidMagic as error:
            at_start = file.tell() == MAGIC_SIZE
            raise BrokenFileError("is not MCAP" if at_start else "is damaged") from error
        except Exception as error:  # each compression raises its own kind
            raise BrokenFileError("is damaged") from error
        if record is None:
            return
        yield record


def _picture(message: Message, schema: str) -> EncodedPicture:
    if schema not in IMAGE_SCHEMAS:
        raise BrokenFileError(f"has pictures of schema {schema}, not {' or '.join(IMAGE_SCHEMAS)}")
    try:
        picture = IMAGE_SCHEMAS[schema].FromString(message.data)
    except DecodeError as error:
        raise BrokenFileError("is damaged") from error
    if picture.format not in ENCODINGS:
        raise BrokenFileError(f"has pictures in '{picture.format}', not jpeg or h264")
    stamped = picture.HasField("timestamp")
    time = picture.timestamp.ToNanoseconds() if stamped else message.log_time
    return EncodedPicture(picture.data, ENCODINGS[picture.format], seconds_of(time))


def _intrinsics(message: Message) -> Intrinsics | None:
    try:
        calibration = CameraCalibration.FromString(message.data)
        if not any(calibration.K):  # Foxglove: all zeros say that the camera is not calibrated
            return None
        matrix = np.array(calibration.K).reshape(3, 3)
        size = (calibration.width, calibration.height)
        return Intrinsics(matrix, np.array(calibration.D or [0.0] * 5), size)
    except (DecodeError, ValueError, TrackingError) as error:
        raise BrokenFileError(f"has a calibration that cannot be used ({error})") from error
