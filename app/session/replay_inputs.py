"""Reading the messages of a recording, frame by frame, for a replay from a later stage."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.session import messages
from cubeling.app.session.encoding import MESSAGE_TYPES, decode
from cubeling.app.session.options import START_STAGES, check_stage

FIELD_OF_TOPIC = {
    "/cube/state": "state",
    "/cube/controls": "controls",
    "/character/command": "command",
    "/character/pose": "posed",
}
"""The field of `ReplayInputs` for each channel, in the order of the stages after the camera."""


def read_replay_inputs(source: str, start: str) -> Iterator[ReplayInputs]:
    """Yield the recorded messages up to the stage `start`, for each frame.

    Raises AppError if there is no such stage, or the source is no session.
    """
    check_stage(start)
    if not source.endswith(".mcap"):
        raise AppError(f"'{source}' has no recorded channels to start from '{start}'")
    return _read(Path(source), tuple(FIELD_OF_TOPIC)[: START_STAGES.index(start)])


def _read(path: Path, topics: tuple[str, ...]) -> Iterator[ReplayInputs]:
    fields: dict[str, Any] = {}
    for topic, _, data in messages(path, *topics):
        fields[FIELD_OF_TOPIC[topic]] = decode(MESSAGE_TYPES[topic], data)
        if topic == topics[-1]:  # the recorder writes the messages of a frame in this order
            yield ReplayInputs(**fields)
            fields = {}
