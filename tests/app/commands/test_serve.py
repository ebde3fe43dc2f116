"""What `cubeling serve` refuses before anybody is let in."""

import socket
import sys
from contextlib import closing

import pytest

from cubeling.app.bridges.opening import InstrumentOptions, open_instruments
from cubeling.app.errors import AppError
from cubeling.app.ui.web.server import LOOPBACK


def test_a_short_token_and_an_unknown_scenario_are_refused(cubeling):
    code, _, err = cubeling("serve", "--token", "short")
    assert (code, err) == (
        2,
        "cubeling: a token has 8 to 128 letters, digits and characters of . _ ~ -\n",
    )
    code, _, err = cubeling("serve", "--scenario", "chess")
    assert (code, err.count("\n")) == (2, 1)


def test_without_its_libraries_it_says_what_to_install(cubeling, monkeypatch):
    monkeypatch.delitem(sys.modules, "cubeling.app.ui.web.opening", raising=False)
    monkeypatch.setitem(sys.modules, "segno", None)
    code, _, err = cubeling("serve")
    assert code == 2
    assert "pip install aiohttp cryptography segno" in err


def test_a_wizards_desk_says_so_too(monkeypatch):
    monkeypatch.delitem(sys.modules, "cubeling.app.ui.web.opening", raising=False)
    monkeypatch.setitem(sys.modules, "segno", None)
    asked = InstrumentOptions(wizard=True)
    with pytest.raises(AppError, match="segno"), open_instruments(asked, print):
        pass


def test_a_port_in_use_is_refused(cubeling):
    with closing(socket.create_server((LOOPBACK, 0))) as taken:
        port = taken.getsockname()[1]
        code, _, err = cubeling("serve", "--port", str(port), "--preferences", "preferences.toml")
    assert code == 2
    assert f"cannot listen at {LOOPBACK}:{port}: " in err
    assert err.endswith("choose another --port\n")
