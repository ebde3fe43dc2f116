"""Reports: printed figures from their counts, statistics against their definitions, pages."""

import csv
import io
import math
import re
import sys
from collections import defaultdict
from dataclasses import asdict
from datetime import datetime
from itertools import pairwise
from statistics import NormalDist

import numpy as np
import pytest

from cubeling.app.session import WizardAct, session_info
from cubeling.app.workshop.pages.box_plot import box_plot
from cubeling.app.workshop.pages.page import page, table
from cubeling.app.workshop.pages.report_table import ReportTable, interval
from cubeling.app.workshop.study.bundled import (
    gesture_and_speech,
    single_facial_actions as faces,
    vleo_and_pleo,
    whose_idle_motion,
)
from cubeling.app.workshop.study.participants.study_log import StudyFolder, participants_in
from cubeling.app.workshop.study.protocols.protocol_file import (
    bundled_protocols,
    load_protocol,
    read_protocol,
)
from cubeling.app.workshop.study.reporting.measures import task_parts, wizard_parts
from cubeling.app.workshop.study.reporting.statistics import (
    compare_paired,
    compare_several,
    compare_unpaired,
    describe,
)
from cubeling.app.workshop.study.reporting.tables import gather, write_tables
from tests.examples import some

RUNS = 1000


@pytest.fixture
def stats():
    from scipy import stats  # a second: not for who only collects the tests

    return stats


def test_the_printed_percentages_of_the_child_study_follow_from_twelve_children():
    (printed,) = vleo_and_pleo.printed_tables()
    rows = {row[0]: row[1:] for row in printed.rows}
    assert rows["Pleo is very happy"] == ("91.7 %", "91.7 %")
    assert rows["Pleo is happy, not much"] == ("8.3 %", "8.3 %")
    assert rows["Pleo is very angry"] == ("100 %", "100.0 %")
    assert rows["Plays most with both"] == ("83.3 %", "83.3 %")
    assert rows["Plays most with Pleo only"] == ("16.7 %", "16.7 %")
    # An erratum of the thesis: (22 − 16.8) / 22.
    assert rows["Second task is faster"] == ("27 %", "23.6 %")
    assert rows["Its times vary less"] == ("39 %", "39.2 %")


def test_the_printed_scores_of_gestures_follow_from_counts():
    (printed,) = gesture_and_speech.printed_tables()
    for stated, counted in zip(printed.rows[::2], printed.rows[1::2], strict=True):
        for name, column in (("better", 2), ("worse", 3), ("mean", 4), ("median", 5)):
            if stated[column] != "–" and stated[column] != "8.0":  # 10 of 124 are 8.06 %
                assert stated[column] == counted[column], name
    assert "intensity 40.3 % (printed 40.3 %)" in printed.note
    assert "time 16.9 % (printed 16.9 %)" in printed.note
    assert "random 15.3 % (printed 15.3 %)" in printed.note


def test_d_prime_follows_from_the_printed_rates():
    assert whose_idle_motion.d_prime(0.73, 0.54) == pytest.approx(0.713, abs=5e-4)
    rows = {row[0]: row[2] for row in whose_idle_motion.printed_tables()[0].rows}
    assert (rows["right in all"], rows["d′"]) == ("63.5 %", "0.71")


def test_the_two_tables_of_faces_agree_in_their_margins():
    for action, (high, low) in faces.INTENSITY.items():
        moving, still = faces.PRESENTATION[action]
        for one in range(3):
            assert (high[one] + low[one]) / 2 == pytest.approx(
                (moving[one] + still[one]) / 2, abs=0.13
            )


def rate(action, factor, level, scale, size, rng):
    """Answers of simulated raters on a scale, as so many rows of `size` answers."""
    others = {"intensity": ("high", "low"), "mode": ("animation", "picture")}
    other = next(name for name in others if name != factor)
    chances = np.mean(
        [
            faces.shares(
                faces.latent_of(faces.cell_mean(action, scale, **{factor: level, other: each}))
            )
            for each in others[other]
        ],
        axis=0,
    )
    return rng.choice(5, p=chances / chances.sum(), size=(RUNS, size)) + 1.0


ANSWERS = 130
"""Of each action at each level: 92 people gave 16.3 answers to each of 8 stimuli."""


