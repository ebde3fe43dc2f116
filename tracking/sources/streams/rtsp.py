"""Frames from a network camera by RTSP, decoded by FFmpeg."""

import time
from urllib.parse import urlsplit

import av

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Image
from cubeling.tracking.sources.decoding import bgr_of, pixel_shape_of, reason_of
from cubeling.tracking.sources.device import Clock, DeviceSetting
from cubeling.tracking.sources.live import LiveSource

OPEN_TIMEOUT_S, READ_TIMEOUT_S = 6.0, 3.0
"""A camera that does not answer within the first time is not there; one that is silent for the
second is opened again."""

LOW_DELAY = {"rtsp_transport": "tcp", "fflags": "nobuffer", "flags": "low_delay"}
"""Options of FFmpeg: over TCP no packet is lost, which H.264 would show as smears for a second, and
no image waits for the next ones."""


class RtspSource(LiveSource):
    """A stream of H.264, H.265 or MJPEG, as most network cameras serve it.

    The URL is as "rtsp://camera:554/live"; a name and password may precede the host.

    Raises
    ------
    TrackingError
        There is no answer, or the answer has no video. A stream that breaks later is opened again:
        see `base.LiveFrames`.
    """

    def __init__(self, url: str, *, clock: Clock = time.monotonic) -> None:
        try:
            address = urlsplit(url)
            port = f":{address.port}" if address.port else ""
        except ValueError as error:
            raise TrackingError(f"'{url}' is not an address: {error}") from error
        if not address.hostname:
            raise TrackingError(f"'{url}' names no host; write rtsp://HOST:PORT/PATH")
        name = f"{address.scheme}://{address.hostname}{port}{address.path}"
        super().__init__(lambda: _RtspStream(url, name), name, clock)


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> RtspSource:
    """Open "rtsp://HOST:PORT/PATH"; the size is the camera's."""
    return RtspSource(uri, clock=clock)


class _RtspStream:
    """One session with the camera."""

    settings: tuple[DeviceSetting, ...] = ()
    exposed: float | None = None

    def __init__(self, url: str, name: str) -> None:
        self._name = name
        try:
            self._container = av.open(
                url,
                options=LOW_DELAY,
                timeout=(OPEN_TIMEOUT_S, READ_TIMEOUT_S),
                metadata_errors="replace",
            )
        except av.FFmpegError as error:
            raise TrackingError(
                f"cannot open {name} ({reason_of(error)}): check address, name and password"
            ) from error
        if not self._container.streams.video:
            self._container.close()
            raise TrackingError(f"{name} has no video")
        stream = self._container.streams.video[0]
        stream.thread_type = "SLICE"  # frame threads would delay images
        self.rate = float(stream.average_rate or 30)
        self._pixel_shape = pixel_shape_of(stream)
        self._frames = self._container.decode(stream)

    def read(self) -> Image:
        """Wait for the next image; broken ones are left out."""
        try:
            while (frame := next(self._frames)).is_corrupt:
                pass
        except StopIteration as error:
            raise TrackingError(f"{self._name} ended its stream") from error
        except av.FFmpegError as error:
            raise TrackingError(f"{self._name} failed: {reason_of(error)}") from error
        return bgr_of(frame, self._pixel_shape)

    def interrupt(self) -> None:
        """Do nothing: FFmpeg cannot be woken from another thread, and returns in time by itself."""

    def close(self) -> None:
        """Close the session."""
        self._container.close()
