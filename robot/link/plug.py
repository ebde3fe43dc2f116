"""A serial port that is found again, under another name if need be, after its plug was pulled.

Linux numbers USB ports as they come: what was /dev/ttyACM0 is /dev/ttyACM1 when something still
held the old name. The device is the same if its USB identity is.
"""

from typing import NamedTuple

from serial.tools import list_ports


class Identity(NamedTuple):
    """What tells one USB device from another."""

    vendor: int
    """USB vendor id."""

    product: int
    """USB product id."""

    serial: str | None
    """Its serial number; cheap boards have none."""

    socket: str | None
    """Where it is plugged in, as the system says; looked at where there is no serial number."""


def identity_of(name: str) -> Identity | None:
    """Return the identity of the USB device behind a port; None if it is none, or is not there."""
    return next((known for device, known in _present() if device == name), None)


def name_of(identity: Identity) -> str | None:
    """Return the port that a device is now behind; None unless exactly one can be it."""
    names = [device for device, known in _present() if _same(known, identity)]
    return names[0] if len(names) == 1 else None


def _same(one: Identity, other: Identity) -> bool:
    if one.serial and other.serial:
        return one[:3] == other[:3]
    return one == other


def _present() -> list[tuple[str, Identity]]:
    return [
        (port.device, Identity(port.vid, port.pid, port.serial_number, port.location))
        for port in list_ports.comports()
        if port.vid is not None
    ]
