"""Checks of the failsafe and of farewells (section 7): a robot alone goes to neutral."""

from robot.conformance.check import Chapter
from robot.conformance.heard import header
from robot.conformance.probe import ACTS_WITHIN, AT_ONCE, NEUTRAL, SLACK, Probe, told
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.schema import spec_of
from robot.protocol.wire import encode_frame

FAILSAFE = Chapter("Failsafe", 7)

ALONE = timing.FAILSAFE_PROMISE + 0.02
"""How long the robot hears nothing [s]: its time, and a little for the line."""

NOT_BEFORE = 0.400
"""No robot gives a session up after less silence than this [s] (PROTOCOL.md, section 7)."""

NOT_YET = NOT_BEFORE - 0.03
"""After so much silence a session must still be open [s]; the line may take the rest."""

FED_EVERY = 0.27
"""Time between two messages of which one alone would not do [s]."""

NOISE_EVERY = 0.03
"""Time between two stretches of noise [s]."""

_EACH = round(1000 * FED_EVERY)


@FAILSAFE.must
def session_ends_after_silence(robot: Probe) -> None:
    """After 500 ms without a message of its session, that session is gone."""
    robot.fresh()
    robot.beat("HELLO")
    robot.hear(ALONE)
    _is_gone(robot, f"{1000 * ALONE:.0f} ms of silence")


@FAILSAFE.must
def session_survives_short_silence(robot: Probe) -> None:
    """Before 400 ms without a message have passed, the session is still open."""
    robot.fresh()
    robot.beat("HELLO")
    robot.hear(NOT_YET)
    robot.beat(f"{1000 * NOT_YET:.0f} ms of silence")


@FAILSAFE.must
def any_message_counts(robot: Probe) -> None:
    """Whatever message of the session comes keeps it open: also a repeat, and a vain ASK."""
    robot.fresh()
    number = robot.next_number()
    messages = (
        m.Hello(timing.VERSION, robot.host),  # first: after the others it would open it again
        m.Ask(m.ITEM_MOTION, 0),
        m.Ask(9, 255),
        m.Express(number, 0.0, 0.0),
        m.Express(number, 0.0, 0.0),
        m.Play(number + 1, m.ITEM_MOTION, 254),
        m.Stop(number + 2),
    )
    for message in messages:
        robot.hear(FED_EVERY - SLACK)
        robot.say(message)
        gone = [one for one in robot.hear(SLACK) if isinstance(one.message, m.Gone)]
        if gone:
            name = spec_of(type(message)).name
            raise UnmetError(f"an open session for {name}, {_EACH} ms after a message", told(gone))
    robot.hear(FED_EVERY)
    robot.beat(f"seven messages that are no BEAT, {_EACH} ms apart")


@FAILSAFE.must
def silent_after_failsafe(robot: Probe) -> None:
    """When the session has ended by silence, the robot is silent too."""
    robot.fresh()
    robot.hear(ALONE + SLACK)
    came = robot.hear(0.3)
    if came:
        raise UnmetError("silence once the session has ended by silence", told(came))


@FAILSAFE.must
def failsafe_forgets_the_emotion(robot: Probe) -> None:
    """After the failsafe no command is in force: WELCOME says 0 to the same host."""
    robot.fresh()
    robot.express(0.3, 0.3)
    robot.hear(ALONE)
    welcome = robot.again()
    if welcome.taken:
        raise UnmetError("WELCOME(taken=0) after the failsafe", f"taken={welcome.taken}")


@FAILSAFE.must
def failsafe_keeps_the_numbers(robot: Probe) -> None:
    """After the failsafe the numbers of the same host go on: old commands stay without effect."""
    robot.fresh()
    robot.command(m.Express(5, 0.0, 0.0))
    robot.hear(ALONE)
    robot.again()
    before = robot.beat("HELLO")
    if before.taken != 5:
        raise UnmetError("STATE(taken=5) after EXPRESS 5, the failsafe, HELLO", f"{before.taken}")
    robot.say(m.Express(5, 0.9, 0.9))
    robot.expect(m.Ack, "EXPRESS 5 again", number=5)
    after = robot.live(ACTS_WITHIN)[-1]
    if max(after.valence - before.valence, after.arousal - before.arousal) > NEUTRAL:
        raise UnmetError("no effect of EXPRESS 5, taken before the failsafe", f"{after.valence}")
    robot.command(m.Express(6, 0.0, 0.0))
    welcome = robot.again()
    if welcome.taken != 6:
        raise UnmetError("WELCOME(taken=6) after EXPRESS 6", f"taken={welcome.taken}")


@FAILSAFE.must
def failsafe_not_fed_by_noise(robot: Probe) -> None:
    """Noise and damaged frames do not keep a session open."""
    robot.fresh()
    robot.beat("HELLO")
    damaged = bytearray(robot.frame(m.Beat(robot.next_count())))
    damaged[-2] ^= 1
    _fed(robot, (b"\x55\xaa noise \r\n", bytes(damaged), b"\0\0\0"), "noise")


@FAILSAFE.must
def failsafe_not_fed_by_strangers(robot: Probe) -> None:
    """Messages of other sessions do not keep a session open."""
    robot.fresh()
    robot.beat("HELLO")
    foreign = robot.session ^ 0x1111
    frames = (
        robot.frame(m.Beat(7), foreign),
        robot.frame(m.Express(1, 0.5, 0.5), foreign),
        robot.frame(m.Hello(timing.VERSION, robot.host), 0),
    )
    _fed(robot, frames, "messages of another session")


@FAILSAFE.must
def failsafe_not_fed_by_what_is_skipped(robot: Probe) -> None:
    """Bodies that are skipped do not keep a session open: echoes, unknown, short, out of range."""
    robot.fresh()
    robot.beat("HELLO")
    frames = (
        robot.frame(m.Ack(1, m.TAKEN)),
        encode_frame(header(0x42, robot.session) + b"\1\1\1\1"),
        encode_frame(header(0x03, robot.session) + b"\1"),
        encode_frame(header(0x10, robot.session) + b"\1\1\1\1\x7f\x7f\x7f\x7f\xff"),
    )
    _fed(robot, frames, "bodies to be skipped")


@FAILSAFE.must
def bye_ends_the_session(robot: Probe) -> None:
    """After BYE the session is gone, and no command is in force."""
    robot.fresh()
    robot.express(0.3, 0.3)
    robot.say(m.Bye())
    robot.hear(AT_ONCE)
    _is_gone(robot, "BYE")
    welcome = robot.again()
    if welcome.taken:
        raise UnmetError("WELCOME(taken=0) after BYE", f"taken={welcome.taken}")


def _is_gone(robot: Probe, after: str) -> None:
    robot.say(m.Beat(robot.next_count()))
    robot.expect(m.Gone, f"{after}, then BEAT")


def _fed(robot: Probe, frames: tuple[bytes, ...], what: str) -> None:
    """Send what must not count until the session must have ended, and see that it has."""
    end = robot.now + ALONE
    while robot.now < end:
        for frame in frames:
            robot.write(frame)
        robot.hear(min(NOISE_EVERY, max(end - robot.now, 0)))
    robot.hear(2 * timing.GONE_EVERY)
    _is_gone(robot, f"{1000 * ALONE:.0f} ms of {what}")
