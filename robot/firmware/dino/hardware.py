"""A real board with MicroPython: ESP32 or RP2040."""

import select
import sys
import time

import machine
import micropython

from .board import Board
from .table import Table

WATCHDOG = 4000
"""A board that has not said for this long that it lives reboots [ms]."""

NOTE = "last_error.txt"
"""Where the first error since boot is kept."""

VOLUME = 8000
"""Of the buzzer: how long it is on in each cycle, of 65536."""

QUIET = 100
"""What a developer's tool sends first comes after a silence of at least this [ms]."""


class Hardware(Board):
    """The board that this runs on.

    Parameters
    ----------
    table
        Which pins do what.
    """

    def __init__(self, table: Table) -> None:
        self._last = time.ticks_ms()
        self._one = bytearray(1)
        self._pins = {}
        self._servos = _pca9685(table) if table.driver else None
        self._buzzer = None if table.buzzer is None else machine.Pin(table.buzzer)
        self._tone = None
        self._battery = table.battery
        self._adc = machine.ADC(table.battery[0]) if table.battery else None
        self._watchdog = None
        self._noted = False
        self._uart = None
        self._left = False
        self._heard = self._last
        self._return = False
        if table.port:
            number, tx, rx = table.port
            self._uart = machine.UART(
                number, 115200, tx=machine.Pin(tx), rx=machine.Pin(rx), timeout=0, rxbuf=512,
                txbuf=512,
            )  # fmt: skip
        self._in = self._uart or sys.stdin.buffer
        self._out = self._uart or sys.stdout.buffer
        self._readable = select.poll()
        self._readable.register(self._uart or sys.stdin, select.POLLIN)
        self._writable = select.poll()
        self._writable.register(self._uart or sys.stdout, select.POLLOUT)

    def elapsed(self) -> int:
        """Return the time since this was last asked [whole ms]."""
        now = time.ticks_ms()
        elapsed = time.ticks_diff(now, self._last)
        self._last = now
        return elapsed

    def wait(self, ms: int) -> None:
        """Wait for bytes, at most `ms` ms."""
        for _ in self._readable.ipoll(ms):
            return

    def read(self, data: bytearray) -> int:
        """Put the bytes that have come into `data`; return how many, 0 if none have."""
        if self._uart:
            return self._uart.readinto(data) or 0
        count = 0
        # One by one: more would wait until all are there.
        while count < len(data) and self._is_ready(self._readable):
            self._in.readinto(self._one)
            data[count] = self._one[0]
            count += 1
            if self._asks_for_prompt(self._one[0]):
                break  # what follows is for the prompt
        return count

    def _asks_for_prompt(self, byte: int) -> bool:
        """Whether this byte ends what mpremote sends to interrupt a program: silence, CR, Ctrl-C.

        Ctrl-C alone is a byte like any other here, for frames are full of it; and no frame begins
        with CR, Ctrl-C.
        """
        now = time.ticks_ms()
        quiet = time.ticks_diff(now, self._heard) >= QUIET
        self._heard = now
        self._left = byte == 3 and self._return
        self._return = byte == 13 and quiet
        return self._left

    def write(self, data: memoryview) -> int:
        """Give bytes to the line; return how many it has taken at once."""
        if self._uart:
            return self._uart.write(data) or 0
        count = 0
        # One by one: where nobody reads, the second would wait for half a second.
        while count < len(data) and self._is_ready(self._writable):
            self._out.write(data[count : count + 1])
            count += 1
        return count

    def pulse(self, pin: int, us: int) -> None:
        """Give a servo pulses of this length [µs] from now on, 0 for none."""
        if self._servos:
            self._servos.pulse(pin, us)
            return
        pwm = self._pins.get(pin)
        if pwm is None:
            if not us:
                return
            pwm = self._pins[pin] = machine.PWM(machine.Pin(pin), freq=50, duty_ns=0)
        pwm.duty_ns(1000 * us)

    def tone(self, hertz: int) -> None:
        """Let the buzzer sound; 0 for silence."""
        if self._buzzer is None:
            return
        if self._tone is None:
            if not hertz:
                return
            self._tone = machine.PWM(self._buzzer, freq=hertz, duty_u16=VOLUME)
        elif hertz:
            self._tone.freq(hertz)
            self._tone.duty_u16(VOLUME)
        else:
            self._tone.duty_u16(0)

    def battery(self) -> int:
        """Return how full the battery is, in 1/10000; 10000 on mains."""
        if self._adc is None:
            return 10000
        _, empty, full, ratio = self._battery
        volts = self._adc.read_u16() * 3.3 / 65535 * ratio
        return min(max(round(10000 * (volts - empty) / (full - empty)), 0), 10000)

    def begin(self, program: bool) -> None:
        """Take the line for the program, or give it back to the developer's prompt."""
        if not program and self._watchdog:
            # It cannot be stopped, and would end the developer's work after some seconds.
            machine.reset()
        if not self._uart:
            micropython.kbd_intr(-1 if program else 3)

    def left(self) -> bool:
        """Whether somebody wants the program to end."""
        return self._left

    def watch(self) -> None:
        """From now on, reboot if `feed` is not called for `WATCHDOG` ms."""
        if self._watchdog is None and hasattr(machine, "WDT"):
            self._watchdog = machine.WDT(timeout=WATCHDOG)

    def feed(self) -> None:
        """Say that the program lives."""
        if self._watchdog:
            self._watchdog.feed()

    def note(self, error: BaseException) -> None:
        """Keep the first error since boot in a file; flash wears out."""
        if self._noted:
            return
        self._noted = True
        try:
            with open(NOTE, "w") as file:
                sys.print_exception(error, file)
        except OSError:
            pass  # a full or read-only flash is no reason to stop

    def _is_ready(self, poll) -> bool:
        for _ in poll.ipoll(0):
            return True
        return False


def developer_holds(table: Table) -> bool:
    """Whether the developer's pin is held to ground."""
    if table.developer_pin is None:
        return False
    return not machine.Pin(table.developer_pin, machine.Pin.IN, machine.Pin.PULL_UP).value()


def _pca9685(table: Table):
    from .pca9685 import PCA9685

    number, sda, scl, address = table.driver
    return PCA9685(machine.I2C(number, sda=machine.Pin(sda), scl=machine.Pin(scl)), address)
