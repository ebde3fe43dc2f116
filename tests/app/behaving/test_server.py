"""Blocks over TCP: documents in, feedback out, and clients that misbehave."""

import socket
import threading
from contextlib import closing

import pytest

from cubeling.app.behaving.live import NoOutput, play_live
from cubeling.app.behaving.server import MAX_UNSENT, BlockServer
from cubeling.app.errors import AppError
from tests.app.behaving.players import block, player

WAIT_S = 20.0


@pytest.fixture
def server():
    with closing(BlockServer(0)) as opened:
        yield opened


def connected(server):
    client = socket.create_connection(("127.0.0.1", server.port))
    client.settimeout(WAIT_S)
    return closing(client)


def received(client, until):
    """Return what comes up to a text, or up to the end."""
    found = b""
    while until not in found and (part := client.recv(65536)):
        found += part
    return found.decode()


def test_documents_of_all_clients_come_and_feedback_goes_to_all(server):
    with connected(server) as one, connected(server) as other:
        one.sendall(b"<bml><x>")
        other.sendall(b'<bml id="2"/>')
        assert server.documents(WAIT_S) == [b'<bml id="2"/>']
        one.sendall(b"</x></bml>")
        assert server.documents(WAIT_S) == [b"<bml><x></x></bml>"]
        server.send("<done/>")
        assert received(one, b"<done/>") == received(other, b"<done/>") == "<done/>\n"


def test_a_client_that_sends_no_xml_is_told_so_and_the_others_go_on(server):
    with connected(server) as bad, connected(server) as good:
        bad.sendall(b"hello")
        assert "PARSING_FAILURE" in received(bad, b"never")
        good.sendall(b"<bml/>")
        assert server.documents(WAIT_S) == [b"<bml/>"]


def test_a_client_that_reads_nothing_is_let_go_and_stalls_nobody(server):
    with connected(server) as deaf, connected(server) as good:
        deaf.sendall(b"<bml/>")
        good.sendall(b"<bml/>")
        while len(server.documents(WAIT_S)) == 0:
            pass
        large = "<x>" + "y" * (MAX_UNSENT // 4) + "</x>"
        for number in range(40):
            server.send(large)
            received(good, b"</x>")
            good.sendall(f"<bml id='{number}'/>".encode())
            assert server.documents(WAIT_S)


def test_a_client_that_goes_away_is_forgotten(server):
    for _ in range(40):
        with connected(server) as client:
            client.sendall(b"<bml/>")
            assert server.documents(WAIT_S)
    server.send("<x/>")


def test_closing_twice_is_nothing_and_disconnects_clients():
    server = BlockServer(0)
    with connected(server) as client:
        client.sendall(b"<bml/>")
        assert server.documents(WAIT_S)
        server.send("<last/>")
        server.close()
        server.close()
        assert received(client, b"never") == "<last/>\n"


@pytest.mark.parametrize("port", [-1, 70_000])
def test_a_port_that_there_is_not_is_one_line(port):
    with pytest.raises(AppError, match="choose another port"):
        BlockServer(port)


def test_a_port_in_use_is_one_line(server):
    with pytest.raises(AppError, match="choose another port"):
        BlockServer(server.port)


class Limited(NoOutput):
    """Ends once a block is over."""

    def __init__(self):
        self.closed = False
        self.times = []

    def show(self, player, frame):
        self.times.append(frame.realized.now)
        self.closed = any(
            getattr(each, "sync", "") == "end"
            and each.block == "b"
            and not hasattr(each, "behaviour")
            for each in frame.feedback
        )


def test_a_block_is_performed_while_it_plays_and_its_feedback_comes_back(server):
    output = Limited()
    with connected(server) as client:
        heard = []
        reader = threading.Thread(target=lambda: heard.append(received(client, b'"b:end"')))
        reader.start()
        client.sendall(
            block('<head id="n" lexeme="NOD"/><speech><text>One</text></speech>').encode()
        )
        play_live(player(), server, output, 25.0)
        reader.join(WAIT_S)
    assert output.times == sorted(output.times)
    order = [
        heard[0].index(f'id="b:{each}"')
        for each in ("start", "n:start", "n:stroke", "n:end", "end")
    ]
    assert order == sorted(order)
