"""Servos with limited speed. Angles are integers in 1/100 degree."""

from .board import RobotBoard
from .table import Servo

POWER_ON_EVERY_MS = 150
"""Time between the power-on of two servos [ms]: a servo jumps at its first pulse, and all at once
would overload the supply."""

RETRY_EVERY_MS = 500
"""Time between two attempts after a failure [ms]; each may take as long as the I2C timeout."""

_SERVO_RANGE = 18000  # between the shortest and the longest pulse [1/100°]
_MICRORAD = 17453  # per degree


class ServoJoints:
    """The servos of the robot, and their expected angles: hobby servos cannot be measured."""

    def __init__(self, servos: list[Servo], board: RobotBoard) -> None:
        count = len(servos)
        self._servos = servos
        self._board = board
        self.angles = [0] * count
        """Expected angle of each joint now."""
        self.powered = [False] * count
        """Whether each servo gets pulses."""
        self.failed = False
        """Whether the pulse generator did not answer the last time."""
        self._pulses = [0] * count
        self._next_power_on = 0

    def names(self) -> list[str]:
        """Return the names of the joints."""
        return [servo.name for servo in self._servos]

    def limits(self, index: int) -> tuple[int, int, int]:
        """Return lowest and highest angle [mrad] and top speed [mrad/s] for the catalogue."""
        servo = self._servos[index]
        # Rounded outwards, so that a rounded angle stays inside.
        low, high = servo.low * _MICRORAD // 1000, -(-servo.high * _MICRORAD // 1000)
        return low, high, -(-servo.speed * _MICRORAD // 1000)

    def mrad(self, index: int) -> int:
        """Return the expected angle of a joint [mrad]."""
        return (self.angles[index] * _MICRORAD + 50000) // 100000

    def from_mrad(self, angle: int) -> int:
        """Return an angle of the protocol [mrad] in ours."""
        return (angle * 100000 + _MICRORAD // 2) // _MICRORAD

    @property
    def limp(self) -> bool:
        """Whether no servo gets pulses."""
        return True not in self.powered

    @property
    def neutral(self) -> bool:
        """Whether all joints are at 0."""
        return not any(self.angles)

    def start(self, now: int) -> None:
        """Power on the next servo that is off, if it is due at `now` [ms]."""
        if now < self._next_power_on or False not in self.powered:
            return
        index = self.powered.index(False)
        self._pulses[index] = 0
        done = self._pulse(index)
        self.powered[index] = done
        self._next_power_on = now + (POWER_ON_EVERY_MS if done else RETRY_EVERY_MS)

    def release(self) -> None:
        """Power off all servos; they stay where they are, or sink."""
        for index, servo in enumerate(self._servos):
            self.powered[index] = False
            try:
                self._board.pulse(servo.pin, 0)
            except OSError:
                continue  # a generator that fails gives no pulses either

    def move(self, targets: list[int], elapsed: int) -> None:
        """Move every joint towards its target, within its limits and its speed in `elapsed` ms."""
        for index, servo in enumerate(self._servos):
            if not self.powered[index]:
                continue
            target = min(max(targets[index], 100 * servo.low), 100 * servo.high)
            max_step = servo.speed * elapsed // 10
            way = target - self.angles[index]
            if way:
                self.angles[index] += min(max(way, -max_step), max_step)
                if not self._pulse(index):
                    # The pulse generator failed, and every servo is off.
                    self.powered[:] = [False] * len(self.powered)
                    return

    def _pulse(self, index: int) -> bool:
        """Send a servo to the expected angle of its joint; return whether that worked."""
        servo = self._servos[index]
        position = 100 * (servo.neutral + servo.trim) + servo.direction * self.angles[index]
        pulse = servo.shortest + (servo.longest - servo.shortest) * position // _SERVO_RANGE
        if pulse != self._pulses[index]:
            try:
                self._board.pulse(servo.pin, pulse)
            except OSError:
                self.failed = True
                return False
            self.failed = False
            self._pulses[index] = pulse
        return True
