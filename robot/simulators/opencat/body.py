"""The body: servos that turn no faster than they can, and do nothing without power."""

from collections.abc import Mapping

from robot.simulators.opencat.skills import REST, Skill

SPEED = 180.0
"""How fast a posture turns each joint [deg/s]; a board interpolates, well below what servos can."""

JOINTS = 16
"""Joints that a board counts, whether the robot has them or not."""


class Body:
    """The body of a simulated Bittle or Nybble; angles change in straight lines over time.

    Parameters
    ----------
    crossed
        Whether its back legs are bent the other way, as Nybble's.
    """

    def __init__(self, crossed: bool) -> None:
        self.powered = False
        """Whether the servos have power."""
        self.showing = REST.mood
        """What it looks like, as mood and word."""
        self._crossed = crossed
        self._from = self._to = [float(angle) for angle in REST.angles(crossed)]
        self._begun = self._ends = 0.0

    def take(self, skill: Skill, now: float) -> float:
        """Go where a skill ends; return how long that takes [s]."""
        wanted = dict(enumerate(skill.angles(self._crossed)))
        self.showing = skill.mood
        return max(self.move(wanted, now), skill.seconds)

    def move(self, wanted: Mapping[int, float], now: float) -> float:
        """Turn some joints together, {number: angle [deg]}; return how long it takes [s]."""
        self.powered = True
        self._from = self.angles(now)
        self._to = [wanted.get(joint, angle) for joint, angle in enumerate(self._from)]
        way = max(abs(to - at) for to, at in zip(self._to, self._from, strict=True))
        self._begun, self._ends = now, now + way / SPEED
        return way / SPEED

    def let_go(self, now: float) -> None:
        """Take the power from the servos; they stay where they are, as the robot lies."""
        self._from = self._to = self.angles(now)
        self.powered = False
        self.showing = REST.mood

    def angles(self, now: float) -> list[float]:
        """Return where the joints are at time `now` [s], in degrees."""
        if now >= self._ends:
            return list(self._to)
        share = max(now - self._begun, 0.0) / (self._ends - self._begun)
        pairs = zip(self._from, self._to, strict=True)
        return [at + (to - at) * share for at, to in pairs]
