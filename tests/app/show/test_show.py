"""Plays: the order and the overlap of their cues, with a voice that is made up."""

import math
import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.scenario import OVER_EVENT, ConversingScenario, Inputs, ScenarioSettings
from cubeling.app.pipeline.table.attention import Attention
from cubeling.app.pipeline.table.situation import SeenCube, Situation
from cubeling.app.pipeline.table.spoken_line import SpokenLine
from cubeling.app.running.asked_scenario import load_cast
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionOptions
from cubeling.app.show.scenario import BACK_S, show_scenario
from cubeling.app.show.stage_state import MAX_WAIT_S
from cubeling.app.speaking.line_chooser import LineRequest
from cubeling.app.speaking.speaker import soundless_line
from cubeling.bad_input import BadInputError
from cubeling.characters import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.speech import DEFAULT_PROFILE, Manner
from cubeling.tracking import CubeModel, CubeState
from tests.app.conftest import Hand
from tests.bundled_characters import bundled_character

CUBE = CubeModel.load("companion")
ANTIGONE = Path("app/show/antigone.show")
FRAME = 1 / 30
TALK = (
    '<dialogue><unit name="u"><state name="q"><transition>'
    '<condition type="input_match">* you *</condition><action type="say">Me.</action>'
    "</transition></state></unit></dialogue>"
)
VOICE_S = 6.0
"""How long every line of the made up voice is [s]."""


class Theatre:
    """Plays a file with a voice that answers after two frames, and notes what happens."""

    def __init__(self, hand, path, *, voice=True):
        self.hand, self.voice = hand, voice
        lead = show_scenario(path)(CUBE, ScenarioSettings())
        others = range(1, len(lead.script.cast))
        self.cast: list[Any] = [lead, *(lead.scenario_of(at, RootDelta()) for at in others)]
        self.events = []  # (time, who, what)
        self._due = {}
        self._acting = [""] * len(self.cast)
        self.over = False

    def frame(self, **asked):
        controls = self.hand.frame()
        now = controls.timestamp
        outcomes = []
        for who, scenario in enumerate(self.cast):
            frames, line = self._due.get(who, (None, None))
            line = line if frames is not None and self.hand.frames >= frames else None
            if line is not None:
                self._due.pop(who)
                self.events.append((now, who, "speaks"))
            inputs = Inputs(line=line, **asked)
            outcome = scenario.update(controls, Situation(), inputs)
            outcomes.append(outcome)
            if outcome.reply is not None:
                self.events.append((now, who, "reply"))
                request = LineRequest(outcome.reply.text, "en", Manner())
                said = soundless_line(request, DEFAULT_PROFILE)
                said = replace(said, utterance=replace(said.utterance, duration=VOICE_S))
                if self.voice:
                    self._due[who] = self.hand.frames + 2, said
            action = outcome.command.activity
            if action != self._acting[who]:
                self._acting[who] = action
                self.events.append((now, who, action))
            if outcome.icon == "talk":
                self.events.append((now, who, "shows talk"))
        self.over = OVER_EVENT in outcomes[0].events
        return outcomes

    def play(self, seconds):
        for _ in range(round(seconds / FRAME)):
            self.frame()
            if self.over:
                return

    def times(self, who, what):
        return [time for time, number, event in self.events if (number, event) == (who, what)]


def test_antigone_and_creon_in_their_order_and_with_their_overlap(hand):
    theatre = Theatre(hand, ANTIGONE)
    theatre.play(90.0)
    assert theatre.over
    creon, antigone = theatre.times(0, "speaks"), theatre.times(1, "speaks")
    first, third = creon
    second, fourth = antigone
    assert first < second < third < fourth
    assert theatre.times(0, "shows talk")[0] == pytest.approx(first, abs=2 * FRAME)
    (listens,) = theatre.times(1, "nod")
    assert first + VOICE_S - listens == pytest.approx(4.0, abs=2 * FRAME), "4 s before his end"
    (ends,) = [t for t in theatre.times(1, "idle") if t > listens]
    assert ends == pytest.approx(first + VOICE_S + 2.0, abs=4 * FRAME), "6 s of it are enough"
    for before, after in ((first, second), (second, third), (third, fourth)):
        assert 0.4 <= after - (before + VOICE_S) < 0.6
    (shakes,) = theatre.times(0, "shake")
    assert shakes >= fourth + VOICE_S - FRAME


