"""Network cameras by RTSP: frames from a server on loopback, and one line where there are none."""

import base64
import contextlib
import socket
import struct
import threading
from fractions import Fraction

import av
import numpy as np
import pytest

from cubeling.tracking import LiveFrames, TrackingError, open_source
from tests.tracking.sources.live import SIZE, picture

FRAMES = 30


def access_units():
    """Encode `picture(0)`, …, each as a list of its NAL units."""
    codec = av.CodecContext.create("libx264", "w")
    codec.width, codec.height, codec.pix_fmt = *SIZE, "yuv420p"
    codec.time_base = Fraction(1, 30)
    codec.options = {"tune": "zerolatency", "x264-params": "repeat-headers=1:keyint=1"}
    for number in range(FRAMES):
        frame = av.VideoFrame.from_ndarray(picture(number), format="bgr24")
        frame.pts = number
        stream = b"".join(
            bytes(packet) for packet in codec.encode(frame.reformat(format="yuv420p"))
        )
        units = stream.replace(b"\0\0\0\1", b"\0\0\1").split(b"\0\0\1")
        yield [unit for unit in units if unit]


class Camera(threading.Thread):
    """Serves H.264 to one client after another, in the RTSP connection itself (RFC 2326, 10.12)."""

    def __init__(self, password=""):
        super().__init__(daemon=True)
        self._server = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._server.getsockname()[1]}/live"
        self._wanted = base64.b64encode(password.encode()).decode() if password else ""
        self._units = list(access_units())

    def run(self):
        with contextlib.suppress(OSError):
            while True:
                client, _ = self._server.accept()
                with client, contextlib.suppress(OSError):
                    self._serve(client)

    def close(self):
        self._server.shutdown(socket.SHUT_RDWR)
        self._server.close()
        self.join()

    def _serve(self, client):
        requests = client.makefile("rb")
        while line := requests.readline():
            method = line.split()[0].decode()
            headers = dict(iter(lambda: requests.readline().decode().strip().partition(": ")[::2],
                                ("", "")))  # fmt: skip
            known = headers.get("Authorization", "").endswith(self._wanted)
            answer = [f"CSeq: {headers['CSeq']}", "Session: 1", "Public: DESCRIBE, SETUP, PLAY"]
            body = ""
            if method == "DESCRIBE":
                answer.append('WWW-Authenticate: Basic realm="camera"')
                body = "v=0\r\no=- 0 0 IN IP4 127.0.0.1\r\ns=-\r\nt=0 0\r\nm=video 0 RTP/AVP 96\r\n"
                body += "a=rtpmap:96 H264/90000\r\na=control:0\r\n"
                answer += ["Content-Type: application/sdp", f"Content-Length: {len(body)}"]
            if method == "SETUP":
                answer.append("Transport: RTP/AVP/TCP;unicast;interleaved=0-1")
            status = "200 OK" if known or method != "DESCRIBE" else "401 Unauthorized"
            text = "\r\n".join([f"RTSP/1.0 {status}", *answer, "", body])
            client.sendall(text.encode())
            if method == "PLAY":
                self._play(client)
                return

    def _play(self, client):
        sequence = 0
        for number, units in enumerate(self._units):
            for unit in units:
                last = 0x80 if unit is units[-1] else 0
                head = struct.pack(">BBHII", 0x80, last | 96, sequence, 3000 * number, 1)
                client.sendall(struct.pack(">cBH", b"$", 0, len(head + unit)) + head + unit)
                sequence += 1


@pytest.fixture
def camera(request):
    camera = Camera(getattr(request, "param", ""))
    camera.start()
    yield camera.address
    camera.close()


def test_a_network_camera_delivers_its_frames(camera):
    with open_source(f"rtsp://{camera}") as source:
        frame = next(iter(source))
        assert (source.size, source.live) == (SIZE, True)
        assert np.abs(frame.image.astype(int) - picture(frame.index)).mean() < 20


@pytest.mark.parametrize("camera", ["anna:s cret"], indirect=True)
def test_name_and_password_are_sent_but_not_printed_when_wrong(camera):
    with open_source(f"rtsp://anna:s%20cret@{camera}") as source:
        assert isinstance(source, LiveFrames)
        assert source.health.name == f"rtsp://{camera}"
    with pytest.raises(TrackingError, match="name and password") as caught:
        open_source(f"rtsp://anna:guess@{camera}")
    assert "guess" not in str(caught.value)


def test_an_address_without_a_camera_is_one_line():
    with pytest.raises(TrackingError, match=r"cannot open rtsp://127.0.0.1:1/live \(conn"):
        open_source("rtsp://127.0.0.1:1/live")
    with pytest.raises(TrackingError, match="names no host"):
        open_source("rtsp://")
