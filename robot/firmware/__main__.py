"""The firmware without a board: `python -m robot.firmware` prints the port that it is on."""

import sys

from robot.firmware.dino import servos
from robot.firmware.dino.desk import Desk
from robot.firmware.dino.robot import run
from robot.firmware.dino.table import Table


def main() -> None:
    """Run a robot behind a pseudo-terminal until Ctrl-C."""
    table = Table(servos)
    table.check(sys.platform)
    try:
        desk = Desk()
    except (ImportError, AttributeError):
        sys.exit("there are no pseudo-terminals on this system: take a board, or sim:cubeling")
    sys.stdout.write(f"{desk.url}\n")
    sys.stdout.flush()
    try:
        run(desk, table)
    except KeyboardInterrupt:
        desk.give_back()


if __name__ == "__main__":
    main()
