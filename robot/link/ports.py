"""The serial ports of this computer and what is probably connected to them."""

from dataclasses import dataclass

from serial.tools import list_ports

_GUESSES = {
    0x6962: "a Pleo",  # source: PleoCommand, 2010
    0x2341: "an Arduino",
    0x2E8A: "a Raspberry Pi Pico",
    0x303A: "an ESP32",
    0x10C4: "a board with a CP210x USB bridge (ESP32, Petoi)",
    0x1A86: "a board with a CH340 USB bridge (Petoi, Arduino clones)",
    0x0403: "a board with an FTDI USB bridge",
}


@dataclass(frozen=True)
class SerialPort:
    """A serial port of this computer."""

    url: str
    """Device or path that `connect` takes."""

    description: str
    """Description by the operating system."""

    guess: str | None
    """The device that is probably connected; None if unknown."""

    vendor: int | None
    """USB vendor id; None for a port that is not on USB."""

    product: int | None
    """USB product id, or None."""


def serial_ports() -> list[SerialPort]:
    """List the serial ports of this computer, USB ports first; opens none of them."""
    found = [
        SerialPort(port.device, port.description or "", _GUESSES.get(port.vid), port.vid, port.pid)
        for port in list_ports.comports()
    ]
    return sorted(found, key=lambda port: (port.vendor is None, port.url))
