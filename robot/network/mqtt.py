"""The bus over a broker: one thread that connects, reads and writes, again and again."""

import contextlib
import select
import socket
import ssl
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any

from paho.mqtt import client as paho
from paho.mqtt.enums import CallbackAPIVersion, MQTTErrorCode
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties
from paho.mqtt.reasoncodes import ReasonCode
from paho.mqtt.subscribeoptions import SubscribeOptions

from robot.errors import RobotError
from robot.network.access import Address
from robot.network.bus import BusState, Handler, Letter
from robot.network.topics import fits

KEEPALIVE = 4
"""The broker takes a member for lost that is silent for 1.5 times this [s], and we the broker."""

ANSWER_WITHIN = 5.0
"""Longest wait for the broker's answer in each of: TCP, TLS, MQTT [s]."""

VERDICT_WITHIN = 6.0
"""Longest wait of `open` [s]; then the broker counts as away, and is tried on."""

RETRY_FIRST, RETRY_LAST = 0.1, 5.0
"""Pause before the next attempt to connect: doubles from the one to the other [s]."""

UNCONFIRMED_MAX = 100
"""Most messages on their way to the broker without its confirmation."""

WAITING_MAX = 100
"""Most messages that wait for those; more are not taken."""

PACKET_MAX = 8192
"""Longest packet that the broker may send to us [bytes]."""

POLL = 0.25
"""Longest sleep of the thread [s]."""

CLOSE_WITHIN = 1.0
"""Longest wait for the last words to be confirmed [s]."""

QOS = 1
"""Every message is confirmed by the broker."""

_REASONS = {
    "refused": "nobody listens there",
    "timed out": "nobody answers there",
    "not known": "there is no such host",
    "No address": "there is no such host",
    "resolution": "there is no such host",
    "unreachable": "the network does not reach it",
    "reset": "it closed the connection",
}


