"""The main program of the board, next to the folder `dino`. Under CPython: on a pseudo-terminal."""

import sys

from dino import servos
from dino.table import ServoTable

table = ServoTable(servos)
table.check(sys.platform)
if sys.implementation.name == "micropython":
    from dino.hardware import Hardware, developer_pin_held
    from dino.robot import run

    if not developer_pin_held(table):
        run(Hardware(table), table)
else:
    from dino.pty_board import run_on_pty

    run_on_pty(table)
