"""The simulated dinosaur: the robot side of the protocol and a body."""

from cubeling.robot.simulators.cubeling.body import DinosaurBody
from cubeling.robot.simulators.cubeling.device import DeviceLink


class Simulator:
    """A simulated dinosaur robot with the protocol "cubeling"; a `Simulated`.

    It has no clock: the caller advances it to a time.

    Parameters
    ----------
    seed
        Seed of everything random in it: the noise of its sensors and its first battery level.
    """

    edge = b"\0"
    """Every frame ends with it."""

    def __init__(self, seed: int = 0) -> None:
        self._seed = seed
        self.body = DinosaurBody(seed)
        """The body, for inspection."""
        self.link = DeviceLink(self.body)
        """The robot side of the protocol."""

    def receive(self, data: bytes, now: float) -> None:
        """Process received bytes at time `now` [s]."""
        self.advance(now)
        self.link.receive(data, now)

    def advance(self, now: float) -> None:
        """Advance to time `now` [s]."""
        self.body.advance(now)
        self.link.tick(now)

    def bytes_to_send(self) -> bytes:
        """Return the bytes to write, once."""
        return self.link.bytes_to_send()

    def reboot(self) -> None:
        """Restart, as after a loss of power: session, last command and emotion are gone."""
        self.body = DinosaurBody(self._seed)
        self.link = DeviceLink(self.body)

    def portrait(self) -> tuple[float, str]:
        """Return the mood that it shows, from −1, angry, to 1, happy, and its word."""
        return self.body.emotion.valence, self.body.label
