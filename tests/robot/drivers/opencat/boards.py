"""Boards that are hard to hear, and a host whose board is known already."""

from cubeling.robot.drivers.opencat.host import OpenCatHost
from cubeling.robot.simulators.opencat.simulator import OpenCatSimulator


class HeldBackBoard(OpenCatSimulator):
    """A board whose echoes can be held back, as if it were busy."""

    held = False

    def bytes_to_send(self) -> bytes:
        return b"" if self.held else super().bytes_to_send()


class UnheardBoard(OpenCatSimulator):
    """A board whose lines can be lost on the way."""

    held = False

    def bytes_to_send(self) -> bytes:
        said = super().bytes_to_send()
        return b"" if self.held else said


def introduced_host() -> OpenCatHost:
    """Make a host whose board has reported its model at 2 s, and was asked nothing since."""
    host = OpenCatHost()
    host.port_opened(0.0)
    host.tick(2.0)
    assert host.bytes_to_send() == b"?\n"
    host.receive(b"Bittle X\r\nB10_241013\r\n?\r\n", 2.0)
    return host
