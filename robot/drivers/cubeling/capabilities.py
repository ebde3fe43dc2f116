"""Asks a robot for its catalogue."""

from collections.abc import Sized

from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.protocol import messages as m


class CapabilityQuery:
    """The questions for a catalogue after one WELCOME, one at a time."""

    def __init__(self, welcome: m.Welcome) -> None:
        self.welcome = welcome
        """The message with the number of entries."""
        self._counts = (welcome.joints, welcome.motions, welcome.sounds, welcome.moods)
        self._joints: list[JointLimits] = []
        self._names: tuple[list[str], list[str], list[str]] = ([], [], [])

    def question(self) -> m.Ask | None:
        """Return the next question; None when everything was answered."""
        known: tuple[Sized, ...] = (self._joints, *self._names)
        for item, (entries, count) in enumerate(zip(known, self._counts, strict=True)):
            if len(entries) < count:
                return m.Ask(item, len(entries))
        return None

    def answer(self, entry: m.Joint | m.Name) -> bool:
        """Process an answer; return False unless it answers the current question."""
        item = m.ITEM_JOINT if isinstance(entry, m.Joint) else entry.item
        if self.question() != m.Ask(item, entry.index):
            return False
        if isinstance(entry, m.Joint):
            self._joints.append(JointLimits(entry.name, entry.low, entry.high, entry.speed))
        else:
            self._names[entry.item - m.ITEM_MOTION].append(entry.name)
        return True

    def catalogue(self) -> Catalogue:
        """Return the catalogue of all answers."""
        motions, sounds, moods = (tuple(names) for names in self._names)
        return Catalogue(
            self.welcome.name, self.welcome.firmware, tuple(self._joints), motions, sounds, moods
        )
