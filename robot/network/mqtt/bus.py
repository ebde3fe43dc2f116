"""The bus over an MQTT 5 broker: paho's client, its thread, its reconnection and its queue."""

import contextlib
import ssl
import sys
import threading
from typing import Any

from paho.mqtt import client as paho
from paho.mqtt.enums import CallbackAPIVersion, MQTTErrorCode
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties
from paho.mqtt.reasoncodes import ReasonCode
from paho.mqtt.subscribeoptions import SubscribeOptions

from cubeling.robot.errors import RobotError
from cubeling.robot.network.bus import Bus, BusState, Message
from cubeling.robot.network.mqtt.access import Address
from cubeling.robot.network.topics import topic_matches

KEEPALIVE_S = 4
"""Keepalive interval [s]: the broker drops a client after 1.5 times as long without a packet."""

CONNECT_TIMEOUT_S = 5.0
"""Longest wait for a TCP connection [s]; TLS and the answer to CONNECT each have `KEEPALIVE_S`."""

OPEN_TIMEOUT_S = 6.0
"""Longest wait of `open` [s]; then the broker counts as away, and is tried again."""

CLOSE_TIMEOUT_S = 1.0
"""Longest wait for the confirmation of the last messages, and for paho's thread to end [s]."""

MIN_RETRY_DELAY_S, MAX_RETRY_DELAY_S = 0.1, 5.0
"""Delay before the next connection attempt: doubles from the first to the second [s]."""

MAX_QUEUED = 100
"""Most messages without the broker's confirmation; `publish` takes no more."""

MAX_PACKET_BYTES = 8192
"""Longest packet that the broker may send to us [bytes]."""

QOS = 1
"""The broker confirms every message."""

_REASONS = {
    "refused": "no broker listens there",
    "timed out": "no answer",
    "not known": "there is no such host",
    "No address": "there is no such host",
    "resolution": "there is no such host",
    "unreachable": "the network does not reach it",
    "reset": "it closed the connection",
}
"""Parts of the systems' error messages, and what they mean."""


