"""Checks the table of servos before anything moves, and says in one line what is wrong with it."""

from .messages import JOINTS_MAX, NAME_BYTES

PULSES = (400, 2600)
"""Shortest and longest pulse that is ever sent [µs]; hobby servos take 500 to 2500."""


class Servo:
    """One row of the table. Raises ValueError, in one line, if it cannot be right."""

    def __init__(
        self,
        name: str,
        pin: int,
        low: int,
        high: int,
        neutral: int,
        direction: int,
        trim: int,
        speed: int,
        shortest: int,
        longest: int,
    ) -> None:
        self.name = name
        """What the joint is called."""
        self.pin = pin
        """Of the board, or channel of the driver."""
        self.low = low
        """Smallest angle of the joint [°]."""
        self.high = high
        """Largest angle of the joint [°]."""
        self.neutral = neutral
        """Where the servo stands when the joint is at 0 [°]."""
        self.direction = direction
        """1, or -1 if the servo turns the other way."""
        self.trim = trim
        """What is added to where it stands [°]."""
        self.speed = speed
        """Top speed [°/s]."""
        self.shortest = shortest
        """Pulse at which the servo stands at 0° [µs]."""
        self.longest = longest
        """Pulse at which it stands at 180° [µs]."""
        self._check()

    def _check(self) -> None:
        name = self.name
        _bytes_of_name("a joint's name", name)
        if not -180 <= self.low <= 0 <= self.high <= 180:
            raise ValueError(f"{name}: -180 <= lowest <= 0 <= highest <= 180 must hold")
        if self.direction not in (-1, 1):
            raise ValueError(f"{name}: the direction must be 1 or -1")
        if not 1 <= self.speed <= 600:
            raise ValueError(f"{name}: the speed must be from 1 to 600 degrees a second")
        if not PULSES[0] <= self.shortest < self.longest <= PULSES[1]:
            raise ValueError(
                f"{name}: pulses must rise, from {PULSES[0]} us to {PULSES[1]} us at most"
            )
        for angle in (self.low, self.high):
            stands = self.neutral + self.trim + self.direction * angle
            if not 0 <= stands <= 180:
                raise ValueError(
                    f"{name}: at {angle} degrees its servo stands at {stands}, not from 0 to 180"
                )


class Table:
    """What `servos` holds.

    Parameters
    ----------
    module
        `servos`, or another of its kind.
    """

    def __init__(self, module: object) -> None:
        self.name: str = getattr(module, "NAME")
        self.servos: list[Servo] = []
        for row in getattr(module, "SERVOS"):
            if len(row) != 10:
                raise ValueError(f"a row of SERVOS has 10 values, not {len(row)}: {row}")
            self.servos.append(Servo(*row))
        self.port: tuple[int, int, int] | None = getattr(module, "PORT")
        self.driver: tuple[int, int, int, int] | None = getattr(module, "DRIVER")
        self.buzzer: int | None = getattr(module, "BUZZER")
        self.battery: tuple[int, float, float, float] | None = getattr(module, "BATTERY")
        self.developer_pin: int | None = getattr(module, "DEVELOPER_PIN")
        self.rest_after: int = getattr(module, "REST_AFTER")

    def check(self, platform: str) -> None:
        """Raise ValueError, in one line, if the table cannot be right on this kind of board."""
        _bytes_of_name("NAME", self.name)
        if not 1 <= len(self.servos) <= JOINTS_MAX:
            raise ValueError(f"SERVOS must have 1 to {JOINTS_MAX} rows")
        names = [servo.name for servo in self.servos]
        pins = [servo.pin for servo in self.servos]
        for values in (names, [str(pin) for pin in pins]):
            for value in values:
                if values.count(value) > 1:
                    raise ValueError(f"SERVOS has {value} twice")
        if self.driver:
            _check_channels(pins)
        else:
            self._check_pins(pins, platform)

    def _check_pins(self, pins: list[int], platform: str) -> None:
        others = [self.buzzer, self.developer_pin]
        others += self.port[1:] if self.port else ()
        others += self.battery[:1] if self.battery else ()
        for pin in pins:
            if pin in others:
                raise ValueError(f"pin {pin} is a servo's and something else's")
        if platform == "rp2":
            _check_slices(pins, self.buzzer)


def _bytes_of_name(what: str, name: str) -> None:
    if not 1 <= len(name.encode()) <= NAME_BYTES:
        raise ValueError(f"{what} must have 1 to {NAME_BYTES} bytes: {name}")


def _check_channels(channels: list[int]) -> None:
    for channel in channels:
        if not 0 <= channel <= 15:
            raise ValueError(f"a PCA9685 has channels 0 to 15, not {channel}")


def _check_slices(pins: list[int], buzzer: int | None) -> None:
    """On an RP2040 pins share PWMs: 2n with 2n + 1 the frequency, and those 16 apart everything."""
    for pin in pins:
        for other in pins:
            if other > pin and (other - pin) % 16 == 0:
                raise ValueError(f"pins {pin} and {other} are one PWM on this board")
        if buzzer is not None and pin % 16 // 2 == buzzer % 16 // 2:
            raise ValueError(
                f"pin {pin} shares the frequency of its PWM with the buzzer's pin {buzzer}"
            )
