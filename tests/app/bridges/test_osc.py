"""OSC in a session: what is sent, what is taken, and what nobody can break or slow down."""

import socket
import struct
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pythonosc.osc_bundle_builder import OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket

from cubeling.affect import Emotion
from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.osc import MAX_ACTS_AT_ONCE, TAKEN, OscIn, OscOut, messages_of
from cubeling.app.bridges.osc_socket import (
    DROP_AT_ONCE,
    MAX_BUNDLE_BYTES,
    READ_AT_ONCE,
    OscMessage,
    OscReceiver,
    _encoded,
    decoded,
)
from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.acts import Act
from cubeling.app.running import opening
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions, session_info
from cubeling.app.session.encoding import CHANNEL_TYPES, MESSAGE_TYPES
from cubeling.app.workshop.exporting import EXPORT_TABLES
from tests.app import session_parts
from tests.app.scripted import play_script

FREE = UdpAddress("127.0.0.1", 0)
NO_STEP: Any = None


def message(address, *arguments):
    builder = OscMessageBuilder(address)
    for each in arguments:
        builder.add_arg(each)
    return builder.build().dgram


@pytest.fixture
def desk():
    """An OSC input on this computer, what it says, and a function that sends to it."""
    said: list[str] = []
    with OscIn(FREE, said.append) as taken, socket.socket(type=socket.SOCK_DGRAM) as ours:
        send = lambda data: ours.sendto(data, ("127.0.0.1", taken.port))  # noqa: E731
        yield SimpleNamespace(
            taken=taken, said=said, send=send, ask=lambda: taken.follow(NO_STEP, (), 0.0)
        )


@pytest.fixture
def listener():
    """A socket that hears what is sent to it, with its address."""
    with socket.socket(type=socket.SOCK_DGRAM) as ours:
        ours.bind(("127.0.0.1", 0))
        ours.setblocking(False)
        yield ours, UdpAddress("127.0.0.1", ours.getsockname()[1])


def heard(ours):
    """Return all datagrams that wait."""
    found: list[bytes] = []
    while True:
        try:
            found.append(ours.recv(65536))
        except BlockingIOError:
            return found


@pytest.fixture(scope="module")
def steps():
    """The steps of a short session."""
    found: list[Step] = []
    play_script("companion", progress=found.append, seconds=3.0)
    return found


def test_every_scalar_column_of_an_export_has_its_address(steps):
    sent = {each.address for step in steps for each in messages_of(step, 0.0)}
    for table in EXPORT_TABLES:
        if table.topic in MESSAGE_TYPES:
            missing = [
                column.name
                for column in table.columns
                if f"/cubeling{table.topic}/{column.name}" not in sent
            ]
            # Nothing is said, and nobody is sent to another place.
            assert set(missing) <= {"said", "target_x_m", "target_z_m"}


def test_a_step_is_sent_in_bundles_that_are_to_be_carried_out_at_once(steps, listener):
    ours, address = listener
    with OscOut(address) as out:
        for step in steps[:10]:
            out.follow(step, (), 0.0)
        out.happen("placed top", 0.0)
    datagrams = heard(ours)
    got: Counter[str] = Counter()
    for data in datagrams:
        assert data[:16] == b"#bundle\0" + struct.pack(">Q", 1)
        messages = [each.message for each in OscPacket(data).messages]
        assert len(data) <= MAX_BUNDLE_BYTES or len(messages) == 1
        got.update(each.address for each in messages)
    assert got["/cubeling/cube/state/x_m"] == got["/cubeling/time"] == 10
    assert got["/cubeling/event"] == 1
    (valence,) = next(
        each.message.params
        for data in datagrams
        for each in OscPacket(data).messages
        if each.message.address == "/cubeling/robot/emotion/valence"
    )
    assert valence == pytest.approx(steps[0].emotion.emotion.valence, abs=1e-6)


WORDS = st.text(st.characters(exclude_characters="\0", codec="utf-8"), max_size=20)


@given(st.lists(st.floats(width=32) | st.integers(-(2**31), 2**31 - 1) | WORDS, max_size=9))
def test_what_is_sent_is_what_others_read(arguments):
    sent = _encoded(OscMessage("/cubeling/x", tuple(arguments)))
    (read,) = OscPacket(sent).messages
    assert read.message.address == "/cubeling/x"
    assert repr(read.message.params) == repr(arguments)


def test_nobody_need_listen(steps):
    with socket.socket(type=socket.SOCK_DGRAM) as gone:
        gone.bind(("127.0.0.1", 0))
        address = UdpAddress("127.0.0.1", gone.getsockname()[1])
    with OscOut(address) as out:
        for step in steps[:5]:
            assert out.follow(step, (), 0.0) == Inputs()


