"""Checks of the failsafe and of BYE (section 7): a robot without a host ends its session."""

from itertools import pairwise

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import EFFECT_WITHIN_S, EMOTION_CHANGE, TIMING_SLACK_S, Probe
from cubeling.robot.conformance.received import describe_frames
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import spec_of

FAILSAFE = CheckGroup("Failsafe", 7)

SILENCE_S = timing.FAILSAFE_PROMISE + 0.02
"""Silence after which the session must have ended [s]: the protocol's, and 20 ms for the line."""

FAILSAFE_NOT_BEFORE_S = 0.400
"""No robot ends a session after less silence than this [s] (PROTOCOL.md, section 7)."""

SHORT_SILENCE_S = FAILSAFE_NOT_BEFORE_S - 0.03
"""Silence after which the session must still be open [s]; the line may take the rest."""

NEARLY_FAILSAFE_S = FAILSAFE_NOT_BEFORE_S - 0.005
"""A silence that a session survives unless the line delays its end [s]."""

NEARLY_ATTEMPTS = 3
"""Attempts to meet that moment: a robot that reads its line every 20 ms may miss it."""

MESSAGE_EVERY_S = 0.27
"""Time between two messages that keep a session open only together [s]."""

STEADY_BYTES_PER_S = 8000
"""Bytes that never cease, for a robot that reads its clock only when none wait [1/s]: fewer than a
line of 115200 baud takes."""

STEADY_EVERY_S = 0.001
"""Time between two writes of them [s]."""

NOISE_EVERY_S = 0.03
"""Time between two bursts of noise [s]."""

_MESSAGE_EVERY_MS = round(1000 * MESSAGE_EVERY_S)
_SILENCE_MS = round(1000 * SILENCE_S)


@FAILSAFE.must
def session_ends_after_silence(probe: Probe) -> None:
    """After 500 ms without a message of its session, that session is gone."""
    probe.open_session()
    probe.beat("HELLO")
    probe.receive(SILENCE_S)
    _expect_session_gone(probe, f"{_SILENCE_MS} ms of silence")


@FAILSAFE.must
def session_survives_short_silence(probe: Probe) -> None:
    """Before 400 ms without a message have passed, the session is still open."""
    probe.open_session()
    probe.beat("HELLO")
    probe.receive(SHORT_SILENCE_S)
    probe.beat(f"{1000 * SHORT_SILENCE_S:.0f} ms of silence")


@FAILSAFE.must
def session_open_until_400_ms(probe: Probe) -> None:
    """After 395 ms without a message the session is still open, at least once in three attempts."""
    for attempt in range(1, NEARLY_ATTEMPTS + 1):
        probe.open_session()
        begin = probe.now
        probe.beat("HELLO")
        probe.receive_until(begin + NEARLY_FAILSAFE_S)
        try:
            probe.beat(f"{1000 * NEARLY_FAILSAFE_S:.0f} ms of silence")
            return
        except CheckFailed:
            if attempt == NEARLY_ATTEMPTS:
                raise


@FAILSAFE.must
def any_message_counts(probe: Probe) -> None:
    """Every message of the session keeps it open, also a repeat and an ASK without an answer."""
    probe.open_session()
    number = probe.next_number()
    messages: list[object] = [
        m.Hello(timing.VERSION, probe.host),  # first: after the others it would open it again
        m.Ask(m.ITEM_MOTION, 0),
        m.Ask(9, 255),
        m.Express(number, 0.0, 0.0),
        m.Express(number, 0.0, 0.0),
        m.Play(number + 1, m.ITEM_MOTION, 254),
        m.Stop(number + 2),
    ]
    if probe.version >= 3:
        messages.append(m.Move(number + 3, 0.0, 0, 0, (0.0,) * m.JOINTS_MAX))
    for message in messages:
        probe.receive(MESSAGE_EVERY_S - TIMING_SLACK_S)
        probe.send(message)
        received = probe.receive(TIMING_SLACK_S)
        gone = [one for one in received if isinstance(one.message, m.Gone)]
        if gone:
            name = spec_of(type(message)).name
            expected = f"an open session for {name}, {_MESSAGE_EVERY_MS} ms after a message"
            raise CheckFailed(expected, describe_frames(gone))
    probe.receive(MESSAGE_EVERY_S)
    probe.beat(f"{len(messages)} messages other than BEAT, {_MESSAGE_EVERY_MS} ms apart")


