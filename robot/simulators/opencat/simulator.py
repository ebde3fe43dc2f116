"""A whole simulated Bittle or Nybble, in virtual or in real time."""

import numpy as np

from robot.simulators.opencat.board import Board
from robot.simulators.opencat.habits import Habits


class OpenCatSimulator:
    """A simulated robot that runs OpenCat; Petoi's dog Bittle on a BiBoard unless said otherwise.

    It has no clock: it lives until the time that it is told.

    Parameters
    ----------
    seed
        Of everything in it that is drawn.
    model, version
        What it calls itself.
    habits
        How ugly its board is.
    new_board
        Whether it asks, at its first start, whether to erase its calibration.
    """

    edge = b"\n"
    """Every line ends with it."""

    def __init__(
        self,
        seed: int = 0,
        model: str = "Bittle X",
        version: str = "B10_241013",
        habits: Habits | None = None,
        new_board: bool = False,
    ) -> None:
        random = np.random.default_rng(seed)
        self.board = Board(random, model, version, habits, new_board)
        """The board and its robot, for those who want to look inside."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        self.board.receive(data, now)

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        self.board.advance(now)

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        return self.board.bytes_to_send()

    def reboot(self) -> None:
        """Lose power and come back."""
        self.board.start_again()

    def portrait(self) -> tuple[float, str]:
        """Return what it looks like: the mood from angry, −1, to happy, 1, and the word for it."""
        return self.board.body.showing


def nybble(seed: int = 0) -> OpenCatSimulator:
    """Make Petoi's cat Nybble on a NyBoard, whose lines wait in order in a small buffer."""
    habits = Habits(merges=False, buffer=64)
    return OpenCatSimulator(seed, "Nybble", "N12_230306", habits)
