"""The bus over a broker: one thread that connects, reads and writes, again and again."""

import contextlib
import socket
import ssl
import threading
import time
from collections import deque

from robot.errors import RobotError
from robot.network.bus import Bus, BusState, Letter
from robot.network.mqtt.access import Address
from robot.network.mqtt.connection import ANSWER_WITHIN, CLOSE_WITHIN, BrokerLine

VERDICT_WITHIN = 6.0
"""Longest wait of `open` [s]; then the broker counts as away, and is tried on."""

RETRY_FIRST, RETRY_LAST = 0.1, 5.0
"""Pause before the next attempt to connect: doubles from the one to the other [s]."""

WAITING_MAX = 100
"""Most messages that wait to be sent; more are not taken."""

POLL = 0.25
"""Longest sleep of the thread [s]."""

_REASONS = {
    "refused": "nobody listens there",
    "timed out": "nobody answers there",
    "not known": "there is no such host",
    "No address": "there is no such host",
    "resolution": "there is no such host",
    "unreachable": "the network does not reach it",
    "reset": "it closed the connection",
}
"""Signs in the systems' messages, and what they mean."""


class MqttBus(Bus):
    """One member's connection to an MQTT 5 broker; see `Bus`.

    Every connection begins with nothing: the broker keeps no session; the member says all again.

    Parameters
    ----------
    address
        The broker.
    name
        The client's id: another one for every member and run.
    """

    def __init__(self, address: Address, name: str) -> None:
        super().__init__()
        self._address = address
        self._name = name
        self._verdict = threading.Event()
        self._closing = threading.Event()
        self._waiting: deque[Letter] = deque()
        self._farewell: tuple[Letter, ...] = ()
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._wake_reader.setblocking(False)
        self._wake_writer.setblocking(False)
        self._thread = threading.Thread(target=self._run, name=f"mqtt {name}", daemon=True)

    def open(self) -> None:
        """Connect, and wait for the broker's verdict, at most `VERDICT_WITHIN`.

        Raises
        ------
        RobotError
            If the broker is there and refuses: user, password, certificate.
        """
        self._thread.start()
        self._verdict.wait(VERDICT_WITHIN)
        if self._state == "refused":
            trouble = self._trouble
            self.close()
            raise RobotError(trouble)

    def publish(self, letter: Letter) -> bool:
        """Hand over a message; False if there is no connection, or too many wait. Never waits."""
        if self._state != "connected" or len(self._waiting) >= WAITING_MAX:
            return False
        self._waiting.append(letter)
        self._wake()
        return True

    def close(self, farewell: tuple[Letter, ...] = ()) -> None:
        """Publish the last words if possible, and end. A second call does nothing."""
        if self._closing.is_set():
            return
        self._farewell = farewell
        self._closing.set()
        self._wake()
        if self._thread.ident is None:
            self._close_wakers()  # never opened
        else:
            self._thread.join(CLOSE_WITHIN + POLL)
        self._change("closed", "")

    # --- The thread ----------------------------------------------------------------------------

    def _run(self) -> None:
        pause = RETRY_FIRST
        while not self._closing.is_set():
            line = BrokerLine(
                self._address, self._name, self._will, self.handlers, self._wake_reader
            )
            try:
                line.connect()
                self._serve(line)
            except Exception as error:  # whatever it is, the thread must go on
                self._fail(error)
            line.hang_up()
            self._waiting.clear()
            if line.connected:
                pause = RETRY_FIRST
            self._closing.wait(RETRY_LAST if self._state == "refused" else pause)
            pause = min(2 * pause, RETRY_LAST)
        self._close_wakers()

    def _serve(self, line: BrokerLine) -> None:
        """Read and write until the connection ends."""
        began = time.monotonic()
        ended = "the connection broke"
        while not self._closing.is_set():
            stands = line.exchange(self._waiting, POLL)
            self._follow(line)
            if not stands:
                break
            if not line.connected and time.monotonic() - began > ANSWER_WITHIN:
                ended = "nobody speaks MQTT there"
                break
        if self._closing.is_set() and line.connected:
            line.say_goodbye((*self._waiting, *self._farewell))
        elif line.refusal:
            self._change("refused", line.refusal)
        else:
            if line.wordless:
                ended = "it closed the connection without a word; does it want TLS (mqtts://)?"
            self._change("away", f"{self._address}: {ended}")

    def _follow(self, line: BrokerLine) -> None:
        """Take over what has become of the connection."""
        if line.connected and self._state != "connected":
            self.connections += 1
            self._change("connected", "")
        if line.denial and line.denial != self._trouble:
            self._change(self._state, line.denial)

    def _fail(self, error: Exception) -> None:
        """Say why no connection came about; a bad certificate is a refusal."""
        if isinstance(error, ssl.SSLCertVerificationError):
            why = error.verify_message or error.reason
            self._change(
                "refused",
                f"{self._address} shows a certificate that is not to be trusted: {why}; "
                "is the CA file the right one?",
            )
        elif isinstance(error, ssl.SSLError):
            self._change("refused", f"{self._address}: no TLS comes about: {error.reason}")
        else:
            secret = self._address.tls is not None and isinstance(error, ConnectionResetError)
            hint = "; does it speak TLS there?" if secret else ""
            self._change("away", f"{self._address}: {_reason(error)}{hint}")

    def _change(self, state: BusState, trouble: str) -> None:
        super()._change(state, trouble)
        if state != "connecting":
            self._verdict.set()

    def _close_wakers(self) -> None:
        for end in (self._wake_reader, self._wake_writer):
            end.close()

    def _wake(self) -> None:
        with contextlib.suppress(OSError):  # full: it is awake already; closed: it has ended
            self._wake_writer.send(b"\0")


def _reason(error: Exception) -> str:
    text = " ".join(str(error).split())
    for sign, words in _REASONS.items():
        if sign in text:
            return words
    return text or type(error).__name__
