"""The board's own module, with stand-ins for what only MicroPython has."""

import importlib
import io
import sys
import time
from types import ModuleType, SimpleNamespace
from typing import Any, ClassVar

import pytest

from cubeling.robot.firmware.dino import servos
from cubeling.robot.firmware.dino.table import ServoTable


class Pwm:
    """Remembers what it was told last."""

    made: ClassVar[dict[int, "Pwm"]] = {}

    def __init__(self, pin: Any, freq: int, duty_ns: int = 0, duty_u16: int = 0) -> None:
        self.hertz, self.ns, self.share = freq, duty_ns, duty_u16
        Pwm.made[pin.number] = self

    def duty_ns(self, ns: int) -> None:
        self.ns = ns

    def duty_u16(self, share: int) -> None:
        self.share = share

    def freq(self, hertz: int) -> None:
        self.hertz = hertz


class Bus:
    """An I2C bus with a PCA9685; it can be unplugged."""

    latest: ClassVar["Bus"]

    def __init__(self, number: int, sda: Any, scl: Any) -> None:
        Bus.latest = self
        self.pins = (number, sda.number, scl.number)
        self.registers = bytearray(256)
        self.written: list[int] = []
        self.plugged = True

    def writeto_mem(self, address: int, register: int, data: bytes) -> None:
        if not self.plugged:
            raise OSError(19)
        assert address == 0x40
        self.written.append(register)
        for index, byte in enumerate(data):
            self.registers[register + index] = byte


class Pin:
    IN, PULL_UP = 0, 1
    grounded: ClassVar[set[int]] = set()

    def __init__(self, number: int, *how: int) -> None:
        self.number = number

    def value(self) -> int:
        return int(self.number not in Pin.grounded)


class Poll:
    """Polls streams that know themselves whether they are ready."""

    def register(self, stream: Any, flags: int) -> None:
        self.stream, self.flags = stream, flags

    def ipoll(self, ms: int) -> list[object]:
        ready = self.stream.readable() if self.flags == 1 else self.stream.writable()
        return [object()] if ready else []


class Stream:
    """The board's USB socket: one half of `sys.stdin` and `sys.stdout`."""

    def __init__(self) -> None:
        self.buffer = self
        self.coming = b""
        self.gone = b""
        self.room = 1000

    def readable(self) -> bool:
        return bool(self.coming)

    def writable(self) -> bool:
        return self.room > 0

    def readinto(self, data: bytearray) -> int:
        assert len(data) <= len(self.coming), "it would wait for more"
        data[:], self.coming = self.coming[: len(data)], self.coming[len(data) :]
        return len(data)

    def write(self, data: memoryview) -> int:
        assert len(data) <= self.room, "it would wait for room"
        self.gone += bytes(data)
        self.room -= len(data)
        return len(data)


class Uart:
    """A UART, which takes and gives what it can at once."""

    latest: ClassVar["Uart"]

    def __init__(self, number: int, baud: int, tx: Pin, rx: Pin, **buffers: int) -> None:
        assert buffers["timeout"] == 0, "it would wait"
        self.set_up = (number, baud, tx.number, rx.number)
        self.coming, self.gone = b"", b""
        Uart.latest = self

    def readinto(self, data: bytearray) -> int | None:
        if not self.coming:
            return None
        count = min(len(data), len(self.coming))
        data[:count], self.coming = self.coming[:count], self.coming[count:]
        return count

    def write(self, data: memoryview) -> int | None:
        self.gone += bytes(data[:4])
        return min(4, len(data)) or None


class Watchdog:
    """Counts what keeps the board from a reboot."""

    made: ClassVar[list["Watchdog"]] = []

    def __init__(self, timeout: int) -> None:
        self.timeout, self.fed = timeout, 0
        Watchdog.made.append(self)

    def feed(self) -> None:
        self.fed += 1


