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
from cubeling.robot.simulators import Simulated
from tests.campaigns.mutants import find_fault
from tests.examples import some
from tests.robot.conformance.mutants.base import MUTANTS, Mutant
from tests.robot.conformance.planted import FAULTS
from tests.robot.conformance.planted.robot import VERSIONS, planted_robot

PLANTED = {
    "frames found only between edges": "forgets what it has at 125 bytes without an edge",
    "burst survived": "crash when more is to be sent than fits",
    "short express leaves the choice": "EXPRESS of version 1 keeps the mood that was named",
    "own mood follows the emotion shown": "mood of its own choice by the emotion commanded",
    "emotion and mood kept": "named mood ended by MOVE",
    "hello of its host keeps everything": "repeated HELLO drops the named mood",
    "session zero reported": "messages in session 0 not answered",
    "answered in order": "commands acknowledged after all else",
    "never refused": "EXPRESS refused while a motion is played",
    "play again begins again": "PLAY of the motion that is played ignored",
    "refusals end nothing": "refused EXPRESS drops the named mood",
    "other joints left alone": "MOVE lets go of the joints that it does not name",
    "joint returns within its speed": "joints faster than their top speed when they are let go",
    "move taken in earlier versions": "MOVE refused in sessions of earlier versions",
    "beats of one count answered": "BEAT with the count of the one before not answered",
    "clock read while bytes arrive": "clock read only while no bytes wait",
    "clock read before waiting bytes": "waiting bytes processed before the clock is read",
    "clock read for every state": "clock in steps of 20 ms",
    "log lines wait": "LOG drops the oldest line",
    "log comes after its ack": "LOG with a time in the future",
    "frames have own edges": "no edge before a frame",
    "texts padded": "name with the rest of a longer one after its end",
    "nothing sent unasked": "ACK of the last command sent after HELLO",
}
"""A planted fault for each check that no mutant has; the campaign has all of them."""

SAMPLE = 8
"""Faults of each version that `make test` tries, about."""

PAIRS = [(check, mutant) for check, mutants in MUTANTS.items() for mutant in mutants]


def failures(robot: Simulated, checks) -> list[str]:
    report = run_checks(SimulatedChannel(robot), checks, host=77)
    return [one.check.name for one in report.results if one.verdict == "failed"]


@pytest.mark.full
@pytest.mark.parametrize(
    ("check", "mutant"), PAIRS, ids=[f"{mutant.__name__}-{check}" for check, mutant in PAIRS]
)
def test_a_robot_that_breaks_a_rule_fails_its_check(check: str, mutant: type[Mutant]):
    assert failures(mutant(), [one for one in all_checks() if one.name == check]) == [check]


def test_for_every_check_there_is_a_robot_that_fails_it():
    assert {check.name for check in all_checks()} == MUTANTS.keys() | PLANTED.keys()


@pytest.mark.parametrize("check", PLANTED)
def test_a_planted_fault_fails_the_check_that_is_made_for_it(check: str):
    (fault,) = [one for one in FAULTS if one.name == PLANTED[check]]
    with planted_robot(edits=fault.edits) as robot:
        # What is tested of everything received is tested of some commands and sessions at least.
        checks = [one for one in all_checks() if one.name in (check, "stop and refusal in force")]
        assert check in failures(robot, checks)


@pytest.mark.full
@pytest.mark.slow(reason="robots of all versions are tested for a sample of faults")
@pytest.mark.parametrize("version", some(sorted(VERSIONS, reverse=True)))
def test_a_sample_of_the_planted_faults_is_found(version: int):
    possible = [one for one in FAULTS if version in one.versions]
    sample = possible[version :: len(possible) // SAMPLE]
    missed = [one.name for one in sample if not find_fault(one, version).found_by]
    assert missed == []


@pytest.mark.parametrize("version", VERSIONS)
def test_a_robot_without_a_fault_conforms_in_every_version(version: int):
    with planted_robot(version) as robot:
        assert failures(robot, all_checks()) == []


def test_a_fault_that_does_not_fit_the_firmware_is_refused():
    with (
        pytest.raises(ValueError, match="has 0 times, not once"),
        planted_robot(edits=(("session", "no such line", ""),)),
    ):
        pass


@pytest.mark.full
def test_a_mutant_without_a_mutation_passes():
    assert failures(Mutant(), all_checks()) == []


def test_the_selected_checks_have_the_word_in_their_names():
    assert [check.name for check in select_checks(["wrong-mark"])] == ["wrong mark dropped"]
