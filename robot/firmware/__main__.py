"""The firmware without a board: `python -m robot.firmware` prints the name of its port."""

import sys

from robot.firmware.dino import servos
from robot.firmware.dino.pty_board import PtyBoard
from robot.firmware.dino.robot import run
from robot.firmware.dino.table import ServoTable


def main() -> None:
    """Run the firmware on a pseudo-terminal until Ctrl-C."""
    table = ServoTable(servos)
    table.check(sys.platform)
    try:
        board = PtyBoard()
    except (ImportError, AttributeError):
        sys.exit("this system has no pseudo-terminals: use a board, or sim:cubeling")
    sys.stdout.write(f"{board.url}\n")
    sys.stdout.flush()
    try:
        run(board, table)
    except KeyboardInterrupt:
        board.release()


if __name__ == "__main__":
    main()
