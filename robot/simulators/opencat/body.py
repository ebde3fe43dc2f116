"""The body of a simulated Bittle or Nybble: its skills, and servos with limited speed and power.

The angles are our own; only the names are those of real boards.
"""

from collections.abc import Mapping
from dataclasses import dataclass

SERVO_SPEED_DEG_PER_S = 180.0
"""Speed of a joint in a posture [°/s]; a board interpolates well below the speed of its servos."""


@dataclass(frozen=True)
class Skill:
    """A posture, or a skill that plays once."""

    seconds: float
    """Its length [s]; 0 for a posture, which takes as long as the joints need."""

    head: tuple[int, int, int]
    """Final angles of head pan, head tilt and tail [°]; a robot may lack some."""

    shoulders: tuple[int, int]
    """Final angles of the front and the back shoulders [°]."""

    knees: tuple[int, int]
    """Final angles of the front and the back knees [°]."""

    mood: tuple[float, str]
    """The mood that it shows: from −1, angry, to 1, happy, and its word."""

    def angles(self, crossed: bool) -> list[int]:
        """Return the final angles of the board's 16 joints [°]; a cat's back legs are `crossed`."""
        (front, back), (knee, heel) = self.shoulders, self.knees
        if crossed:
            back, heel = -back, -heel
        rolls = [0] * 5
        return [*self.head, *rolls, front, front, back, back, knee, knee, heel, heel]


REST_SKILL = Skill(0.0, (-25, -70, -40), (65, 65), (-50, -50), (0.0, "resting"))
"""The pose after "d" and after the start."""

SKILLS = {
    "balance": Skill(0.0, (0, 0, 0), (32, 32), (28, 28), (0.0, "neutral")),
    "up": Skill(0.0, (0, 0, 0), (30, 30), (30, 30), (0.0, "neutral")),
    "buttUp": Skill(0.0, (20, 35, 0), (75, 40), (-50, 10), (0.8, "happy")),
    "str": Skill(0.0, (10, 30, -30), (-60, 50), (55, 40), (-0.8, "angry")),
    "sit": Skill(0.0, (8, -18, -50), (35, 80), (50, -40), (-0.3, "sad")),
    "rest": Skill(0.0, (-25, -70, -40), (65, 65), (-50, -50), (0.0, "sleepy")),
    "hi": Skill(2.5, (30, -15, -60), (-55, 60), (45, 20), (0.5, "waving")),
    "ck": Skill(1.8, (25, 15, 30), (28, 30), (40, 20), (0.1, "looking")),
    "pu": Skill(4.5, (0, -20, 0), (60, 45), (-40, 10), (0.3, "exercising")),
    "pd": Skill(3.5, (40, 40, 0), (10, 10), (70, 70), (-0.2, "playing dead")),
}
"""What the simulated board's skills do, by the name after "k"."""


class OpenCatBody:
    """The body of a simulated Bittle, or Nybble if `crossed`; angles change linearly over time."""

    def __init__(self, crossed: bool) -> None:
        self.powered = False
        """Whether the servos have power."""
        self.mood = REST_SKILL.mood
        """The mood that it shows, and its word."""
        self._crossed = crossed
        self._from = self._to = [float(angle) for angle in REST_SKILL.angles(crossed)]
        self._begun = self._ends = 0.0

    def perform(self, skill: Skill, now: float) -> float:
        """Start a skill; return how long it takes [s]."""
        wanted = dict(enumerate(skill.angles(self._crossed)))
        self.mood = skill.mood
        return max(self.move(wanted, now), skill.seconds)

    def move(self, wanted: Mapping[int, float], now: float) -> float:
        """Turn some joints together, {number: angle [°]}; return how long it takes [s]."""
        self.powered = True
        self._from = self.angles(now)
        self._to = [wanted.get(joint, angle) for joint, angle in enumerate(self._from)]
        way = max(abs(end - start) for end, start in zip(self._to, self._from, strict=True))
        self._begun, self._ends = now, now + way / SERVO_SPEED_DEG_PER_S
        return way / SERVO_SPEED_DEG_PER_S

    def power_off(self, now: float) -> None:
        """Switch the servos off; they stay where they are."""
        self._from = self._to = self.angles(now)
        self.powered = False
        self.mood = REST_SKILL.mood

    def angles(self, now: float) -> list[float]:
        """Return the joint angles at time `now` [s], in degrees."""
        if now >= self._ends:
            return list(self._to)
        share = max(now - self._begun, 0.0) / (self._ends - self._begun)
        pairs = zip(self._from, self._to, strict=True)
        return [start + (end - start) * share for start, end in pairs]
