"""A real board with MicroPython: ESP32 or RP2040."""

import select
import sys
import time

import machine
import micropython

from .board import RobotBoard
from .table import ServoTable

WATCHDOG_MS = 4000
"""Timeout of the watchdog [ms]."""

ERROR_FILE = "last_error.txt"
"""File with the first error since boot."""

BUZZER_DUTY = 8000
"""Duty cycle of the buzzer, of 65536: its volume."""

MIN_SILENCE_MS = 100
"""Shortest silence before the first bytes of a developer's tool [ms]."""


class Hardware(RobotBoard):
    """The board with the microcontroller; the table names its pins."""

    def __init__(self, table: ServoTable) -> None:
        self._last = time.ticks_ms()
        self._byte = bytearray(1)
        self._pins = {}
        self._servos = _pca9685(table) if table.driver else None
        self._buzzer = None if table.buzzer is None else machine.Pin(table.buzzer)
        self._tone = None
        self._battery = table.battery
        self._adc = machine.ADC(table.battery[0]) if table.battery else None
        self._watchdog = None
        self._error_logged = False
        self._uart = None
        self._exit_requested = False
        self._last_byte = self._last
        self._return_received = False
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
        """Return the time since the last call [whole ms]."""
        now = time.ticks_ms()
        elapsed = time.ticks_diff(now, self._last)
        self._last = now
        return elapsed

    def wait(self, ms: int) -> None:
        """Wait for bytes, at most `ms` ms."""
        for _ in self._readable.ipoll(ms):
            return

    def read(self, data: bytearray) -> int:
        """Read received bytes into `data`; return how many, 0 if there are none."""
        if self._uart:
            return self._uart.readinto(data) or 0
        count = 0
        # One by one: a longer read blocks until all have arrived.
        while count < len(data) and self._is_ready(self._readable):
            self._in.readinto(self._byte)
            data[count] = self._byte[0]
            count += 1
            if self._asks_for_prompt(self._byte[0]):
                break  # the next bytes are for the prompt
        return count

    def _asks_for_prompt(self, byte: int) -> bool:
        """Whether this byte completes the interrupt sequence of mpremote: silence, CR, Ctrl-C.

        Ctrl-C alone is common in frames, but no frame begins with CR, Ctrl-C.
        """
        now = time.ticks_ms()
        silent = time.ticks_diff(now, self._last_byte) >= MIN_SILENCE_MS
        self._last_byte = now
        self._exit_requested = byte == 3 and self._return_received
        self._return_received = byte == 13 and silent
        return self._exit_requested

    def write(self, data: memoryview) -> int:
        """Write as many bytes as possible without blocking; return how many."""
        if self._uart:
            return self._uart.write(data) or 0
        count = 0
        # One by one: if nobody reads, the second byte blocks for half a second.
        while count < len(data) and self._is_ready(self._writable):
            self._out.write(data[count : count + 1])
            count += 1
        return count

    def pulse(self, pin: int, us: int) -> None:
        """Set the pulse width of a servo [µs], 0 for no pulses."""
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
        """Set the frequency of the buzzer; 0 for silence."""
        if self._buzzer is None:
            return
        if self._tone is None:
            if not hertz:
                return
            self._tone = machine.PWM(self._buzzer, freq=hertz, duty_u16=BUZZER_DUTY)
        elif hertz:
            self._tone.freq(hertz)
            self._tone.duty_u16(BUZZER_DUTY)
        else:
            self._tone.duty_u16(0)

    def battery(self) -> int:
        """Return the charge of the battery in 1/10000; 10000 on mains."""
        if self._adc is None:
            return 10000
        _, empty, full, ratio = self._battery
        volts = self._adc.read_u16() * 3.3 / 65535 * ratio
        return min(max(round(10000 * (volts - empty) / (full - empty)), 0), 10000)

    def begin(self, program: bool) -> None:
        """Use the line for the program, or return it to the developer's prompt."""
        if not program and self._watchdog:
            # The watchdog cannot be stopped, and would reboot during the developer's work.
            machine.reset()
        if not self._uart:
            micropython.kbd_intr(-1 if program else 3)

    def exit_requested(self) -> bool:
        """Whether a developer's tool has interrupted the program."""
        return self._exit_requested

    def start_watchdog(self) -> None:
        """Reboot from now on if `feed_watchdog` is not called for `WATCHDOG_MS`."""
        if self._watchdog is None and hasattr(machine, "WDT"):
            self._watchdog = machine.WDT(timeout=WATCHDOG_MS)

    def feed_watchdog(self) -> None:
        """Restart the watchdog's time."""
        if self._watchdog:
            self._watchdog.feed()

    def log_error(self, error: BaseException) -> None:
        """Write the first error since boot to a file; only one, as flash wears out."""
        if self._error_logged:
            return
        self._error_logged = True
        try:
            with open(ERROR_FILE, "w") as file:
                sys.print_exception(error, file)
        except OSError:
            pass  # the flash is full or read-only

    def _is_ready(self, poll) -> bool:
        for _ in poll.ipoll(0):
            return True
        return False


def developer_pin_held(table: ServoTable) -> bool:
    """Whether the developer's pin is held to ground."""
    if table.developer_pin is None:
        return False
    return not machine.Pin(table.developer_pin, machine.Pin.IN, machine.Pin.PULL_UP).value()


def _pca9685(table: ServoTable):
    from .pca9685 import PCA9685

    number, sda, scl, address = table.driver
    return PCA9685(machine.I2C(number, sda=machine.Pin(sda), scl=machine.Pin(scl)), address)
