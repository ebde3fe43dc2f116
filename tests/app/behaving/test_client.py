"""What a client of a block server may send, and for how long: without sockets and clocks."""

import pytest

from cubeling.app.admission import ClientLimits, Token
from cubeling.app.behaving.client import ServedClient
from cubeling.app.behaving.splitting import StreamBroken
from cubeling.app.errors import AppError

TOKEN = Token("open-sesame")

LIMITS = ClientLimits(documents=3, bytes=1000)


def served(first: bytes = b"token open-sesame\n") -> ServedClient:
    client = ServedClient(TOKEN, LIMITS, 0.0)
    client.receive(first, 0.0)
    return client


def test_a_token_comes_before_documents_wherever_the_stream_is_cut():
    stream = b"token open-sesame\r\n<bml id='a'/><bml id='b'/>"
    for cut in range(len(stream)):
        client = served(stream[:cut])
        client.receive(stream[cut:], 0.0)
        assert client.admitted
        assert list(client.waiting) == [b"<bml id='a'/>", b"<bml id='b'/>"]


@pytest.mark.parametrize(
    "first",
    [
        b"<bml/>\n",
        b"token\n",
        b"token open-sesam\n",
        b"token open-sesame2\n",
        b"\xff\xfe\n",
        b"\n",
        b"t" * 300,
    ],
)
def test_without_the_token_nothing_is_read(first):
    with pytest.raises(StreamBroken, match="the first line has to be: token"):
        served(first)


def test_a_client_that_has_enough_waiting_is_read_again_when_a_document_is_taken():
    client = served()
    client.receive(b"".join(b"<bml id='%d'/>" % number for number in range(8)), 0.0)
    assert client.full
    taken = []
    while client.waiting:
        taken.append(client.waiting.popleft())
        client.read(0.0)
        assert len(client.waiting) <= LIMITS.documents
    assert taken == [b"<bml id='%d'/>" % number for number in range(8)]
    client.receive(b"<bml>" + b" " * LIMITS.bytes + b"</bml>", 0.0)
    assert client.full


def test_limits_of_time_are_those_of_admission_of_a_document_and_of_silence():
    stranger = ServedClient(TOKEN, LIMITS, 10.0)
    assert not stranger.overdue(14.9)
    assert "no token" in stranger.overdue(15.1)
    client = served()
    client.receive(b"<bml>", 20.0)
    for now in (25.0, 35.0, 45.0):  # a byte now and then does not help
        client.receive(b" ", now)
    assert not client.overdue(49.9)
    assert "not complete" in client.overdue(50.1)
    client.receive(b"</bml>", 50.0)
    assert not client.overdue(649.9)
    assert "nothing has come" in client.overdue(650.1)


def test_a_client_that_is_not_read_is_not_idle():
    client = served()
    client.receive(b"<bml/>" * 4, 0.0)
    assert not client.overdue(5000.0)
    client.waiting.clear()
    client.read(5000.0)
    assert not client.overdue(5599.0)
    assert client.overdue(5601.0)


@pytest.mark.parametrize("text", ["", "short", "with space in it", "x" * 200, "ümlaut-token"])
def test_a_token_fits_into_a_line_and_a_url(text):
    with pytest.raises(AppError, match="8 to 128"):
        Token(text)


def test_tokens_that_are_made_differ():
    assert len({Token.generate().text for _ in range(20)}) == 20
