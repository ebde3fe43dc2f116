"""Scenarios that are a file of rules."""

import dataclasses
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import check_actions
from cubeling.app.running.asked_scenario import names_of_cast
from cubeling.app.scenarios import Inputs, ScenarioSettings, Situation, make_scenario
from cubeling.app.scenarios.rules.file import read_rules
from cubeling.app.scenarios.rules.scenario import rules_scenario
from cubeling.app.scenarios.rules.vocabulary import ACTIONS, CONDITIONS, Term
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.lines import bundled_languages, bundled_lines
from cubeling.characters import Character, RootDelta
from cubeling.tracking import CubeModel, Intrinsics

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/rules.md").read_text("utf-8")

RULES = """
summary = "a test"
hint = "usual"
[[rule]]
when = "shaken"
do = "cheer"
say = "Hooray!"
for = 1.0
[[rule]]
when = "lifted"
do = "wave"
say = ["Hello!", "Again!"]
hint = "waving"
for = 2.0
[[rule]]
while = ["resting", "top kiss"]
do = "kiss"
[[rule]]
when = "not lifted"
after = 5.0
feel = "ignored"
hint = "bored"
"""


@pytest.fixture
def rules(tmp_path):
    path = tmp_path / "test.toml"
    path.write_text(RULES)
    return str(path)


@pytest.fixture
def play(rules, hand):
    """Returns the outcome of a frame of the hand, which the scenario is shown first."""
    scenario = make_scenario(rules)
    scenario.update(hand.frame(), Situation(), Inputs())

    def update(controls, inputs=None):
        return scenario.update(controls, Situation(), inputs or Inputs())

    return update


def test_a_rule_acts_when_its_condition_begins_and_for_its_time(play, hand):
    begun = play(hand.frame(resting=False, lifted=True))
    assert (begun.command.activity, begun.hint, begun.events) == ("wave", "waving", ("rule 2",))
    later = [play(controls) for controls in hand.wait(1.9)]
    assert {outcome.command.activity for outcome in later} == {"wave"}
    assert not any(outcome.events for outcome in later), "it is said once"
    over = [play(controls) for controls in hand.wait(0.2)][-1]
    assert (over.command.activity, over.hint) == ("idle", "usual"), "the cube is still lifted"


def test_another_rule_takes_over(play, hand):
    play(hand.frame(resting=False, lifted=True))
    assert play(hand.frame(gestures=("shaken",))).command.activity == "cheer"


def test_a_lasting_rule_acts_while_all_its_conditions_hold(play, hand):
    kiss = next(f.name for f in CubeModel.load("companion").faces if f.role == "kiss")
    shown = hand.frame(top_face=kiss, resting=True)
    assert play(shown).command.activity == "kiss"
    assert [play(each).command.activity for each in hand.wait(10.0)][-1] == "kiss"
    assert play(hand.frame(resting=False)).command.activity == "idle"


def test_a_rule_may_wait(play, hand):
    hints = [play(controls).hint for controls in hand.wait(6.0)]
    assert hints[0] == "usual"
    assert hints.count("bored") == pytest.approx(30, abs=2), "the last of six seconds"


def test_the_key_c_begins_again(play, hand):
    play(hand.frame(resting=False, lifted=True))
    assert play(hand.frame(), Inputs(clear=True)).command.activity == "wave"
    assert play(hand.frame(resting=True, lifted=False)).command.activity == "wave"


def test_an_action_that_the_character_lacks_is_named_before_play(rules):
    scenario = make_scenario(rules)
    check_actions(scenario, "me", ("wave", "nod", "cheer", "kiss"))
    with pytest.raises(AppError, match=r"rule\[1\].do: me cannot 'wave'; its actions: nod, cheer"):
        check_actions(scenario, "me", ("nod", "cheer"))


def test_a_character_that_lacks_an_action_is_not_let_in(tmp_path):
    path = tmp_path / "bark.toml"
    path.write_text("[[rule]]\nwhen = 'lifted'\ndo = 'bark'\n")
    with pytest.raises(AppError, match=r"bark\.toml: rule\[0\]\.do: human cannot 'bark'"):
        Playground(str(path), Intrinsics.guess((640, 480)))
    path.write_text("others = ['vleo']\n[[rule]]\nwho = 'vleo'\nwhen = 'seen'\ndo = 'bark'\n")
    with pytest.raises(AppError, match=r"rule\[0\]\.do: vleo cannot 'bark'"):
        Playground(str(path), Intrinsics.guess((640, 480)), others=[Character.load("vleo")])


