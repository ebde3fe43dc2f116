"""Attacks on a block server: what a client, or many, may send or leave out.

Each is called until its time is over; what goes wrong on its own side is none of its business.
"""

import itertools
import socket
import struct
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, suppress

import numpy as np

from tests.campaigns.served import Served
from tests.characters.behaviour.bml.suite import block

Attack = Callable[[Served, float], None]
"""Attacks a server until a time of `time.monotonic` [s]."""

NUMBERS = itertools.count()
"""So that every block has an id of its own."""


def _send(server: Served, until: float, parts: Iterator[bytes]) -> None:
    """Send parts over one connection, and over a new one when it is closed, reading feedback."""
    while time.monotonic() < until:
        with suppress(OSError), closing(server.connect()) as client:
            client.setblocking(False)
            for part in parts:
                _push(client, part, until)
                if time.monotonic() > until:
                    return


def _push(client: socket.socket, part: bytes, until: float) -> None:
    """Send all of a part as far as the time allows, and read what comes meanwhile."""
    rest = memoryview(part)
    while rest and time.monotonic() < until:
        with suppress(BlockingIOError):
            if client.recv(1 << 18) == b"":
                raise ConnectionResetError
        try:
            rest = rest[client.send(rest[: 1 << 16]) :]
        except BlockingIOError:
            time.sleep(0.002)


def documents(make: Callable[[int], str | bytes]) -> Attack:
    """Return the attack that sends documents made of a number as fast as they are taken."""

    def parts() -> Iterator[bytes]:
        for number in NUMBERS:
            made = make(number)
            yield made if isinstance(made, bytes) else made.encode()

    return lambda server, until: _send(server, until, parts())


def once(text: bytes, first: str | None = None, connections: int = 1) -> Attack:
    """Return the attack that sends a text over some connections, and holds them."""

    def attack(server: Served, until: float) -> None:
        with ExitStack() as held:
            for _ in range(connections):
                with suppress(OSError):
                    client = held.enter_context(closing(server.connect(first)))
                    client.setblocking(False)
                    _push(client, text, until)
            while time.monotonic() < until:
                time.sleep(0.02)

    return attack


def again(text: bytes, first: str | None = None, reset: bool = False) -> Attack:
    """Return the attack that connects, sends a text and leaves, again and again."""

    def attack(server: Served, until: float) -> None:
        while time.monotonic() < until:
            with suppress(OSError), closing(server.connect(first)) as client:
                if reset:  # closing sends RST
                    client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                client.setblocking(False)
                _push(client, text, until)

    return attack


def slowly(text: bytes, connections: int = 1) -> Attack:
    """Return the attack that sends a text byte by byte over some connections."""

    def attack(server: Served, until: float) -> None:
        with ExitStack() as held:
            clients = [held.enter_context(closing(server.connect())) for _ in range(connections)]
            for number in itertools.cycle(range(len(text))):
                for client in clients:
                    with suppress(OSError):
                        client.sendall(text[number : number + 1])
                time.sleep(0.02)
                if time.monotonic() > until:
                    return

    return attack


def deafly(make: Callable[[int], str]) -> Attack:
    """Return the attack that sends documents and never reads the feedback."""

    def attack(server: Served, until: float) -> None:
        while time.monotonic() < until:
            with suppress(OSError), closing(server.connect()) as client:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
                while time.monotonic() < until:
                    client.sendall(make(next(NUMBERS)).encode())

    return attack


def half_closed(server: Served, until: float) -> None:
    """Send a document and close one direction, again and again."""
    while time.monotonic() < until:
        with suppress(OSError), closing(server.connect()) as client:
            client.sendall(_named("<wait/>").encode())
            client.shutdown(socket.SHUT_WR)
            client.recv(4096)


def _named(inside: str, more: str = "") -> str:
    return block(inside, name=f"a{next(NUMBERS)}", more=more)


def _rules(rule: str, count: int, behaviours: str = "<wait id='w'/><head id='h'/>") -> str:
    rules = "".join(rule.format(i=i, j=(7 * i + 3) % 150) for i in range(count))
    return _named(f"{behaviours}<constraint>{rules}</constraint>")


HEADS = "".join(f"<head id='h{i}' lexeme='NOD'/>" for i in range(150))

SYNCHRONIZE = "<synchronize ref='w:end+{i}'><sync ref='w:start'/></synchronize>"

THREE = (
    "<synchronize><sync ref='w:start+{i}'/><sync ref='h:start'/><sync ref='h:end'/></synchronize>"
)

CIRCLES = "<after ref='h{j}:end'><sync ref='h{i}:start'/></after>"