@pytest.mark.parametrize(
    ("action", "factor", "levels"),
    some([("AU6", "mode", ("animation", "picture")), ("AU1+2", "intensity", ("high", "low"))]),
)
def test_simulated_raters_have_the_printed_means_and_find_the_strong_effects(
    stats, action, factor, levels
):
    rng = np.random.default_rng(2)
    one, other = (rate(action, factor, level, "EXP", ANSWERS, rng) for level in levels)
    printed = (faces.PRESENTATION if factor == "mode" else faces.INTENSITY)[action]
    assert one.mean() == pytest.approx(printed[0][0], abs=0.15)
    assert other.mean() == pytest.approx(printed[1][0], abs=0.15)
    found = stats.mannwhitneyu(one, other, axis=1).pvalue < 0.05
    assert found.mean() >= 0.8


def power(one, other, size):
    """Power of Mann and Whitney's test for two distributions, by the normal approximation."""
    both = (one + other) / 2
    chance = float(one @ (np.concatenate([[0.0], np.cumsum(other)[:-1]]) + other / 2))
    ties = 1 - float((both**3).sum())
    under_none = math.sqrt(ties / (6 * size))
    below = np.concatenate([[0.0], np.cumsum(other)[:-1]]) + other / 2
    above = 1 - np.concatenate([[0.0], np.cumsum(one)[:-1]]) - one / 2
    spread = float(one @ (below - chance) ** 2 + other @ (above - chance) ** 2)
    z = (abs(chance - 0.5) - 1.96 * under_none) / math.sqrt(spread / size)
    return NormalDist().cdf(z)


def test_a_planted_effect_is_found_at_the_computed_power_and_none_in_five_per_cent(stats):
    rng = np.random.default_rng(4)
    high, low = faces.shares(faces.latent_of(3.03)), faces.shares(faces.latent_of(2.64))
    one = rng.choice(5, p=high / high.sum(), size=(RUNS, ANSWERS))
    other = rng.choice(5, p=low / low.sum(), size=(RUNS, ANSWERS))
    none = rng.choice(5, p=high / high.sum(), size=(RUNS, ANSWERS))
    found = (stats.mannwhitneyu(one, other, axis=1).pvalue < 0.05).mean()
    assert found == pytest.approx(power(high, low, ANSWERS), abs=0.06)
    assert (stats.mannwhitneyu(one, none, axis=1).pvalue < 0.05).mean() == pytest.approx(
        0.05, abs=0.02
    )


def test_a_first_choice_is_as_frequent_as_printed():
    rng = np.random.default_rng(5)
    for action, rates in faces.FIRST_CHOICE.items():
        for wrinkles, expected in zip(("with", "without"), rates, strict=True):
            right = np.concatenate(
                [
                    rate(action, "intensity", level, "EXP", 10, rng).ravel()
                    for level in ("high", "low")
                ]
            )
            chances = faces.shares(faces.latent_of(faces.other_mean(action, wrinkles)))
            others = rng.choice(5, p=chances / chances.sum(), size=(len(right), 2)) + 1
            assert (right > others.max(1)).mean() == pytest.approx(expected, abs=0.02)


def test_effects_are_what_they_are_called(stats):
    rng = np.random.default_rng(0)
    one, other = rng.normal(1, 1, 15), rng.normal(0, 1, 15)
    unpaired = compare_unpaired(one, other)
    greater = np.sign(one[:, None] - other[None]).mean()
    assert unpaired.effect == pytest.approx(greater)
    assert unpaired.p == pytest.approx(stats.mannwhitneyu(one, other).pvalue)
    paired = compare_paired(one, other)
    ranks = stats.rankdata(np.abs(one - other)) * np.sign(one - other)
    assert paired.effect == pytest.approx(ranks.sum() / np.abs(ranks).sum())
    assert paired.p == pytest.approx(stats.wilcoxon(one, other).pvalue)
    assert paired.interval[0] < paired.difference < paired.interval[1]
    assert compare_paired([2, 2], [2, 2]).p == compare_unpaired([2, 2], [2, 2]).p == 1.0
    assert interval(describe([3.0]).interval) == "–"  # one value says nothing of a mean


def test_samples_without_spread_are_compared_without_a_warning(stats):
    same = [[1.0, 2.0], [1.0, 2.0], [1.0, 2.0]]
    assert compare_several(same, paired=True)[1:] == (0.0, 1.0)
    assert compare_several([[1.0], [1.0], [1.0]], paired=False)[1:] == (0.0, 1.0)
    name, _, p = compare_several([[1.0, 2.0, 3.0], [2.0, 3.0, 4.0], [3.0, 4.0, 5.0]], paired=True)
    assert name == "Friedman"
    assert p == pytest.approx(stats.chi2.sf(6.0, 2))


