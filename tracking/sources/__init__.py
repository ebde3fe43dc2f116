"""Frame sources: `open_source` turns a URI into a `FrameSource`.

A new kind of source is one module with a function `open_uri(uri, size, clock)` and one line in
`SCHEME_MODULES` or `SUFFIX_MODULES`. The module is imported when the first such source is opened,
so a camera starts without loading the video libraries.
"""

import time
from importlib import import_module
from pathlib import PurePath

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.sources.base import BufferedFrames, FrameSource, LiveFrames, StoredFrames
from cubeling.tracking.sources.device import Clock, Health

SCHEME_MODULES = {
    "camera": "cubeling.tracking.sources.webcam.camera",
    "http": "cubeling.tracking.sources.streams.http",
    "https": "cubeling.tracking.sources.streams.http",
    "rtsp": "cubeling.tracking.sources.streams.rtsp",
    "rtsps": "cubeling.tracking.sources.streams.rtsp",
    "synthetic": "cubeling.tracking.synthetic.source",
}
"""Module that opens the URIs of a scheme."""

SUFFIX_MODULES = {".mcap": "cubeling.tracking.sources.session"}
"""Module that opens files with a suffix."""

OTHER_FILES_MODULE = "cubeling.tracking.sources.video"
"""Module that opens all other files."""


def open_source(
    uri: str, *, size: tuple[int, int] | None = None, clock: Clock = time.monotonic
) -> FrameSource:
    """Open the source that a URI names.

    Parameters
    ----------
    uri
        "camera:0", "camera:/dev/video0", "camera:0?exposure=8&focus=30&lock=0", "take.mp4",
        "session.mcap", "http://phone:8080/video", "rtsp://camera/live", or "synthetic:NAME".
    size
        Width and height to request from a camera [px]; other sources ignore it.
    clock
        Returns the time [s]; timestamps the frames of live sources and detects their loss.

    Raises
    ------
    TrackingError
        The source cannot be opened.
    """
    scheme = uri.partition(":")[0]
    if scheme not in SCHEME_MODULES and "://" in uri:
        raise TrackingError(
            f"cannot open '{uri}': use {', '.join(SCHEME_MODULES)} or a file's path"
        )
    module = SCHEME_MODULES.get(scheme) or SUFFIX_MODULES.get(
        PurePath(uri).suffix, OTHER_FILES_MODULE
    )
    source: FrameSource = import_module(module).open_uri(uri, size, clock)
    return source


__all__ = ["BufferedFrames", "FrameSource", "Health", "LiveFrames", "StoredFrames", "open_source"]
