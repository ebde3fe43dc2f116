"""Checks of section 7: the lines of the robot's log, and its clock."""

from itertools import pairwise

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import TIMING_SLACK_S, Probe
from cubeling.robot.protocol import messages as m, timing

LOG = CheckGroup("Clock and log", 7)

REFUSED_COMMANDS = 30
"""Commands to be refused, which a robot may have something to say about."""

REFUSED_EVERY_S = 0.04
"""Time between two of them [s]."""

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
    remark = f"{1000 * (first - last):+.0f} ms in {span:.0f} s"
    if abs(first - last) > timing.CLOCK_TOLERANCE * span + TIMING_SLACK_S:
        raise CheckFailed(
            f"a clock that is right to {1e6 * timing.CLOCK_TOLERANCE:.0f} ppm", remark
        )
    return remark


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
    """A LOG has a text without control characters, and its own count."""
    if len(probe.log.logs) < 2:  # one at boot says little
        _refuse_many(probe)
    for _, line in probe.log.logs:
        if not line.text.strip() or not line.text.isprintable():
            raise CheckFailed("a LOG with a line of text", repr(line.text))
    for (_, before), (_, after) in pairwise(probe.log.logs):
        if after.count == before.count:
            raise CheckFailed("another count in every LOG", f"{after.count} twice")


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
