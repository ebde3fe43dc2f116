"""A phone that serves the pictures of a recording over HTTP, again and again, in real time."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from itertools import islice
from pathlib import Path

import cv2

from cubeling.tracking import open_source

RECORDING = Path(__file__).parents[2] / "recordings" / "companion.mcap"
"""What the phone sees: a hand with the companion cube."""


def jpegs(count: int | None = None, size: tuple[int, int] | None = None) -> list[bytes]:
    """Return the first pictures of the recording, or all, as JPEG files, of a size [px] or its."""
    with open_source(str(RECORDING)) as source:
        return [
            cv2.imencode(".jpg", image if size is None else cv2.resize(image, size))[1].tobytes()
            for image in (frame.image for frame in islice(source, count))
        ]


class PhoneServer(ThreadingHTTPServer):
    """Serves pictures until it is closed; a client may leave at any time."""

    daemon_threads = True

    def __init__(self, pictures: list[bytes], rate: float) -> None:
        super().__init__(("127.0.0.1", 0), PhoneStream)
        self.pictures, self.interval = pictures, 1 / rate
        self.plugged = threading.Event()
        self.plugged.set()

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing: clients close the connection when they end."""


class PhoneStream(BaseHTTPRequestHandler):
    """One client's stream."""

    server: PhoneServer

    def log_message(self, format: str, *arguments: object) -> None:
        """Say nothing."""

    def do_GET(self) -> None:
        """Send one picture after the other; while the phone is away, none."""
        self.send_response(200)
        self.send_header("Content-Type", "multipart/x-mixed-replace; boundary=frame")
        self.end_headers()
        start, number = time.monotonic(), 0
        while self.server.plugged.is_set():
            data = self.server.pictures[number % len(self.server.pictures)]
            head = f"--frame\r\nContent-Type: image/jpeg\r\nContent-Length: {len(data)}\r\n\r\n"
            self.wfile.write(head.encode() + data + b"\r\n")
            number += 1
            time.sleep(max(0.0, start + number * self.server.interval - time.monotonic()))


@contextmanager
def phone(pictures: list[bytes], rate: float = 30.0) -> Iterator[tuple[str, PhoneServer]]:
    """Serve pictures, and yield the address of the camera."""
    server = PhoneServer(pictures, rate)
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}/video", server
    finally:
        server.plugged.clear()
        server.shutdown()
        server.server_close()
