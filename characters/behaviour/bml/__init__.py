"""BML 1.0: blocks of behaviours, their schedule, their realizer and its feedback."""

from cubeling.characters.behaviour.bml.document import (
    BML,
    BMLA,
    CUBELING,
    FACE_SYNCS,
    GESTURE_SYNCS,
    HOLD_SYNCS,
    SHIFT_SYNCS,
    SYNCS,
    Behaviour,
    Block,
    BmlElement,
    Constraint,
    SyncMark,
    SyncReference,
)
from cubeling.characters.behaviour.bml.feedback import (
    BlockPrediction,
    BlockProgress,
    BmlWarning,
    Feedback,
    PredictedBehaviour,
    SyncPointProgress,
    feedback_xml,
)
from cubeling.characters.behaviour.bml.parser import parse
from cubeling.characters.behaviour.bml.realizer import Realizer
from cubeling.characters.behaviour.bml.timing import (
    CannotRealize,
    Scheduled,
    Timing,
    TimingEstimator,
    elastic,
    rigid,
)

__all__ = [
    "BML",
    "BMLA",
    "CUBELING",
    "FACE_SYNCS",
    "GESTURE_SYNCS",
    "HOLD_SYNCS",
    "SHIFT_SYNCS",
    "SYNCS",
    "Behaviour",
    "Block",
    "BlockPrediction",
    "BlockProgress",
    "BmlElement",
    "BmlWarning",
    "CannotRealize",
    "Constraint",
    "Feedback",
    "PredictedBehaviour",
    "Realizer",
    "Scheduled",
    "SyncMark",
    "SyncPointProgress",
    "SyncReference",
    "Timing",
    "TimingEstimator",
    "elastic",
    "feedback_xml",
    "parse",
    "rigid",
]
