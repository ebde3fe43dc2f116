"""The bytes of a robot's line in words."""

import dataclasses

from hypothesis import given, strategies as st

from cubeling.app.ui.panels.wire_log import MAX_CHUNKS, MAX_MESSAGES, RATE_SPAN_S, WireLog
from cubeling.app.ui.panels.wire_words import WORDS, CubelingDecoder
from cubeling.robot import Catalogue, JointLimits
from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import MESSAGES, pack
from cubeling.robot.protocol.wire import encode_frame

JOINTS = tuple(JointLimits(name, -1.0, 1.0, 1.0) for name in ("neck", "tail"))
CATALOGUE = Catalogue(
    name="Dino", firmware="1", joints=JOINTS, motions=("dance", "bow"), sounds=("roar",),
    moods=("neutral", "happy"),
)  # fmt: skip


STATE = m.State(
    beat=3, taken=1, flags=0, valence=0.5, arousal=-0.25, battery=1.0, mood=1, motion=1, sound=255,
    joints=(0.0,) * 16,
)  # fmt: skip


def frame(message):
    return encode_frame(pack(message, 7))


def test_every_message_has_words():
    assert set(WORDS) == {spec.kind for spec in MESSAGES.values()}


def test_messages_are_told_by_the_names_of_the_catalogue():
    log = WireLog()
    log("tx", frame(m.Hello(2, 99)), 0.0)
    log("rx", frame(m.Welcome(2, 0, 5, 1, 2, 1, 2, "Dino", "v1")), 0.1)
    log("tx", frame(m.Express(12, 0.5, -0.25, 1)) + frame(m.Play(13, 1, 0))[:5], 0.2)
    log("tx", frame(m.Play(13, 1, 0))[5:], 0.3)
    log("rx", frame(m.Ack(12, 0)) + frame(m.Ack(13, 1)) + frame(STATE), 0.4)
    log("tx", frame(m.Beat(3)), 0.5)
    traffic = log.read("cubeling", CATALOGUE, 0.5)
    assert [(each.direction, each.text, each.time) for each in traffic.messages] == [
        ("tx", "hello, I speak version 2", 0.0),
        ("rx", "welcome, I am Dino with v1", 0.1),
        ("tx", "12: feel happy (+0.50, -0.25)", 0.2),
        ("tx", "13: play dance", 0.3),
        ("rx", "12 is taken", 0.4),
        ("rx", "13 is refused: it has no such entry", 0.4),
    ]
    assert [each.text for each in traffic.routine] == [
        "beat 3",
        "I feel happy (+0.50, -0.25), playing bow",
    ]
    assert traffic.rates["tx"][0] == 4 / RATE_SPAN_S
    assert traffic.rates["rx"][0] == 4 / RATE_SPAN_S
    assert log.read("cubeling", CATALOGUE, 10.0).rates == {"tx": (0.0, 0.0), "rx": (0.0, 0.0)}


def test_moves_and_the_robots_log_are_told():
    log = WireLog()
    log("tx", frame(m.Move(5, 0.5, 0b10, 0b1, (0.1,) * 16)), 0.0)
    log("rx", frame(m.Log(1, 0, 1, "low battery")) + frame(m.Log(2, 0, 7, "a\x1b[31mb")), 0.1)
    messages = log.read("cubeling", CATALOGUE, 0.1).messages
    assert [each.text for each in messages] == [
        "5: turn neck in 0.5 s and let go of tail",
        "warning: low battery",
        "error: a [31mb",
    ]


def test_it_starts_in_the_middle_of_a_session_and_without_a_catalogue():
    log = WireLog()
    for count in range(MAX_CHUNKS + 40):
        log("tx", frame(m.Express(count + 1, 0.0, 0.0, 9)), 0.01 * count)
    traffic = log.read("cubeling", None, 0.01 * count)
    assert len(traffic.messages) == MAX_MESSAGES
    assert traffic.messages[-1].text == f"{count + 1}: feel mood 9 (+0.00, +0.00)"


@given(st.binary(max_size=300))
def test_any_bytes_are_survived(data):
    log = WireLog()
    for protocol in ("cubeling", "pleo"):
        log("rx", data, 0.0)
        log("rx", b"\0\n", 0.0)
        for message in log.read(protocol, CATALOGUE, 0.0).messages:
            assert message.text.isprintable()


def test_every_message_can_be_told_without_names():
    for spec in MESSAGES.values():
        kinds = {
            "u8": 1,
            "u16": 1,
            "u32": 1,
            "i16": 0.0,
            "text16": "x",
            "text80": "x",
            "i16x16": (0.0,) * 16,
        }
        fields = {
            field.name: kinds[field.metadata["wire"][0]] for field in dataclasses.fields(spec.kind)
        }
        (words,) = CubelingDecoder(spec.sender).feed(frame(spec.kind(**fields)), None)
        assert words.text
