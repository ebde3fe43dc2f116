"""The main program of the board, next to the folder `dino`. Under CPython: on a pseudo-terminal."""

import sys

from dino import servos
from dino.robot import run
from dino.table import ServoTable

table = ServoTable(servos)
table.check(sys.platform)
if sys.implementation.name == "micropython":
    from dino.hardware import Hardware, developer_pin_held

    if not developer_pin_held(table):
        run(Hardware(table), table)
else:
    from dino.pty_board import PtyBoard

    board = PtyBoard()
    sys.stdout.write(board.url + "\n")
    sys.stdout.flush()
    run(board, table)
