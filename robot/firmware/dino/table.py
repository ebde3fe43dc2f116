"""The configuration in `servos`, checked before anything moves."""

from .messages import JOINTS_MAX, NAME_BYTES

PULSE_RANGE_US = (400, 2600)
"""Shortest and longest pulse width [µs]; hobby servos use 500 to 2500."""


class Servo:
    """A row of the table; raises ValueError, in one line, if it is not valid."""

    name: str
    """Name of the joint."""
    pin: int
    """Pin of the board, or channel of the driver."""
    low: int
    """Smallest angle of the joint [°]."""
    high: int
    """Largest angle of the joint [°]."""
    neutral: int
    """Position of the servo when the joint is at 0 [°]."""
    direction: int
    """1, or -1 if the servo turns the other way."""
    trim: int
    """Correction of that position [°]."""
    speed: int
    """Top speed [°/s]."""
    shortest: int
    """Pulse width at the servo's 0° [µs]."""
    longest: int
    """Pulse width at its 180° [µs]."""

    def __init__(self, name: str, *numbers: int) -> None:
        if len(numbers) != 9:
            raise ValueError(f"a row of SERVOS has 10 values, not {1 + len(numbers)}: {name}")
        self.name = name
        self.pin, self.low, self.high, self.neutral = numbers[:4]
        self.direction, self.trim, self.speed, self.shortest, self.longest = numbers[4:]
        self._check()

    def _check(self) -> None:
        name = self.name
        _check_name("a joint's name", name)
        if not -180 <= self.low <= 0 <= self.high <= 180:
            raise ValueError(f"{name}: -180 <= lowest <= 0 <= highest <= 180 must hold")
        if self.direction not in (-1, 1):
            raise ValueError(f"{name}: the direction must be 1 or -1")
        if not 1 <= self.speed <= 600:
            raise ValueError(f"{name}: the speed must be from 1 to 600 degrees a second")
        low, high = PULSE_RANGE_US
        if not low <= self.shortest < self.longest <= high:
            raise ValueError(f"{name}: pulses must rise, from {low} us to {high} us at most")
        for angle in (self.low, self.high):
            position = self.neutral + self.trim + self.direction * angle
            if not 0 <= position <= 180:
                raise ValueError(
                    f"{name}: at {angle} degrees its servo is at {position}, not from 0 to 180"
                )


class ServoTable:
    """The configuration in `servos`, or in another module with the same constants."""

    def __init__(self, module: object) -> None:
        self.name: str = getattr(module, "NAME")
        self.servos = [Servo(*row) for row in getattr(module, "SERVOS")]
        self.port: tuple[int, int, int] | None = getattr(module, "PORT")
        self.driver: tuple[int, int, int, int] | None = getattr(module, "DRIVER")
        self.buzzer: int | None = getattr(module, "BUZZER")
        self.battery: tuple[int, float, float, float] | None = getattr(module, "BATTERY")
        self.developer_pin: int | None = getattr(module, "DEVELOPER_PIN")
        self.rest_after: int = getattr(module, "REST_AFTER")

    def check(self, platform: str) -> None:
        """Raise ValueError, in one line, if the table is not valid for this kind of board."""
        _check_name("NAME", self.name)
        if not 1 <= len(self.servos) <= JOINTS_MAX:
            raise ValueError(f"SERVOS must have 1 to {JOINTS_MAX} rows")
        names = [servo.name for servo in self.servos]
        pins = [servo.pin for servo in self.servos]
        for values in (names, [str(pin) for pin in pins]):
            for value in values:
                if values.count(value) > 1:
                    raise ValueError(f"SERVOS has {value} twice")
        if not self.driver:
            self._check_pins(pins, platform)
            return
        for channel in pins:
            if not 0 <= channel <= 15:
                raise ValueError(f"a PCA9685 has channels 0 to 15, not {channel}")

    def _check_pins(self, pins: list[int], platform: str) -> None:
        others = [self.buzzer, self.developer_pin]
        others += self.port[1:] if self.port else ()
        others += self.battery[:1] if self.battery else ()
        for pin in pins:
            if pin in others:
                raise ValueError(f"pin {pin} is used for a servo and for something else")
        if platform == "rp2":
            _check_slices(pins, self.buzzer)


def _check_name(what: str, name: str) -> None:
    if not 1 <= len(name.encode()) <= NAME_BYTES:
        raise ValueError(f"{what} must have 1 to {NAME_BYTES} bytes: {name}")


def _check_slices(pins: list[int], buzzer: int | None) -> None:
    """Refuse pins that share a PWM of an RP2040: 2n and 2n + 1 its frequency, n and n + 16 all."""
    for pin in pins:
        for other in pins:
            if other > pin and (other - pin) % 16 == 0:
                raise ValueError(f"pins {pin} and {other} share one PWM on this board")
        if buzzer is not None and pin % 16 // 2 == buzzer % 16 // 2:
            raise ValueError(f"pin {pin} shares its PWM's frequency with the buzzer's pin {buzzer}")
