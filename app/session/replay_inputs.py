"""A recording replayed from further down the line: its arrows, a frame at a time."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from app.errors import AppError
from app.pipeline.step import Given
from app.session import messages
from app.session.encoding import ARROWS, decode

STARTS: dict[str, tuple[str, ...]] = {
    "camera": (),
    "state": ("/cube/state",),
    "controls": ("/cube/state", "/cube/controls"),
    "command": ("/cube/state", "/cube/controls", "/character/command"),
    "pose": ("/cube/state", "/cube/controls", "/character/command", "/character/pose"),
}
"""For each place to start from, the channels that are taken as recorded."""

FIELDS = {
    "/cube/state": "state",
    "/cube/controls": "controls",
    "/character/command": "command",
    "/character/pose": "posed",
}
"""Where each channel goes in `Given`."""


def recorded_arrows(source: str, start: str) -> Iterator[Given]:
    """Give out the recorded arrows before `start`, one `Given` for each frame.

    Raises
    ------
    AppError
        There is no such start, or the source is no session.
    """
    if start not in STARTS:
        raise AppError(f"a replay cannot start from '{start}': choose one of {', '.join(STARTS)}")
    if not source.endswith(".mcap"):
        raise AppError(f"'{source}' has no recorded channels to start from '{start}'")
    return _read(Path(source), STARTS[start])


def _read(path: Path, topics: tuple[str, ...]) -> Iterator[Given]:
    arrows: dict[str, Any] = {}
    for topic, _, data in messages(path, *topics):
        arrows[FIELDS[topic]] = decode(ARROWS[topic], data)
        if topic == topics[-1]:  # the recorder writes a frame's arrows in the order of the line
            yield Given(**arrows)
            arrows = {}
