"""The rate of errors that pass the check of a frame, measured and predicted."""

from dataclasses import dataclass

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import pack

MIN_P_VALUE = 1e-6
"""Probability of a false alarm of each comparison."""

BODIES = (
    pack(m.Bye(), 7),
    pack(m.Express(70_000, 0.8, -0.25, 1), 0xABCD),
    pack(m.State(513, 4, 2, 0.8, 0.0, 0.5, 1, 255, 1, (0.0, -1.571, *[0.0] * 14)), 0xABCD),
    bytes(range(100, 220)),
)
"""Bodies of 3, 12, 51 and 120 bytes."""


@dataclass
class ErrorRate:
    """One row of the table."""

    what: str
    """The kind of errors."""

    trials: int
    """Number of trials."""

    passed: int
    """Frames that passed."""

    chance: float
    """Predicted share of them."""

    edges: int = 0
    """Trials that were skipped because they made an edge."""

    @property
    def p_value(self) -> float:
        """Probability of a rate at least this far from the prediction, if that is right."""
        if self.chance == 0:
            return 0.0 if self.passed else 1.0
        from scipy.stats import binomtest  # a second of each process that collects the tests

        return float(binomtest(self.passed, self.trials, self.chance).pvalue)

    @property
    def as_predicted(self) -> bool:
        """Whether the rate agrees with the prediction."""
        return self.p_value >= MIN_P_VALUE
