"""The whole robot: line, protocol and body, one turn after the other, and what ends them."""

from .board import Board
from .body import Body
from .frames import Outbox
from .joints import Joints
from .link import Link
from .table import Table

WAIT = 5
"""Longest wait for bytes [ms]: so often is the clock looked at."""

PAUSE = 300
"""After an error nothing is tried for this long [ms]."""


class Robot:
    """A robot on a board, from boot, or from an error, to the next.

    Parameters
    ----------
    board
        What it runs on.
    table
        What it is made of.
    joints
        Its servos; they remember over an error where they are.
    """

    def __init__(self, board: Board, table: Table, joints: Joints) -> None:
        self._board = board
        self._outbox = Outbox()
        self._waiting = memoryview(self._outbox.data)
        self._input = bytearray(256)
        self._watched = False
        self.body = Body(joints, board, table.buzzer is not None, 1000 * table.rest_after)
        """What it moves."""
        self.link = Link(self.body, self._outbox, table.name, board)
        """Its end of the protocol."""

    def turn(self, now: int) -> None:
        """Do all that is due at `now` [ms], and never wait."""
        board = self._board
        # Also without bytes: the failsafe and STATE are due by the clock.
        self.link.receive(self._input, board.read(self._input), now)
        attended = self.link.session != 0
        self.body.advance(now, attended)
        outbox = self._outbox
        if outbox.end:
            outbox.sent(board.write(self._waiting[outbox.start : outbox.end]))
        if attended and not self._watched:
            # Not sooner: a board that nobody has greeted lets the developer in.
            self._watched = True
            board.watch()
        board.feed()


def live(board: Board, table: Table, joints: Joints) -> None:
    """Let the robot live until somebody wants the program to end."""
    robot = Robot(board, table, joints)
    now = 0
    while robot.link.session or not board.left():
        # Not the board's own clock: that one wraps.
        now += board.elapsed()
        robot.turn(now)
        board.wait(WAIT)


def run(board: Board, table: Table) -> None:
    """Run the robot, through every error, until somebody wants the program to end."""
    joints = Joints(table.servos, board)
    board.begin(True)
    try:
        while True:
            try:
                live(board, table, joints)
                return
            except Exception as error:
                joints.release()
                board.tone(0)
                board.note(error)
                pause(board, PAUSE)
    finally:
        joints.release()
        board.begin(False)


def pause(board: Board, time: int) -> None:
    """Wait, and say to the watchdog that this is meant."""
    board.elapsed()
    while time > 0 and not board.left():
        board.feed()
        board.wait(WAIT)
        time -= board.elapsed()
