"""What each test costs: one that takes clearly more than a second of CPU names its reason.

It is the CPU time of the test and of the programs that it started. What a fixture makes for several
tests is not counted, as any of them may be the first.
"""

import os
from collections.abc import Callable, Generator
from typing import Any

import pytest

LIMIT_S = 1.0
"""CPU time of a test that needs no reason [s]."""

NOISE = 3.0
"""How much longer a test may seem to take. One machine took between 1.0 and 3.5 s of CPU for one
loop within a day, and the first test of a process pays for what its commands load."""

REASONS = "slow", "full"
"""Markers of tests that may take longer: those with a reason, and those not of every change."""

Hook = Generator[None, object, object]

_spent, _shared = pytest.StashKey[float](), pytest.StashKey[float]()


def cpu_s() -> float:
    """Return the CPU time of this process and of those that it started and waited for [s]."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


class CostCheck:
    """Measures every test, and lists those that take long without a reason."""

    def __init__(self, strict: bool, clock: Callable[[], float] = cpu_s) -> None:
        self.strict = strict
        """Whether such a test fails the run."""
        self.long: dict[str, float] = {}
        """CPU time of such tests [s]."""
        self._clock = clock

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> Hook:
        """Measure what the test prepares."""
        item.stash[_spent] = item.stash[_shared] = 0.0
        return (yield from self._measured(item, _spent))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_fixture_setup(
        self, fixturedef: pytest.FixtureDef[Any], request: pytest.FixtureRequest
    ) -> Hook:
        """Measure what is prepared for several tests."""
        if fixturedef.scope == "function":
            return (yield)
        return (yield from self._measured(request._pyfuncitem, _shared))

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Hook:
        """Measure the test."""
        return (yield from self._measured(item, _spent))

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        """Write the cost into the report, which comes from another process with xdist."""
        report = yield
        if call.when == "call" and not any(map(item.get_closest_marker, REASONS)):
            own = item.stash[_spent] - item.stash[_shared]
            report.user_properties.append(("cpu_s", own))
        return report

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Collect the tests that take too long."""
        own = dict(report.user_properties).get("cpu_s", 0.0) if report.when == "call" else 0.0
        if isinstance(own, float) and own > NOISE * LIMIT_S:
            self.long[report.nodeid] = own

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        """Let the run fail, if that is asked for."""
        if self.strict and self.long and session.exitstatus == pytest.ExitCode.OK:
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """List the tests that take too long."""
        if not self.long:
            return
        terminalreporter.section("more than a second of CPU without a reason")
        for name, own in sorted(self.long.items(), key=lambda one: -one[1]):
            terminalreporter.line(f"{own:5.1f} s  {name}")
        terminalreporter.line("Make them cheaper, or say why: @pytest.mark.slow(reason=…)")

    def _measured(self, item: pytest.Item, where: pytest.StashKey[float]) -> Hook:
        start = self._clock()
        try:
            return (yield)
        finally:
            item.stash[where] = item.stash.get(where, 0.0) + self._clock() - start
