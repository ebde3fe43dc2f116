"""Frames from a phone or network camera: JPEG pictures in one endless HTTP answer."""

import base64
import contextlib
import socket
import time
from http.client import HTTPConnection, HTTPException, HTTPResponse, HTTPSConnection
from urllib.parse import SplitResult, unquote, urlsplit

from tracking.errors import TrackingError
from tracking.sources.device import Clock
from tracking.sources.health import Setting
from tracking.sources.live import LiveSource
from tracking.sources.multipart import MultipartError, MultipartParser

READ_SIZE = 64 * 1024

QUIET_S = 3.0
"""A connection on which nothing came for so long is made anew; a wireless network stalls for a
second now and then, and the stream then goes on by itself."""


class HttpSource(LiveSource):
    """An MJPEG stream, as phone apps such as "IP Webcam" and most network cameras serve it.

    Parameters
    ----------
    url
        "http://phone:8080/video"; a name and password may stand before the host.
    clock
        Seconds; stamps the frames as they arrive.

    Raises
    ------
    TrackingError
        Nobody answers, the answer is no stream of JPEG pictures, or none came for 2 s.
        A stream that breaks off later is connected to anew: see `base.LiveFrames`.
    """

    def __init__(self, url: str, *, clock: Clock = time.monotonic) -> None:
        try:
            address = urlsplit(url)
            name = f"{address.scheme}://{address.hostname}"
            name += f":{address.port}{address.path}" if address.port else address.path
        except ValueError as error:
            raise TrackingError(f"'{url}' is no web address: {error}") from error
        if not address.hostname:
            raise TrackingError(f"'{url}' names no host; write http://HOST:PORT/PATH")
        # A phone that films a wall may well compress it to the same bytes again and again.
        super().__init__(lambda: _Stream(address, name), name, clock, tell_frozen=False)


class _Stream:
    """One HTTP answer that goes on and on."""

    rate = 30.0
    settings: tuple[Setting, ...] = ()
    exposed: float | None = None

    def __init__(self, address: SplitResult, name: str) -> None:
        self._name = name
        kind = HTTPSConnection if address.scheme == "https" else HTTPConnection
        self._connection = kind(address.hostname or "", address.port, timeout=QUIET_S)
        try:
            self._connection.connect()
            self._socket: socket.socket = self._connection.sock
            self._connection.request("GET", _target(address), headers=_headers(address))
            self._answer = self._connection.getresponse()
            self._parser = MultipartParser(_boundary(self._answer, name))
        except (OSError, HTTPException) as error:
            self._connection.close()
            raise TrackingError(
                f"cannot connect to {name} ({_reason(error)}): "
                "is the app on the phone running, and is it in the same network?"
            ) from error
        except TrackingError:
            self.close()
            raise

    def read(self) -> bytes:
        """Wait for the next JPEG; the newest where several came at once."""
        while True:
            try:
                data = self._answer.read1(READ_SIZE)
                pictures = self._parser.feed(data)
            except TimeoutError as error:
                raise TrackingError(f"{self._name} sent nothing for {QUIET_S:g} s") from error
            except (OSError, HTTPException, ValueError) as error:
                raise TrackingError(f"{self._name} broke off: {_reason(error)}") from error
            except MultipartError as error:
                raise TrackingError(f"{self._name} {error}") from error
            if pictures:
                return pictures[-1]
            if not data or self._parser.ended:
                raise TrackingError(f"{self._name} ended its stream")

    def interrupt(self) -> None:
        """Wake a read that waits."""
        with contextlib.suppress(OSError):  # the other side may have closed it already
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Hang up."""
        self._answer.close()
        self._connection.close()


def _target(address: SplitResult) -> str:
    return (address.path or "/") + (f"?{address.query}" if address.query else "")


def _headers(address: SplitResult) -> dict[str, str]:
    if address.username is None:
        return {}
    secret = f"{unquote(address.username)}:{unquote(address.password or '')}".encode()
    return {"Authorization": f"Basic {base64.b64encode(secret).decode()}"}


def _boundary(answer: HTTPResponse, name: str) -> str:
    """Check that the answer is a stream of pictures; return what separates them."""
    if answer.status == 401:
        raise TrackingError(f"{name} wants a password: write http://NAME:PASSWORD@HOST:PORT/PATH")
    if answer.status in (301, 302, 303, 307, 308):
        raise TrackingError(f"{name} has moved: open {answer.headers['Location']} instead")
    if answer.status != 200:
        raise TrackingError(f"{name} answers {answer.status} {answer.reason}: check the address")
    kind = answer.headers.get_content_type()
    boundary = answer.headers.get_param("boundary")
    if not kind.startswith("multipart/") or not isinstance(boundary, str) or not boundary:
        raise TrackingError(
            f"{name} is {kind}, not a stream of JPEG pictures: "
            "give the address of the stream itself, such as http://PHONE:8080/video"
        )
    return boundary


def _reason(error: Exception) -> str:
    """Return the system's words without its error number."""
    if isinstance(error, TimeoutError):
        return "no answer"
    return str(getattr(error, "strerror", None) or error or type(error).__name__).lower()