@pytest.mark.parametrize(
    ("data", "asked"),
    [
        (message("/cubeling/in/action", "kiss"), Inputs(acts=(Act("action", "kiss"),))),
        (message("/cubeling/in/action", "kiss", 0.5), Inputs(acts=(Act("action", "kiss", 0.5),))),
        (
            message("/cubeling/in/gesture/vleo", "nod"),
            Inputs(acts=(Act("gesture", "nod", who="vleo"),)),
        ),
        (message("/cubeling/in/say", "Olé!"), Inputs(acts=(Act("say", "Olé!"),))),
        (
            message("/cubeling/in/emotion", -0.5, 0.25),
            Inputs(acts=(Act("emotion", emotion=Emotion(-0.5, 0.25)),)),
        ),
        (message("/cubeling/in/emotion"), Inputs(acts=(Act("emotion"),))),
        (message("/cubeling/in/mark", "error: fell"), Inputs(marks=("error: fell",))),
        (message("/cubeling/in/mark", 7), Inputs(marks=("7",))),
        (message("/cubeling/in/type", "hello"), Inputs(typed="hello")),
        (message("/cubeling/in/clear"), Inputs(clear=True)),
        (message("/cubeling/in/clear", 1.0), Inputs(clear=True)),
        (message("/cubeling/in/clear", 0.0), Inputs()),
    ],
)
def test_what_is_asked_for_comes_in_with_the_next_frame(desk, data, asked):
    desk.send(data)
    assert desk.ask() == asked
    assert desk.ask() == Inputs()
    assert desk.said == []


def test_an_emotion_may_be_a_word(desk):
    desk.send(message("/cubeling/in/emotion", "angry"))
    (act,) = desk.ask().acts
    assert act.emotion.word == "angry"
    assert act.emotion.valence < 0.0 < act.emotion.arousal


def test_a_bundle_of_the_future_is_carried_out_now(desk):
    bundle = OscBundleBuilder(2_000_000_000)
    for _ in range(2):
        builder = OscMessageBuilder("/cubeling/in/gesture")
        builder.add_arg("nod")
        bundle.add_content(builder.build())
    desk.send(bundle.build().dgram)
    assert len(desk.ask().acts) == 2


@pytest.mark.parametrize(
    "data",
    [
        message("/cubeling/in/action"),
        message("/cubeling/in/action", 3),
        message("/cubeling/in/action", "kiss", 7.0),
        message("/cubeling/in/gesture", "nod", 1.0),
        message("/cubeling/in/emotion", 2.0, 0.0),
        message("/cubeling/in/emotion", "nosuchword"),
        message("/cubeling/in/emotion", "a", "b", "c"),
        message("/cubeling/in/mark", "two\nlines"),
        message("/cubeling/in/mark", "x" * 500),
        message("/cubeling/in/nosuch", 1),
        message("/elsewhere", 1),
    ],
)
def test_what_asks_for_nothing_that_there_is_is_counted_and_said_once(desk, data):
    for _ in range(3):
        desk.send(data)
        assert desk.ask() == Inputs()
    assert desk.taken.unknown == 3
    assert desk.said == ["OSC drops messages that asked for nothing that there is"]
    desk.taken.close()
    assert desk.said[1:] == ["OSC dropped 3 messages that asked for nothing that there is"]


NAN = b"/cubeling/in/emotion\0\0\0\0,ff\0" + struct.pack(">ff", float("nan"), 0.0)
BLOB = message("/cubeling/in/say", b"bytes")
DEEP = b"#bundle\0" + struct.pack(">Q", 1)
for _ in range(40):
    DEEP = b"#bundle\0" + struct.pack(">Qi", 1, len(DEEP)) + DEEP
MALFORMED = [b"", b"hello", b"#bundle\0", b"/x", NAN, BLOB, DEEP, b"/" * 3000,
             message("/cubeling/in/say", "x" * 3000), b"#bundle\0" + b"\xff" * 64]  # fmt: skip


@pytest.mark.parametrize("data", MALFORMED)
def test_what_is_no_osc_is_counted_and_dropped(desk, data):
    desk.send(data)
    desk.send(message("/cubeling/in/action", "kiss"))
    assert desk.ask().acts == (Act("action", "kiss"),)
    assert desk.taken.counts["could not be read"] == 1
    assert desk.said == ["OSC drops messages that could not be read"]


@given(st.binary(max_size=200), st.integers(0, 200))
def test_no_datagram_raises_an_error(data, at):
    good = message("/cubeling/in/action", "kiss", 0.5)
    for each in (data, b"/a\0\0," + data, good[:at] + data + good[at:], b"#bundle\0" + data):
        decoded(each)


