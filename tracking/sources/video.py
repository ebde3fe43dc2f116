"""Frames from a video file, with the times of its container."""

from collections.abc import Generator, Iterator
from pathlib import Path

import av
from av.container import InputContainer

from tracking.errors import TrackingError
from tracking.geometry.frame import Frame
from tracking.sources.base import FrameSource, Timeline
from tracking.sources.pictures import from_video_frame


class VideoSource(FrameSource):
    """A video file that FFmpeg can read: mp4, mkv, avi, webm.

    Frames wait until they are asked for. Timestamps count from the file's first frame.

    Raises
    ------
    TrackingError
        While opening: the file is absent or is no video. While iterating: it breaks off, after all
        frames that could be read.
    """

    live = False

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        self._container: InputContainer | None = _open(self._path)
        stream = self._container.streams.video[0]
        stream.thread_type = "AUTO"
        self._frames = self._decoded(self._container)
        try:
            self._first = next(self._frames, None)
        except BaseException:
            self.close()
            raise
        if self._first is None:
            self.close()
            raise TrackingError(f"the video '{path}' has no frame that can be decoded")
        height, width = self._first.image.shape[:2]
        self.size = (width, height)
        self.intrinsics = None
        self.rate = float(stream.average_rate or 30)
        self.duration = _duration(self._container)

    def __iter__(self) -> Iterator[Frame]:
        if self._first is not None:
            first, self._first = self._first, None
            yield first
        yield from self._frames

    def close(self) -> None:
        """Close the file. Safe to call again; the iteration then ends."""
        container, self._container = self._container, None
        if container is not None:
            self._frames.close()
            container.close()

    def _decoded(self, container: InputContainer) -> Generator[Frame, None, None]:
        timeline, start, count = Timeline(), None, 0
        stream = container.streams.video[0]
        # AVI holds times of packets only, and B frames come out in another order than packets.
        untimed = container.format.name == "avi" and stream.codec_context.has_b_frames
        try:
            for picture in container.decode(stream):
                if untimed or picture.pts is None or picture.time_base is None:
                    seconds = count / float(stream.average_rate or 30)
                else:
                    # A ratio of whole numbers, divided once: no error builds up.
                    start = picture.pts if start is None else start
                    seconds = float((picture.pts - start) * picture.time_base)
                yield Frame(from_video_frame(picture), timeline.stamp(seconds), count)
                count += 1
        except av.FFmpegError as error:
            raise TrackingError(
                f"the video '{self._path}' is damaged ({_reason(error)}): "
                f"its first {count} frames could be read"
            ) from error


def _open(path: Path) -> InputContainer:
    if not path.is_file():
        raise TrackingError(f"there is no file '{path}'")
    try:
        container = av.open(str(path))
    except av.FFmpegError as error:
        raise TrackingError(f"'{path}' is not a video: {_reason(error)}") from error
    if not container.streams.video:
        container.close()
        raise TrackingError(f"'{path}' is not a video: it holds no moving picture")
    return container


def _duration(container: InputContainer) -> float | None:
    return None if container.duration is None else container.duration / av.time_base


def _reason(error: av.FFmpegError) -> str:
    """FFmpeg's own words without its numbers and paths."""
    return (error.strerror or type(error).__name__).lower()
