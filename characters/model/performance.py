"""A motion together with the skeleton that it was recorded on."""

from dataclasses import dataclass

from characters.motion.clip import Clip
from characters.skeleton.pose import Skeleton


@dataclass(frozen=True)
class Performance:
    """A recorded motion and the skeleton that its poses are of.

    A `Clip` alone says how joints turn, not which joints they are: whatever looks at a recording
    (retargeting, finding contacts, inspecting) needs both.
    """

    skeleton: Skeleton
    """The performer's joints and rest pose [m], in glTF's axes (+y up)."""

    clip: Clip
    """The motion, on that skeleton."""

    notes: tuple[str, ...] = ()
    """What was guessed or repaired on the way, one line each, for a person to check."""
