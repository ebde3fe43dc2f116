"""Frames from a phone or network camera: JPEG images in one endless HTTP response (MJPEG)."""

import base64
import contextlib
import socket
import time
from http.client import (
    BadStatusLine,
    HTTPConnection,
    HTTPException,
    HTTPResponse,
    HTTPSConnection,
)
from urllib.error import URLError
from urllib.parse import SplitResult, unquote, urlsplit
from urllib.request import (
    AbstractDigestAuthHandler,
    HTTPPasswordMgr,
    Request,
    parse_http_list,
    parse_keqv_list,
)

from cubeling.tracking.errors import TrackingError
from cubeling.tracking.sources.device import Clock, DeviceSetting
from cubeling.tracking.sources.live import LiveSource
from cubeling.tracking.sources.streams.multipart import MultipartError, MultipartParser

READ_SIZE_BYTES = 64 * 1024

SOCKET_TIMEOUT_S = 3.0
"""A silent connection is closed and opened again after this time. A wireless network may stall for
a second, after which the stream continues by itself."""

FROZEN_AFTER_S = 3.0
"""Identical images for this time are a frozen camera's. Servers repeat those of a slow camera, but
no sensor delivers the same bytes twice."""

UNNAMED_KINDS = ("application/octet-stream", "application/x-octet-stream")
"""Content types of servers that do not say what they send."""


class HttpSource(LiveSource):
    """An MJPEG stream, as phone apps such as "IP Webcam" and most network cameras serve it.

    The URL is as "http://phone:8080/video"; a name and password may precede the host.

    Raises
    ------
    TrackingError
        There is no answer, the answer is not a stream of JPEG images, or no image came for 2 s.
        A stream that breaks later is opened again: see `base.LiveFrames`.
    """

    def __init__(self, url: str, *, clock: Clock = time.monotonic) -> None:
        try:
            address = urlsplit(url)
            name = f"{address.scheme}://{address.hostname}"
            name += f":{address.port}{address.path}" if address.port else address.path
        except ValueError as error:
            raise TrackingError(f"'{url}' is not a web address: {error}") from error
        if not address.hostname:
            raise TrackingError(f"'{url}' names no host; write http://HOST:PORT/PATH")
        super().__init__(
            lambda: _MjpegStream(address, name), name, clock, frozen_after=FROZEN_AFTER_S
        )


def open_uri(uri: str, size: tuple[int, int] | None, clock: Clock) -> HttpSource:
    """Open "http://HOST:PORT/PATH"; the size is the server's."""
    return HttpSource(uri, clock=clock)


