"""Every check can fail: for each there is a robot that breaks its rule and no other."""

import pytest

import tests.robot.conformance.mutants.alone
import tests.robot.conformance.mutants.commands
import tests.robot.conformance.mutants.frames
import tests.robot.conformance.mutants.heartbeat
import tests.robot.conformance.mutants.keeping
import tests.robot.conformance.mutants.moving
import tests.robot.conformance.mutants.playing
import tests.robot.conformance.mutants.reporting
import tests.robot.conformance.mutants.sessions  # noqa: F401 # these enter themselves
from cubeling.robot.conformance import SimulatedChannel, all_checks, run_checks, select_checks
from tests.robot.conformance.mutants.base import MUTANTS, Mutant

PAIRS = [(check, mutant) for check, mutants in MUTANTS.items() for mutant in mutants]


def failures(robot: Mutant, checks) -> list[str]:
    report = run_checks(SimulatedChannel(robot), checks, host=77)
    return [one.check.name for one in report.results if one.verdict == "failed"]


@pytest.mark.full
@pytest.mark.parametrize(
    ("check", "mutant"), PAIRS, ids=[f"{mutant.__name__}-{check}" for check, mutant in PAIRS]
)
def test_a_robot_that_breaks_a_rule_fails_its_check(check: str, mutant: type[Mutant]):
    assert failures(mutant(), [one for one in all_checks() if one.name == check]) == [check]


def test_for_every_check_there_is_a_robot_that_fails_it():
    assert {check.name for check in all_checks()} == set(MUTANTS)


def test_a_mutant_without_a_mutation_passes():
    assert failures(Mutant(), all_checks()) == []


def test_the_selected_checks_have_the_word_in_their_names():
    assert [check.name for check in select_checks(["wrong-mark"])] == ["wrong mark dropped"]
