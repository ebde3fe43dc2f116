"""Run by MicroPython, see micropython.mjs: the robot on a board whose line is a TCP port."""
# ruff: noqa
# mypy: ignore-errors

import host

from dino import servos
from dino.board import Board
from dino.joints import Joints
from dino.robot import Robot
from dino.table import Table


class Wasm(Board):
    def read(self, data):
        count = 0
        while count < len(data):
            byte = host.next()
            if byte < 0:
                break
            data[count] = byte
            count += 1
        return count

    def write(self, data):
        host.write("".join("%02x" % byte for byte in data))
        return len(data)

    def pulse(self, pin, us):
        pass

    def tone(self, hertz):
        pass


table = Table(servos)
table.check("rp2")
board = Wasm()
robot = Robot(board, table, Joints(table.servos, board))


def turn():
    robot.turn(host.milliseconds())
