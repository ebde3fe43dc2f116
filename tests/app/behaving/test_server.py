"""Blocks over TCP: documents in, feedback out, and clients that misbehave."""

import socket
import threading
from contextlib import ExitStack, closing

import pytest

from cubeling.app.admission import ClientLimits, Token
from cubeling.app.behaving.live import NoOutput, play_live
from cubeling.app.behaving.server import BlockServer
from cubeling.app.errors import AppError
from tests.app.behaving.players import block, player

WAIT_S = 20.0

TOKEN = Token("open-sesame")


@pytest.fixture
def server():
    with closing(BlockServer(0, TOKEN)) as opened:
        yield opened


def connected(server, first=f"token {TOKEN.text}\n"):
    client = socket.create_connection(("127.0.0.1", server.port))
    client.settimeout(WAIT_S)
    client.sendall(first.encode())
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
        assert server.next_document(WAIT_S) == b'<bml id="2"/>'
        one.sendall(b"</x></bml>")
        assert server.next_document(WAIT_S) == b"<bml><x></x></bml>"
        server.send("<done/>")
        assert received(one, b"<done/>") == received(other, b"<done/>") == "<done/>\n"


def test_a_client_that_sends_no_xml_is_told_so_and_the_others_go_on(server):
    with connected(server) as bad, connected(server) as good:
        bad.sendall(b"hello")
        assert "PARSING_FAILURE" in received(bad, b"never")
        good.sendall(b"<bml/>")
        assert server.next_document(WAIT_S) == b"<bml/>"


def test_a_client_that_reads_nothing_is_let_go_and_stalls_nobody(server):
    with connected(server) as deaf, connected(server) as good:
        deaf.sendall(b"<bml/>")
        good.sendall(b"<bml/>")
        assert server.next_document(WAIT_S)
        assert server.next_document(WAIT_S)
        large = "<x>" + "y" * (ClientLimits().unsent // 4) + "</x>"
        for number in range(40):
            server.send(large)
            received(good, b"</x>")
            good.sendall(f"<bml id='{number}'/>".encode())
            assert server.next_document(WAIT_S)


def test_a_client_without_the_token_is_told_so_and_gets_nothing(server):
    with connected(server, "token another-one\n<bml/>") as stranger, connected(server) as good:
        assert "the first line has to be: token" in received(stranger, b"never")
        good.sendall(b"<bml id='g'/>")
        assert server.next_document(WAIT_S) == b"<bml id='g'/>"


@pytest.fixture
def timeless():
    """A server whose limits of time never come."""
    with closing(BlockServer(0, TOKEN, clock=lambda: 0.0)) as opened:
        yield opened


def test_documents_are_taken_by_turns(timeless):
    with connected(timeless) as busy, connected(timeless) as quiet:
        busy.sendall(b"<bml id='b'/>" * 500)
        assert timeless.next_document(WAIT_S) == b"<bml id='b'/>"
        quiet.sendall(b"<bml id='q'/><<")
        received(quiet, b"never")  # told that this is no XML, so all before it has come
        taken = [timeless.next_document(WAIT_S) for _ in range(500)]
        assert taken.index(b"<bml id='q'/>") <= 1


def test_strangers_take_no_place_of_clients_and_there_are_so_many_places():
    limits = ClientLimits(clients=2)
    with closing(BlockServer(0, TOKEN, limits=limits)) as server, ExitStack() as open_ones:
        for _ in range(6):
            open_ones.enter_context(connected(server, "tok"))
        one, two = (open_ones.enter_context(connected(server)) for _ in range(2))
        for client in (one, two):
            client.sendall(b"<bml/>")
            assert server.next_document(WAIT_S)
        with connected(server) as third:
            assert "there are 2 clients" in received(third, b"never")
        server.send("<x/>")
        assert received(one, b"<x/>") == received(two, b"<x/>") == "<x/>\n"


def test_who_is_quiet_gives_its_place_up_to_a_newcomer():
    now, limits = [0.0], ClientLimits(clients=2)
    opened = BlockServer(0, TOKEN, limits=limits, clock=lambda: now[0])
    with closing(opened) as server, connected(server) as quiet, connected(server) as busy:
        for client in (quiet, busy):
            client.sendall(b"<bml/>")
            assert server.next_document(WAIT_S)
        now[0] += 5.0
        busy.sendall(b"<bml/>")
        assert server.next_document(WAIT_S)
        with connected(server) as newcomer:
            newcomer.sendall(b"<bml id='n'/>")
            assert server.next_document(WAIT_S) == b"<bml id='n'/>"
            assert "another client needs the place" in received(quiet, b"never")


def test_a_burst_of_strangers_ends_no_client_that_is_about_to_tell_the_token(server):
    with ExitStack() as open_ones, connected(server, "") as slow:
        for _ in range(60):
            open_ones.enter_context(connected(server, "tok"))
        with connected(server) as other:  # all that connected before it are known now
            other.sendall(b"<bml id='o'/>")
            assert server.next_document(WAIT_S)
        slow.sendall(f"token {TOKEN.text}\n<bml id='s'/>".encode())
        assert server.next_document(WAIT_S) == b"<bml id='s'/>"


def test_a_client_that_sends_nothing_is_disconnected_after_a_while():
    now = [0.0]
    with (
        closing(BlockServer(0, TOKEN, clock=lambda: now[0])) as server,
        connected(server) as client,
    ):
        client.sendall(b"<bml/>")
        assert server.next_document(WAIT_S)
        now[0] = ClientLimits().idle_s + 1.0
        assert "nothing has come for 600 s" in received(client, b"never")


def test_what_clients_that_have_gone_have_sent_shares_one_turn(timeless):
    for _ in range(4):
        with connected(timeless) as client:
            client.sendall(b"<bml id='gone'/>" * 8 + b"<<")
            received(client, b"never")
    with connected(timeless) as good:
        good.sendall(b"<bml id='good'/>" * 3 + b"<<")
        received(good, b"never")
        taken = [timeless.next_document(WAIT_S) for _ in range(12)]
        assert taken.count(b"<bml id='good'/>") == 3


def test_a_client_that_goes_away_is_forgotten(server):
    for _ in range(40):
        with connected(server) as client:
            client.sendall(b"<bml/>")
            assert server.next_document(WAIT_S)
    server.send("<x/>")


def test_closing_twice_is_nothing_and_disconnects_clients():
    server = BlockServer(0, TOKEN)
    with connected(server) as client:
        client.sendall(b"<bml/>")
        assert server.next_document(WAIT_S)
        server.send("<last/>")
        server.close()
        server.close()
        assert received(client, b"never") == "<last/>\n"


@pytest.mark.parametrize("port", [-1, 70_000])
def test_a_port_that_there_is_not_is_one_line(port):
    with pytest.raises(AppError, match="choose another port"):
        BlockServer(port, TOKEN)


def test_a_port_in_use_is_one_line(server):
    with pytest.raises(AppError, match="choose another port"):
        BlockServer(server.port, TOKEN)


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
