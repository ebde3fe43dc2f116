"""Cameras with faults: what each sends instead of pictures, and a phone that has one of them."""

import functools
import itertools
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread

import cv2
import numpy as np

from tests.campaigns.phone import jpegs
from tests.tracking.sources.live import claims

RATE = 15.0
"""Pictures a second of the cameras."""

SIZE = 640, 360
"""Size of the pictures [px]."""

Sent = bytes | None
"""A picture as a camera sends it; None if it sends nothing."""


@functools.cache
def pictures() -> list[bytes]:
    """Return what the camera sees, again and again."""
    return jpegs(60, SIZE)


@dataclass(frozen=True)
class Fault:
    """A fault of a camera."""

    send: Callable[[int], Sent] = lambda number: None
    """What is sent instead of a picture, by its number since the beginning of the stream."""

    connects: bool = True
    """Whether the camera can be opened while the fault lasts."""

    breaks_after: int | None = None
    """Number of pictures after which the stream breaks off; None if it does not."""

    status: int = 200
    """What a phone answers."""

    raw: bool = False
    """Whether a phone sends what it sends without the frame of a stream."""

    loses: bool = True
    """Whether the camera then counts as lost."""


def garbage(number: int) -> bytes:
    """Return bytes that are nothing."""
    return np.random.default_rng(number).bytes(20_000)


def usual(number: int) -> bytes:
    """Return a picture."""
    return pictures()[number % len(pictures())]


def _jpeg(image: np.ndarray) -> bytes:
    return cv2.imencode(".jpg", image)[1].tobytes()


UPRIGHT = [_jpeg(np.full((SIZE[0], SIZE[1], 3), grey, np.uint8)) for grey in (80, 90)]
BLACK = _jpeg(np.zeros((SIZE[1], SIZE[0], 3), np.uint8))

FAULTS = {
    "stall": Fault(),
    "close": Fault(connects=False, breaks_after=0),
    "reopen": Fault(usual, breaks_after=3, loses=False),
    "slow": Fault(lambda number: usual(number) if number % round(2 * RATE) == 0 else None),
    "half JPEG": Fault(lambda number: usual(number)[: len(usual(number)) // 2]),
    "wrong size": Fault(lambda number: UPRIGHT[number % 2]),
    "huge header": Fault(lambda number: claims(usual(number), (65000, 65000))),
    "black": Fault(lambda number: BLACK, loses=False),
    "frozen": Fault(lambda number: usual(0), loses=False),
    "garbage": Fault(garbage, raw=True),
    "refused at first": Fault(connects=False, breaks_after=0, status=503),
}
"""The faults by their names. Black and frozen pictures are no loss of a phone, which may lie on a
table; those of a webcam are."""


class FaultyPhone(ThreadingHTTPServer):
    """Serves pictures over HTTP, with a fault while one is set."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Stream)
        pictures()  # a phone that makes them while it is asked is late
        self.fault: Fault | None = None
        self.streams = 0

    def verify_request(self, request: object, client_address: object) -> bool:
        """Close connections at once while the phone cannot be reached."""
        return self.fault is None or self.fault.connects or self.fault.status != 200

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing: clients close the connection."""


class _Stream(BaseHTTPRequestHandler):
    server: FaultyPhone

    def log_message(self, format: str, *arguments: object) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        self.server.streams += 1
        fault = self.server.fault
        self.send_response(200 if fault is None else fault.status)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        if fault is not None and fault.status != 200:
            return
        start, since = time.monotonic(), 0
        for number in itertools.count():
            fault = self.server.fault
            since = 0 if fault is None else since + 1
            if fault is not None and fault.breaks_after is not None and since > fault.breaks_after:
                return
            data = usual(number) if fault is None else fault.send(number)
            if data is not None:
                raw = fault is not None and fault.raw
                head = f"--frame\r\nContent-Length: {len(data)}\r\n\r\n".encode()
                self.wfile.write(data if raw else head + data + b"\r\n")
            time.sleep(max(0.0, start + number / RATE - time.monotonic()))


@contextmanager
def faulty_phone() -> Iterator[FaultyPhone]:
    """Serve until the end of the block."""
    with FaultyPhone() as server:
        Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        try:
            yield server
        finally:
            server.shutdown()
