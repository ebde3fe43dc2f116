"""Phones: frames over HTTP, and a one-line error in time if none arrives."""

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar

import pytest

from cubeling.tracking import TrackingError, open_source
from cubeling.tracking.sources.http import HttpSource
from tests.tracking.sources.live import SIZE, fails, fast_clock, jpeg

TEST_TIMEOUT_S = 10.0
"""Real time after which a test that waits for another thread has failed."""


class Phone(BaseHTTPRequestHandler):
    """Serves valid and invalid streams of phone apps."""

    ended = threading.Event()
    heard: ClassVar[list[str]] = []

    def log_message(self, *arguments):
        pass

    def answer(self, kind, status=200, **headers):
        self.send_response(status)
        self.send_header("Content-Type", kind)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()

    def part(self, data, length=True):
        head = f"Content-Length: {len(data)}\r\n" if length else ""
        self.wfile.write(
            f"--frame\r\nContent-Type: image/jpeg\r\n{head}\r\n".encode() + data + b"\r\n"
        )

    def do_GET(self):
        kind = "multipart/x-mixed-replace; boundary=frame"
        self.heard.append(self.headers.get("Authorization", ""))
        match self.path:
            case "/page":
                self.answer("text/html")
            case "/photo":
                self.answer("image/jpeg")
            case "/secret":
                self.answer("text/html", 401)
            case "/moved":
                self.answer("text/html", 302, Location="http://elsewhere/video")
            case "/silent":
                self.answer(kind)
                self.ended.wait(TEST_TIMEOUT_S)
            case "/bare":
                self.answer('multipart/x-mixed-replace; boundary="--frame"')
                for number in range(3):
                    self.part(jpeg(number), length=False)
                self.wfile.write(b"--frame--\r\n")
            case "/video?quality=high":
                self.answer(kind)
                self.part(jpeg(0))
                self.part(jpeg(1))
                self.ended.wait(TEST_TIMEOUT_S)
            case "/stops":
                self.answer(kind)
                self.part(jpeg(0))
            case _:
                self.answer("text/plain", 404)


class QuietServer(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request, client_address):
        """Clients may close the connection."""


@pytest.fixture(scope="module")
def phone():
    Phone.ended.clear()
    server = QuietServer(("127.0.0.1", 0), Phone)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield f"127.0.0.1:{server.server_port}"
    Phone.ended.set()
    server.shutdown()
    thread.join()
    server.server_close()


def lost(source):
    """Read frames until there are none, without patience."""
    while True:
        source.wait(0.05, patience=0.0)


def test_a_phone_returns_its_own_jpeg_bytes(phone):
    with open_source(f"http://{phone}/video?quality=high", clock=lambda: 5.0) as source:
        assert (source.size, source.live, source.intrinsics) == (SIZE, True, None)
        frame = next(iter(source))
        assert frame.encoded in (jpeg(0), jpeg(1))
        assert (frame.encoding, frame.timestamp) == ("jpeg", 5.0)


def test_a_stream_without_lengths_is_understood(phone):
    with open_source(f"http://{phone}/bare") as source:
        frames = iter(source)
        assert next(frames).encoded in {jpeg(number) for number in range(3)}
        fails(lambda: lost(source), "ended its stream")


def test_name_and_password_are_sent_but_not_printed(phone):
    Phone.heard.clear()
    with pytest.raises(TrackingError) as caught:
        open_source(f"http://anna:s%20cret@{phone}/secret")
    assert Phone.heard == ["Basic YW5uYTpzIGNyZXQ="]
    assert "cret" not in str(caught.value).replace("/secret", "")
    assert "needs a password" in str(caught.value)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/page", "is text/html, not a stream of JPEG images"),
        ("/photo", "is image/jpeg, not a stream of JPEG images"),
        ("/moved", "has moved: open http://elsewhere/video instead"),
        ("/none", "answers 404"),
    ],
)
def test_an_answer_other_than_a_stream_is_one_line(phone, path, words):
    fails(lambda: open_source(f"http://{phone}{path}"), words)


def test_a_phone_that_falls_silent_is_one_line(phone):
    fails(lambda: HttpSource(f"http://{phone}/silent", clock=fast_clock(0.05)), "no image for 2 s")


def test_a_closed_stream_is_one_line_after_its_last_frame(phone):
    with open_source(f"http://{phone}/stops") as source:
        frames = iter(source)
        assert next(frames).encoded == jpeg(0)
        fails(lambda: lost(source), "ended its stream")


def test_a_closed_stream_is_opened_again(phone):
    with open_source(f"http://{phone}/stops", clock=fast_clock(0.02)) as source:
        frames = iter(source)
        first, second = next(frames), next(frames)
        assert (first.encoded, second.encoded) == (jpeg(0), jpeg(0))
        assert (second.index, second.timestamp > first.timestamp) == (1, True)
        assert isinstance(source, HttpSource)
        assert source.health.gaps >= 1


def test_addresses_without_a_server_are_one_line(phone):
    fails(lambda: open_source("http://127.0.0.1:1/video"), "cannot connect to http://127.0.0.1:1")
    fails(lambda: open_source("http://"), "names no host")
    fails(lambda: open_source("http://phone:ninety/"), "is not a web address")
