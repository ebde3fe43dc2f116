"""What a kind of behaviour is to a realizer: its natural times, and what the body does for it."""

from typing import Protocol

from cubeling.characters.behaviour.bml import Behaviour, Scheduled, Timing
from cubeling.characters.behaviour.realization.frame import RealizationContext, RealizedFrame


class BehaviourKind(Protocol):
    """Plays one kind of behaviour; a kind of one's own is an entry of a realizer's `kinds`."""

    channel: str
    """What of the body stays as it leaves it, "gaze" …; "" if nothing does."""

    def timing(self, behaviour: Behaviour, who: RealizationContext) -> Timing:
        """Return the natural times of a behaviour.

        Raises
        ------
        CannotRealize
            If the body cannot do it, or no such target is known.
        """
        ...

    def realize(self, scheduled: Scheduled, who: RealizationContext, frame: RealizedFrame) -> None:
        """Add what the body does for a behaviour that is being played."""
        ...
