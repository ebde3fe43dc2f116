"""How the host learns what a robot has: one question at a time, until the catalogue is whole."""

from robot.contract.catalogue import Catalogue, JointLimits
from robot.protocol import messages as m


class Introduction:
    """The questions and answers after one WELCOME."""

    def __init__(self, welcome: m.Welcome) -> None:
        self.welcome = welcome
        self._counts = (welcome.joints, welcome.motions, welcome.sounds, welcome.moods)
        self._joints: list[JointLimits] = []
        self._names: tuple[list[str], list[str], list[str]] = ([], [], [])

    def question(self) -> m.Ask | None:
        """Return what to ask next; None when everything has been answered."""
        for item, (have, count) in enumerate(zip(self._have(), self._counts, strict=True)):
            if have < count:
                return m.Ask(item, have)
        return None

    def answer(self, entry: m.Joint | m.Name) -> bool:
        """Take an answer; False if it was not the one asked for, as a repeated one is not."""
        item = m.ITEM_JOINT if isinstance(entry, m.Joint) else entry.item
        if self.question() != m.Ask(item, entry.index):
            return False
        if isinstance(entry, m.Joint):
            self._joints.append(JointLimits(entry.name, entry.low, entry.high, entry.speed))
        else:
            self._names[entry.item - m.ITEM_MOTION].append(entry.name)
        return True

    def catalogue(self) -> Catalogue:
        """Return what has been told."""
        motions, sounds, moods = (tuple(names) for names in self._names)
        return Catalogue(
            self.welcome.name, self.welcome.firmware, tuple(self._joints), motions, sounds, moods
        )

    def _have(self) -> tuple[int, ...]:
        return (len(self._joints), *(len(names) for names in self._names))
