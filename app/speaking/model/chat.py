"""A language model behind an address that speaks the protocol of OpenAI's chat completions.

Only the standard library, and only the address that the user names: no proxy of the environment is
used, and no redirection followed.
"""

import http.client
import json
import os
import socket
import ssl
import threading
from collections import deque
from collections.abc import Collection
from contextlib import suppress
from urllib.parse import SplitResult, urlsplit

import msgspec

from cubeling.affect import Emotion
from cubeling.app.errors import AppError
from cubeling.app.speaking.model.protocol import TIMEOUT_S, ModelError
from cubeling.app.speaking.model.tagged_reply import tagged_reply
from cubeling.characters.behaviour import DialogueScript
from cubeling.toml_file import printable

KEY_VARIABLE = "CUBELING_MODEL_KEY"
"""The variable of the environment that holds the key of the address, if it needs one."""

MAX_ANSWER_BYTES = 262_144
"""Largest answer that is read [B]: a thousand times what is said."""

MAX_TOKENS = 120
"""Longest reply that is asked for, in the model's own parts of words."""

MAX_REMEMBERED_LINES = 12
"""Lines of both sides that are sent along."""

LANGUAGES = {"en": "English", "es": "Spanish"}
"""Names of languages by their codes."""


class _Message(msgspec.Struct):
    content: str


class _Choice(msgspec.Struct):
    message: _Message


class _Completion(msgspec.Struct):
    choices: list[_Choice]


class ChatModel:
    """A `LanguageModel` at an address.

    Parameters
    ----------
    url
        The address, up to and with `/v1`.
    name
        The model's name there.
    script
        The dialogue, for what the model is told of itself.
    gestures
        Those that its tags may name.
    timeout
        How long an answer may take [s].

    Raises
    ------
    AppError
        The address or the key cannot be used.
    """

    def __init__(
        self,
        url: str,
        name: str,
        script: DialogueScript,
        gestures: Collection[str],
        timeout: float = TIMEOUT_S,
    ) -> None:
        self._url, self._name, self._timeout = checked_url(url), name, timeout
        self._key = os.environ.get(KEY_VARIABLE, "")
        if not (self._key.isascii() and self._key.isprintable()):
            raise AppError(f"the key in {KEY_VARIABLE} has characters that no key has")
        self._gestures = gestures
        self.note = ""
        """What was left out of the last reply."""
        some = ", ".join(sorted(gestures)[:40])
        self._persona = (
            f"{script.summary}. You are that character, and talk with a child: kindly, in one or "
            "two short sentences, without emoji, Markdown or lists. You may perform a gesture "
            'while you say some words: <begin_gesture id="g1" anim="nod"/>words<end_gesture '
            f'id="g1"/>. Gestures: {some or "none"}.'
        )
        self._lines: deque[dict[str, str]] = deque(maxlen=MAX_REMEMBERED_LINES)

    def reply(self, text: str, emotion: Emotion) -> str:
        """Return what the character says; see `LanguageModel`."""
        asked = {"role": "user", "content": text}
        told = f"{self._persona} You feel {emotion.label}. Answer in the language of the child."
        body = {
            "model": self._name,
            "messages": [{"role": "system", "content": told}, *self._lines, asked],
            "max_tokens": MAX_TOKENS,
            "stream": False,
        }
        data = _post(self._url, json.dumps(body).encode(), self._key, self._timeout)
        try:
            found = msgspec.json.decode(data, type=_Completion)
        except (msgspec.MsgspecError, RecursionError) as error:
            why = printable(str(error))[:100]
            raise ModelError(f"the model's answer is no chat completion: {why}") from error
        if not found.choices:
            raise ModelError("the model's answer has no choices")
        said, self.note = tagged_reply(found.choices[0].message.content, self._gestures)
        self._lines += [asked, {"role": "assistant", "content": said}]
        return said

    def remember(self, said: str) -> None:
        """Take what the character has said by itself."""
        self._lines.append({"role": "assistant", "content": said})


def checked_url(url: str) -> SplitResult:
    """Return the parts of an address; AppError if it is none."""
    try:
        parts = urlsplit(url)
        port_is_good = parts.port != 0
    except ValueError:
        parts, port_is_good = SplitResult("", "", "", "", ""), False
    good = parts.scheme in ("http", "https") and parts.hostname and port_is_good
    if not good or parts.username or parts.query or parts.fragment or not url.isprintable():
        raise AppError(
            f"--model {printable(url):.80}: give an address such as http://localhost:11434/v1; a "
            f"key goes into {KEY_VARIABLE}"
        )
    return parts


def _post(url: SplitResult, body: bytes, key: str, timeout: float) -> bytes:
    """Return what an address answers; ModelError after a bounded time."""
    assert url.hostname is not None
    where = f"the model at {url.hostname}"
    headers = {"Content-Type": "application/json", "Accept": "application/json"}
    if key:
        headers["Authorization"] = f"Bearer {key}"
    if url.scheme == "https":
        secure = ssl.create_default_context()
        connection: http.client.HTTPConnection = http.client.HTTPSConnection(
            url.hostname, url.port, timeout=timeout, context=secure
        )
    else:
        connection = http.client.HTTPConnection(url.hostname, url.port, timeout=timeout)
    late = threading.Event()
    connected: list[socket.socket] = []

    def give_up() -> None:
        late.set()
        for each in connected:
            with suppress(OSError):  # it is not connected any more
                each.shutdown(socket.SHUT_RDWR)

    # The time-out of a socket is that of one byte: who sends one a second would never end.
    timer = threading.Timer(timeout, give_up)
    timer.daemon = True
    timer.start()
    try:
        connection.connect()
        connected.append(connection.sock)  # the connection itself forgets it while it is read
        connection.request("POST", f"{url.path.rstrip('/')}/chat/completions", body, headers)
        with connection.getresponse() as answer:
            if 300 <= answer.status < 400:
                raise ModelError(f"{where} answers with a redirection, which is not followed")
            if answer.status != http.client.OK:
                raise ModelError(f"{where} answers {answer.status} {printable(answer.reason):.60}")
            data = answer.read(MAX_ANSWER_BYTES + 1)
    except (OSError, http.client.HTTPException, ValueError) as error:
        # The time-out of the socket may come before that of the whole answer.
        is_late = late.is_set() or isinstance(error, TimeoutError)
        why = f"has not answered in {timeout:g} s" if is_late else _reason(error)
        raise ModelError(f"{where} {why}") from error
    finally:
        timer.cancel()
        connection.close()
    if late.is_set():
        raise ModelError(f"{where} has not answered in {timeout:g} s")
    if len(data) > MAX_ANSWER_BYTES:
        raise ModelError(f"{where} answers more than {MAX_ANSWER_BYTES >> 10} kB")
    return data


def _reason(error: Exception) -> str:
    if isinstance(error, OSError):
        return f"cannot be reached: {printable(error.strerror or str(error)):.80}"
    return f"breaks off: {printable(str(error) or type(error).__name__):.80}"