LAUGHS = "".join(f"<!ENTITY l{i} '{f'&l{i - 1};' * 10 if i else 'ha'}'>" for i in range(12))

LONG = "word " * 990

GESTURES = "".join(f"<gesture id='g{i}' lexeme='WAVE'/>" for i in range(200))

FML = "".join(f"<performative id='p{i}' type='greet'/>" for i in range(60))

JUNK = np.random.default_rng(1).bytes(1 << 16)

ATTACKS: dict[str, Attack] = {
    "a flood of documents": documents(lambda n: _named("<head lexeme='NOD'/>")),
    "a flood of empty blocks": documents(lambda n: f"<bml id='e{n}'/>"),
    "a flood of one id": documents(lambda n: block("<wait/>", name="same")),
    "half documents, and gone": again(b"<bml id='h'><head"),
    "half a document, held": once(b"<bml id='h'><head", connections=15),
    "slow loris": slowly(b"<bml id='s'>" + b" " * 10_000),
    "fifteen slow lorises": slowly(b"<bml id='s'>" + b" " * 10_000, connections=15),
    "a slow token": once(b"", "tok", connections=60),
    "a document of 20 MB": again(b"<bml id='x'>" + b" " * 20_000_000),
    "documents of 1 MB": documents(lambda n: _named(f"<speech><text>{LONG * 200}</text></speech>")),
    "feedback that is not read": deafly(lambda n: _named(HEADS)),
    "the wrong token": again(b"<bml id='w'/>", "token guess-number-one\n"),
    "no token": again(b"<bml id='w'/>", ""),
    "a first line of 1 MB": again(b"t" * (1 << 20), ""),
    "sixty connections": once(b"<bml id='c'/>", connections=60),
    "connections that come and go": again(b""),
    "connections that are reset": again(b"<bml id='r'><wait/></bml>" * 20, reset=True),
    "half-closed connections": half_closed,
    "2,400 constraints": documents(lambda n: _rules(SYNCHRONIZE, 2400)),
    "as many constraints as are taken": documents(lambda n: _rules(SYNCHRONIZE, 250)),
    "constraints of three moments": documents(lambda n: _rules(THREE, 160)),
    "orders in circles": documents(lambda n: _rules(CIRCLES, 150, HEADS)),
    "deep nesting": documents(lambda n: "<bml id='d'>" + "<required>" * 5000),
    "a billion laughs": documents(
        lambda n: f"<!DOCTYPE b [{LAUGHS}]><bml id='l{n}'><speech><text>&l11;</text></speech></bml>"
    ),
    "an external entity": documents(
        lambda n: f"<!DOCTYPE b [<!ENTITY x SYSTEM 'file:///etc/passwd'>]><bml id='x{n}'>&x;</bml>"
    ),
    "binary junk": again(JUNK),
    "a comment of ends": once(b"<bml><!--" + b">" * 1_000_000),
    "junk after a tag": again(b"<bml>" + JUNK),
    "zero bytes": again(b"<bml id='z'>" + bytes(1 << 16)),
    "unknown encodings": documents(lambda n: f'<?xml version="1.0" encoding="utf-{n}"?><bml/>'),
    "long ids": documents(lambda n: block("<wait/>", name="i" * 500_000)),
    "long numbers": documents(lambda n: _named(f"<wait start='{'1' * 500_000}x'/>")),
    "thousands of elements": documents(
        lambda n: _named("<gesture>" + "<x/>" * 4900 + "</gesture>")
    ),
    "200 gestures at once": documents(lambda n: _named(GESTURES)),
    "looks of an hour": documents(lambda n: _named("<gaze target='cube' end='3600'/>")),
    "postures of many poses": documents(
        lambda n: _named("<posture>" + "<pose type='ARMS_CROSSED'/>" * 2000 + "</posture>")
    ),
    "blocks that wait for ever": documents(lambda n: _named("", 'bmla:preplan="true"')),
    "a chain of blocks": documents(lambda n: _named("<wait/>", 'composition="APPEND"')),
    "blocks that replace all": documents(lambda n: _named(HEADS, 'composition="REPLACE"')),
    "interrupts of nobody": documents(
        lambda n: _named("".join(f"<bmla:interrupt id='i{i}' target='x y z'/>" for i in range(200)))
    ),
    "long speeches": documents(
        lambda n: _named(
            "".join(f"<speech id='s{i}'><text>{LONG}</text></speech>" for i in range(9))
        )
    ),
    "times without an end": documents(lambda n: _named("<wait start='1e9'/><head end='-1e300'/>")),
    "many intentions": documents(lambda n: f"<fml id='f{n}'>{FML}</fml>"),
}
"""Attacks by name."""