def test_a_page_holds_all_it_shows_and_no_markup_of_others():
    content = ReportTable("<b>T</b>", ("a & b",), (("<script>x</script>",),))
    text = page("<i>", [table(content), box_plot([("<u>", [1.0, 2.0, 9.0]), ("none", [])], "<s>")])
    assert not re.search(r"<(script|i|b|u|s)>|src=|href=|url\(", text)
    assert text.count("<rect") == 1
    assert text.count('class="point"') == 3


def rows_of(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.slow(reason="a whole study of 24 participants")
@pytest.mark.parametrize("name", some(bundled_protocols()))
def test_each_bundled_protocol_goes_from_run_to_report_by_one_command(cubeling, tmp_path, name):
    code, out, err = cubeling("study", "run", name, "-o", "s", "--simulated", 24)
    assert (code, err) == (0, "")
    assert out.startswith("24 participants (simulated), ")
    folder = tmp_path / "s"
    text = (folder / "report.html").read_text("utf-8")
    assert "Simulated participants" in text
    assert "24 took part, 24 finished." in text
    dictionary = {(row["table"], row["column"]) for row in rows_of(folder / "data_dictionary.csv")}
    for table_name in ("participants", "answers", "tasks", "scores"):
        rows = rows_of(folder / f"{table_name}.csv")
        assert all((table_name, column) in dictionary for row in rows for column in row)
        assert {row["kind"] for row in rows} <= {"simulated"}
    again = cubeling("study", "report", "s")
    assert again[0] == 0
    assert (folder / "report.html").read_text("utf-8") == text


def test_a_strangers_study_goes_from_a_template_to_a_report(cubeling, tmp_path):
    assert cubeling("study", "new", "turns")[0] == 0
    code, _, err = cubeling("study", "run", "turns.toml", "-o", "trial", "--simulated", 8)
    assert (code, err) == (0, "")
    orders = defaultdict[str, int](int)
    for row in rows_of(tmp_path / "trial" / "participants.csv"):
        orders[row["conditions"]] += 1
    assert orders == {"two turns;one turn": 4, "one turn;two turns": 4}
    text = (tmp_path / "trial" / "report.html").read_text("utf-8")
    assert "Conditions compared: Time to the goal [s]" in text
    assert text.index("two turns") < text.index("Reached")
    places = [text.index(f"<h2>{each}</h2>") for each in ("Participants", "Tasks", "Questions")]
    assert all(first < then for first, then in pairwise(places))


LIVE = """
title = "x"
[[phase]]
name = "p"
parts = ["kiss"]
[[task]]
name = "kiss"
text = "Let it throw a kiss."
scenario = "companion"
goal = { value = "face", equals = "front" }
limit_s = 1.0
then = ["q"]
[[questionnaire]]
name = "q"
[[questionnaire.item]]
name = "easy"
text = "Easy?"
[[questionnaire.item]]
name = "more"
text = "More?"
kind = "text"
"""


@pytest.mark.slow(reason="a second of a recording is played")
def test_a_participant_plays_and_answers_and_goes_on_later(
    cubeling, monkeypatch, tmp_path, bundled_session
):
    (tmp_path / "x.toml").write_text(LIVE)
    run = ("study", "run", "x.toml", "-o", "s", "--participant", "P01", "--no-pictures")
    monkeypatch.setattr(sys, "stdin", io.StringIO("\nseven\n9\n4\n"))
    code, out, err = cubeling(*run, "--source", bundled_session)
    assert code == 130  # the input ended
    assert "a number from 1 to 5, please" in out
    assert "reached" not in out, "it would tell the participant what is measured"
    assert "Go on: cubeling study run x.toml -o s --participant P01" in out
    info = session_info(tmp_path / "s" / "P01" / "kiss.mcap")
    assert (info.labels.participant, round(info.duration)) == ("P01", 1)
    monkeypatch.setattr(sys, "stdin", io.StringIO("It was fun.\n"))
    assert cubeling(*run)[0] == 0
    assert cubeling("study", "report", "s")[0] == 0
    answers = {row["item"]: row["answer"] for row in rows_of(tmp_path / "s" / "answers.csv")}
    assert answers == {"easy": "4.0", "more": "It was fun."}
    (task,) = rows_of(tmp_path / "s" / "tasks.csv")
    told = [task[name] for name in ("reached", "ended_by", "attempt", "recording")]
    assert told == ["0", "limit", "1", "kiss.mcap"]
    assert "It was fun." in (tmp_path / "s" / "report.html").read_text("utf-8")
    code, _, err = cubeling(*run)
    assert (code, err) == (2, "cubeling: 'P01' has taken part already: use another code\n")


def test_the_report_says_how_tasks_count_that_did_not_go_on_to_the_end(tmp_path):
    (tmp_path / "x.toml").write_text(LIVE)
    protocol = read_protocol(tmp_path / "x.toml")
    study = StudyFolder(tmp_path / "s", protocol, tmp_path / "x.toml", "study")
    ends = {"P01": "goal", "P02": "limit", "P03": "person", "P04": "source"}
    for code, ended_by in ends.items():
        log = study.begin(code, datetime(2026, 5, 4))
        key = log.plan[0].key
        for _ in range(1 + (code == "P02")):  # whose first attempt was interrupted
            log.write({"tries": key}, datetime(2026, 5, 4))
        reached = ended_by == "goal"
        found = {"reached": reached, "time_s": 0.5 if reached else None, "played_s": 0.5}
        log.write({"key": key, **found, "ended_by": ended_by}, datetime(2026, 5, 4))
    data = gather(protocol, "study", participants_in(tmp_path / "s"))
    assert [row["ended_by"] for row in data.tables["tasks"]] == list(ends.values())
    assert [row["attempt"] for row in data.tables["tasks"]] == [1, 2, 1, 1]
    words = re.sub(r"<[^>]+>", " ", "".join(task_parts(data)))
    assert "1 of 3 (33 %)" in words
    assert "Ended by the participant before goal and limit, counted as not reached: P03." in words
    assert "Cut off, as there were no more pictures, not counted: P04." in words
    assert "of which the last attempt counts: P02." in words


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "vleo-and-pleo", "-o", "s"),
        ("run", "vleo-and-pleo", "-o", "no/s", "--participant", "P1"),
        ("run", "vleo-and-pleo", "-o", "s", "--participant", "a/b"),
        ("run", "vleo-and-pleo", "-o", "s", "--participant", "P1", "--source", "missing.mp4"),
        ("run", "vleo-and-pleo", "-o", "s", "--participant", "P1", "--robot", "sim:dragon"),
        ("run", "vleo", "-o", "s", "--simulated", "2"),
        ("run", "missing.toml", "-o", "s", "--simulated", "2"),
        ("run", "vleo-and-pleo", "-o", "s", "--simulated", "2", "--pilot"),
        ("run", "vleo-and-pleo", "-o", "/dev/null", "--simulated", "2"),
        ("run", "vleo-and-pleo", "-o", "/proc/study", "--simulated", "2"),
        ("report", "nothing"),
        ("new", "no/x.toml"),
        ("new", "x.toml", "--like", "y"),
    ],
)
def test_bad_input_is_one_line_and_leaves_nothing(cubeling, tmp_path, arguments):
    code, _, err = cubeling("study", *arguments)
    assert code == 2
    assert len(err.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_the_report_counts_a_wizards_acts_and_errors_and_gives_the_delays(tmp_path):
    protocol, file = load_protocol("vleo-and-pleo")
    study = StudyFolder(tmp_path / "s", protocol, file, "study")
    log = study.begin("P01", datetime(2026, 5, 4))
    step = next(each for each in log.plan if each.kind == "task")
    acts = [
        WizardAct(1, 2.0, "say", "Hello!", "greets", 0.5),
        WizardAct(2, 3.0, "action", "shout", "greets", 9.0, undone=True),
        WizardAct(3, 3.5, "action", "kiss", "greets", 1.5),
        WizardAct(4, 6.0, "gesture", "NOD", "", None),
    ]
    entry = {
        "key": step.key,
        "reached": True,
        "time_s": 8.0,
        "played_s": 8.0,
        "recording": "x.mcap",
    }
    log.write({**entry, "acts": [asdict(each) for each in acts]}, datetime(2026, 5, 4))
    data = gather(protocol, "study", participants_in(tmp_path / "s"))
    assert [row["undone"] for row in data.tables["acts"]] == [False, True, False, False]
    words = re.sub(r"<[^>]+>", " ", "".join(wizard_parts(data)))
    assert "4 acts; taken back as errors: 1 (25.0 %)." in words
    row = words[words.index(step.part) :].split()
    assert row[row.index("everybody") + 1 :][:4] == ["4", "1", "(25", "%)"]
    # The mean of 0.5 and 1.5, and that of 9.0 with them, which was an error.
    assert "1.00, 0.71, 1.50, 2 3.67, 4.65, 9.00, 3" in " ".join(row)
    write_tables(data, tmp_path / "s")
    with (tmp_path / "s" / "acts.csv").open(encoding="utf-8", newline="") as table_file:
        assert [each["delay_s"] for each in csv.DictReader(table_file)] == ["0.5", "9.0", "1.5", ""]
