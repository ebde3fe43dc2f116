"""A whole simulated robot: the protocol's other end and a body, in virtual or in real time."""

from robot.simulators.cubeling.body import DinosaurBody
from robot.simulators.cubeling.device import DeviceLink


class Simulator:
    """A simulated dinosaur robot that speaks the protocol "cubeling".

    It has no clock: it lives until the time that it is told.

    Parameters
    ----------
    seed
        Of everything in it that is drawn.
    """

    edge = b"\0"
    """Every frame ends with it."""

    def __init__(self, seed: int = 0) -> None:
        self._seed = seed
        self.body = DinosaurBody(seed)
        """The body, for those who want to look inside."""
        self.link = DeviceLink(self.body)
        """Its end of the protocol."""

    def receive(self, data: bytes, now: float) -> None:
        """Take bytes from the line at time `now` [s]."""
        self.advance(now)
        self.link.receive(data, now)

    def advance(self, now: float) -> None:
        """Live until time `now` [s]."""
        self.body.advance(now)
        self.link.tick(now)

    def bytes_to_send(self) -> bytes:
        """Return what is to be written to the line, once."""
        return self.link.bytes_to_send()

    def reboot(self) -> None:
        """Lose power and come back: the protocol's memory and the feelings are gone."""
        self.body = DinosaurBody(self._seed)
        self.link = DeviceLink(self.body)

    def portrait(self) -> tuple[float, str]:
        """Return what it shows now: the mood from angry, −1, to happy, 1, and the word for it."""
        return self.body.feeling.valence, self.body.label
