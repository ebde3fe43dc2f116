"""Reading the messages of a recording, frame by frame, for a replay from a later stage."""

from collections.abc import Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.session import messages
from cubeling.app.session.encoding import APPEARANCE_TOPIC, CHANNEL_TYPES, decode
from cubeling.app.session.options import START_STAGES, check_stage

FIELD_OF_TOPIC = {
    "/cube/state": "state",
    "/cube/controls": "controls",
    APPEARANCE_TOPIC: "appearance",
    "/character/command": "command",
    "/character/pose": "posed",
}
"""The field of `ReplayInputs` for each channel, in the order of the stages after the camera."""


def read_replay_inputs(source: str, start: str) -> Iterator[ReplayInputs]:
    """Yield the recorded messages up to the stage `start`, for each frame.

    Raises AppError if there is no such stage, or the source is no session or has no such channel.
    """
    check_stage(start)
    topics = tuple(FIELD_OF_TOPIC)[: START_STAGES.index(start)]
    path = Path(source)
    if not source.endswith(".mcap") or next(messages(path, topics[-1]), None) is None:
        raise AppError(f"'{source}' has no recorded channels to start from '{start}'")
    return _read(path, topics)


def _read(path: Path, topics: tuple[str, ...]) -> Iterator[ReplayInputs]:
    for _, found in groupby(messages(path, *topics), key=itemgetter(1)):
        yield ReplayInputs(
            **{
                FIELD_OF_TOPIC[topic]: decode(CHANNEL_TYPES[topic], data)
                for topic, _, data in found
            }
        )