@FAILSAFE.must
def silent_after_failsafe(probe: Probe) -> None:
    """When the session has ended by silence, the robot is silent too."""
    probe.open_session()
    probe.receive(SILENCE_S + TIMING_SLACK_S)
    received = probe.receive(0.3)
    if received:
        expected = "silence once the session has ended by silence"
        raise CheckFailed(expected, describe_frames(received))


@FAILSAFE.must
def failsafe_forgets_the_emotion(probe: Probe) -> None:
    """After the failsafe no command is in force: WELCOME says 0 to the same host."""
    probe.open_session()
    probe.express(0.3, 0.3)
    probe.receive(SILENCE_S)
    _expect_welcome(probe, 0, "the failsafe")


@FAILSAFE.must
def failsafe_keeps_the_numbers(probe: Probe) -> None:
    """The same host's command numbers go on after the failsafe: old commands have no effect."""
    probe.open_session()
    probe.command(m.Express(5, 0.0, 0.0))
    probe.receive(SILENCE_S)
    _expect_numbers_kept(probe, "the failsafe")


@FAILSAFE.must
def hello_after_failsafe(probe: Probe) -> None:
    """After the failsafe, HELLO with the session that has ended opens it again."""
    probe.open_session()
    probe.beat("HELLO")
    probe.receive(SILENCE_S)
    probe.hello()
    probe.beat("the failsafe and HELLO with the same session")


@FAILSAFE.must
def failsafe_not_reset_by_noise(probe: Probe) -> None:
    """Noise and damaged frames do not keep a session open."""
    probe.open_session()
    probe.beat("HELLO")
    damaged = bytearray(probe.frame(m.Beat(probe.next_beat())))
    damaged[-2] ^= 1
    _expect_failsafe_despite(probe, (b"\x55\xaa noise \r\n", bytes(damaged), b"\0\0\0"), "noise")


@FAILSAFE.must
def clock_read_while_bytes_arrive(probe: Probe) -> None:
    """While bytes never cease to arrive, STATE comes every 100 ms, and the failsafe acts."""
    probe.open_session()
    probe.beat("HELLO")
    begin, sent, states = probe.now, 0, [probe.now]
    while (passed := probe.now - begin) < SILENCE_S:
        due = round(passed * STEADY_BYTES_PER_S)
        probe.write(b"\x55" * (due - sent), keep=True)
        sent = due
        for one in probe.receive(STEADY_EVERY_S):
            if isinstance(one.message, m.State):
                states.append(one.timestamp)
    states.append(max(states[-1], begin + FAILSAFE_NOT_BEFORE_S))
    quiet = max(later - former for former, later in pairwise(states))
    if quiet > timing.STATE_EVERY + TIMING_SLACK_S:
        expected = f"STATE every {1000 * timing.STATE_EVERY:.0f} ms while bytes arrive"
        raise CheckFailed(expected, f"none for {1000 * quiet:.0f} ms")
    probe.write(b"\0", keep=True)
    _expect_session_gone(probe, f"{_SILENCE_MS} ms of bytes without an edge")


@FAILSAFE.must_of(5)
def clock_read_before_waiting_bytes(probe: Probe) -> None:
    """Bytes that have waited while the robot did not run do not belong to the old session."""
    probe.open_session()
    probe.beat("HELLO")
    if not probe.hold_up(SILENCE_S):
        raise NotApplicableError(
            "needs virtual time, which no robot on a port has; see docs/conformance.md"
        )
    # Nothing is read before, so that the robot finds bytes and time at once.
    probe.write(probe.frame(m.Beat(probe.next_beat())), keep=True)
    probe.expect(m.Gone, f"{_SILENCE_MS} ms in which the robot did not run, and a BEAT meanwhile")


