"""How often a frame's check let something pass, and how often it should have."""

from dataclasses import dataclass

from scipy.stats import binomtest

from robot.protocol import messages as m
from robot.protocol.schema import pack

DOUBT = 1e-6
"""Chance of a false alarm of each comparison."""

BODIES = (
    pack(m.Bye(), 7),
    pack(m.Express(70_000, 0.8, -0.25, 1), 0xABCD),
    pack(m.State(513, 4, 2, 0.8, 0.0, 0.5, 1, 255, 1, (0.0, -1.571, *[0.0] * 14)), 0xABCD),
    bytes(range(100, 220)),
)
"""Bodies of 3, 12, 51 and 120 bytes."""


@dataclass
class Figure:
    """One row of the table."""

    what: str
    """What was done to the frames."""

    trials: int
    """How often."""

    passed: int
    """How many of them were taken for whole."""

    chance: float
    """The predicted share of them."""

    edges: int = 0
    """Trials left out, for they made an edge."""

    @property
    def doubt(self) -> float:
        """Chance of a figure at least so far from the prediction, if that is right."""
        if self.chance == 0:
            return 0.0 if self.passed else 1.0
        return float(binomtest(self.passed, self.trials, self.chance).pvalue)

    @property
    def as_predicted(self) -> bool:
        """Whether the prediction may be right."""
        return self.doubt >= DOUBT
