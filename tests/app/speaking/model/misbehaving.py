"""A server on this computer that answers as a language model, or as none ever should."""

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

SAYS = 'Light <begin_gesture id="g" anim="nod"/>is scattered<end_gesture id="g"/> by air.'


def completion(content: object) -> bytes:
    """Return the answer of a model that says something."""
    return json.dumps(
        {"choices": [{"message": {"role": "assistant", "content": content}}]}
    ).encode()


class _Handler(BaseHTTPRequestHandler):
    server: "ModelServer"

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.asked.append(json.loads(body))
        self.server.keys.append(self.headers.get("Authorization"))
        getattr(self, f"_{self.server.manner}")()

    def _send(self, data: bytes, status: int = 200, **headers: str):
        self.send_response(status)
        for name, value in headers.items():
            self.send_header(name.replace("_", "-"), value)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def _good(self):
        self._send(completion(self.server.says))

    def _number(self):
        self._send(completion(7))

    def _nothing(self):
        self._send(completion(None))

    def _empty(self):
        self._send(completion("<br/> … "))

    def _no_choices(self):
        self._send(b'{"choices": []}')

    def _no_json(self):
        self._send(b"<html>It works!</html>")

    def _nested(self):
        self._send(b"[" * 100_000)

    def _broken(self):
        self._send(b"oh no", 500)

    def _no_key(self):
        self._send(b"{}", 401)

    def _redirect(self):
        self._send(b"", 302, Location=f"{self.server.url}/elsewhere")

    def _no_http(self):
        self.wfile.write(b"220 mail.example ESMTP\r\n")

    def _hangs_up(self):
        self.connection.close()

    def _half(self):
        self.send_response(200)
        self.send_header("Content-Length", "5000")
        self.end_headers()
        self.wfile.write(completion(SAYS)[:20])

    def _slow(self):
        self.server.released.wait(20)

    def _endless(self):
        self.send_response(200)
        self.end_headers()
        try:
            while not self.server.released.wait(0.02):
                self.wfile.write(b"data: {}\n\n")
        except OSError:
            pass

    def _endless_header(self):
        try:
            self.wfile.write(b"HTTP/1.1 200 OK\r\nX-Long: ")
            while not self.server.released.wait(0.02):
                self.wfile.write(b"x")
        except OSError:
            pass

    def _huge(self):
        self.send_response(200)
        self.end_headers()
        try:
            for _ in range(40):
                self.wfile.write(b" " * (1 << 20))
        except OSError:
            pass

    def log_message(self, *_):
        pass


class ModelServer(ThreadingHTTPServer):
    """Answers in one `manner`, and keeps what it was asked."""

    daemon_threads = False  # closing it waits for them

    def __init__(self, manner: str, says: str):
        super().__init__(("127.0.0.1", 0), _Handler)
        self.manner, self.says = manner, says
        self.asked: list[dict[str, Any]] = []
        self.keys: list[str | None] = []
        self.released = threading.Event()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/v1"

    def handle_error(self, *_):
        pass  # the client has gone


@contextmanager
def model_server(manner: str = "good", says: str = SAYS) -> Iterator[ModelServer]:
    """Run a server while the block lasts."""
    server = ModelServer(manner, says)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    try:
        yield server
    finally:
        server.released.set()
        server.shutdown()
        thread.join()
        server.server_close()
