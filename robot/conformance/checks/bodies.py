"""Checks of section 3: what is skipped, and what is used."""

from functools import partial

from robot.conformance.check import Chapter
from robot.conformance.heard import header
from robot.conformance.probe import ACTS_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m
from robot.protocol.schema import MESSAGES, pack, spec_of
from robot.protocol.wire import MAX_BODY, encode_frame

BODIES = Chapter("Bodies", 3)

_UNKNOWN = (0x00, 0x04, 0x13, 0x42, 0x80, 0xA0, 0xFF)
_ECHOES = (
    m.Welcome(2, 0, 1, 1, 1, 1, 1, "echo", "echo"),
    m.Joint(0, -1.0, 1.0, 1.0, "echo"),
    m.Name(m.ITEM_MOTION, 0, "echo"),
    m.State(1, 0, 0, 0.0, 0.0, 1.0, 0, m.NOTHING, m.NOTHING, (0.0,) * 16),
    m.Ack(1, m.TAKEN),
    m.Gone(),
)
_SPOKEN = (
    m.Hello(1, 0x01010101),
    m.Ask(m.ITEM_MOTION, 0),
    m.Beat(0x0101),
    m.Express(1, 0.5, 0.5),
    m.Play(1, m.ITEM_MOTION, 0),
    m.Stop(1),
)


@BODIES.must
def unknown_message_skipped(robot: Probe) -> None:
    """A message whose number is not known is skipped, in the session and outside of it."""
    robot.fresh()
    for number in _UNKNOWN:
        for session in (robot.session, robot.session + 0x0101):
            body = header(number, session) + b"\x01\x02\x03\x04\x05"
            robot.unanswered(encode_frame(body), f"a message {number:02X}")


@BODIES.must
def echo_skipped(robot: Probe) -> None:
    """A message that only robots send is an echo and is skipped, in the session and outside."""
    robot.fresh()
    for echo in _ECHOES:
        for session in (robot.session, robot.session + 0x0101):
            what = f"an echo of {spec_of(type(echo)).name}"
            robot.unanswered(robot.frame(echo, session), what)


@BODIES.must
def short_body_skipped(robot: Probe) -> None:
    """A body that is shorter than its message was in version 1 is skipped."""
    robot.fresh()
    for length in (1, 2):
        robot.unanswered(encode_frame(b"\x03\x21"[:length]), f"a body of {length} bytes")
    for message in _SPOKEN:
        form = spec_of(type(message))
        for length in range(3, form.size):
            body = pack(message, robot.session)[:length]
            what = f"{form.name} of {length} bytes"
            robot.unanswered(encode_frame(body), what)
    _untaken(robot, "short bodies")


@BODIES.must
def longer_body_used(robot: Probe) -> None:
    """Of a body that is longer than known, the known fields are used."""
    robot.fresh()
    for more in (1, 4, 40):
        count = robot.next_count()
        robot.write(_longer(m.Beat(count), robot, more))
        robot.expect(m.State, f"a BEAT with {more} bytes more", beat=count)
        number = robot.next_number()
        robot.write(_longer(m.Express(number, 0.0, 0.0), robot, more))
        robot.expect(m.Ack, f"an EXPRESS with {more} bytes more", number=number, result=m.TAKEN)
        robot.next_session()
        robot.write(_longer(m.Hello(2, robot.host), robot, more))
        robot.expect(m.Welcome, f"a HELLO with {more} bytes more")


@BODIES.must
def field_out_of_range_skipped(robot: Probe) -> None:
    """A body with a field out of its range is skipped."""
    robot.fresh()
    good = robot.express(0.0, 0.0)
    number = (good + 1).to_bytes(4, "little")
    wrong = {
        "EXPRESS with valence 10001": (0x10, number + b"\x11\x27\x00\x00\xff"),
        "EXPRESS with valence -10001": (0x10, number + b"\xef\xd8\x00\x00\xff"),
        "EXPRESS with arousal 10001": (0x10, number + b"\x00\x00\x11\x27\xff"),
        "EXPRESS with arousal -32768": (0x10, number + b"\x00\x00\x00\x80\xff"),
        "EXPRESS with number 0": (0x10, bytes(8) + b"\xff"),
        "PLAY of item 0": (0x11, number + b"\x00\x00"),
        "PLAY of item 3": (0x11, number + b"\x03\x00"),
        "PLAY with number 0": (0x11, bytes(4) + b"\x01\x00"),
        "STOP with number 0": (0x12, bytes(4)),
        "HELLO with version 0": (0x01, b"\x00\x01\x01\x01\x01"),
        "HELLO with host 0": (0x01, b"\x02\x00\x00\x00\x00"),
    }
    for what, (kind, rest) in wrong.items():
        robot.unanswered(encode_frame(header(kind, robot.session) + rest), what)
    _untaken(robot, "fields out of range", good)


@BODIES.must
def express_of_version_1_used(robot: Probe) -> None:
    """An EXPRESS without the fields that version 2 added is used, and means the default."""
    for offer in (1, 2):
        robot.fresh(offer)
        number = robot.next_number()
        robot.say(m.Express(number, 0.5, 0.5), version=1)
        what = f"an EXPRESS of 11 bytes, after HELLO (version {offer})"
        robot.expect(m.Ack, what, number=number, result=m.TAKEN)


@BODIES.must
def express_of_version_2_used(robot: Probe) -> None:
    """The mood that an EXPRESS names is the one that STATE shows from then on."""
    welcome = robot.fresh()
    if robot.version < 2 or welcome.moods < 2:
        raise NotApplicableError("it speaks version 1, or has fewer than two moods")
    for mood in (welcome.moods - 1, 0):
        robot.express(0.0, 0.0, mood)
        states = robot.live(ACTS_WITHIN, partial(_has_mood, mood=mood))
        if states[-1].mood != mood:
            raise UnmetError(
                f"STATE(mood={mood}) within {1000 * ACTS_WITHIN:.0f} ms after EXPRESS with it",
                f"mood={states[-1].mood}",
            )


def _has_mood(state: m.State, mood: int) -> bool:
    return state.mood == mood


def _longer(message: object, robot: Probe, more: int) -> bytes:
    body = pack(message, robot.session) + b"\x17" * more
    return encode_frame(body[:MAX_BODY])


def _untaken(robot: Probe, what: str, number: int = 0) -> None:
    taken = robot.beat(what).taken
    if taken != number:
        raise UnmetError(f"STATE(taken={number}) after {what}", f"taken={taken}")


assert not {*_UNKNOWN} & {*MESSAGES}
