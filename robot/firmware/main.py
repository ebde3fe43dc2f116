"""What the board starts; its place is beside the folder `dino`. Under CPython: a desk's robot."""

import sys

from dino import servos
from dino.robot import run
from dino.table import Table

table = Table(servos)
table.check(sys.platform)
if sys.implementation.name == "micropython":
    from dino.hardware import Hardware, developer_holds

    if not developer_holds(table):
        run(Hardware(table), table)
else:
    from dino.desk import Desk

    desk = Desk()
    sys.stdout.write(desk.url + "\n")
    sys.stdout.flush()
    run(desk, table)
