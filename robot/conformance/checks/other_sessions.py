"""Checks of section 5: messages outside the open session."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import TIMING_SLACK_S, Probe
from cubeling.robot.conformance.received import ReceivedFrame, describe_frames
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.schema import spec_of

OTHER_SESSIONS = CheckGroup("Messages of other sessions", 5)

LISTENING_TIME_S = 0.4
"""Time in which a robot without a session must be silent [s]."""

FRAME_COUNT = 240
"""Frames of another session in a row."""

FRAMES_PER_WRITE = 4
"""How many of them go in one write."""

WRITE_EVERY_S = 0.005
"""Time between two such writes [s]: about what a line of 115200 baud needs for one."""

_MOVE = m.Move(1, 0.0, 0, 0, (0.0,) * m.JOINTS_MAX)
_MESSAGES = (
    m.Ask(m.ITEM_JOINT, 0),
    m.Beat(7),
    m.Express(1, 0.5, 0.5),
    m.Play(1, m.ITEM_MOTION, 0),
    m.Stop(1),
    m.Bye(),
)


@OTHER_SESSIONS.must
def other_session_reported(probe: Probe) -> None:
    """A message of another session is answered by GONE in the session of that message."""
    probe.open_session()
    for message in _messages(probe):
        other = probe.session ^ 0x1111
        probe.receive(2 * timing.GONE_EVERY)
        probe.send(message, session=other)
        after = f"{spec_of(type(message)).name} in another session"
        probe.expect(m.Gone, after, session=other)
        probe.expect_taken(0, after)


@OTHER_SESSIONS.must
def gone_without_session(probe: Probe) -> None:
    """A robot without a session answers every message but HELLO by GONE."""
    probe.open_session()
    probe.send(m.Bye())
    probe.receive(REPLY_WITHIN_S)
    for message in _messages(probe):
        probe.receive(2 * timing.GONE_EVERY)
        probe.send(message)
        probe.expect(m.Gone, f"{spec_of(type(message)).name} after BYE")


@OTHER_SESSIONS.must
def session_zero_reported(probe: Probe) -> None:
    """Every message but HELLO in session 0 is answered by GONE in session 0."""
    for opened in (True, False):
        probe.open_session()
        if not opened:
            probe.send(m.Bye())
        for message in _messages(probe):
            probe.receive(2 * timing.GONE_EVERY)
            probe.send(message, session=0)
            where = "in session 0" + ("" if opened else ", with none open")
            probe.expect(m.Gone, f"{spec_of(type(message)).name} {where}", session=0)


@OTHER_SESSIONS.must
def gone_rate_bounded(probe: Probe) -> None:
    """GONE is sent at most every 20 ms."""
    probe.open_session()
    frame = probe.frame(m.Beat(7), probe.session ^ 0x1111)
    probe.receive(2 * timing.GONE_EVERY)
    begin = probe.now
    received: list[ReceivedFrame] = []
    for _ in range(FRAME_COUNT // FRAMES_PER_WRITE):
        probe.write(frame * FRAMES_PER_WRITE, keep=True)
        received += probe.receive(WRITE_EVERY_S)
    received += probe.receive(REPLY_WITHIN_S)
    gone = [one for one in received if isinstance(one.message, m.Gone)]
    if not gone:
        raise CheckFailed(f"GONE after {FRAME_COUNT} BEATs of another session", "none")
    duration = gone[-1].timestamp - begin
    limit = (duration + TIMING_SLACK_S) / timing.GONE_EVERY + 2
    if len(gone) > limit:
        raise CheckFailed(
            f"at most {limit:.0f} GONEs in {1000 * duration:.0f} ms, "
            f"after {FRAME_COUNT} BEATs of another session",
            f"{len(gone)}",
        )


@OTHER_SESSIONS.must
def silent_without_session(probe: Probe) -> None:
    """A robot without a session sends nothing unasked, and does not answer BYE."""
    probe.open_session()
    probe.keep_alive(0.1)
    probe.send(m.Bye())
    probe.receive(TIMING_SLACK_S)  # frames that were on their way
    received = probe.receive(LISTENING_TIME_S)
    if received:
        expected = f"silence for {1000 * LISTENING_TIME_S:.0f} ms after BYE"
        raise CheckFailed(expected, describe_frames(received))


def _messages(probe: Probe) -> tuple[object, ...]:
    """Return a message of every kind but HELLO that the robot knows."""
    return (_MOVE, *_MESSAGES) if probe.version >= 3 else _MESSAGES