class MqttBus(Bus):
    """One member's connection to an MQTT 5 broker; see `Bus`.

    The broker keeps no session between connections. Messages without confirmation are sent again
    after a reconnection, before everything that the member publishes then; so a topic always ends
    with the latest message.

    Parameters
    ----------
    address
        The broker.
    client_id
        The client's id at the broker; another one for every member and session.
    """

    def __init__(self, address: Address, client_id: str) -> None:
        super().__init__()
        self._address = address
        self._answered = threading.Event()
        self._closing = False
        self._confirming = threading.Lock()  # guards the next two; never held during a call of paho
        self._topics: dict[int, str] = {}  # of the messages without confirmation, by their id
        self._early_reasons: dict[int, ReasonCode] = {}  # confirmed before `publish` knew the id
        self._last_sent: paho.MQTTMessageInfo | None = None
        client = paho.Client(CallbackAPIVersion.VERSION2, client_id, protocol=paho.MQTTv5)
        client.connect_timeout = CONNECT_TIMEOUT_S
        client.max_inflight_messages_set(MAX_QUEUED)
        client.max_queued_messages_set(MAX_QUEUED)
        client.reconnect_delay_set(MIN_RETRY_DELAY_S, MAX_RETRY_DELAY_S)  # type: ignore[arg-type]
        if address.user is not None:
            client.username_pw_set(address.user, address.password)
        if address.tls is not None:
            client.tls_set_context(address.tls)
        client.on_connect = self._on_connect
        client.on_connect_fail = self._on_connect_fail
        client.on_disconnect = self._on_disconnect
        client.on_message = self._on_message
        client.on_publish = self._on_publish
        self._client = client

    def open(self) -> None:
        """Connect, and wait up to `OPEN_TIMEOUT_S`.

        Raises
        ------
        RobotError
            If the broker can be reached and refuses our user, password or certificate, or we its.
        """
        client, will = self._client, self._will
        if will is not None:
            client.will_set(will.topic, will.payload, QOS, will.retain)
        properties = Properties(PacketTypes.CONNECT)  # type: ignore[no-untyped-call] # paho's gap
        properties.MaximumPacketSize = MAX_PACKET_BYTES
        client.connect_async(
            self._address.host,
            self._address.port,
            KEEPALIVE_S,
            clean_start=True,
            properties=properties,
        )
        client.loop_start()
        self._answered.wait(OPEN_TIMEOUT_S)
        if self._state == "refused":
            problem = self._problem
            self.close()
            raise RobotError(problem)

    def publish(self, message: Message) -> bool:
        """Send a message; False if there is no connection, or the queue is full. Never blocks."""
        if self._state != "connected":
            return False
        info = self._client.publish(message.topic, message.payload, QOS, message.retain)
        if info.rc == MQTTErrorCode.MQTT_ERR_QUEUE_SIZE:
            return False
        self._last_sent = info
        with self._confirming:
            reason = self._early_reasons.pop(info.mid, None)
            if reason is None:
                self._topics[info.mid] = message.topic
        if reason is not None:
            self._note_confirmation(message.topic, reason)
        return True

    def close(self, closing_messages: tuple[Message, ...] = ()) -> None:
        """Publish the last messages if possible, and disconnect. A second call does nothing."""
        if self._closing:
            return
        connected = self._state == "connected"
        for message in closing_messages:
            self.publish(message)
        self._closing = True
        if connected and self._last_sent is not None:
            with contextlib.suppress(RuntimeError):  # the connection broke
                self._last_sent.wait_for_publish(CLOSE_TIMEOUT_S)
        self._client.disconnect()
        # paho waits without a limit for its thread, which may be connecting or have a full queue.
        stop = threading.Thread(target=self._client.loop_stop, daemon=True)
        stop.start()
        stop.join(CLOSE_TIMEOUT_S)
        self._change("closed", "")

    # --- Callbacks, on paho's thread -----------------------------------------------------------

    def _on_connect(self, client: Any, _: Any, flags: Any, reason: ReasonCode, *__: Any) -> None:
        if self._closing:
            client.disconnect()
            return
        if reason.is_failure:
            user = self._address.user
            identity = "without a user" if user is None else f"as {user!r}"
            self._change("refused", f"{self._address} does not let us in {identity}: {reason}")
            return
        if self.subscriptions:
            options = SubscribeOptions(qos=QOS)
            client.subscribe([(topic_filter, options) for topic_filter, _ in self.subscriptions])
        self.connections += 1
        self._change("connected", "")

    def _on_connect_fail(self, *_: Any) -> None:
        """Report why there is no connection; paho calls this while it handles the exception."""
        error = sys.exc_info()[1]
        if isinstance(error, ssl.SSLCertVerificationError):
            reason = error.verify_message or error.reason
            self._change(
                "refused",
                f"{self._address} has an untrusted certificate: {reason}; is the CA file right?",
            )
        elif isinstance(error, ssl.SSLError):
            self._change("refused", f"{self._address}: the TLS handshake failed: {error.reason}")
        else:
            reset = self._address.tls is not None and isinstance(error, ConnectionResetError)
            hint = "; does it speak TLS there?" if reset else ""
            self._change("away", f"{self._address}: {_describe(error)}{hint}")

    def _on_disconnect(self, client: Any, _: Any, flags: Any, reason: ReasonCode, *__: Any) -> None:
        if self._state == "connected":
            self._change("away", f"{self._address}: the connection broke")
        elif self._state != "refused":
            timeout = reason.getName() == "Keep alive timeout"
            hint = "is there an MQTT broker" if timeout else "does it want TLS (mqtts://)"
            self._change("away", f"{self._address}: no answer to CONNECT; {hint}?")

    def _on_message(self, client: paho.Client, _: Any, message: paho.MQTTMessage) -> None:
        for topic_filter, handler in self.subscriptions:
            if topic_matches(topic_filter, message.topic):
                handler(message.topic, bytes(message.payload))
                return  # overlapping filters deliver it once

    def _on_publish(self, client: Any, _: Any, mid: int, reason: ReasonCode, *__: Any) -> None:
        with self._confirming:
            topic = self._topics.pop(mid, None)
            if topic is None:
                self._early_reasons[mid] = reason
        if topic is not None:
            self._note_confirmation(topic, reason)

    def _note_confirmation(self, topic: str, reason: ReasonCode) -> None:
        """Report a message that the broker refused."""
        if reason.is_failure:
            problem = f"{self._address} does not let us publish to {topic}: {reason}"
            if problem != self._problem:
                self._change(self._state, problem)

    def _change(self, state: BusState, problem: str) -> None:
        if self._closing and state != "closed":
            return
        super()._change(state, problem)
        self._answered.set()


def _describe(error: BaseException | None) -> str:
    text = " ".join(str(error).split())
    for part, meaning in _REASONS.items():
        if part in text:
            return meaning
    return text or type(error).__name__
