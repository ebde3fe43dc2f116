"""Driver of the PCA9685, a chip for sixteen servos on I2C (NXP's data sheet, section 7.3)."""

import machine

MODE1 = 0x00
LED0 = 0x06
PRESCALE = 0xFE

SLEEP = 0x10
AUTO_INCREMENT = 0x20
FULL_OFF = 0x10

PERIOD_US = 20000
"""Period of the pulses [µs]."""


class PCA9685:
    """A servo driver on an I2C bus; initialised at the first pulse, and after a failure."""

    def __init__(self, bus: machine.I2C, address: int = 0x40) -> None:
        self._bus = bus
        self._address = address
        self._ready = False
        self._registers = bytearray(4)

    def pulse(self, channel: int, us: int) -> None:
        """Set the pulse width of a servo [µs], 0 for no pulses; OSError if that fails."""
        try:
            if not self._ready:
                self._initialise()
            registers = self._registers
            count = us * 4096 // PERIOD_US
            registers[0] = registers[1] = 0
            registers[2] = count & 0xFF
            registers[3] = count >> 8 if us else FULL_OFF
            self._bus.writeto_mem(self._address, LED0 + 4 * channel, registers)
            self._ready = True
        except OSError:
            self._ready = False
            raise

    def _initialise(self) -> None:
        # The oscillator has 25 MHz; the prescaler may be set only in sleep mode.
        prescale = (25 * PERIOD_US + 2048) // 4096 - 1
        for register, value in ((MODE1, SLEEP), (PRESCALE, prescale), (MODE1, AUTO_INCREMENT)):
            self._bus.writeto_mem(self._address, register, bytes((value,)))
