"""The firmware without a board: `python -m robot.firmware` prints the name of its port."""

import sys

from robot.firmware.dino import servos
from robot.firmware.dino.pty_board import run_on_pty
from robot.firmware.dino.table import ServoTable

if __name__ == "__main__":
    table = ServoTable(servos)
    table.check(sys.platform)
    run_on_pty(table)