class MicroPython:
    """The stand-ins, and what they have noticed."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._monkeypatch = monkeypatch
        self.line = Stream()
        self.milliseconds = 2**30 - 5
        self.interrupt: int | None = 3
        self.resets = 0
        Pwm.made.clear()
        Watchdog.made.clear()
        Pin.grounded = set()

        def module(name: str, **content: object) -> None:
            made = ModuleType(name)
            vars(made).update(content)
            monkeypatch.setitem(sys.modules, name, made)

        module("machine", Pin=Pin, PWM=Pwm, I2C=Bus, UART=Uart, WDT=Watchdog, reset=self._reset,
               ADC=lambda pin: SimpleNamespace(read_u16=lambda: 40_000))  # fmt: skip
        module("micropython", kbd_intr=self._kbd_intr)
        module("select", poll=Poll, POLLIN=1, POLLOUT=4)
        monkeypatch.setattr(sys, "print_exception", self._print_exception, raising=False)
        monkeypatch.setattr(time, "ticks_ms", lambda: self.milliseconds % 2**30, raising=False)
        monkeypatch.setattr(
            time, "ticks_diff",
            lambda one, other: (one - other + 2**29) % 2**30 - 2**29, raising=False,
        )  # fmt: skip
        for name in ("hardware", "pca9685"):
            monkeypatch.delitem(sys.modules, f"cubeling.robot.firmware.dino.{name}", raising=False)
        self.hardware = importlib.import_module("cubeling.robot.firmware.dino.hardware")
        for name in ("hardware", "pca9685"):
            monkeypatch.delitem(sys.modules, f"cubeling.robot.firmware.dino.{name}", raising=False)

    def board(self, **changes: object) -> Any:
        # Not sooner: pytest replaces both between a fixture and its test.
        with self._monkeypatch.context() as patch:
            patch.setattr(sys, "stdin", self.line)
            patch.setattr(sys, "stdout", self.line)
            return self.hardware.Hardware(ServoTable(SimpleNamespace(**(vars(servos) | changes))))

    def _reset(self) -> None:
        self.resets += 1

    def _kbd_intr(self, byte: int) -> None:
        self.interrupt = byte

    def _print_exception(self, error: BaseException, file: io.StringIO) -> None:
        file.write(repr(error))


@pytest.fixture
def micropython(monkeypatch) -> MicroPython:
    return MicroPython(monkeypatch)


def test_servos_on_pins_get_pulses_at_50_hz_and_none_without_power(micropython):
    board = micropython.board()
    board.pulse(16, 0)
    assert Pwm.made == {}, "a servo that is let go before its first pulse gets none"
    board.pulse(16, 1500)
    assert (Pwm.made[16].hertz, Pwm.made[16].ns) == (50, 1_500_000)
    board.pulse(16, 0)
    assert Pwm.made[16].ns == 0


def test_servos_on_a_pca9685_get_pulses_and_survive_its_unplugging(micropython):
    board = micropython.board(DRIVER=(1, 20, 21, 0x40))
    bus = Bus.latest
    assert bus.pins == (1, 20, 21)
    board.pulse(3, 1500)
    assert bus.registers[0xFE] == 121, "50 Hz from 25 MHz"
    assert bus.registers[0] & 0x10 == 0, "it is awake"
    assert int.from_bytes(bus.registers[6 + 12 : 6 + 16], "little") == 1500 * 4096 // 20_000 << 16
    board.pulse(3, 0)
    assert bus.registers[6 + 15] == 0x10, "fully off"
    bus.plugged = False
    with pytest.raises(OSError, match="19"):
        board.pulse(3, 1600)
    bus.plugged = True
    bus.written.clear()
    board.pulse(3, 1600)
    assert bus.written == [0, 0xFE, 0, 6 + 12], "it lost its power, and is set up again"


def test_the_line_never_blocks(micropython):
    board = micropython.board()
    data = bytearray(8)
    assert board.read(data) == 0
    micropython.line.coming = bytes(range(65, 75))
    assert (board.read(data), bytes(data)) == (8, b"ABCDEFGH")
    assert board.read(data) == 2
    micropython.line.room = 3
    assert board.write(memoryview(b"frame")) == 3
    assert micropython.line.gone == b"fra"


def test_a_host_on_a_uart_does_not_use_the_prompt(micropython):
    board = micropython.board(PORT=(1, 8, 9))
    uart = Uart.latest
    assert uart.set_up == (1, 115_200, 8, 9)
    data = bytearray(8)
    assert board.read(data) == 0
    uart.coming = b"\r\x03"
    assert board.read(data) == 2
    assert board.write(memoryview(b"a frame")) == 4
    board.begin(True)
    assert not board.exit_requested()
    assert micropython.interrupt == 3, "Ctrl-C on the USB socket still interrupts"


def test_the_clock_survives_its_wrap(micropython):
    board = micropython.board()
    micropython.milliseconds += 12
    assert board.elapsed() == 12


def test_ctrl_c_interrupts_only_in_the_sequence_of_mpremote(micropython):
    board = micropython.board()
    board.begin(True)
    assert micropython.interrupt == -1
    data = bytearray(64)

    def hear(sent: bytes, after: int) -> bool:
        micropython.milliseconds += after
        micropython.line.coming += sent
        while board.read(data):
            pass
        return bool(board.exit_requested())

    assert not hear(b"\x00\x03\x01\x01\x06\x01\x03", 200), "a greeting"
    assert not hear(b"\x03", 200), "half of one"
    assert not hear(b"\r\x03", 20), "in the middle of a stream"
    micropython.milliseconds += 200
    micropython.line.coming = b"\r\x03\r\x01"
    board.read(data)
    assert board.exit_requested()
    assert micropython.line.coming == b"\r\x01", "the rest is for the prompt"
    board.begin(False)
    assert (micropython.interrupt, micropython.resets) == (3, 0)


def test_a_running_watchdog_reboots_before_the_prompt(micropython):
    board = micropython.board()
    board.feed_watchdog()
    board.start_watchdog()
    board.start_watchdog()
    (watchdog,) = Watchdog.made
    board.feed_watchdog()
    assert (watchdog.timeout, watchdog.fed) == (4000, 1)
    board.begin(False)
    assert micropython.resets == 1


def test_the_buzzer_and_the_battery(micropython):
    board = micropython.board(BATTERY=(26, 3.0, 4.2, 2.0))
    board.tone(0)
    assert Pwm.made == {}
    board.tone(440)
    assert Pwm.made[22].hertz == 440
    assert Pwm.made[22].share
    board.tone(220)
    assert Pwm.made[22].hertz == 220
    board.tone(0)
    assert Pwm.made[22].share == 0
    assert board.battery() == round(1e4 * (40_000 * 3.3 / 65535 * 2 - 3.0) / 1.2)
    assert micropython.board().battery() == 10_000
    micropython.board(BUZZER=None).tone(440)


def test_the_first_error_is_kept_in_a_file(micropython, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    board = micropython.board()
    board.log_error(MemoryError("first"))
    board.log_error(MemoryError("second"))
    assert (tmp_path / "last_error.txt").read_text("utf-8") == "MemoryError('first')"


def test_the_developers_pin_keeps_the_robot_from_starting(micropython):
    table = ServoTable(servos)
    assert not micropython.hardware.developer_pin_held(table)
    Pin.grounded = {servos.DEVELOPER_PIN}
    assert micropython.hardware.developer_pin_held(table)
