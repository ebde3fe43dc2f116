"""The suite: runs every check in turn, in bounded time, and reports the results."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

from cubeling.robot.conformance.channel import Channel
from cubeling.robot.conformance.check import Check, CheckGroup
from cubeling.robot.conformance.checks.bodies import BODIES
from cubeling.robot.conformance.checks.catalogue import CATALOGUE
from cubeling.robot.conformance.checks.commands import COMMANDS
from cubeling.robot.conformance.checks.failsafe import FAILSAFE
from cubeling.robot.conformance.checks.frames import FRAMES
from cubeling.robot.conformance.checks.going_neutral import NEUTRALITY
from cubeling.robot.conformance.checks.heartbeat import HEARTBEAT
from cubeling.robot.conformance.checks.log import LOG
from cubeling.robot.conformance.checks.moods import MOODS
from cubeling.robot.conformance.checks.moving import MOVING
from cubeling.robot.conformance.checks.other_sessions import OTHER_SESSIONS
from cubeling.robot.conformance.checks.playing import PLAYING
from cubeling.robot.conformance.checks.recorded import RECORDED
from cubeling.robot.conformance.checks.sessions import SESSIONS
from cubeling.robot.conformance.checks.stopping import STOPPING
from cubeling.robot.conformance.errors import CheckFailed, NoAnswerError, NotApplicableError
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.errors import RobotError
from cubeling.robot.protocol import messages as m, timing

GROUPS: tuple[CheckGroup, ...] = (
    FRAMES, BODIES, SESSIONS, OTHER_SESSIONS, CATALOGUE, COMMANDS, MOODS, PLAYING, STOPPING,
    MOVING, HEARTBEAT, FAILSAFE, NEUTRALITY, LOG, RECORDED,
)  # fmt: skip
"""The checks by subject; those of everything received come last."""

MAX_DURATION_S = 240.0
"""No check starts later than this after the first one [s]."""

FIRST_REPLY_WITHIN_S = 0.5
"""Longest wait for the answer to each of the first HELLOs [s]; a slow robot is not a silent one."""

BUSY_OVERRUN_S = 0.030
"""A wait that overruns by this much means that this computer is busy [s]."""

MAX_ATTEMPTS = 3
"""Most attempts of a check that fails while this computer is busy."""

MAX_SILENT_CHECKS = 2
"""After this many consecutive checks without an answer, the others are skipped."""

Verdict = Literal["ok", "failed", "skipped"]


@dataclass(frozen=True)
class CheckResult:
    """The result of one check."""

    check: Check

    verdict: Verdict
    """Whether the robot meets the requirement; skipped if that could not be tested."""

    expected: str = ""
    """What it should have done, if it failed."""

    received: str = ""
    """What it did instead."""

    remark: str = ""
    """Why the check was skipped, or what it measured."""

    seconds: float = 0.0
    """Duration of the check [s]."""


@dataclass
class ConformanceReport:
    """The results of the suite."""

    welcome: m.Welcome
    """The robot's first WELCOME."""

    results: list[CheckResult] = field(default_factory=list)
    """One for each check, in order."""

    cut_short: str = ""
    """Why checks were left out; empty if none were."""

    seconds: float = 0.0
    """Duration of the suite [s]."""

    @property
    def conforms(self) -> bool:
        """Whether the suite was not cut short and no check of level "must" failed."""
        failed = any(one.verdict == "failed" and one.check.level == "must" for one in self.results)
        return not failed and not self.cut_short


def all_checks() -> list[Check]:
    """Return every check, in the order of the document."""
    return [check for group in GROUPS for check in group]


def select_checks(words: Iterable[str]) -> list[Check]:
    """Return the checks whose names contain any of the words, in the order of the document.

    Raises
    ------
    RobotError
        If one of the words is in no name.
    """
    selected: set[str] = set()
    for word in words:
        plain = word.lower().replace("-", " ").replace("_", " ").strip()
        names = {check.name for check in all_checks() if plain and plain in check.name}
        if not names:
            raise RobotError(f"no check is called {word!r}; `cubeling robot conform --list`")
        selected |= names
    return [check for check in all_checks() if check.name in selected]


def run_checks(
    channel: Channel,
    checks: Iterable[Check],
    host: int,
    on_result: Callable[[CheckResult], None] = lambda result: None,
    max_duration: float = MAX_DURATION_S,
) -> ConformanceReport:
    """Run checks in this order, and always leave the robot neutral and without a session.

    Parameters
    ----------
    channel
        The robot. The channel must not lose frames, because a check sends everything once.
    checks
        The checks.
    host
        Number of the first host, one that the robot has not seen before.
    on_result
        Called after each check.
    max_duration
        No check starts later than this after the first one [s].

    Raises
    ------
    RobotError
        If no robot answers HELLO, or the port is lost.
    """
    probe = Probe(channel, host)
    begin = probe.now
    try:
        report = ConformanceReport(_first_welcome(probe))
        silent_checks = 0
        for check in checks:
            if silent_checks == MAX_SILENT_CHECKS:
                report.cut_short = "it no longer answers HELLO"
            elif probe.now - begin > max_duration:
                report.cut_short = f"the checks have taken {max_duration:.0f} s"
            if report.cut_short:
                result = CheckResult(check, "skipped", remark=report.cut_short)
            else:
                result, silent = _run(check, probe)
                silent_checks = silent_checks + 1 if silent else 0
            report.results.append(result)
            on_result(result)
    finally:
        probe.end_session()
    report.seconds = probe.now - begin
    return report


def _first_welcome(probe: Probe) -> m.Welcome:
    """Send HELLO until the robot answers; it may be booting."""
    probe.next_host()
    end = probe.now + timing.ANSWER_WITHIN
    while probe.now < end:
        probe.next_session()
        try:
            return probe.hello(FIRST_REPLY_WITHIN_S)
        except CheckFailed:
            continue
    raise RobotError(
        f"no robot of this protocol answers within {timing.ANSWER_WITHIN:.0f} s: "
        + probe.sample.diagnosis()
    )


def _run(check: Check, probe: Probe) -> tuple[CheckResult, bool]:
    """Run a check; return its result, and whether the robot did not even answer HELLO.

    A failure while this computer is busy proves nothing about the robot, and is retried.
    """
    begin = probe.now
    retried = ""
    for attempt in range(1, MAX_ATTEMPTS + 1):
        probe.max_overrun = 0.0
        result, silent = _run_once(check, probe)
        if result.verdict != "failed" or probe.max_overrun < BUSY_OVERRUN_S:
            break
        probe.durations = probe.stop_pose = None  # measured on a busy computer
        overrun = 1000 * probe.max_overrun
        retried = f"at attempt {attempt} this computer was busy for {overrun:.0f} ms"
    remark = "; ".join(filter(None, (result.remark, retried)))
    return replace(result, remark=remark, seconds=probe.now - begin), silent


def _run_once(check: Check, probe: Probe) -> tuple[CheckResult, bool]:
    try:
        remark = check.run(probe)
    except CheckFailed as failure:
        result = CheckResult(check, "failed", failure.expected, failure.received)
        return result, isinstance(failure, NoAnswerError)
    except NotApplicableError as reason:
        return CheckResult(check, "skipped", remark=str(reason)), False
    return CheckResult(check, "ok", remark=remark or ""), False
