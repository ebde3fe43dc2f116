"""Servos that turn no faster than the table allows. Angles are in 1/100 degree, all whole."""

from .board import Board
from .table import Servo

STAGGER = 150
"""Between the first pulse of one servo and of the next [ms]: a servo whose pulses begin jumps to
them, and all at once would pull the supply down."""

RETRY = 500
"""Between two attempts while pulses cannot be given [ms]; one may take as long as I2C waits."""

_TURN = 18000  # what a servo's pulses span [1/100°]
_MRAD = 17453  # in a degree, thousandths


class Joints:
    """All servos of the robot, and where they should be by now: none of them can be measured.

    Parameters
    ----------
    servos
        The table, already checked.
    board
        Gives the pulses.
    """

    def __init__(self, servos: list[Servo], board: Board) -> None:
        count = len(servos)
        self._servos = servos
        self._board = board
        self.angles = [0] * count
        """Where each joint should be by now."""
        self.powered = [False] * count
        """Which of them get pulses."""
        self.broken = False
        """Whether the pulses could not be given."""
        self._pulses = [0] * count
        self._next_start = 0

    def names(self) -> list[str]:
        """Return what the joints are called."""
        return [servo.name for servo in self._servos]

    def limits(self, index: int) -> tuple[int, int, int]:
        """Return lowest and highest angle [mrad] and top speed [mrad/s] for the catalogue."""
        servo = self._servos[index]
        # Outwards, so that a rounded angle stays inside.
        low, high = servo.low * _MRAD // 1000, -(-servo.high * _MRAD // 1000)
        return low, high, -(-servo.speed * _MRAD // 1000)

    def mrad(self, index: int) -> int:
        """Return where a joint should be by now [mrad]."""
        return (self.angles[index] * _MRAD + 50000) // 100000

    @property
    def limp(self) -> bool:
        """Whether no servo holds its joint."""
        return True not in self.powered

    @property
    def neutral(self) -> bool:
        """Whether all of them are at 0."""
        return not any(self.angles)

    def start(self, now: int) -> None:
        """Give power to the next servo that has none, if it is time [ms]."""
        if now < self._next_start or False not in self.powered:
            return
        index = self.powered.index(False)
        self._pulses[index] = 0
        given = self._pulse(index)
        self.broken = not given
        self.powered[index] = given
        self._next_start = now + (STAGGER if given else RETRY)

    def release(self) -> None:
        """Take the power from all of them; they stay where they are, or sink."""
        for index, servo in enumerate(self._servos):
            self.powered[index] = False
            try:
                self._board.pulse(servo.pin, 0)
            except OSError:
                self.broken = True

    def move(self, wanted: list[int], elapsed: int) -> None:
        """Turn every joint towards where it is wanted, as far as it may in `elapsed` ms."""
        for index, servo in enumerate(self._servos):
            if not self.powered[index]:
                continue
            target = wanted[index]
            low, high = 100 * servo.low, 100 * servo.high
            target = low if target < low else high if target > high else target
            reach = servo.speed * elapsed // 10
            way = target - self.angles[index]
            if way:
                self.angles[index] += -reach if way < -reach else reach if way > reach else way
                if not self._pulse(index):
                    self._lose()
                    return

    def _pulse(self, index: int) -> bool:
        """Send a servo where its joint should be; whether that was possible."""
        servo = self._servos[index]
        stands = 100 * (servo.neutral + servo.trim) + servo.direction * self.angles[index]
        pulse = servo.shortest + (servo.longest - servo.shortest) * stands // _TURN
        if pulse != self._pulses[index]:
            try:
                self._board.pulse(servo.pin, pulse)
            except OSError:
                return False
            self._pulses[index] = pulse
        return True

    def _lose(self) -> None:
        """Remember that whoever gives the pulses is gone, and every servo limp."""
        self.broken = True
        for index in range(len(self.powered)):
            self.powered[index] = False
