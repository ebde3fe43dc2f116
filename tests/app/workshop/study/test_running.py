"""Studies that run: tasks judged by their channels, kills that lose one answer, bad protocols."""

import itertools
import sys
from dataclasses import replace
from datetime import timedelta
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.encoding import MESSAGE_TYPES
from cubeling.app.ui.screen import NullScreen
from cubeling.app.workshop.study.participants.live_task import judge, play_task
from cubeling.app.workshop.study.participants.running import run_participant, run_simulated
from cubeling.app.workshop.study.participants.simulated import BEGIN, SimulatedDesk, simulate_task
from cubeling.app.workshop.study.participants.study_log import (
    LOG_NAME,
    StudyFolder,
    participants_in,
    read_participant,
    read_study,
)
from cubeling.app.workshop.study.protocols.goals import Goal, GoalWatch
from cubeling.app.workshop.study.protocols.plan import plan_of
from cubeling.app.workshop.study.protocols.protocol import Resume, Settings, StudyTask
from cubeling.app.workshop.study.protocols.protocol_file import (
    bundled_protocols,
    load_protocol,
    protocol_text,
    read_protocol,
)
from tests.campaigns.study_kills import MAX_LOST, lost_answers

NOW = BEGIN + timedelta(hours=6)  # when simulated participants take part


def study(path, name="vleo-and-pleo", kind="study", **changes):
    protocol, file = load_protocol(name)
    return StudyFolder(path, replace(protocol, **changes), file, kind)


class KilledError(Exception):
    """The program is killed."""


class KilledDesk(SimulatedDesk):
    """Answers so many times."""

    def __init__(self, protocol, number, answers):
        super().__init__(protocol, number)
        self.left = answers

    def ask(self, step, questionnaire, item):
        self.left -= 1
        if self.left < 0:
            raise KilledError
        return super().ask(step, questionnaire, item)


def test_a_participant_goes_on_after_the_last_answer(tmp_path):
    folder = study(tmp_path / "s")
    desk = KilledDesk(folder.protocol, 0, 2)
    with pytest.raises(KilledError):
        run_participant(folder.protocol, folder.begin("P01", NOW), desk)
    before = read_participant(tmp_path / "s" / "P01").done
    assert len([key for key in before if "after" in key]) == 2
    log = folder.begin("P01", NOW + timedelta(hours=1))
    assert {step.key for step in log.left} == {step.key for step in log.plan} - before
    run_participant(folder.protocol, log, SimulatedDesk(folder.protocol, 0))
    (person,) = participants_in(tmp_path / "s")
    assert (person.times_begun, len(person.entries)) == (2, len(log.plan))
    with pytest.raises(AppError, match="has taken part already"):
        folder.begin("P01", NOW)


@pytest.mark.parametrize("name", bundled_protocols())
def test_a_log_that_is_cut_anywhere_loses_at_most_one_answer(tmp_path, name):
    folder = study(tmp_path / "s", name, "simulated")
    run_simulated(folder, 1)
    path = tmp_path / "s" / "SIM01" / LOG_NAME
    whole = path.read_bytes()
    rng = np.random.default_rng(3)
    for cut in rng.integers(120, len(whole), 10):
        path.write_bytes(whole[:cut])
        begun = whole[:cut].count(b"\n") - 1  # without the line that begins
        log = folder.begin("SIM01", NOW)
        assert len(log.plan) - len(log.left) == begun
        run_participant(folder.protocol, log, SimulatedDesk(folder.protocol, 0))
        assert folder.has_finished(read_participant(path.parent))


@pytest.mark.full
@pytest.mark.slow(reason="a program is started and killed, three times")
@pytest.mark.skipif(sys.platform == "win32", reason="kill -9")
def test_a_killed_program_loses_at_most_one_answer(tmp_path):
    lost = lost_answers("whose-idle-motion", 3, np.random.default_rng(1), tmp_path / "s")
    assert max(lost) <= MAX_LOST


@pytest.mark.parametrize(
    ("rules", "hours", "kept"),
    [
        (Resume(), 1, 5),
        (Resume(policy="restart"), 1, 0),
        (Resume(oldest_h=24.0), 30, 0),
        (Resume(at="phase"), 1, 3),
    ],
)
def test_the_policy_says_where_a_participant_goes_on(tmp_path, rules, hours, kept):
    folder = study(tmp_path / "s", resume=rules)
    with pytest.raises(KilledError):
        run_participant(
            folder.protocol, folder.begin("P01", NOW), _at(KilledDesk(folder.protocol, 0, 1))
        )
    log = folder.begin("P01", NOW + timedelta(hours=hours))
    assert len(log.plan) - len(log.left) == kept


