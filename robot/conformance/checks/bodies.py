"""Checks of section 3: which bodies are skipped, and which are used."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.moods import expect_mood, mood_to_name
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import MESSAGES, pack, spec_of
from cubeling.robot.protocol.wire import MAX_BODY, encode_frame

BODIES = CheckGroup("Bodies", 3)

_UNKNOWN_NUMBERS = (0x00, 0x04, 0x14, 0x42, 0x80, 0xA0, 0xFF)
_ROBOT_MESSAGES = (
    m.Welcome(2, 0, 1, 1, 1, 1, 1, "echo", "echo"),
    m.Joint(0, -1.0, 1.0, 1.0, "echo"),
    m.Name(m.ITEM_MOTION, 0, "echo"),
    m.State(1, 0, 0, 0.0, 0.0, 1.0, 0, m.NOTHING, m.NOTHING, (0.0,) * 16),
    m.Log(1, 1, m.SEVERITY_ERROR, "echo"),
    m.Ack(1, m.RESULT_TAKEN),
    m.Gone(),
)
_HOST_MESSAGES = (
    m.Hello(1, 0x01010101),
    m.Ask(m.ITEM_MOTION, 0),
    m.Beat(0x0101),
    m.Express(1, 0.5, 0.5),
    m.Play(1, m.ITEM_MOTION, 0),
    m.Stop(1),
    m.Move(1, 0.0, 0, 1, (0.0,) * m.JOINTS_MAX),
)


@BODIES.must
def unknown_message_skipped(probe: Probe) -> None:
    """A message with an unknown number is skipped, in the session and outside."""
    probe.open_session()
    for number in _UNKNOWN_NUMBERS:
        for session in (probe.session, probe.session + 0x0101):
            frame = probe.raw_frame(number, b"\x01\x02\x03\x04\x05", session)
            probe.expect_no_reply(frame, f"a message {number:02X}")


@BODIES.must
def echo_skipped(probe: Probe) -> None:
    """A message that only robots send is an echo and is skipped, in the session and outside."""
    probe.open_session()
    for echo in _ROBOT_MESSAGES:
        for session in (probe.session, probe.session + 0x0101):
            what = f"an echo of {spec_of(type(echo)).name}"
            probe.expect_no_reply(probe.frame(echo, session), what)


@BODIES.must
def short_body_skipped(probe: Probe) -> None:
    """A body that is shorter than its message was at first is skipped."""
    probe.open_session()
    for length in (1, 2):
        probe.expect_no_reply(encode_frame(b"\x03\x21"[:length]), f"a {length}-byte body")
    for message in _HOST_MESSAGES:
        spec = spec_of(type(message))
        for length in range(3, spec.size):
            body = pack(message, probe.session)[:length]
            probe.expect_no_reply(encode_frame(body), f"{spec.name} of {length} bytes")
    probe.expect_taken(0, "short bodies")


@BODIES.must
def longer_body_used(probe: Probe) -> None:
    """The known fields of a body that is longer than known are used."""
    probe.open_session()
    for more in (1, 4, 40):
        count = probe.next_beat()
        probe.write(_extend(m.Beat(count), probe, more))
        probe.expect(m.State, f"a BEAT with a {more}-byte extension", beat=count)
        number = probe.next_number()
        probe.write(_extend(m.Express(number, 0.0, 0.0), probe, more))
        what = f"an EXPRESS with a {more}-byte extension"
        probe.expect(m.Ack, what, number=number, result=m.RESULT_TAKEN)
        probe.write(_extend(m.Ask(m.ITEM_JOINT, 0), probe, more))
        if probe.welcome is not None and probe.welcome.joints:
            probe.expect(m.Joint, f"an ASK with a {more}-byte extension", index=0)
        commands: list[m.Command] = [
            m.Play(probe.next_number(), m.ITEM_MOTION, 254),
            m.Stop(probe.next_number()),
        ]
        if probe.version >= 3:
            commands.append(m.Move(probe.next_number(), 0.0, 0, 0, (0.0,) * m.JOINTS_MAX))
        for command in commands:
            probe.write(_extend(command, probe, more))
            what = f"a {spec_of(type(command)).name} with a {more}-byte extension"
            probe.expect(m.Ack, what, number=command.number)
        probe.write(_extend(m.Bye(), probe, more))
        probe.receive(2 * timing.GONE_EVERY)
        probe.send(m.Beat(probe.next_beat()))
        probe.expect(m.Gone, f"BEAT after a BYE with a {more}-byte extension")
        probe.next_session()
        probe.write(_extend(m.Hello(timing.VERSION, probe.host), probe, more))
        probe.expect(m.Welcome, f"a HELLO with a {more}-byte extension")


@BODIES.must
def field_out_of_range_skipped(probe: Probe) -> None:
    """A body with a field out of its range is skipped."""
    probe.open_session()
    valid = probe.express(0.0, 0.0)
    number = (valid + 1).to_bytes(4, "little")
    invalid = {
        "EXPRESS with valence 10001": (0x10, number + b"\x11\x27\x00\x00\xff"),
        "EXPRESS with valence -10001": (0x10, number + b"\xef\xd8\x00\x00\xff"),
        "EXPRESS with arousal 10001": (0x10, number + b"\x00\x00\x11\x27\xff"),
        "EXPRESS with arousal -32768": (0x10, number + b"\x00\x00\x00\x80\xff"),
        "EXPRESS with number 0": (0x10, bytes(8) + b"\xff"),
        "PLAY of item 0": (0x11, number + b"\x00\x00"),
        "PLAY of item 3": (0x11, number + b"\x03\x00"),
        "PLAY with number 0": (0x11, bytes(4) + b"\x01\x00"),
        "STOP with number 0": (0x12, bytes(4)),
        "MOVE with number 0": (0x13, bytes(42)),
        "HELLO with version 0": (0x01, b"\x00\x01\x01\x01\x01"),
        "HELLO with host 0": (0x01, b"\x02\x00\x00\x00\x00"),
    }
    for what, (kind, fields) in invalid.items():
        probe.expect_no_reply(probe.raw_frame(kind, fields), what)
    probe.expect_taken(valid, "fields out of range")


@BODIES.must
def express_of_version_1_used(probe: Probe) -> None:
    """An EXPRESS without the fields that version 2 added is used, with their defaults."""
    for offer in (1, 2):
        probe.open_session(offer)
        number = probe.next_number()
        probe.send(m.Express(number, 0.5, 0.5), version=1)
        what = f"an EXPRESS of 11 bytes, after HELLO (version {offer})"
        probe.expect(m.Ack, what, number=number, result=m.RESULT_TAKEN)


@BODIES.must
def express_of_version_2_used(probe: Probe) -> None:
    """The mood that an EXPRESS names is the one that STATE shows from then on."""
    for mood in (mood_to_name(probe), 0):
        probe.express(0.0, 0.0, mood)
        expect_mood(probe, mood, "EXPRESS with it")


def _extend(message: object, probe: Probe, more: int) -> bytes:
    body = pack(message, probe.session) + b"\x17" * more
    return encode_frame(body[:MAX_BODY])


assert not {*_UNKNOWN_NUMBERS} & {*MESSAGES}
