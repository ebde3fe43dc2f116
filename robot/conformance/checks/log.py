"""Checks of section 7: the lines of the robot's log, and its clock."""

from itertools import pairwise
from math import inf

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.heartbeat import pauses_between_states
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import TIMING_SLACK_S, Probe
from cubeling.robot.protocol import messages as m, timing

LOG = CheckGroup("Clock and log", 7)

REFUSED_COMMANDS = 30
"""Commands to be refused, which a robot may have something to say about."""

REFUSED_EVERY_S = 0.04
"""Time between two of them [s]."""

WAITING_REFUSALS = 20
"""Refused commands in a session of version 2: more lines than a robot keeps."""

DRAINED_WITHIN_S = 4.0
"""Time after which a robot that still sends LOGs is one that always does [s]."""

ACK_ATTEMPTS = 2
"""Attempts to see a LOG before the ACK of its command."""

FIT_S = 2.0
"""Time in which the readings of the clock must fit one offset [s]."""

FIT_EVERY_S = 0.023
"""Time between two readings [s]: not a multiple of the steps in which a clock might count."""

READING_TOLERANCE_S = 0.001
"""Error of a reading [s]: it is in whole milliseconds."""

END_S = 1.0
"""How long the first and the last readings of the clock are, of which the least late count [s]."""


@LOG.must
def clock_runs_true(probe: Probe) -> str:
    """`time` in STATE never goes back, and is at most 500 ppm fast or slow."""
    probe.open_session()
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    probe.keep_alive(2 * END_S)
    probe.reopen_session()
    probe.keep_alive(0.1)
    readings = probe.log.readings
    elapsed = [0.0]
    for (_, before), (_, after) in pairwise(readings):
        step = (after - before + 0x80000000) % 0x100000000 - 0x80000000
        if step < 0:
            raise CheckFailed("a clock that never goes back", f"{before} ms, then {after} ms")
        elapsed.append(elapsed[-1] + step / 1000)
    # A STATE may arrive late, but not early.
    late = [(time, time - own) for (time, _), own in zip(readings, elapsed, strict=True)]
    begin, end = late[0][0], late[-1][0]
    first = min(one for time, one in late if time <= begin + END_S)
    last = min(one for time, one in late if time >= end - END_S)
    span = end - begin
    remark = f"{1000 * (first - last):+z.0f} ms in {span:.0f} s"
    if abs(first - last) > timing.CLOCK_TOLERANCE * span + TIMING_SLACK_S:
        raise CheckFailed(
            f"a clock that is right to {1e6 * timing.CLOCK_TOLERANCE:.0f} ppm", remark
        )
    return remark


@LOG.must
def clock_read_for_every_state(probe: Probe) -> str:
    """`time` is read between the arrival of a BEAT and the sending of its STATE.

    So the readings of some seconds fit one offset, within their round trips and whole milliseconds.
    """
    probe.open_session()
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    begin = probe.now
    earliest, latest = -inf, inf
    first: int | None = None
    while probe.now < begin + FIT_S:
        sent = probe.now
        reading = probe.beat("others").time
        first = reading if first is None else first
        passed = ((reading - first) % 0x100000000) / 1000
        drift = timing.CLOCK_TOLERANCE * (probe.now - begin) + READING_TOLERANCE_S
        earliest = max(earliest, passed - (probe.now - begin) - drift)
        latest = min(latest, passed - (sent - begin) + drift)
        if earliest > latest:
            raise CheckFailed(
                "readings of one clock, each made between a BEAT and its STATE",
                f"two that are {1000 * (earliest - latest):.0f} ms farther apart",
            )
        probe.receive(FIT_EVERY_S)
    return f"known to {500 * (latest - earliest):.1f} ms"


@LOG.must
def log_lines_wait(probe: Probe) -> str | None:
    """Lines of sessions of earlier versions wait, the oldest first, and delay no STATE."""
    welcome = probe.open_session()
    _drain(probe)
    last = probe.log.logs[-1][1].count if probe.log.logs else None
    probe.hello(offer=2)
    for _ in range(WAITING_REFUSALS):
        refused = m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions)
        probe.command(refused, m.RESULT_REFUSED)
    before = len(probe.log.logs)
    probe.hello()
    longest = max(pauses_between_states(probe))
    if longest > timing.STATE_EVERY + TIMING_SLACK_S:
        expected = f"STATE every {1000 * timing.STATE_EVERY:.0f} ms while lines of the log wait"
        raise CheckFailed(expected, f"a pause of {1000 * longest:.0f} ms")
    waited = [line for _, line in probe.log.logs[before:]]
    if not waited or last is None:
        return "it has logged nothing"
    if waited[0].count != (last + 1) & 0xFFFF:
        expected = f"the line with count {(last + 1) & 0xFFFF}, the oldest, first"
        raise CheckFailed(expected, f"count={waited[0].count}")
    return None


