"""What a BML realizer reports, and how it is written as XML."""

from dataclasses import dataclass
from typing import Literal
from xml.sax.saxutils import escape, quoteattr

from cubeling.characters.behaviour.bml.document import BML

WarningType = Literal[
    "PARSING_FAILURE",
    "NO_SUCH_TARGET",
    "IMPOSSIBLE_TO_SCHEDULE",
    "BEHAVIOR_TYPE_NOT_SUPPORTED",
    "CUSTOM_BEHAVIOR_NOT_SUPPORTED",
    "CANNOT_CREATE_BEHAVIOR",
    "READ_AS_DIALECT",
]
"""Kinds of warnings: those of the standard, and one for what was changed to read a document."""


@dataclass(frozen=True)
class BlockProgress:
    """A block starts or ends."""

    block: str

    sync: Literal["start", "end"]

    time: float
    """By the clock of the player [s]."""

    character: str = ""
    """Whose block it is."""


@dataclass(frozen=True)
class SyncPointProgress:
    """A sync point has come."""

    block: str

    behaviour: str

    sync: str

    time: float
    """By the clock of the player [s]."""

    block_time: float
    """When, since the start of its block [s]."""

    character: str = ""
    """Whose block it is."""


@dataclass(frozen=True)
class PredictedBehaviour:
    """When the sync points of a behaviour are expected."""

    id: str

    kind: str
    """Name of its element."""

    times: tuple[tuple[str, float], ...]
    """Sync points and when they are, since the start of the block [s]."""


@dataclass(frozen=True)
class BlockPrediction:
    """When a block is expected to start and to end."""

    block: str

    start: float
    """When it starts [s]; inf if that is not known."""

    end: float
    """When it ends [s]; inf if that is not known."""

    behaviours: tuple[PredictedBehaviour, ...] = ()
    """What it does, and when."""

    character: str = ""
    """Whose block it is."""


@dataclass(frozen=True)
class BmlWarning:
    """A block, a constraint or a behaviour that is not performed."""

    id: str
    """Which: "bml1" or "bml1:gaze2"; "" for a document without id."""

    type: WarningType
    """What kind of failure it is."""

    description: str
    """Why, in one line."""

    time: float
    """When it was found [s]."""

    character: str = ""
    """Whose block it is."""


Feedback = BlockProgress | SyncPointProgress | BlockPrediction | BmlWarning


def feedback_xml(feedback: Feedback) -> str:
    """Return the XML document of a report, one line.

    >>> feedback_xml(BlockProgress("bml1", "start", 1.5))
    '<blockProgress xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="bml1:start" globalTime="1.5"/>'
    """  # noqa: E501
    match feedback:
        case BlockProgress():
            of = _attributes(id=f"{feedback.block}:{feedback.sync}", globalTime=feedback.time)
            return f"<blockProgress {_head(feedback)}{of}/>"
        case SyncPointProgress():
            of = _attributes(
                id=f"{feedback.block}:{feedback.behaviour}:{feedback.sync}",
                time=feedback.block_time,
                globalTime=feedback.time,
            )
            return f"<syncPointProgress {_head(feedback)}{of}/>"
        case BmlWarning():
            of = _attributes(id=feedback.id, type=feedback.type)
            text = escape(feedback.description)
            return f"<warningFeedback {_head(feedback)}{of}>{text}</warningFeedback>"
        case BlockPrediction():
            return _prediction(feedback)


def _prediction(feedback: BlockPrediction) -> str:
    block = _attributes(id=feedback.block, globalStart=feedback.start, globalEnd=feedback.end)
    behaviours = "".join(
        f"<{b.kind} {_attributes(id=f'{feedback.block}:{b.id}', **dict(b.times))}/>"
        for b in feedback.behaviours
    )
    head = _head(feedback).rstrip()
    return f"<predictionFeedback {head}><bml {block}/>{behaviours}</predictionFeedback>"


def _head(feedback: Feedback) -> str:
    whose = f"characterId={quoteattr(feedback.character)} " if feedback.character else ""
    return f'xmlns="{BML}" {whose}'


def _attributes(**values: str | float) -> str:
    return " ".join(
        f"{name}={quoteattr(value)}" if isinstance(value, str) else f'{name}="{value:.6g}"'
        for name, value in values.items()
        if value != float("inf")
    )
