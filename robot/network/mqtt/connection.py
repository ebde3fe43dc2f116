"""One connection to a broker, from its first byte to its last; paho speaks, we wait."""

import contextlib
import select
import socket
import ssl
import time
from collections import deque
from typing import Any

from paho.mqtt import client as paho
from paho.mqtt.enums import CallbackAPIVersion, MQTTErrorCode
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties
from paho.mqtt.reasoncodes import ReasonCode
from paho.mqtt.subscribeoptions import SubscribeOptions

from robot.network.bus import Handler, Letter
from robot.network.mqtt.access import Address
from robot.network.topics import fits

KEEPALIVE = 4
"""The broker takes a member for lost that is silent for 1.5 times this [s], and we the broker."""

ANSWER_WITHIN = 5.0
"""Longest wait for the broker's answer in each of: TCP, TLS, MQTT [s]."""

UNCONFIRMED_MAX = 100
"""Most messages on their way to the broker without its confirmation."""

PACKET_MAX = 8192
"""Longest packet that the broker may send to us [bytes]."""

CLOSE_WITHIN = 1.0
"""Longest wait for the last words to be confirmed [s]."""

QOS = 1
"""Every message is confirmed by the broker."""


class BrokerLine:
    """One connection. Nothing is left of it when it ends. Used by one thread.

    Parameters
    ----------
    address
        The broker.
    name
        The client's id.
    will
        What the broker publishes if the connection breaks.
    handlers
        What to subscribe to, in this order, and who hears it.
    waker
        A socket that becomes readable when there is something to send.
    """

    def __init__(
        self,
        address: Address,
        name: str,
        will: Letter | None,
        handlers: list[tuple[str, Handler]],
        waker: socket.socket,
    ) -> None:
        self.connected = False
        """Whether the broker has let us in."""
        self.refusal = ""
        """Why it did not."""
        self.denial = ""
        """What it did not let us publish, last."""
        self.wordless = False
        """Whether it closed the connection before it had said anything."""
        self._address = address
        self._handlers = handlers
        self._waker = waker
        self._unconfirmed: dict[int, str] = {}
        self._client = client = paho.Client(CallbackAPIVersion.VERSION2, name, protocol=paho.MQTTv5)
        client.connect_timeout = ANSWER_WITHIN
        client.max_inflight_messages_set(UNCONFIRMED_MAX)
        if address.user is not None:
            client.username_pw_set(address.user, address.password)
        if address.tls is not None:
            client.tls_set_context(address.tls)
        if will is not None:
            client.will_set(will.topic, will.payload, QOS, will.retain)
        client.on_connect = self._on_connect
        client.on_disconnect = self._on_disconnect
        client.on_message = self._on_message
        client.on_publish = self._on_publish

    def connect(self) -> None:
        """Open the connection; raises OSError. The broker's answer comes by `exchange`."""
        properties = Properties(PacketTypes.CONNECT)  # type: ignore[no-untyped-call] # paho's gap
        properties.MaximumPacketSize = PACKET_MAX
        host, port = self._address.host, self._address.port
        self._client.connect(host, port, KEEPALIVE, clean_start=True, properties=properties)

    def exchange(self, waiting: deque[Letter], wait: float) -> bool:
        """Read, and write what waits, sleeping for either at most `wait` [s]; whether it stands."""
        client = self._client
        line = client.socket()
        if line is None:
            return False
        writing = [line] if client.want_write() else []
        readable, writable, _ = select.select([line, self._waker], writing, [], wait)
        if self._waker in readable:
            with contextlib.suppress(BlockingIOError):
                self._waker.recv(4096)
        if line in readable:
            self._read()
        while self.connected and waiting and len(self._unconfirmed) < UNCONFIRMED_MAX:
            self._send(waiting.popleft())
        if writable and client.socket() is not None:
            client.loop_write()
        return client.socket() is not None and client.loop_misc() == MQTTErrorCode.MQTT_ERR_SUCCESS

    def say_goodbye(self, farewell: tuple[Letter, ...]) -> None:
        """Say the last words, wait a bounded time for their confirmation, and disconnect."""
        waiting = deque(farewell)
        end = time.monotonic() + CLOSE_WITHIN
        while (waiting or self._unconfirmed) and time.monotonic() < end:
            if not self.exchange(waiting, 0.05):
                return
        self._client.disconnect()
        self.exchange(waiting, 0.0)

    def hang_up(self) -> None:
        """Give the socket back."""
        line = self._client.socket()
        if line is not None:
            with contextlib.suppress(OSError):
                line.close()

    def _read(self) -> None:
        self._client.loop_read()
        # What TLS has decrypted already does not wake `select`.
        while isinstance(line := self._client.socket(), ssl.SSLSocket) and line.pending():
            self._client.loop_read()

    def _send(self, letter: Letter) -> None:
        info = self._client.publish(letter.topic, letter.payload, QOS, letter.retain)
        if info.rc == MQTTErrorCode.MQTT_ERR_SUCCESS:
            self._unconfirmed[info.mid] = letter.topic

    # --- What the broker says; called within `exchange` ----------------------------------------

    def _on_connect(
        self, client: paho.Client, _: Any, flags: Any, why: ReasonCode, *__: Any
    ) -> None:
        if why.is_failure:
            who = self._address.user
            as_whom = "without a user" if who is None else f"as {who!r}"
            self.refusal = f"{self._address} does not let us in {as_whom}: {why}"
            client.disconnect()
            return
        if self._handlers:
            options = SubscribeOptions(qos=QOS)
            client.subscribe([(topic_filter, options) for topic_filter, _ in self._handlers])
        self.connected = True

    def _on_disconnect(self, *_: Any) -> None:
        self.wordless = not self.connected and not self.refusal

    def _on_message(self, client: paho.Client, _: Any, message: paho.MQTTMessage) -> None:
        for topic_filter, handler in self._handlers:
            if fits(topic_filter, message.topic):
                handler(message.topic, bytes(message.payload))
                return  # one member, one inbox: overlapping filters give it once

    def _on_publish(self, client: paho.Client, _: Any, mid: int, why: ReasonCode, *__: Any) -> None:
        topic = self._unconfirmed.pop(mid, "")
        if why.is_failure:
            self.denial = f"{self._address} does not let us publish to {topic}: {why}"