class _MjpegStream:
    """One endless HTTP response."""

    rate = 30.0
    settings: tuple[DeviceSetting, ...] = ()
    exposed: float | None = None

    def __init__(self, address: SplitResult, name: str) -> None:
        self._name = name
        try:
            self._get(address, _basic_authorization(address))
            challenge = self._response.headers.get("WWW-Authenticate", "")
            refused = self._response.status == 401 and address.username is not None
            if refused and challenge.lower().startswith("digest"):
                self.close()
                self._get(address, _digest_authorization(address, challenge, name))
            self._parser = MultipartParser(_boundary(self._response, address, name))
        except (OSError, HTTPException) as error:
            self._connection.close()
            # A server that says nothing at all has "no status", too.
            if isinstance(error, BadStatusLine) and not isinstance(error, OSError):
                line = str(error.args[0]).strip()[:60]
                raise TrackingError(
                    f"{name} does not answer in HTTP: its first line is '{line}', "
                    "not a status such as 'HTTP/1.1 200 OK'"
                ) from error
            raise TrackingError(
                f"cannot connect to {name} ({_reason(error)}): "
                "is the app on the phone running, and is it in the same network?"
            ) from error
        except TrackingError:
            self.close()
            raise

    def _get(self, address: SplitResult, headers: dict[str, str]) -> None:
        kind = HTTPSConnection if address.scheme == "https" else HTTPConnection
        self._connection = kind(address.hostname or "", address.port, timeout=SOCKET_TIMEOUT_S)
        self._connection.connect()
        self._socket: socket.socket = self._connection.sock
        self._connection.request("GET", _target(address), headers=headers)
        self._response = self._connection.getresponse()

    def read(self) -> bytes:
        """Wait for the next JPEG; the newest one if several have arrived."""
        while True:
            try:
                data = self._response.read1(READ_SIZE_BYTES)
                images = self._parser.feed(data)
            except TimeoutError as error:
                message = f"{self._name} sent nothing for {SOCKET_TIMEOUT_S:g} s"
                raise TrackingError(message) from error
            except (OSError, HTTPException, ValueError) as error:
                raise TrackingError(f"{self._name} failed: {_reason(error)}") from error
            except MultipartError as error:
                raise TrackingError(f"{self._name} {error}") from error
            if images:
                # Older ones would only add to the delay.
                return images[-1]
            if not data or self._parser.ended:
                raise TrackingError(f"{self._name} ended its stream")

    def interrupt(self) -> None:
        """Wake a blocked read."""
        with contextlib.suppress(OSError):  # the peer may have closed it already
            # close() alone does not wake a thread that is blocked in recv; shutdown does.
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Close the connection; a read that waits on another thread ends with an error."""
        self._response.close()
        self._connection.close()


def _target(address: SplitResult) -> str:
    return (address.path or "/") + (f"?{address.query}" if address.query else "")


def _basic_authorization(address: SplitResult) -> dict[str, str]:
    if address.username is None:
        return {}
    secret = f"{unquote(address.username)}:{unquote(address.password or '')}".encode()
    return {"Authorization": f"Basic {base64.b64encode(secret).decode()}"}


def _digest_authorization(address: SplitResult, challenge: str, name: str) -> dict[str, str]:
    """Answer the challenge of a server that wants no password in clear text (RFC 7616)."""
    passwords = HTTPPasswordMgr()
    handler = AbstractDigestAuthHandler(passwords)
    request = Request(f"{address.scheme}://{address.hostname}{_target(address)}")
    values = parse_keqv_list(parse_http_list(challenge.partition(" ")[2]))
    if "qop" in values:
        values["qop"] = values["qop"].replace(" ", "")  # the handler splits at commas alone
    passwords.add_password(
        values.get("realm", ""),
        request.full_url,
        unquote(address.username or ""),
        unquote(address.password or ""),
    )
    try:
        answer = handler.get_authorization(request, values)
    except (ValueError, URLError):  # an algorithm, and a quality of protection, that it lacks
        answer = None
    if not answer:
        raise TrackingError(
            f"{name} asks for the password in a way that is not supported "
            f"(digest, {values.get('algorithm', 'MD5')}, {values.get('qop', 'no qop')}): "
            "choose basic authentication or none in the settings of the camera"
        )
    return {"Authorization": f"Digest {answer}"}


def _boundary(response: HTTPResponse, address: SplitResult, name: str) -> str:
    """Check that the response is a stream of parts; return their boundary, "" if it is not told."""
    if response.status == 401:
        if address.username is not None:
            raise TrackingError(f"{name} refuses this name and password")
        raise TrackingError(f"{name} needs a password: write http://NAME:PASSWORD@HOST:PORT/PATH")
    if response.status in (301, 302, 303, 307, 308):
        raise TrackingError(f"{name} has moved: open {response.headers['Location']} instead")
    if response.status != 200:
        reason = f"{response.status} {response.reason}"
        raise TrackingError(f"{name} answers {reason}: check the address")
    kind = response.headers.get_content_type()
    boundary = response.headers.get_param("boundary")
    if kind.startswith("multipart/") or kind in UNNAMED_KINDS:
        return boundary if isinstance(boundary, str) else ""
    what = "a single JPEG image" if kind == "image/jpeg" else f"{kind}, not a stream of JPEG images"
    raise TrackingError(
        f"{name} is {what}: give the address of the stream itself, such as http://PHONE:8080/video"
    )


def _reason(error: Exception) -> str:
    """Return the system's message without its error number."""
    if isinstance(error, TimeoutError):
        return "no answer"
    return str(getattr(error, "strerror", None) or error or type(error).__name__).lower()