def show_of(folder, cues, characters='<character name="a"/><character name="b"/>'):
    path = folder / "my.show"
    path.write_text(f"<show>{characters}\n{cues}\n</show>")
    return path


def test_what_is_cut_off_fades_and_stalls_nothing(hand, tmp_path):
    path = show_of(
        tmp_path,
        '<do who="a" id="x" for="20">wave</do><wait seconds="1"/><stop what="x" fade="2"/>'
        '<say who="b" id="y">Hello there.</say><wait seconds="0.5"/><stop what="y"/>'
        '<wait for="y"/><wait for="x"/>',
    )
    theatre = Theatre(hand, path)
    weights = []
    while not theatre.over and hand.frames < 900:
        weights.append(theatre.frame()[0].command.action.weight)
    assert hand.frames * FRAME == pytest.approx(3.0, abs=0.2)
    assert weights[10] == 1.0
    fading = [weight for weight in weights if -1.0 < weight < 1.0 and weight]
    assert len(fading) > 50
    assert all(a > b for a, b in pairwise(fading))
    assert theatre.times(1, "speaks"), "the line had begun"


def test_a_voice_that_never_answers_stalls_nothing(hand):
    theatre = Theatre(hand, ANTIGONE, voice=False)
    theatre.play(5 * MAX_WAIT_S + 20.0)
    assert theatre.over


def test_typing_hands_over_to_the_dialogue_in_mid_play(hand, tmp_path):
    (tmp_path / "my.xml").write_text(TALK)
    path = show_of(
        tmp_path,
        '<say who="a">A long story begins.</say><wait seconds="60"/><talk script="my.xml"/>',
    )
    theatre = Theatre(hand, path)
    theatre.play(3.0)
    (outcome, other) = theatre.frame(typed="who are you?")
    assert outcome.reply is not None
    assert outcome.hush
    assert other.reply is None
    theatre.play(9.0)
    assert len(theatre.times(0, "reply")) == 2
    theatre.frame(clear=True)
    theatre.play(1.0)
    assert len(theatre.times(0, "reply")) == 3, "it begins again"


def test_the_play_goes_on_after_a_talk(hand, tmp_path):
    (tmp_path / "my.xml").write_text(TALK)
    path = show_of(
        tmp_path,
        '<say who="a" id="x">A story begins.</say><wait for="x"/><say who="b" id="y">It ends.</say>'
        '<wait for="y"/><talk script="my.xml"/>',
    )
    theatre = Theatre(hand, path)
    theatre.play(2.0)
    theatre.frame(typed="who are you?")
    theatre.play(5.0)
    assert not theatre.times(1, "reply"), "the play waits"
    theatre.play(VOICE_S + BACK_S)
    (ends,) = theatre.times(1, "reply")
    assert ends == pytest.approx(2.0 + VOICE_S + BACK_S, abs=0.5)
    theatre.play(VOICE_S + 1.0)
    theatre.frame(typed="and you?")
    theatre.play(40.0)
    assert len(theatre.times(1, "reply")) == 1, "the dialogue has come with its cue, and stays"


def test_a_checkpoint_keeps_the_stage_that_the_cast_shares(hand):
    theatre = Theatre(hand, ANTIGONE)
    theatre.play(9.0)
    copy = Checkpoint({"cast": theatre.cast}).content()["cast"]
    assert copy[0]._stage is copy[1]._stage
    assert copy[0]._stage is not theatre.cast[0]._stage
    frames, events, due = hand.frames, len(theatre.events), dict(theatre._due)
    acting = list(theatre._acting)
    theatre.play(12.0)
    first = theatre.events[events:]
    hand.frames = frames
    theatre.cast, theatre._due, theatre._acting = copy, due, acting
    del theatre.events[events:]
    theatre.play(12.0)
    assert len(first) > 1
    assert theatre.events[events:] == first


