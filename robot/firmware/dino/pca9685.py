"""The PCA9685: sixteen servos on two wires. Registers by NXP's data sheet, section 7.3."""

import machine

MODE1 = 0x00
LED0 = 0x06
PRESCALE = 0xFE

SLEEP = 0x10
AUTO_INCREMENT = 0x20
FULL_OFF = 0x10

PERIOD = 20000
"""One period of its pulses [µs]."""


class PCA9685:
    """A servo driver on an I2C bus. It sets itself up with the first pulse, and after a failure.

    Parameters
    ----------
    bus
        A `machine.I2C`.
    address
        Of the chip; 0x40 if nothing is soldered.
    """

    def __init__(self, bus: machine.I2C, address: int = 0x40) -> None:
        self._bus = bus
        self._address = address
        self._ready = False
        self._four = bytearray(4)

    def pulse(self, channel: int, us: int) -> None:
        """Give a servo pulses of this length [µs] from now on, 0 for none; OSError if it fails."""
        try:
            if not self._ready:
                self._set_up()
            on_off = self._four
            count = us * 4096 // PERIOD
            on_off[0] = on_off[1] = 0
            on_off[2] = count & 0xFF
            on_off[3] = count >> 8 if us else FULL_OFF
            self._bus.writeto_mem(self._address, LED0 + 4 * channel, on_off)
            self._ready = True
        except OSError:
            self._ready = False
            raise

    def _set_up(self) -> None:
        # Its oscillator has 25 MHz, and the period may be set only while it sleeps.
        prescale = (25 * PERIOD + 2048) // 4096 - 1
        for register, value in ((MODE1, SLEEP), (PRESCALE, prescale), (MODE1, AUTO_INCREMENT)):
            self._bus.writeto_mem(self._address, register, bytes((value,)))
