"""Where frames come from: `open_source` turns a URI into a `FrameSource`.

Each kind is imported when it is asked for, so that a camera starts without a video library.
"""

import time
from collections.abc import Callable

from tracking.errors import TrackingError
from tracking.sources.base import FrameSource, LiveFrames
from tracking.sources.health import Health

CAMERA_SIZE = (1280, 720)
"""What a camera is asked for where the caller does not say."""


def open_source(
    uri: str,
    *,
    size: tuple[int, int] | None = None,
    clock: Callable[[], float] = time.monotonic,
) -> FrameSource:
    """Open whatever the URI names.

    Parameters
    ----------
    uri
        "camera:0", "camera:/dev/video0", "camera:0?exposure=8&focus=30&lock=0", "take.mp4",
        "session.mcap", "http://phone:8080/video", or "synthetic:NAME".
    size
        Width and height to ask of a camera [px]; other sources have their own.
    clock
        Seconds; stamps the frames of live sources and tells when they fell silent.

    Raises
    ------
    TrackingError
        There is nothing to read: one line says why.
    """
    scheme, _, rest = uri.partition(":")
    if scheme == "camera":
        from tracking.sources.camera import CameraSource

        return CameraSource.from_uri(rest, size or CAMERA_SIZE, clock)
    if scheme in ("http", "https"):
        from tracking.sources.http import HttpSource

        return HttpSource(uri, clock=clock)
    if scheme == "synthetic":
        from tracking.synthetic import open_synthetic

        return open_synthetic(rest)
    if "://" in uri:
        raise TrackingError(f"cannot open '{uri}': '{scheme}' is not camera, http or synthetic")
    if uri.endswith(".mcap"):
        from tracking.sources.session import SessionSource

        return SessionSource(uri)
    from tracking.sources.video import VideoSource

    return VideoSource(uri)


__all__ = ["FrameSource", "Health", "LiveFrames", "open_source"]