def _at(desk):
    desk._now = NOW
    return desk


def test_a_policy_may_turn_people_away(tmp_path):
    folder = study(tmp_path / "s", resume=Resume(policy="block"))
    folder.begin("P01", NOW)
    with pytest.raises(AppError, match="lets nobody go on"):
        folder.begin("P01", NOW)


def test_codes_are_codes_and_a_folder_has_one_study(tmp_path):
    folder = study(tmp_path / "s")
    folder.begin("p01", NOW)
    for code, words in (("P01", "in other letters"), ("", "needs a code"), ("../x", "short code")):
        with pytest.raises(AppError, match=words):
            folder.begin(code, NOW)
    with pytest.raises(AppError, match="kind 'study', not 'pilot'"):
        study(tmp_path / "s", kind="pilot")
    with pytest.raises(AppError, match="holds the study"):
        study(tmp_path / "s", "whose-idle-motion")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "x").touch()
    with pytest.raises(AppError, match="not empty"):
        study(tmp_path / "full")


def test_scripted_users_make_pleo_happy_in_time_and_sooner_with_half_the_turns():
    times = {}
    for turns in (2.0, 1.0):
        task = StudyTask("happy", "", "companion", Goal("mood", "happy"))
        results = [
            simulate_task(task, Settings(turns=turns), np.random.default_rng(seed))
            for seed in range(24)
        ]
        times[turns] = [120.0 if each.time_s is None else each.time_s for each in results]
        assert max(times[turns]) <= 40.0
    assert all(fast <= slow for fast, slow in zip(times[1.0], times[2.0], strict=True))
    assert np.mean(times[1.0]) < np.mean(times[2.0])


@pytest.mark.slow(reason="the channels of a whole recording are read")
def test_a_task_is_judged_by_the_channels_of_its_recording(scripted_session):
    session = scripted_session("companion")
    task = StudyTask("kiss", "", "companion", Goal("action", "kiss", hold_s=0.5))
    result = judge(session, task)
    with SessionFile(session) as file:
        topic = "/character/command"
        commands = [
            (time, command.activity)
            for _, time, command in file.decode_messages({topic: MESSAGE_TYPES[topic]})
        ]
    first = commands[0][0]
    since = next(time for time, activity in commands if activity == "kiss")
    reached = next(time for time, _ in commands if time - since >= 0.5)
    assert result.time_s == pytest.approx(reached - first)
    late = judge(session, replace(task, limit_s=since - first))
    assert (late.reached, late.time_s) == (False, None)
    assert late.played_s == pytest.approx(since - first)


@pytest.mark.parametrize("ended_by", ["source", "person", "limit"])
def test_the_log_tells_what_ended_a_task(tmp_path, monkeypatch, ended_by):
    asked = itertools.count()
    monkeypatch.setattr(
        NullScreen, "closed", property(lambda _: ended_by == "person" and next(asked) > 2)
    )
    options = SessionOptions(
        scenario="companion",
        source="synthetic:companion?rate=5&size=160x90",
        end_s=1.0,
        record=tmp_path / "x.mcap",
        pictures=False,
    )
    limit_s = 0.5 if ended_by == "limit" else 60.0
    task = StudyTask("t", "", "companion", Goal("mood", "angry"), limit_s)
    result = play_task(options, task)
    assert (result.reached, result.ended_by) == (False, ended_by)


def test_a_goal_that_must_hold_begins_again_when_it_was_lost():
    watch = GoalWatch(Goal("gesture", "shaken", hold_s=0.2), 10.0)
    message = type("Controls", (), {"gestures": ("shaken",)})
    nothing = type("Controls", (), {"gestures": ()})
    for time, seen in (
        (0.0, message),
        (0.1, nothing),
        (0.2, message),
        (0.3, message),
        (0.4, message),
    ):
        watch.see("/cube/controls", time, seen)
    assert watch.result.time_s == pytest.approx(0.4)


