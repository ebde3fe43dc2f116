"""Run by MicroPython, see micropython.mjs: the robot on a board whose line and time are a test's.

`exchange("1500 00030501…")` lets it hear bytes at 1500 ms, and returns what it sends.
"""
# ruff: noqa
# mypy: ignore-errors

from dino import servos
from dino.board import RobotBoard
from dino.joints import ServoJoints
from dino.log import LogQueue
from dino.robot import Firmware
from dino.table import ServoTable


class VirtualBoard(RobotBoard):
    def __init__(self):
        self.incoming = b""
        self.outgoing = bytearray()

    def read(self, data):
        count = min(len(self.incoming), len(data))
        data[:count] = self.incoming[:count]
        self.incoming = self.incoming[count:]
        return count

    def write(self, data):
        self.outgoing.extend(data)
        return len(data)

    def pulse(self, pin, us):
        pass

    def tone(self, hertz):
        pass


table = ServoTable(servos)
table.check("rp2")
board = VirtualBoard()
robot = Firmware(board, table, ServoJoints(table.servos, board), LogQueue())


def exchange(line):
    now, _, text = line.partition(" ")
    board.incoming += bytes.fromhex(text)
    board.outgoing = bytearray()
    robot.step(int(now))
    while board.incoming:
        robot.step(int(now))
    # In MicroPython the hex of no bytes is no text, but no bytes.
    return bytes(board.outgoing).hex() if board.outgoing else ""