@LOG.must
def log_comes_after_its_ack(probe: Probe) -> None:
    """ACK comes before a LOG, whose time is that of its writing, by the clock of STATE."""
    welcome = probe.open_session()
    early = 0
    for _ in range(ACK_ATTEMPTS):
        _drain(probe)
        then = probe.beat("others").time
        refused = m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions)
        probe.send(refused)
        answer, before = probe.wait_for(lambda one: isinstance(one.message, m.Ack), REPLY_WITHIN_S)
        logged = [one.message for one in before if isinstance(one.message, m.Log)]
        early += bool(logged)  # once, it may be about something else
        found, _ = probe.wait_for(
            lambda one: isinstance(one.message, m.Log), timing.LOG_EVERY + TIMING_SLACK_S
        )
        lines = logged or ([found.message] if found else [])
        now = probe.beat("a LOG").time
        for line in lines:
            if (line.time - then) % 0x100000000 > (now - then) % 0x100000000 or answer is None:
                expected = f"an ACK, and a LOG with a time from {then} to {now} ms"
                raise CheckFailed(expected, f"time={line.time}")
    if early == ACK_ATTEMPTS:
        raise CheckFailed("the ACK of a refused command before its LOG", "LOG, then ACK")


@LOG.must
def log_rate_bounded(probe: Probe) -> str:
    """LOG is sent at most every 100 ms, however many commands are refused, and delays no STATE."""
    count, seconds = _refuse_many(probe)
    limit = (seconds + TIMING_SLACK_S) / timing.LOG_EVERY + 1
    if count > limit:
        raise CheckFailed(f"at most {limit:.0f} LOGs in {seconds:.1f} s", f"{count}")
    return f"{count} × LOG in {seconds:.1f} s, for {REFUSED_COMMANDS} refusals"


@LOG.must
def log_lines_valid(probe: Probe) -> None:
    """A LOG has a text without control characters, and a higher count than the one before it."""
    if len(probe.log.logs) < 2:  # one at boot says little
        _refuse_many(probe)
    for _, line in probe.log.logs:
        if not line.text.strip() or not line.text.isprintable():
            raise CheckFailed("a LOG with a line of text", repr(line.text))
    for (_, before), (_, after) in pairwise(probe.log.logs):
        if not 0 < (after.count - before.count) & 0xFFFF < 0x8000:
            expected = f"a LOG with a count above {before.count}"
            raise CheckFailed(expected, f"count={after.count}")
        if (after.time - before.time) % 0x100000000 >= 0x80000000:
            expected = f"a LOG with a time from {before.time} ms on"
            raise CheckFailed(expected, f"time={after.time}")


def _drain(probe: Probe) -> None:
    """Wait until no line of the log waits; raises NotApplicableError without version 3."""
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    end = probe.now + DRAINED_WITHIN_S
    while probe.now < end:
        before = len(probe.log.logs)
        probe.keep_alive(2 * timing.LOG_EVERY + TIMING_SLACK_S)
        if len(probe.log.logs) == before:
            return
    raise NotApplicableError("it always has something to say")


def _refuse_many(probe: Probe) -> tuple[int, float]:
    """Send commands to be refused; return the number of LOGs and the time for them [s]."""
    welcome = probe.open_session()
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    before, begin = len(probe.log.logs), probe.now
    for _ in range(REFUSED_COMMANDS):
        refused = m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions)
        probe.command(refused, m.RESULT_REFUSED)
        probe.beat("a refused PLAY")
        probe.receive(REFUSED_EVERY_S)
    probe.keep_alive(2 * timing.LOG_EVERY)
    if not probe.log.logs:
        raise NotApplicableError("it has logged nothing")
    return len(probe.log.logs) - before, probe.now - begin
