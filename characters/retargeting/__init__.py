"""Retargeting: motions of one skeleton for another, matched by body parts.

`retarget` converts one clip. `make_locomotion` makes from a few recordings all the clips that a
character needs to walk and run where it is sent.
"""

from cubeling.characters.retargeting.lent_motions import with_lent_motions
from cubeling.characters.retargeting.locomotion.grading import YAW_RATE_PER_ANGULAR, GaitReport
from cubeling.characters.retargeting.locomotion.locomotion_clips import (
    LocomotionResult,
    make_locomotion,
)
from cubeling.characters.retargeting.recording import Recording, load_recording
from cubeling.characters.retargeting.retarget import retarget

__all__ = [
    "YAW_RATE_PER_ANGULAR",
    "GaitReport",
    "LocomotionResult",
    "Recording",
    "load_recording",
    "make_locomotion",
    "retarget",
    "with_lent_motions",
]
