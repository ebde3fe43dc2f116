"""The certificate made on the spot, and the code and address that are printed."""

import ssl
import stat
import urllib.request
from contextlib import closing

import cv2
import numpy as np
import pytest
import segno

from cubeling.app.admission import Token
from cubeling.app.errors import AppError
from cubeling.app.ui.web.acceptor import Listener
from cubeling.app.ui.web.certificate import FILE, tls_context
from cubeling.app.ui.web.opening import page_address
from cubeling.app.ui.web.server import LOOPBACK, WebServer

TOKEN = Token("open-sesame")


def test_a_browser_that_trusts_the_certificate_gets_the_page(tmp_path):
    context, fingerprint = tls_context(LOOPBACK, tmp_path)
    assert stat.S_IMODE((tmp_path / FILE).stat().st_mode) == 0o600
    trusting = ssl.create_default_context(cafile=str(tmp_path / FILE))
    with closing(WebServer([Listener(LOOPBACK, 0, context)], TOKEN)) as server:
        address = f"https://{LOOPBACK}:{server.ports[0]}/"
        answer = urllib.request.urlopen(address, context=trusting, timeout=20)
        with answer:
            assert b"Cubeling" in answer.read()
    assert tls_context(LOOPBACK, tmp_path)[1] == fingerprint, "it is kept"
    assert tls_context("192.0.2.7", tmp_path)[1] != fingerprint, "for another address, another one"
    (tmp_path / FILE).write_text("rubbish")
    assert len(tls_context("192.0.2.7", None)[1].split(":")) == 32


def test_the_code_leads_to_the_address_with_the_token(tmp_path):
    with closing(WebServer([Listener(LOOPBACK, 0)], TOKEN)) as server:
        own = next(page_address(server))
        assert f"http://localhost:{server.ports[0]}/#open-sesame" in own
    with closing(WebServer([Listener(LOOPBACK, 0)] * 2, TOKEN)) as server:
        code, scan, *_ = page_address(server)
    address = f"https://{LOOPBACK}:{server.ports[1]}/#open-sesame"
    assert address in scan
    drawn = segno.make(address, error="l", micro=False)
    modules = np.array([[0 if dark else 255 for dark in row] for row in drawn.matrix], np.uint8)
    picture = cv2.copyMakeBorder(
        np.kron(modules, np.ones((8, 8), np.uint8)), 32, 32, 32, 32, cv2.BORDER_CONSTANT, value=255
    )
    assert cv2.QRCodeDetector().detectAndDecode(picture)[0] == address
    assert len(code.splitlines()) > 10


def test_a_port_in_use_is_refused_in_one_line():
    with closing(WebServer([Listener(LOOPBACK, 0)], TOKEN)) as server:
        same = [Listener(LOOPBACK, server.ports[0])]
        with pytest.raises(AppError, match="choose another --port"):
            WebServer(same, TOKEN)
