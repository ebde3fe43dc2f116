"""The whole suite: every check in turn, in bounded time, and what they found."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Literal

from robot.conformance.check import Chapter, Check
from robot.conformance.checks.bodies import BODIES
from robot.conformance.checks.catalogue import CATALOGUE
from robot.conformance.checks.commands import COMMANDS
from robot.conformance.checks.failsafe import FAILSAFE
from robot.conformance.checks.frames import FRAMES
from robot.conformance.checks.heartbeat import HEARTBEAT
from robot.conformance.checks.moods import MOODS
from robot.conformance.checks.neutral import NEUTRALITY
from robot.conformance.checks.playing import PLAYING
from robot.conformance.checks.sessions import SESSIONS
from robot.conformance.checks.stopping import STOPPING
from robot.conformance.checks.strangers import OTHERS
from robot.conformance.checks.whole import WHOLE
from robot.conformance.line import Line
from robot.conformance.probe import Probe
from robot.conformance.verdicts import NotApplicableError, SilentError, UnmetError
from robot.errors import RobotError
from robot.protocol import messages as m
from robot.protocol import timing

CHAPTERS: tuple[Chapter, ...] = (
    FRAMES, BODIES, SESSIONS, OTHERS, CATALOGUE, COMMANDS, MOODS, PLAYING, STOPPING, HEARTBEAT,
    FAILSAFE, NEUTRALITY, WHOLE,
)  # fmt: skip
"""The checks, by subject; those of everything heard come last."""

LONGEST = 100.0
"""No check begins later than this after the first one [s]."""

FIRST_WITHIN = 0.5
"""How long each of the first greetings waits [s]: long, so that being slow is not being silent."""

HELD_UP = 0.030
"""A wait that lasts so much longer than asked for means that this computer is busy [s]."""

ATTEMPTS = 3
"""A check that fails on a busy computer is tried so often at most."""

SILENCES = 2
"""After so many checks in a row that nobody answers, the rest is left out."""

Verdict = Literal["ok", "failed", "skipped"]


@dataclass(frozen=True)
class Result:
    """What one check found."""

    check: Check
    """Which one."""

    verdict: Verdict
    """Whether the robot does what is required; skipped if it could not be tried."""

    expected: str = ""
    """What it should have done, if it failed."""

    came: str = ""
    """What it did instead."""

    remark: str = ""
    """Why the check was skipped, or what it measured."""

    seconds: float = 0.0
    """How long it took [s]."""


@dataclass
class Report:
    """What the suite found."""

    welcome: m.Welcome
    """How the robot introduced itself."""

    results: list[Result] = field(default_factory=list)
    """One for each check, in order."""

    cut_short: str = ""
    """Why checks were left out; empty if none were."""

    seconds: float = 0.0
    """How long it took [s]."""

    @property
    def conforms(self) -> bool:
        """Whether all was tried that can be, and nothing failed that a robot must do."""
        failed = any(one.verdict == "failed" and one.check.level == "must" for one in self.results)
        return not failed and not self.cut_short


def all_checks() -> list[Check]:
    """Return every check, in the order of the document."""
    return [check for chapter in CHAPTERS for check in chapter]


def chosen(words: Iterable[str]) -> list[Check]:
    """Return the checks whose names hold any of the words.

    Raises
    ------
    RobotError
        If one of the words is in no name.
    """
    found: set[str] = set()
    for word in words:
        plain = word.lower().replace("-", " ").replace("_", " ").strip()
        names = {check.name for check in all_checks() if plain and plain in check.name}
        if not names:
            raise RobotError(f"no check is called {word!r}; `cubeling robot conform --list`")
        found |= names
    return [check for check in all_checks() if check.name in found]


def examine(
    line: Line,
    checks: Iterable[Check],
    host: int,
    on_result: Callable[[Result], None] = lambda result: None,
    longest: float = LONGEST,
) -> Report:
    """Try a robot, and leave it neutral and without a session, whatever happens.

    Parameters
    ----------
    line
        The way to it; it should be a good one, for a check tries everything once.
    checks
        What to try, in this order.
    host
        A number that the robot has not heard as a host's before.
    on_result
        Is called after each check.
    longest
        No check begins later than this [s].

    Raises
    ------
    RobotError
        If nobody answers a greeting, or the port goes away.
    """
    robot = Probe(line, host)
    begin = robot.now
    try:
        report = Report(_introduced(robot))
        silences = 0
        for check in checks:
            if silences == SILENCES:
                report.cut_short = "it no longer answers a greeting"
            elif robot.now - begin > longest:
                report.cut_short = f"the checks have taken {longest:.0f} s"
            if report.cut_short:
                result = Result(check, "skipped", remark=report.cut_short)
            else:
                result, silent = _tried(check, robot)
                silences = silences + 1 if silent else 0
            report.results.append(result)
            on_result(result)
    finally:
        robot.goodbye()
    report.seconds = robot.now - begin
    return report


def _introduced(robot: Probe) -> m.Welcome:
    """Greet until the robot answers; it may be booting."""
    robot.next_host()
    end = robot.now + timing.ANSWER_WITHIN
    while robot.now < end:
        robot.next_session()
        try:
            return robot.greet(FIRST_WITHIN)
        except UnmetError:
            continue
    came = f"{robot.log.bytes} bytes came, but no WELCOME" if robot.log.bytes else "nothing came"
    raise RobotError(
        f"no robot of this protocol answers within {timing.ANSWER_WITHIN:.0f} s ({came}); "
        "is it switched on, and is its speed 115200 baud?"
    )


def _tried(check: Check, robot: Probe) -> tuple[Result, bool]:
    """Try one thing; say too whether the robot did not even answer a greeting.

    What fails while this computer is held up says nothing of the robot, and is tried again.
    """
    begin = robot.now
    again = ""
    for attempt in range(1, ATTEMPTS + 1):
        robot.held_up = 0.0
        result, silent = _tried_once(check, robot)
        if result.verdict != "failed" or robot.held_up < HELD_UP:
            break
        robot.lengths = robot.pose = None  # what was measured meanwhile is no better
        again = f"at attempt {attempt} this computer was held up for {1000 * robot.held_up:.0f} ms"
    remark = "; ".join(filter(None, (result.remark, again)))
    return replace(result, remark=remark, seconds=robot.now - begin), silent


def _tried_once(check: Check, robot: Probe) -> tuple[Result, bool]:
    try:
        remark = check.run(robot)
    except UnmetError as unmet:
        result = Result(check, "failed", unmet.expected, unmet.came)
        return result, isinstance(unmet, SilentError)
    except NotApplicableError as reason:
        return Result(check, "skipped", remark=str(reason)), False
    return Result(check, "ok", remark=remark or ""), False
