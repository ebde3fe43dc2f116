"""Phones: frames over HTTP, and a one-line error in time if none arrives."""

import hashlib
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import ClassVar
from urllib.request import parse_http_list, parse_keqv_list

import pytest

from cubeling.tracking import TrackingError, open_source
from cubeling.tracking.sources.streams.http import HttpSource
from tests.tracking.sources.live import SIZE, fails, fast_clock, jpeg

TEST_TIMEOUT_S = 10.0
"""Real time after which a test that waits for another thread has failed."""


class Phone(BaseHTTPRequestHandler):
    """Serves valid and invalid streams of phone apps."""

    ended = threading.Event()
    next_part = threading.Event()
    heard: ClassVar[list[str]] = []
    nonce = "dcd98b7102dd2f0e8b11d0f600bfb0c093"

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

    def digest(self):
        """Serve a picture to who answers the challenge for anna with "s cret" (RFC 2617, 3.2.2)."""
        scheme, _, rest = self.headers.get("Authorization", "").partition(" ")
        given = parse_keqv_list(parse_http_list(rest)) if scheme == "Digest" else {}

        def md5(*parts):
            return hashlib.md5(":".join(parts).encode(), usedforsecurity=False).hexdigest()

        keys = ("nonce", "nc", "cnonce", "qop")
        secret, request = md5("anna", "camera", "s cret"), md5("GET", self.path)
        wanted = md5(secret, *[given.get(key, "") for key in keys], request)
        if given.get("nonce") == self.nonce and given["response"] == wanted:
            self.answer("multipart/x-mixed-replace; boundary=frame")
            self.part(jpeg(0))
            self.ended.wait(TEST_TIMEOUT_S)
        else:
            challenge = f'Digest realm="camera", nonce="{self.nonce}", qop="auth-int, auth"'
            self.answer("text/html", 401, **{"WWW-Authenticate": challenge})

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
            case "/digest":
                self.digest()
            case "/unnamed":
                self.answer("multipart/x-mixed-replace")
                self.part(jpeg(0))
                self.part(jpeg(1), length=False)
                self.ended.wait(TEST_TIMEOUT_S)
            case "/octets":
                self.answer("application/octet-stream")
                self.part(jpeg(0))
                self.ended.wait(TEST_TIMEOUT_S)
            case "/letter":
                self.answer("application/octet-stream")
                self.wfile.write(b"dear grandmother\n" * 5000)
                self.ended.wait(TEST_TIMEOUT_S)
            case "/nostatus":
                self.wfile.write(b"Content-Type: multipart/x-mixed-replace\r\n\r\n")
            case "/halves":
                self.answer(kind)
                for number in range(9):
                    whole = jpeg(number)
                    self.part(whole if number % 3 != 1 else whole[: len(whole) // 2] + b"\xff\xd9")
                    Phone.next_part.wait(TEST_TIMEOUT_S)
                    Phone.next_part.clear()
            case "/frozen":
                self.answer(kind)
                while not self.ended.is_set():
                    self.part(jpeg(0))
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
    assert "refuses this name and password" in str(caught.value)
    fails(lambda: open_source(f"http://{phone}/secret"), "needs a password")


def test_a_password_is_proved_without_being_sent_where_the_camera_asks_for_that(phone):
    with open_source(f"http://anna:s%20cret@{phone}/digest") as source:
        assert source.size == SIZE
    fails(lambda: open_source(f"http://anna:guess@{phone}/digest"), "refuses this name and pass")
    fails(lambda: open_source(f"http://{phone}/digest"), "needs a password")


@pytest.mark.parametrize("path", ["/unnamed", "/octets"])
def test_a_boundary_that_is_not_told_is_found_in_the_stream(phone, path):
    with open_source(f"http://{phone}{path}") as source:
        assert next(iter(source)).encoded in (jpeg(0), jpeg(1))


def test_a_half_image_is_left_out_and_counted(phone):
    with open_source(f"http://{phone}/halves") as source:
        assert isinstance(source, HttpSource)
        Phone.next_part.set()
        frames = [next(iter(source)).encoded]
        while len(frames) < 3:
            Phone.next_part.set()
            frame = source.wait(0.05)
            frames += [frame.encoded] if frame else []
        assert source.health.unusable >= 1
    whole = {jpeg(number) for number in range(9) if number % 3 != 1}
    assert whole.issuperset(frames)


def test_a_frozen_stream_is_noticed(phone):
    with open_source(f"http://{phone}/frozen", clock=fast_clock(0.01)) as source:
        fails(lambda: lost(source), "has repeated the same image for")
        assert isinstance(source, HttpSource)
        assert source.health.frozen


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/page", "is text/html, not a stream of JPEG images"),
        ("/photo", "is a single JPEG image: give the address of the stream"),
        ("/letter", "nothing separates its parts"),
        ("/nostatus", "does not answer in HTTP: its first line is 'Content-Type: multipart"),
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
