"""The firmware without a board: `python -m cubeling.robot.firmware` prints the name of its port."""

import sys

from cubeling.robot.firmware.dino import servos
from cubeling.robot.firmware.dino.pty_board import run_on_pty
from cubeling.robot.firmware.dino.table import ServoTable

if __name__ == "__main__":
    table = ServoTable(servos)
    table.check(sys.platform)
    run_on_pty(table)
