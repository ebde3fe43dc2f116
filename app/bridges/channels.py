"""What is streamed of a step: the columns of an export, live."""

from collections.abc import Iterator
from dataclasses import dataclass

from cubeling.app.pipeline.step import Step
from cubeling.app.session.encoding import message_type
from cubeling.app.workshop.exporting import EXPORT_TABLES
from cubeling.app.workshop.exporting.column import Cell, Column

COLUMNS: dict[type[object], tuple[Column, ...]] = {
    kind: table.columns
    for table in EXPORT_TABLES
    if table.read is None and (kind := message_type(table.topic)) is not None
}
"""The columns of each type of message; docs/exporting.md says what they are."""


@dataclass(frozen=True)
class ChannelSample:
    """One message of a step."""

    topic: str
    """The channel's name in a recording: "/cube/state", "/cast/vleo/pose"."""

    message: object

    @property
    def columns(self) -> tuple[Column, ...]:
        """What the message holds, with units."""
        return COLUMNS[type(self.message)]

    @property
    def cells(self) -> Iterator[tuple[Column, Cell]]:
        """Each column with its value."""
        return ((column, column.value(self.message)) for column in self.columns)


def samples_of(step: Step) -> Iterator[ChannelSample]:
    """Yield the messages of a step, those of further characters and cubes too."""
    for topic, message in step.messages().items():
        yield ChannelSample(topic, message)
