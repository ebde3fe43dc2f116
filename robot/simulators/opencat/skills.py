"""What the simulated robots can do: postures, and skills that are played once.

The angles are of our own making; only the names are those of real boards.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Skill:
    """A posture, or a skill that is played once."""

    seconds: float
    """How long it is played [s]; 0 for a posture, which takes as long as the joints need."""

    head: tuple[int, int, int]
    """Where head pan, head tilt and tail end [deg]; a robot takes what it has."""

    shoulders: tuple[int, int]
    """Where the front and the back shoulders end [deg]."""

    knees: tuple[int, int]
    """Where the front and the back knees end [deg]."""

    mood: tuple[float, str]
    """What it looks like: from angry, −1, to happy, 1, and the word for it."""

    def angles(self, crossed: bool) -> list[int]:
        """Return where each of the board's 16 joints ends [deg].

        `crossed` is for a cat, whose back legs are bent the other way.
        """
        (front, back), (knee, heel) = self.shoulders, self.knees
        if crossed:
            back, heel = -back, -heel
        rolls = [0] * 5
        return [*self.head, *rolls, front, front, back, back, knee, knee, heel, heel]


REST = Skill(0.0, (-25, -70, -40), (65, 65), (-50, -50), (0.0, "resting"))
"""How the robot lies after "d" and after its start."""

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
"""By name."""
