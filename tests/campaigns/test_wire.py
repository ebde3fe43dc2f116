"""The campaign accepts the product, and detects defects that are built in."""

import pytest

from cubeling.robot.drivers.cubeling.scheduler import CommandScheduler
from cubeling.robot.protocol import messages as m, timing, wire
from cubeling.robot.simulators.cubeling.device import DeviceLink
from tests.campaigns.fault_mixes import FAULT_MIXES, FaultMix
from tests.campaigns.monitor import emotion_of
from tests.campaigns.wire import add_up, failures, quantile, run_world, runs_for
from tests.campaigns.world import CampaignWorld

pytestmark = pytest.mark.full

BY_NAME = {mix.name: mix for mix in FAULT_MIXES}


def violation(name: str, exchanges: int = 4000) -> str | None:
    return CampaignWorld(BY_NAME[name], seed=3).run(exchanges).violation


@pytest.mark.parametrize("mix", FAULT_MIXES, ids=lambda mix: mix.name)
def test_every_guarantee_holds_under_every_fault_mix(mix):
    outcome = CampaignWorld(mix, seed=1).run(250)
    assert outcome.violation is None
    assert outcome.counts["exchanges"] >= 250


def test_a_run_can_be_repeated_by_its_seed():
    once, again = (CampaignWorld(BY_NAME["harsh"], seed=9).run(60) for _ in range(2))
    assert once == again


def test_the_exchanges_are_divided_among_all_mixes():
    runs = runs_for(10**6, seed=1)
    assert {run.mix for run in runs} == set(FAULT_MIXES)
    assert sum(run.exchanges for run in runs) >= 10**6
    assert len({(run.mix, run.seed) for run in runs}) == len(runs)


def test_a_robot_that_takes_a_command_twice_is_found(monkeypatch):
    obey = DeviceLink.obey

    def obey_again(self, command):
        self.last_command = 0
        obey(self, command)

    monkeypatch.setattr(DeviceLink, "obey", obey_again)
    assert "takes effect after number" in (violation("dup") or "")


def test_a_failsafe_that_comes_too_late_is_found(monkeypatch):
    monkeypatch.setattr(timing, "FAILSAFE_AFTER", 0.470)  # and the robot looks every 50 ms
    assert "ms after the last message" in (violation("unplug", 40_000) or "")


def test_a_failsafe_that_never_comes_is_found(monkeypatch):
    monkeypatch.setattr(timing, "FAILSAFE_AFTER", 10.0)
    assert "ms after the last message" in (violation("unplug") or "")


def test_an_emotion_that_is_not_sent_again_is_found(monkeypatch):
    monkeypatch.setattr(CommandScheduler, "start_session", lambda self, taken: None)
    assert "the last request has no effect" in (violation("reboot") or "")


def test_a_host_that_sends_an_old_emotion_late_is_found(monkeypatch):
    next_command, first = CommandScheduler.next, emotion_of(1)

    def stale(self, now, retry_after):
        command = next_command(self, now, retry_after)
        if isinstance(command, m.Express) and command.number % 50 == 0:
            old = m.Express(command.number, first.valence, first.arousal)
            self.pending.command = old
            return old
        return command

    monkeypatch.setattr(CommandScheduler, "next", stale)
    assert "takes effect after" in (violation("clean", 30_000) or "")


def test_a_wire_without_a_check_is_found(monkeypatch):
    monkeypatch.setattr(wire, "check_bytes", lambda encoded: b"\xe0\x80\x80")
    outcome = run_world(runs_for(3000, seed=2, mixes=[BY_NAME["flip hard"]])[0])
    wrong = failures([outcome], [add_up([outcome])])
    assert outcome.violation or any("passed the check" in one for one in wrong)


def test_emotions_that_take_too_long_are_found():
    slow = FaultMix("drop", "drop=0.05&delay=60ms", 1)
    outcome = CampaignWorld(slow, seed=1).run(200)
    assert quantile(outcome.latencies, 0.5) > 0.050
    assert any("emotions take" in one for one in failures([], [outcome]))


def test_a_run_that_does_not_end_is_found(monkeypatch):
    monkeypatch.setattr(timing, "HELLO_EVERY", 1e9)  # a greeting is lost, and never repeated
    assert "the last request has no effect" in (violation("drop hard", 20_000) or "")