def test_what_rules_say_are_the_lines_of_the_scenario(rules):
    assert bundled_languages(rules) == ("en",)
    said = bundled_lines(rules, "en")
    assert said is not None
    assert said.lines == {"rule 1": ("Hooray!",), "rule 2": ("Hello!", "Again!")}
    with pytest.raises(AppError, match="no lines in 'es'"):
        bundled_lines(rules, "es")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "there is none"),
        ("[[rule]]\ndo = 'wave'", "either when or while"),
        ("[[rule]]\nwhen = 'lifted'", "does nothing"),
        ("[[rule]]\nwhen = 'lift'\ndo = 'wave'", "'lift' is no condition"),
        ("[[rule]]\nwhen = 'top'\ndo = 'wave'", "as in 'top ROLE'"),
        ("[[rule]]\nwhen = 'lifted 3'\ndo = 'wave'", "comes nothing"),
        ("[[rule]]\nwhen = 'near soon'\ndo = 'wave'", "no number of cm"),
        ("[[rule]]\nwhen = 'shaken'\nafter = 1\ndo = 'wave'", "a moment only"),
        ("[[rule]]\nwhile = 'seen'\nfor = 1\ndo = 'wave'", "as long as"),
        ("[[rule]]\nwhen = 'seen'\ngo = 'moon'", "cube, home"),
        ("[[rule]]\nwhen = 'seen'\nwave = 'yes'", "means nothing here"),
        ("[[rule]]\nwhen = 3\ndo = 'wave'", "when must be"),
        ("[[rule]]\nwho = 'vleo'\nwhen = 'seen'\ndo = 'wave'", "rule[0].who"),
        ("[[rule]]\nwhen = 'heard vleo'\ndo = 'wave'", "the cast is human, without 'vleo'"),
        ("others = ['vleo']\n[[rule]]\nwhen = 'heard'\ndo = 'wave'", "as in 'heard WHO'"),
    ],
)
def test_a_wrong_file_is_refused_with_its_name_before_anything_loads(cubeling, text, said):
    Path("mine.toml").write_text(text)
    code, _, err = cubeling("play", "mine.toml")
    assert code == 2
    assert err.startswith("cubeling: mine.toml: ")
    assert said in err
    assert err.count("\n") == 1


def test_a_missing_file_is_one_line(cubeling):
    assert cubeling("play", "none.toml")[2].startswith("cubeling: cannot read the scenario 'none")


def test_a_cube_without_a_role_of_a_rule_is_refused(cubeling, rules):
    code, _, err = cubeling("play", rules, "--cube", "locomotion")
    assert code == 2
    assert "missing: kiss" in err


@pytest.mark.parametrize("condition", CONDITIONS)
def test_every_condition_can_be_asked_and_denied(condition, hand, rules):
    arguments = {"NAME": "shaken", "ROLE": "kiss", "WHO": "vleo"}
    argument = arguments.get(CONDITIONS[condition].argument, "")
    term = Term.parse(f"{condition} {argument}", ["human", "vleo"])
    scenario = make_scenario(rules)
    moment = _moment(scenario, hand.frame())
    assert term.holds(moment) != dataclasses.replace(term, negated=True).holds(moment)


def _moment(scenario, controls):
    from cubeling.app.scenarios.rules.vocabulary import Moment

    return Moment(controls, Situation(), Inputs(), scenario._roles)


def test_the_page_lists_every_condition_and_action():
    conditions, actions = PAGE.partition("<!-- actions -->")[::2]
    named = re.findall(r"^\| `(\w+)[^`]*` \| (.*) \|$", conditions.partition("<!-- cond")[2], re.M)
    assert [name for name, _ in named] == list(CONDITIONS)
    for name, meaning in named:
        assert meaning.partition(";  ")[0].startswith(CONDITIONS[name].meaning)
    assert re.findall(r"^\| `(\w+)` \|", actions, re.M) == list(ACTIONS)


def test_the_examples_of_the_page_can_be_read(tmp_path):
    path, counts = tmp_path / "page.toml", []
    for example in re.findall(r"^```toml\n(.*?)^```", PAGE, re.S | re.M):
        path.write_text(example)
        counts.append(len(read_rules(path).rules))
    assert counts == [3, 2]