class MqttBus:
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
        self._address = address
        self._name = name
        self._handlers: list[tuple[str, Handler]] = []
        self._will: Letter | None = None
        self._hook: Callable[[], None] = lambda: None
        self._state: BusState = "connecting"
        self._trouble = ""
        self._connections = 0
        self._verdict = threading.Event()
        self._closing = threading.Event()
        self._waiting: deque[Letter] = deque()
        self._farewell: tuple[Letter, ...] = ()
        self._unconfirmed: dict[int, str] = {}
        self._ended: str | None = None
        self._wake_reader, self._wake_writer = socket.socketpair()
        self._wake_reader.setblocking(False)
        self._wake_writer.setblocking(False)
        self._thread = threading.Thread(target=self._run, name=f"mqtt {name}", daemon=True)

    @property
    def state(self) -> BusState:
        """How the connection is."""
        return self._state

    @property
    def trouble(self) -> str:
        """Why it is not connected, or what the broker did not allow; in one line."""
        return self._trouble

    @property
    def connections(self) -> int:
        """How often it has been connected."""
        return self._connections

    def subscribe(self, topic_filter: str, handler: Handler) -> None:
        """Hear what is published there, now and after every reconnection; before `open`."""
        self._handlers.append((topic_filter, handler))

    def will(self, letter: Letter) -> None:
        """Leave a last will; before `open`."""
        self._will = letter

    def on_change(self, hook: Callable[[], None]) -> None:
        """Call this whenever the connection changes; before `open`."""
        self._hook = hook

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
            known, self._ended = self._connections, None
            client = self._client()
            try:
                client.connect(
                    self._address.host, self._address.port, KEEPALIVE, clean_start=True,
                    properties=_properties(PacketTypes.CONNECT, MaximumPacketSize=PACKET_MAX),
                )  # fmt: skip
                self._serve(client)
            except Exception as error:  # whatever it is, the thread must go on
                self._fail(error)
            self._hang_up(client)
            if self._connections != known:
                pause = RETRY_FIRST
            self._closing.wait(RETRY_LAST if self._state == "refused" else pause)
            pause = min(2 * pause, RETRY_LAST)
        self._close_wakers()

    def _serve(self, client: paho.Client) -> None:
        """Read and write until the connection ends."""
        began = time.monotonic()
        while not self._closing.is_set():
            if not self._exchange(client, POLL):
                break
            if self._state != "connected" and time.monotonic() - began > ANSWER_WITHIN:
                self._ended = "nobody speaks MQTT there"
                break
        if self._closing.is_set() and self._state == "connected":
            self._say_goodbye(client)
        elif self._ended is None:
            self._ended = "the connection broke"
        if self._ended is not None and self._state != "refused":
            self._change("away", f"{self._address}: {self._ended}")

    def _exchange(self, client: paho.Client, wait: float) -> bool:
        """Read and write once, waiting for either; whether the connection still stands."""
        line = client.socket()
        if line is None:
            return False
        writing = [line] if client.want_write() else []
        readable, writable, _ = select.select([line, self._wake_reader], writing, [], wait)
        if self._wake_reader in readable:
            with contextlib.suppress(BlockingIOError):
                self._wake_reader.recv(4096)
        if line in readable:
            self._read(client)
        while self._waiting and len(self._unconfirmed) < UNCONFIRMED_MAX:
            self._send(client, self._waiting.popleft())
        if writable and client.socket() is not None:
            client.loop_write()
        return client.socket() is not None and client.loop_misc() == MQTTErrorCode.MQTT_ERR_SUCCESS

    def _read(self, client: paho.Client) -> None:
        client.loop_read()
        # What TLS has decrypted already does not wake `select`.
        while isinstance(line := client.socket(), ssl.SSLSocket) and line.pending():
            client.loop_read()

    def _send(self, client: paho.Client, letter: Letter) -> None:
        info = client.publish(letter.topic, letter.payload, QOS, letter.retain)
        if info.rc == MQTTErrorCode.MQTT_ERR_SUCCESS:
            self._unconfirmed[info.mid] = letter.topic

    def _say_goodbye(self, client: paho.Client) -> None:
        for letter in self._farewell:
            self._send(client, letter)
        end = time.monotonic() + CLOSE_WITHIN
        while (self._unconfirmed or self._waiting) and time.monotonic() < end:
            if not self._exchange(client, 0.05):
                return
        client.disconnect()
        self._exchange(client, 0.0)

    def _hang_up(self, client: paho.Client) -> None:
        self._waiting.clear()
        self._unconfirmed.clear()
        line = client.socket()
        if line is not None:
            with contextlib.suppress(OSError):
                line.close()

    # --- What the broker says ------------------------------------------------------------------

    def _client(self) -> paho.Client:
        """Make a client that knows nothing of earlier connections."""
        client = paho.Client(CallbackAPIVersion.VERSION2, self._name, protocol=paho.MQTTv5)
        client.connect_timeout = ANSWER_WITHIN
        client.max_inflight_messages_set(UNCONFIRMED_MAX)
        if self._address.user is not None:
            client.username_pw_set(self._address.user, self._address.password)
        if self._address.tls is not None:
            client.tls_set_context(self._address.tls)
        if self._will is not None:
            client.will_set(self._will.topic, self._will.payload, QOS, self._will.retain)
        client.on_connect = self._on_connect
        client.on_disconnect = self._on_disconnect
        client.on_message = self._on_message
        client.on_publish = self._on_publish
        return client

    def _on_connect(
        self, client: paho.Client, _: Any, flags: Any, why: ReasonCode, *__: Any
    ) -> None:
        if why.is_failure:
            who = self._address.user
            as_whom = "without a user" if who is None else f"as {who!r}"
            self._ended = f"{why}"
            self._change("refused", f"{self._address} does not let us in {as_whom}: {why}")
            client.disconnect()
            return
        options = SubscribeOptions(qos=QOS)
        if self._handlers:
            client.subscribe([(topic_filter, options) for topic_filter, _ in self._handlers])
        self._connections += 1
        self._change("connected", "")

    def _on_disconnect(
        self, client: paho.Client, _: Any, flags: Any, why: ReasonCode, *__: Any
    ) -> None:
        if self._state != "connected" and self._ended is None:
            self._ended = "it closed the connection without a word; does it want TLS (mqtts://)?"

    def _on_message(self, client: paho.Client, _: Any, message: paho.MQTTMessage) -> None:
        for topic_filter, handler in self._handlers:
            if fits(topic_filter, message.topic):
                handler(message.topic, bytes(message.payload))
                return  # one member, one inbox: overlapping filters give it once

    def _on_publish(self, client: paho.Client, _: Any, mid: int, why: ReasonCode, *__: Any) -> None:
        topic = self._unconfirmed.pop(mid, "")
        if why.is_failure:
            self._trouble = f"{self._address} does not let us publish to {topic}: {why}"
            self._hook()

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
        self._state, self._trouble = state, trouble
        if state != "connecting":
            self._verdict.set()
        self._hook()

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


def _properties(packet: int, **values: Any) -> Properties:
    properties = Properties(packet)  # type: ignore[no-untyped-call] # paho leaves it out
    for name, value in values.items():
        setattr(properties, name, value)
    return properties
