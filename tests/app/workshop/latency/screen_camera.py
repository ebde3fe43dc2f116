"""A camera that sees a virtual screen: an MJPEG server that reads its pixels."""

import socketserver
import threading
import time
from collections import deque
from http.server import BaseHTTPRequestHandler

import cv2
import numpy as np

BOUNDARY = "frame"


class ScreenCamera(socketserver.ThreadingTCPServer):
    """Sends what is on the screen, every time a known while after it has looked.

    Parameters
    ----------
    screen
        `VirtualScreen.pixels`, (height, width, 4) BGRX.
    delay
        From the look to the sending of the picture [s].
    rate
        Pictures a second.
    """

    daemon_threads = allow_reuse_address = True

    def __init__(self, screen: np.ndarray, delay: float, rate: float = 30.0) -> None:
        super().__init__(("127.0.0.1", 0), _Stream)
        self.screen, self.delay, self.rate = screen, delay, rate
        self.stopped = threading.Event()
        self.looks: deque[float] = deque(maxlen=10000)
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def url(self) -> str:
        """Where it is."""
        return f"http://127.0.0.1:{self.server_address[1]}/video"

    def look(self) -> np.ndarray:
        """Return the picture of a camera now."""
        return np.ascontiguousarray(self.screen[..., :3])

    def close(self) -> None:
        """End all streams."""
        self.stopped.set()
        self.shutdown()
        self.server_close()


class _Stream(BaseHTTPRequestHandler):
    server: ScreenCamera

    def log_message(self, *arguments):
        pass

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Type", f"multipart/x-mixed-replace; boundary={BOUNDARY}")
        self.end_headers()
        waiting: deque[tuple[float, bytes]] = deque()
        due = time.monotonic()
        while not self.server.stopped.is_set():
            now = time.monotonic()
            if now >= due:
                data = cv2.imencode(".jpg", self.server.look())[1].tobytes()
                waiting.append((now + self.server.delay, data))
                self.server.looks.append(now)
                due = max(due + 1 / self.server.rate, now)
            if waiting and now >= waiting[0][0]:
                data = waiting.popleft()[1]
                head = f"--{BOUNDARY}\r\nContent-Length: {len(data)}\r\n\r\n"
                try:
                    self.wfile.write(head.encode() + data + b"\r\n")
                except OSError:
                    return
            upcoming = min(due, waiting[0][0]) if waiting else due
            self.server.stopped.wait(max(0.0, min(0.002, upcoming - time.monotonic())))
