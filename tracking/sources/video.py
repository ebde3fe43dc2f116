"""Frames from a video file, with the timestamps of its container."""

import itertools
from collections.abc import Generator
from pathlib import Path

import av
from av.container import InputContainer

from cubeling.files import FileKind
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.sources.base import StoredFrames, Timeline, readable_frames
from cubeling.tracking.sources.decoding import bgr_of, pixel_shape_of, reason_of
from cubeling.tracking.sources.device import Clock

VIDEO_FILE = FileKind(
    "video",
    (".mp4", ".mkv", ".avi", ".webm", ".mov"),
    TrackingError,
    1 << 40,
    "cubeling.tracking.sources.video:VideoSource",
)
"""A video; it is read frame by frame, so its size does not matter."""


class VideoSource(StoredFrames):
    """A video file that FFmpeg can read: mp4, mkv, avi, webm.

    Timestamps count from the first frame. Frames are upright and have square pixels, as the file
    says that they are to be displayed.

    Raises
    ------
    TrackingError
        While opening: the file does not exist or is not a video. While iterating: it is damaged,
        after every readable frame.
    """

    intrinsics = None

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._container = _open(self._path)
        try:
            frames = self._decode_frames(self._container)
            self.start(frames, f"the video '{path}' has no frame that can be decoded")
        except BaseException:
            self._container.close()
            raise
        self.rate = float(self._container.streams.video[0].average_rate or 30)
        length = self._container.duration
        self.duration = None if length is None else length / av.time_base

    def close(self) -> None:
        """Close the file and end the iteration. May be called again."""
        super().close()
        self._container.close()

    def restart(self, index: int, timestamp: float | None = None) -> None:
        """Return the frames again, from one on; those before it are decoded, too."""
        self.close()
        self._container = _open(self._path)
        self._frames = self._decode_frames(self._container)
        for _ in itertools.islice(self._frames, index):
            pass

    def _decode_frames(self, container: InputContainer) -> Generator[Frame, None, None]:
        timeline, start, count = Timeline(), None, 0
        stream = container.streams.video[0]
        pixel_shape = pixel_shape_of(stream)
        # AVI has timestamps of packets only, and B frames are decoded in another order.
        untimed = container.format.name == "avi" and stream.codec_context.has_b_frames
        try:
            for picture in container.decode(stream):
                if untimed or picture.pts is None or picture.time_base is None:
                    seconds = count / float(stream.average_rate or 30)
                else:
                    # A ratio of integers, divided once, so that no error accumulates.
                    start = picture.pts if start is None else start
                    seconds = float((picture.pts - start) * picture.time_base)
                yield Frame(bgr_of(picture, pixel_shape), timeline.stamp(seconds), count)
                count += 1
        except av.FFmpegError as error:
            read = readable_frames(count)
            raise TrackingError(
                f"the video '{self._path}' is damaged ({reason_of(error)}): {read}"
            ) from error


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> VideoSource:
    """Open the path of a video; size and times are those of the file."""
    return VideoSource(uri)


def _open(path: Path) -> InputContainer:
    VIDEO_FILE.check(path)
    try:
        container = av.open(  # "file:", as a name with a colon is no address
            f"file:{path}", metadata_errors="replace"
        )
    except av.FFmpegError as error:
        raise TrackingError(f"'{path}' is not a video: {reason_of(error)}") from error
    if not container.streams.video:
        container.close()
        raise TrackingError(f"'{path}' is not a video: it has no video stream")
    # Frames and slices on all cores; without it FFmpeg decodes on one.
    container.streams.video[0].thread_type = "AUTO"
    return container
