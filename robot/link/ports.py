"""Which serial ports there are, and what is probably plugged into them."""

from dataclasses import dataclass

from serial.tools import list_ports

PLEO_VENDOR = 0x6962
"""USB vendor id of Ugobe's Pleo (source: PleoCommand, 2010)."""

_GUESSES = {
    PLEO_VENDOR: "a Pleo",
    0x2341: "an Arduino",
    0x2E8A: "a Raspberry Pi Pico",
    0x303A: "an ESP32",
    0x10C4: "a board with a CP210x USB bridge (ESP32, Petoi)",
    0x1A86: "a board with a CH340 USB bridge (Petoi, Arduino clones)",
    0x0403: "a board with an FTDI USB bridge",
}


@dataclass(frozen=True)
class SerialPort:
    """A serial port of this machine."""

    url: str
    """What `connect` opens."""

    description: str
    """What the system says of it."""

    guess: str | None
    """What is probably plugged in; None where there is no hint."""

    vendor: int | None
    """USB vendor id, or None where it is not a USB port."""

    product: int | None
    """USB product id, or None."""


def guess(vendor: int | None) -> str | None:
    """Say what a USB vendor id hints at.

    >>> guess(0x6962)
    'a Pleo'
    """
    return None if vendor is None else _GUESSES.get(vendor)


def serial_ports() -> list[SerialPort]:
    """List the serial ports of this machine, USB ones first; opens none of them."""
    found = [
        SerialPort(port.device, port.description or "", guess(port.vid), port.vid, port.pid)
        for port in list_ports.comports()
    ]
    return sorted(found, key=lambda port: (port.vendor is None, port.url))