WRONG = {
    "no cue": ("", ":1: a show without a cue"),
    "nobody": ('<say who="c">Hi</say>', ":2: nobody is called 'c': a, b"),
    "no text": ('<say who="a"> </say>', ":2: <say> needs a text"),
    "unknown cue": (
        "<fly/>",
        ":2: <fly> is no cue; there are say, do, stop, bml, sound, feel, wait, talk",
    ),
    "unknown attribute": ('<do who="a" at="3">wave</do>', ":2: <do> has no 'at'"),
    "unknown id": ('<wait for="x"/>', ":2: no cue before it has the id 'x'"),
    "an endless wait": ("<wait/>", ":2: a wait needs seconds="),
    "nothing to stop": ('<stop fade="1"/>', ":2: what is stopped?"),
    "two of one id": (
        '<do who="a" id="x">wave</do>\n<do who="b" id="x">wave</do>',
        ":3: a second id 'x'",
    ),
    "unknown sound": ('<sound play="rain"/>', ":2: 'rain' is no file, and none of wind, gong"),
    "a number": ('<wait seconds="-1"/>', ":2: seconds='-1' is no number"),
    "emotion": ('<feel who="a" emotion="envy"/>', ":2: 'envy' is none of the emotions"),
    "a gesture without an end": (
        '<say who="a"><begin_gesture id="g" anim="wave"/>Hi</say>',
        "gesture 'g' never ends",
    ),
    "after the talk": ('<talk script="x.xml"/><wait seconds="1"/>', ":2: nothing comes after"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_play_that_cannot_be_shown_is_named_by_line(name, tmp_path):
    cues, message = WRONG[name]
    with pytest.raises(BadInputError, match=re.escape(message)) as refused:
        find_scenario(str(show_of(tmp_path, cues)))
    assert "\n" not in str(refused.value)


def test_a_play_without_a_display_is_written(cubeling):
    code, _, errors = cubeling("show", "antigone")
    assert code == 2
    assert "there is no display here: write a video" in errors
    code, _, errors = cubeling("show", "my.mp4")
    assert code == 2
    assert "'my.mp4' is no play: give a .show file" in errors


def speeds(folder, seconds, typed_at=math.inf, again_at=math.inf):
    """Return how fast the quickest joint turns in each frame [rad/s], and where a dialogue has it.

    A person plays, answers what is typed at a time, and begins again at another one [s].
    """
    hand = Hand()
    scenario = show_scenario(folder / "my.show")(CUBE, ScenarioSettings())
    member = CastMember("a", bundled_character("human"), scenario, Attention("camera", 0.06))
    away = np.eye(4)
    away[2, 3] = 0.5
    turned: list[Any] = []
    talks = []
    due: dict[int, SpokenLine] = {}
    for number in range(round(seconds / FRAME)):
        controls = hand.frame()
        state = CubeState(
            True, away, np.zeros(6), np.eye(6), "markers", (), 0.1, controls.timestamp
        )
        seen = SeenCube(state, controls)
        typed = "who are you" if 0.0 <= number * FRAME - typed_at < FRAME else ""
        clear = 0.0 <= number * FRAME - again_at < FRAME
        told = Inputs(line=due.pop(number, None), typed=typed, clear=clear)
        outcome = member.decide(seen, told)
        if outcome.reply is not None:
            request = LineRequest(outcome.reply.text, "en", Manner())
            due = {number + 2: soundless_line(request, DEFAULT_PROFILE)}
        member.perform(member.command(seen, outcome, told, (), None))
        assert member.posed is not None
        turned.append(member.posed.pose.rotations)
        talks.append(scenario._stage.talks)
    one, other = np.array(turned[:-1]), np.array(turned[1:])
    turns = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(one), other))
    return np.linalg.norm(turns, axis=-1).max(axis=1) / FRAME, np.array(talks)


