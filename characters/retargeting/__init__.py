"""A motion of one skeleton on another, by what their joints are; feet hold where they held.

`retarget` moves one clip; `make_locomotion` makes of a few recordings all the clips that a
character needs to walk and run where it is sent.
"""

from characters.retargeting.locomotion.locomotion import Found, Locomotion, make_locomotion
from characters.retargeting.recording import Recording, load_recording
from characters.retargeting.retarget import retarget

__all__ = [
    "Found",
    "Locomotion",
    "Recording",
    "load_recording",
    "make_locomotion",
    "retarget",
]
