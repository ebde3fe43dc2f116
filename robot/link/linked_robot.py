"""A robot on a port, as the rest of the program uses it."""

from collections.abc import Mapping
from dataclasses import replace

from cubeling.affect import Emotion
from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.contract.closeable import Closeable
from cubeling.robot.contract.driver import Driver
from cubeling.robot.contract.moves import joint_move
from cubeling.robot.contract.port import Clock
from cubeling.robot.contract.telemetry import Telemetry
from cubeling.robot.errors import RobotError
from cubeling.robot.link.exchange import PortExchange
from cubeling.robot.protocol import messages as m


class Robot(Closeable):
    """A robot on a port. Made by `connect`; close it, or use it in a `with` statement.

    No method waits for the robot: `telemetry.state` is the state of the link, and `check()` raises
    if the robot cannot be reached. After an unplugging or a reboot the link recovers by itself and
    sends the last emotion again.
    """

    def __init__(self, url: str, exchange: PortExchange, driver: Driver, clock: Clock) -> None:
        self.url = url
        """Its port."""
        self._driver, self._clock, self._exchange = driver, clock, exchange
        self._expressed: Emotion | None = None

    def express(self, emotion: Emotion) -> None:
        """Let the robot show an emotion from now on; the latest wins. Never waits, never raises.

        Parameters
        ----------
        emotion
            Valence and arousal, and optionally a word, "happy". Of the robot's own words for its
            moods, the one closest to that word is shown; without a word the robot chooses.
        """
        if self._expressed == emotion:
            return  # every frame of a session asks; only a new emotion is worth waking the link
        with self._exchange.lock:
            self._expressed = emotion
            self._driver.express(emotion)
        self._exchange.wake()

    def play(self, name: str) -> None:
        """Play one of the robot's motions or sounds once.

        It is played at most once and never late: if the link is lost before the robot takes it, it
        is dropped and counted.

        Raises
        ------
        RobotError
            If the robot has nothing of that name, or too many are waiting.
        """
        catalogue = self.catalogue
        if name in catalogue.motions:
            item, index = m.ITEM_MOTION, catalogue.motions.index(name)
        elif name in catalogue.sounds:
            item, index = m.ITEM_SOUND, catalogue.sounds.index(name)
        else:
            known = ", ".join(catalogue.motions + catalogue.sounds)
            raise RobotError(f"{catalogue.name} cannot play {name!r}; it knows {known}")
        with self._exchange.lock:
            taken = self._driver.play(item, index)
        if not taken:
            raise RobotError(f"{name!r} is one too many: the robot has not played the others yet")
        self._exchange.wake()

    def move(self, angles: Mapping[str, float | None], duration: float = 0.0) -> None:
        """Turn single joints, and hold them there; all others follow mood and motion as before.

        They are held until a later move, `stop`, or the end of the session, and no faster than
        their top speed. A move takes effect at most once, and never late, as in `play`.

        Parameters
        ----------
        angles
            The angle of each joint by name [rad]; None lets go of a joint.
        duration
            Time for the way [s]; 0 for as fast as the joints can.

        Raises
        ------
        RobotError
            If this robot does not turn single joints, an angle or the duration is out of its
            range, or too many moves are waiting.
        """
        catalogue = self.catalogue
        with self._exchange.lock:
            mover = self._driver.joint_mover
            if mover is None:
                raise RobotError(f"the joints of {catalogue.name} cannot be turned one by one")
            taken = mover.move(joint_move(catalogue, angles, duration))
        if not taken:
            raise RobotError("one move too many: the robot has not begun the others yet")
        self._exchange.wake()

    @property
    def moves_joints(self) -> bool:
        """Whether `move` works with this robot."""
        with self._exchange.lock:
            return self._driver.joint_mover is not None

    def stop(self) -> None:
        """End everything, let go of the joints, and hold the neutral pose until another request."""
        with self._exchange.lock:
            self._expressed = None
            self._driver.stop()
        self._exchange.wake()

    @property
    def telemetry(self) -> Telemetry:
        """What is known of the robot now."""
        with self._exchange.lock:
            telemetry = self._driver.telemetry(self._clock())
        discarded = self._exchange.discarded
        if not discarded:
            return telemetry
        return replace(telemetry, counts=replace(telemetry.counts, discarded=discarded))

    @property
    def catalogue(self) -> Catalogue:
        """What the robot has."""
        with self._exchange.lock:
            if self._driver.catalogue is None:
                raise RobotError(f"the robot on {self.url} has not introduced itself yet")
            return self._driver.catalogue

    def check(self) -> None:
        """Raise RobotError if the robot cannot be reached now."""
        failure = self._exchange.failure
        if failure is not None:
            raise RobotError(f"the link to {self.url} broke: {failure!r}") from failure
        telemetry = self.telemetry
        if telemetry.state in ("ready", "degraded"):
            return
        reasons = {"connecting": "has not answered yet", "closed": "was closed"}
        reason = reasons.get(telemetry.state, "has fallen silent")
        silent = "" if telemetry.silence is None else f" (last heard {telemetry.silence:.1f} s ago)"
        raise RobotError(f"the robot on {self.url} {reason}{silent}")

    def wait_until_ready(self, timeout: float) -> bool:
        """Wait at most `timeout` seconds until the link is ready; return whether it is."""
        received, closing = self._exchange.received, self._exchange.closing
        with received:
            return received.wait_for(self._is_decided, timeout) and not closing.is_set()

    def _is_decided(self) -> bool:
        """Return whether the link is ready or has ended."""
        state = self._driver.state(self._clock())
        return self._exchange.closing.is_set() or state in ("ready", "degraded")

    def close(self) -> None:
        """End the session and the thread, and close the port. A second call does nothing."""
        self._exchange.close()