@pytest.mark.full
@pytest.mark.slow(reason="a session is replayed")
def test_a_new_file_of_rules_plays(cubeling, bundled_session):
    assert cubeling("scenario", "new", "hello.toml")[0] == 0
    assert cubeling("scenario", "new", "hello.toml")[0] == 2, "it exists"
    part = ("--no-pictures", "--end", "2", "--robot", "none")
    code, out, _ = cubeling("replay", bundled_session, "--scenario", "hello.toml", *part)
    assert code == 0
    assert "hello.toml" in out


@pytest.mark.full
@pytest.mark.slow(reason="a test runs its test in a program of its own")
def test_a_new_package_has_a_test_that_passes(cubeling):
    assert cubeling("scenario", "new", "big_hello")[0] == 0
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "big_hello"]
    run = subprocess.run(command, capture_output=True, text=True, cwd=Path.cwd())
    assert "1 passed" in run.stdout


@pytest.mark.parametrize("name", ["9a", "class", "Hello", "a-b", "follow"])
def test_a_name_that_cannot_be_one_is_refused(cubeling, name):
    code, _, err = cubeling("scenario", "new", name)
    assert code == 2
    assert err.count("\n") == 1
    assert not Path(name).exists()


@pytest.mark.parametrize(
    ("options", "cast"),
    [
        ({}, ("human", "vleo", "robot")),
        ({"character": "robot"}, ("robot",)),
        ({"character": "robot", "others": ("human",)}, ("robot", "human")),
        ({"players": 2}, ("human", "vleo", "robot")),
    ],
)
def test_a_file_names_its_cast_unless_the_player_does(tmp_path, options, cast):
    path = tmp_path / "cast.toml"
    path.write_text(RULES.replace("[[rule]]", 'others = ["vleo", "robot"]\n[[rule]]', 1))
    asked = SessionOptions(scenario=str(path), source="none", **options)
    assert names_of_cast(asked, make_scenario(str(path))) == cast


def test_a_file_with_too_large_a_cast_is_refused(tmp_path):
    path = tmp_path / "crowd.toml"
    path.write_text(RULES.replace("[[rule]]", f"others = {['vleo'] * 5}\n[[rule]]", 1))
    with pytest.raises(AppError, match="at most 4"):
        make_scenario(str(path))


DIALOGUE = """
others = ["vleo", "vleo"]
[[rule]]
when = "lifted"
say = "Look!"
[[rule]]
who = "vleo"
when = "heard human"
do = "nod"
say = "I see"
for = 0.5
[[rule]]
who = "vleo_2"
while = "lifted"
go = "cube"
[[rule]]
who = "vleo_2"
while = "always"
go = "home"
"""


@pytest.fixture
def dialogue(tmp_path):
    """Returns what a cast does, frame by frame, of which the first one has just spoken or not."""
    path = tmp_path / "dialogue.toml"
    path.write_text(DIALOGUE)
    lead = rules_scenario(str(path))(CubeModel.load("companion"), ScenarioSettings())
    places = RootDelta(0.2, 0.0), RootDelta(0.1, -0.2)
    others = [lead.scenario_of(at, place) for at, place in enumerate(places, start=1)]
    cast = [each for each in (lead, *others) if each is not None]
    assert len(cast) == 3

    def update(controls, heard=None):
        seen = Situation(heard=heard)
        return [each.update(controls, seen, Inputs()) for each in cast if each is not None]

    return update


def test_each_rule_is_for_the_character_that_it_names(dialogue, hand):
    dialogue(hand.frame())
    lifted = dialogue(hand.frame(resting=False, lifted=True))
    assert [each.events for each in lifted] == [("rule 1",), (), ("rule 3",)]
    assert [each.command.activity for each in lifted] == ["idle", "idle", "idle"]
    answered = dialogue(hand.frame(), heard=0)
    assert [each.events for each in answered] == [(), ("rule 2",), ()]
    assert answered[1].command.activity == "nod"
    over = [dialogue(controls) for controls in hand.wait(0.7)][-1]
    assert over[1].command.activity == "idle", "it watches again"


def test_home_is_where_a_character_of_the_cast_stood_first(dialogue, hand):
    _, _, third = dialogue(hand.frame())
    assert third.command.locomotion.target == pytest.approx([0.1, -0.2])


def test_who_has_no_rule_watches(rules):
    lead = rules_scenario(rules)(CubeModel.load("companion"), ScenarioSettings())
    assert lead.scenario_of(1, RootDelta()) is None