@pytest.mark.slow(reason="a person is animated for fifteen seconds")
def test_a_dialogue_takes_over_in_mid_gesture_and_the_play_from_that_in_its_own(tmp_path):
    show_of(
        tmp_path,
        '<say who="a" id="x"><begin_gesture id="g" anim="wave_big"/>A long and winding story '
        'begins<end_gesture id="g"/> here, my friends.</say><wait seconds="60"/>'
        '<talk script="my.xml"/>',
        '<character name="a" body="human"/>',
    )
    (tmp_path / "my.xml").write_text(
        '<dialogue><unit name="u"><state name="q"><transition>'
        '<condition type="input_match">* you *</condition><action type="say">Me? I am only a '
        '<begin_gesture id="g" anim="clap"/>person who tells stories.<end_gesture id="g"/></action>'
        "</transition></state></unit></dialogue>"
    )
    alone, _ = speeds(tmp_path, 4.0)
    answered, _ = speeds(tmp_path, 5.5, typed_at=1.5)
    taken, talks = speeds(tmp_path, 7.0, typed_at=1.5, again_at=3.4)
    out, back = (int(np.flatnonzero(np.diff(talks.astype(int)) == step)[0]) for step in (1, -1))
    assert (out * FRAME, back * FRAME) == pytest.approx((1.5, 3.4), abs=2 * FRAME)
    for at in (out, back):
        assert taken[at - 3 : at].max() > 1.0, "it is in a gesture"
    fastest = max(alone.max(), answered[out + 20 :].max())
    for at in (out, back):
        assert taken[at - 1 : at + 20].max() <= 1.2 * fastest


def test_an_act_whose_time_is_known_is_told_ahead(hand, tmp_path):
    path = show_of(
        tmp_path,
        '<say who="a" id="x">Hello there.</say><wait for="x" before="2"/>'
        '<do who="b" for="1">nod</do><wait seconds="1.5"/><do who="a" for="1">wave</do>'
        '<wait seconds="2"/>',
    )
    theatre = Theatre(hand, path)
    told: list[set[tuple[float, str]]] = [set(), set()]
    while not theatre.over and hand.frames < 900:
        for who, outcome in enumerate(theatre.frame()):
            coming = outcome.command.coming
            if coming is not None:
                told[who].add((round(coming.start, 1), coming.action))
    (nods,), (waves,) = theatre.times(1, "nod"), theatre.times(0, "wave")
    for found, begins, name in ((told[1], nods, "nod"), (told[0], waves, "wave")):
        ((start, action),) = found
        assert action == name
        assert start == pytest.approx(begins, abs=0.15)


def test_who_is_spoken_to_in_a_play_is_its_dialogue(tmp_path):
    path = show_of(tmp_path, '<say who="a">Hello there.</say><talk script="my.xml"/>')
    (tmp_path / "my.xml").write_text(TALK)
    found = show_scenario(path)(CUBE, ScenarioSettings())
    assert isinstance(found, ConversingScenario)
    assert found.conversation is not None
    assert found.conversation.languages == (found.language,)
    theatre = Theatre(Hand(), path)
    theatre.play(1.0)
    assert theatre.frame(hush=True)[0].hush, "who begins to speak is listened to"
    silent = show_scenario(show_of(tmp_path, '<say who="a">Hello there.</say>'))
    assert silent.conversation is None


def test_two_of_one_body_are_told_apart_by_their_colours(tmp_path):
    options = SessionOptions(source="synthetic:talk", scenario=str(ANTIGONE))
    scenario = show_scenario(ANTIGONE)(CUBE, ScenarioSettings())
    creon, antigone = load_cast(options, scenario)
    assert (creon.name, antigone.name) == ("creon", "antigone")
    ones, others = creon.meshes[0].colors, antigone.meshes[0].colors
    assert ones is not None
    assert others is not None
    different = np.linalg.norm(ones - others, axis=1) > 0.1
    assert 0.3 < different.mean() < 0.8, "hair and clothes, and not the skin"
    as_asked = load_cast(replace(options, character="vleo"), scenario)
    assert as_asked[0].skeleton == bundled_character("vleo").skeleton, "colours are of its own cast"


def test_colours_of_another_kind_are_named_by_line(tmp_path):
    path = show_of(tmp_path, '<wait seconds="1"/>', '<character name="a" colours="red"/>')
    with pytest.raises(AppError, match=r"my.show:1: 'red' are no colours; write #7c391d=#b9b3a8"):
        show_scenario(path)
