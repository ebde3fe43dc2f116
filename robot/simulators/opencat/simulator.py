"""The simulated Bittle and Nybble."""

import numpy as np

from robot.simulators.opencat.board import Board
from robot.simulators.opencat.quirks import BoardQuirks


class OpenCatSimulator:
    """A simulated robot with OpenCat, by default Petoi's dog Bittle on a BiBoard; a `Simulated`.

    Parameters
    ----------
    seed
        Seed of all draws.
    model, version
        The names that it reports.
    quirks
        The quirks of its board.
    new_board
        Whether it asks at its first start whether to erase its calibration.
    """

    edge = b"\n"
    """Every line ends with it."""

    def __init__(
        self,
        seed: int = 0,
        model: str = "Bittle X",
        version: str = "B10_241013",
        quirks: BoardQuirks | None = None,
        new_board: bool = False,
    ) -> None:
        random = np.random.default_rng(seed)
        self.board = Board(random, model, version, quirks, new_board)
        """The board and its body, for inspection."""

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        self.board.receive(data, now)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        self.board.advance(now)

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        return self.board.bytes_to_send()

    def reboot(self) -> None:
        """Restart, as after a loss of power."""
        self.board.reboot()

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, from −1, angry, to 1, happy, and its word."""
        return self.board.body.mood


def nybble(seed: int = 0) -> OpenCatSimulator:
    """Return a simulated cat Nybble on a NyBoard, whose lines wait in order in a small buffer."""
    quirks = BoardQuirks(merges=False, buffer=64)
    return OpenCatSimulator(seed, "Nybble", "N12_230306", quirks)