@FAILSAFE.must
def failsafe_not_reset_by_other_sessions(probe: Probe) -> None:
    """Messages of other sessions do not keep a session open."""
    probe.open_session()
    probe.beat("HELLO")
    other = probe.session ^ 0x1111
    frames = (
        probe.frame(m.Beat(7), other),
        probe.frame(m.Express(1, 0.5, 0.5), other),
        probe.frame(m.Hello(timing.VERSION, probe.host), 0),
    )
    _expect_failsafe_despite(probe, frames, "messages of another session")


@FAILSAFE.must
def failsafe_not_reset_by_skipped_bodies(probe: Probe) -> None:
    """Bodies that are skipped do not keep a session open: echoes, unknown, short, out of range."""
    probe.open_session()
    probe.beat("HELLO")
    frames = (
        probe.frame(m.Ack(1, m.RESULT_TAKEN)),
        probe.raw_frame(0x42, b"\1\1\1\1"),
        probe.raw_frame(0x03, b"\1"),
        probe.raw_frame(0x10, b"\1\1\1\1\x7f\x7f\x7f\x7f\xff"),
    )
    _expect_failsafe_despite(probe, frames, "bodies to be skipped")


@FAILSAFE.must
def bye_ends_the_session(probe: Probe) -> None:
    """After BYE the session is gone, and no command is in force; BYE itself is not answered."""
    probe.open_session()
    probe.express(0.3, 0.3)
    probe.send(m.Bye())
    received = probe.receive(REPLY_WITHIN_S)
    if any(isinstance(one.message, m.Gone) for one in received):
        raise CheckFailed("no answer to BYE in the open session", describe_frames(received))
    _expect_session_gone(probe, "BYE")
    _expect_welcome(probe, 0, "BYE")


@FAILSAFE.must
def bye_keeps_the_numbers(probe: Probe) -> None:
    """The same host's command numbers go on after BYE: old commands have no effect."""
    probe.open_session()
    probe.command(m.Express(5, 0.0, 0.0))
    probe.send(m.Bye())
    _expect_numbers_kept(probe, "BYE")


def _expect_numbers_kept(probe: Probe, after: str) -> None:
    """Open another session of the host that has sent EXPRESS 5, and send it again, then 6."""
    probe.reopen_session()
    before = probe.expect_taken(5, f"EXPRESS 5, {after}, HELLO")
    probe.send(m.Express(5, 0.9, 0.9))
    probe.expect(m.Ack, "EXPRESS 5 again", number=5)
    now = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    if max(now.valence - before.valence, now.arousal - before.arousal) > EMOTION_CHANGE:
        raise CheckFailed(f"no effect of EXPRESS 5, taken before {after}", f"{now.valence}")
    probe.command(m.Express(6, 0.0, 0.0))
    _expect_welcome(probe, 6, "EXPRESS 6")


def _expect_session_gone(probe: Probe, after: str) -> None:
    probe.send(m.Beat(probe.next_beat()))
    probe.expect(m.Gone, f"{after}, then BEAT")


def _expect_welcome(probe: Probe, taken: int, after: str) -> None:
    """Open another session as the same host, and check which command is in force."""
    welcome = probe.reopen_session()
    if welcome.taken != taken:
        raise CheckFailed(f"WELCOME(taken={taken}) after {after}", f"taken={welcome.taken}")


def _expect_failsafe_despite(probe: Probe, frames: tuple[bytes, ...], what: str) -> None:
    """Send frames that must not keep the session open until it must have ended."""
    end = probe.now + SILENCE_S
    while probe.now < end:
        for frame in frames:
            probe.write(frame)
        probe.receive(min(NOISE_EVERY_S, max(end - probe.now, 0)))
    probe.receive(2 * timing.GONE_EVERY)
    _expect_session_gone(probe, f"{_SILENCE_MS} ms of {what}")