def test_a_flood_costs_a_frame_no_more_than_some_datagrams(desk):
    """And what comes in time is taken."""
    desk.send(message("/cubeling/in/action", "kiss"))
    noise = message("/cubeling/in/gesture", "nod")
    sent = 1
    with pytest.MonkeyPatch.context() as patch:
        reads: list[int] = []
        read = OscReceiver._read

        def counted(receiver):
            reads.append(1)
            return read(receiver)

        patch.setattr(OscReceiver, "_read", counted)
        for _ in range(5):
            for _ in range(2000):
                desk.send(noise)
                sent += 1
            reads.clear()
            asked = desk.ask()
            assert len(asked.acts) == MAX_ACTS_AT_ONCE
            assert len(reads) <= READ_AT_ONCE + DROP_AT_ONCE
        while desk.ask() != Inputs():
            pass
    taken = desk.taken
    assert 0 < taken.counts["came faster than frames"] < sent
    assert desk.said == ["OSC drops messages that came faster than frames"]


def test_where_the_system_does_not_count_what_it_drops_all_else_is_the_same(desk):
    desk.taken._receiver._counts_lost = False
    desk.send(b"rubbish")
    desk.send(message("/cubeling/in/action", "kiss"))
    assert desk.ask().acts == (Act("action", "kiss"),)
    assert desk.taken.counts["could not be read"] == 1


def test_many_messages_in_few_datagrams_are_not_all_read(desk):
    bundle = OscBundleBuilder(1)
    builder = OscMessageBuilder("/a")
    for _ in range(90):
        bundle.add_content(builder.build())
    data = bundle.build().dgram
    assert len(data) < 2048
    for _ in range(60):
        desk.send(data)
    desk.ask()
    assert desk.taken.unknown < 8 * 90


@pytest.mark.parametrize("text", ["", "host", "host:", ":9000", "9000x", "h:99999", "1:2:x"])
def test_an_address_that_is_none_is_refused(text):
    with pytest.raises(AppError, match="HOST:PORT"):
        UdpAddress.of(text, "--osc")


def test_without_a_host_it_is_this_computer_alone():
    assert UdpAddress.of("9000", "--osc-in") == UdpAddress("127.0.0.1", 9000)
    assert UdpAddress.of("0.0.0.0:9000", "--osc-in") == UdpAddress("0.0.0.0", 9000)


def test_a_port_that_is_taken_is_refused_in_one_line():
    with OscIn(FREE, print) as first, pytest.raises(AppError, match="cannot listen at"):
        OscIn(UdpAddress("127.0.0.1", first.port), print)


class Sender(Instrument):
    """Sends to an OSC input what some frames are to bring, before it is asked."""

    def __init__(self, port, plan):
        self._port, self._plan, self._frame = port, plan, 0

    def follow(self, step, cast, taken):
        with socket.socket(type=socket.SOCK_DGRAM) as ours:
            for data in self._plan.get(self._frame, ()):
                ours.sendto(data, ("127.0.0.1", self._port))
        self._frame += 1
        return Inputs()


@pytest.mark.full
@pytest.mark.slow(reason="a session is computed twice")
def test_a_session_that_osc_drove_replays_without_it_and_without_a_difference(
    short_session, tmp_path, monkeypatch
):
    """Each act is an input of its frame; what cannot be done is told and not recorded."""
    monkeypatch.setattr(opening, "_pace", lambda *_: None)  # a frame waits for what is said in it
    plan = {
        3: [message("/cubeling/in/action", "shout", 1.0)],
        8: [
            message("/cubeling/in/gesture", "shake"),
            message("/cubeling/in/gesture", "nod"),
            message("/cubeling/in/mark", "go"),
        ],
        12: [message("/cubeling/in/emotion", "angry"), message("/cubeling/in/say", "Go away.")],
        16: [message("/cubeling/in/action", "fly"), b"rubbish"],
        20: [np.random.default_rng(seed).bytes(64) for seed in range(50)],
    }
    path = tmp_path / "driven.mcap"
    said: list[str] = []
    options = SessionOptions(
        scenario="companion", source=str(short_session), record=path, pictures=False
    )
    with (
        OscIn(FREE, said.append) as taken,
        open_session(options, instruments=[Sender(taken.port, plan), taken]) as session,
    ):
        run(session, say=said.append)
        refused = "vleo has no action 'fly'; its actions: kiss, shout, nod, shake"
        assert session.refused == [refused]
        assert said.count(refused) == 1
    with SessionFile(path) as file:
        acts = [(act.kind, act.text) for each in file.inputs.values() for act in each.acts]
        assert [mark.name for mark in file.marks] == ["go"]
        spoken = [line[""].utterance.text for line in file.lines.values()]
    # Of two gestures in a frame, the later one is made.
    assert acts == [("action", "shout"), ("gesture", "nod"), ("emotion", ""), ("say", "Go away.")]
    assert spoken == ["Go away."]
    assert "OSC drops messages that could not be read" in said
    assert said[-1] == "OSC dropped 51 messages that could not be read"
    assert session_parts.check(path, session_info(path).options).identical


def test_the_guide_names_every_address_and_channel():
    guide = (Path(__file__).parents[3] / "docs" / "instruments.md").read_text("utf-8")
    for name in TAKEN:
        assert f"`/cubeling/in/{name}`" in guide
    for topic in CHANNEL_TYPES:
        assert f"`/cubeling{topic}/" in guide