TASK = """
title = "x"
[[phase]]
name = "p"
parts = ["t"]
[[task]]
name = "t"
text = "Do it."
scenario = "companion"
"""


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (TASK + 'goal = { value = "mood", equals = "delighted" }', "never 'delighted'"),
        (TASK + 'goal = { value = "valence", at_least = 1.5 }', "cannot be reached"),
        (TASK + 'goal = { value = "action", equals = "wave" }', "never 'wave'"),
        (TASK + 'goal = { value = "face", equals = "lid" }', "never 'lid'"),
        (TASK + 'goal = { value = "joy", equals = "x" }', "cannot ask for 'joy'"),
        (TASK + 'limit_s = 5\ngoal = { value = "mood", equals = "happy", hold_s = 9 }', "holds 9"),
        ('conditions = ["shy"]\n[condition.bold]\n', "none of the conditions, which are shy"),
        (
            TASK.replace("companion", "compagnon") + 'goal = { value = "mood", equals = "happy" }',
            "task[0].scenario: no scenario is called",
        ),
        (TASK.replace('"t"]', '"u"]') + 'goal = { value = "mood", equals = "happy" }', "names 'u'"),
        ('title = "x"', "at least one"),
        ('title = "x"\nconditions = ["a", "a"]', "same name"),
        ("title = 3", "title"),
        ("= 3", "not TOML"),
        (
            'title = "x"\n[[phase]]\nname = "p"\nparts = ["s"]\n[[stimuli]]\nname = "s"\n'
            'ask = "q"\neach = 3\n'
            '[[stimuli.cross]]\na = ["1", "2"]\n[[questionnaire]]\nname = "q"\n'
            '[[questionnaire.item]]\nname = "i"\ntext = "?"',
            "has 2 stimuli, not 3",
        ),
    ],
)
def test_a_protocol_that_cannot_be_run_is_refused_in_one_line(tmp_path, text, words):
    path = tmp_path / "x.toml"
    path.write_text(text)
    with pytest.raises(AppError) as caught:
        read_protocol(path)
    line = str(caught.value)
    assert words in line
    assert line.isprintable()
    assert "x.toml" in line


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ('character = "dino"', "no bundled character 'dino'"),
        ('personality = "friendly"', "no personality 'friendly'"),
        ('controller = "tre"', "no controller is called 'tre'"),
        ("turns = 0", "from 0.1 to 20"),
    ],
)
def test_a_trial_with_simulated_participants_meets_what_people_would_meet(
    cubeling, tmp_path, setting, words
):
    text = protocol_text(None).replace("turns = 1.0", setting)
    (tmp_path / "x.toml").write_text(text, "utf-8")
    code, _, err = cubeling("study", "run", "x.toml", "-o", "s", "--simulated", "1")
    assert (code, len(err.splitlines())) == (2, 1)
    assert words in err
    assert "x.toml: condition" in err
    assert "'one turn'" in err
    assert not (tmp_path / "s").exists()


def test_the_template_is_a_protocol_with_two_conditions_and_five_questions(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(protocol_text(None), encoding="utf-8")
    protocol = read_protocol(path)
    assert len(protocol.conditions) == 2
    assert sum(len(each.item) for each in protocol.questionnaires.values()) == 5
    assert {step.condition for step in plan_of(protocol, 0)} == {"", "two turns", "one turn"}


def test_a_protocol_names_the_buttons_of_a_wizards_desk(tmp_path):
    path = tmp_path / "mine.toml"
    wizard = '[wizard]\ncues = ["greets"]\nplace = [{ name = "l", x_cm = 1, z_cm = 2 }]'
    path.write_text(f"{protocol_text(None)}\n{wizard}\n", encoding="utf-8")
    plan = read_protocol(path).wizard
    assert plan is not None
    assert (plan.cues, plan.actions, plan.place[0].z_cm) == (("greets",), None, 2)
    path.write_text(f'{protocol_text(None)}\n[wizard]\nemotions = ["glee"]\n', encoding="utf-8")
    with pytest.raises(AppError, match="no emotion is called 'glee'"):
        read_protocol(path)


def test_a_study_in_which_nobody_has_begun_is_made_anew(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(protocol_text(None), encoding="utf-8")
    StudyFolder(tmp_path / "s", read_protocol(path), path, "pilot")
    path.write_text(protocol_text(None) + "\n# another\n", encoding="utf-8")
    study = StudyFolder(tmp_path / "s", read_protocol(path), path, "study")
    study.begin("P01", NOW)
    assert read_study(tmp_path / "s")[1:] == ("study", False)


def test_a_changed_protocol_is_kept_beside_the_first_one(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(protocol_text(None), encoding="utf-8")
    StudyFolder(tmp_path / "s", read_protocol(path), path, "study").begin("P01", NOW)
    first = Path(tmp_path / "s" / "protocol.toml").read_text("utf-8")
    path.write_text(protocol_text(None) + "\n# another\n", encoding="utf-8")
    StudyFolder(tmp_path / "s", read_protocol(path), path, "study")
    assert (tmp_path / "s" / "protocol-before-1.toml").read_text("utf-8") == first
    assert (tmp_path / "s" / "protocol.toml").read_text("utf-8") == path.read_text("utf-8")
