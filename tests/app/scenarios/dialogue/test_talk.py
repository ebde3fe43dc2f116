"""The dialogue in play: what is said is heard, cut off and remembered by the frame."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cubeling.affect import OCC_FACES, Emotion
from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings, check_gestures
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.pipeline.table.spoken_line import Speaking, SpokenLine
from cubeling.app.scenarios import check_scenario, find_scenario
from cubeling.app.scenarios.dialogue.cube_words import CubeWords
from cubeling.app.scenarios.dialogue.reply_progress import MAX_WAIT_S
from cubeling.app.scenarios.talk import Talk
from cubeling.app.speaking.line_chooser import LineRequest
from cubeling.app.speaking.speaker import soundless_line
from cubeling.bad_input import BadInputError
from cubeling.characters import known_gestures, meanings_of
from cubeling.characters.speech import DEFAULT_PROFILE, Manner, TaggedText
from cubeling.tracking import CubeControls, CubeModel
from tests.bundled_characters import bundled_character

CUBE = CubeModel.load("companion")


class Conversation:
    """A dialogue that is played, with a voice that answers after some frames."""

    def __init__(self, hand, scenario=Talk, delay: int | None = 2, **settings) -> None:
        self.hand, self.delay = hand, delay
        self.scenario = scenario(CUBE, ScenarioSettings(**settings))
        self.speaking = Speaking()
        self.replies: list[str] = []
        self.emotions: list[Emotion] = []
        self.now = 0.0
        self._due: list[tuple[int, SpokenLine]] = []

    def frame(self, controls: CubeControls | None = None, **asked: Any) -> Outcome:
        controls = controls or self.hand.frame()
        self.now = controls.timestamp
        line = self._due.pop()[1] if self._due and self.hand.frames >= self._due[0][0] else None
        inputs = Inputs(line=line, **asked)
        outcome: Outcome = self.scenario.update(controls, Situation(), inputs)
        silence = inputs.clear or outcome.hush
        self.speech = self.speaking.update(line, outcome.command, silence=silence)
        self.emotions.append(outcome.emotion.emotion)
        if outcome.hush:
            self._due.clear()
        if outcome.reply is not None:
            self.replies.append(outcome.reply.text)
            request = LineRequest(outcome.reply.text, outcome.reply.language, Manner())
            if self.delay is not None:
                due = self.hand.frames + self.delay
                self._due = [(due, soundless_line(request, DEFAULT_PROFILE))]
        return outcome

    def wait(self, seconds: float) -> None:
        for _ in range(round(30 * seconds)):
            self.frame()

    def until_spoken(self) -> None:
        for _ in range(900):
            self.frame()
            if self.speech is not None:
                return
        raise AssertionError("nothing was said")

    def say(self, text: str) -> str:
        """Type a line, and return the reply."""
        before = len(self.replies)
        self.frame(typed=text)
        return self.replies[-1] if len(self.replies) > before else ""

    @property
    def profile(self):
        return self.scenario._dialogue.state.profile


@pytest.fixture
def talk(hand):
    return Conversation(hand)


def test_it_speaks_first(talk):
    talk.wait(1.5)
    assert len(talk.replies) == 1
    assert "Vleo" in talk.replies[0]


@pytest.mark.parametrize("cut", ["line", "typing", "lifted", "start over", "hidden"])
def test_an_interruption_silences_it_in_the_same_frame(talk, cut):
    talk.until_spoken()
    talk.wait(0.5)
    assert talk.speech is not None
    if cut == "lifted":
        talk.frame(talk.hand.frame(lifted=True, resting=False))
    elif cut == "hidden":
        for _ in range(30):
            talk.frame(talk.hand.frame(visible=False))
    else:
        asked: dict[str, dict[str, Any]] = {
            "line": {"typed": "hello"},
            "typing": {"hush": True},
            "start over": {"clear": True},
        }
        talk.frame(**asked[cut])
    assert talk.speech is None


def test_it_remembers_what_was_heard_and_not_what_was_planned(talk):
    talk.until_spoken()
    whole = TaggedText.read(talk.replies[-1]).text
    talk.wait(1.0)
    talk.frame(hush=True)
    heard = talk.profile["said"]
    assert heard.endswith("…")
    assert whole.startswith(heard[:-1])
    assert 0 < len(heard) < len(whole)
    assert heard in TaggedText.read(talk.say("what did you say?")).text
    talk.wait(8.0)
    assert talk.profile["said"] == heard, "who quotes says nothing new"
    talk.say("tell me a joke")
    talk.wait(8.0)
    assert talk.profile["said"] == TaggedText.read(talk.replies[-1]).text, "all of it was heard"


def test_it_still_knows_what_it_said_while_it_thinks(talk):
    talk.wait(8.0)
    before = talk.profile["said"]
    assert before
    talk.say("tell me about eggs")
    assert talk.profile["said"] == before, "nothing of the reply was heard yet"


def test_a_reply_takes_the_place_of_one_that_was_not_begun(talk):
    talk.wait(8.0)
    first = talk.say("tell me about the triceratops")
    second = talk.say("and about eggs?")
    talk.until_spoken()
    assert first != second
    assert talk.speech.utterance.text == TaggedText.read(second).text
    talk.wait(12.0)
    assert talk.profile["said"] == TaggedText.read(second).text


def test_a_line_that_nobody_waits_for_is_not_said(talk, hand):
    talk.wait(6.0)
    late = soundless_line(LineRequest("Too late!", "en", Manner()), DEFAULT_PROFILE)
    talk._due = [(0, late)]
    talk.frame()
    assert talk.speech is None
    assert talk.profile.get("said") != "Too late!"


def test_a_voice_that_never_answers_does_not_end_the_talk(hand):
    talk = Conversation(hand, delay=None)
    talk.wait(1.5)
    assert talk.say("hello")
    talk.wait(MAX_WAIT_S + 15.0)
    assert len(talk.replies) > 2, "silence is broken although nothing was ever heard"


def test_who_types_is_not_talked_to_meanwhile(talk):
    talk.wait(12.0)
    count = len(talk.replies)
    talk.frame(hush=True)
    talk.wait(7.5)
    assert len(talk.replies) == count
    talk.wait(30.0)
    assert len(talk.replies) > count, "one who does not go on is asked"


def test_what_is_typed_is_shown_at_once(talk):
    assert talk.frame(typed="Hola Vleo").hint == "“Hola Vleo”"
    talk.wait(8.0)
    assert talk.frame().hint == "Type to talk, and press Enter"


def test_words_change_the_mood_and_the_mood_changes_words(talk):
    talk.wait(3.0)
    before = talk.emotions[-1].valence
    talk.say("I hate you, you are stupid")
    talk.wait(0.5)
    assert talk.emotions[-1].valence < before
    assert "sad" in talk.say("how are you?") or "better" in talk.replies[-1]


def test_the_cube_is_answered(talk):
    talk.wait(8.0)
    count = len(talk.replies)
    talk.frame(talk.hand.frame(gestures=("shaken",)))
    assert len(talk.replies) == count + 1
    talk.wait(6.0)
    for controls in talk.hand.tip("front"):
        talk.frame(controls)
    assert len(talk.replies) == count + 2


def test_the_words_of_a_cube(hand):
    words = CubeWords(CUBE)
    said = [words.update(hand.frame(gestures=("shaken",)))]
    said += [words.update(controls) for controls in hand.tip("front")]
    said += [words.update(controls) for controls in hand.turn(1.0, 1.0)]
    said += [words.update(controls) for controls in hand.turn(-2.0, 1.0)]
    assert [each for frame in said for each in frame] == [
        "the cube was shaken",
        "the cube was lifted",
        "the cube was put down",
        "face up: kiss",
        "kiss",
        "kiss, strongly",
        "kiss, softly",
    ]


def test_a_checkpoint_goes_on_as_the_talk_does(talk):
    talk.wait(3.0)
    talk.say("hello, my name is Bob")
    talk.wait(6.0)
    copy = Checkpoint({"scenario": talk.scenario}).content()["scenario"]
    frames, before = talk.hand.frames, len(talk.replies)
    first = [talk.say("who am i, and what is my name?"), talk.profile["name"]]
    talk.scenario, talk.hand.frames = copy, frames
    assert [talk.say("who am i, and what is my name?"), talk.profile["name"]] == first
    assert len(talk.replies) == before + 2


def test_it_begins_in_the_language_that_is_chosen(hand):
    talk = Conversation(hand, language="es")
    talk.wait(1.5)
    assert "dinosaurio" in talk.replies[0]
    with pytest.raises(BadInputError, match="does not speak 'fr'"):
        Conversation(hand, language="fr")


@pytest.mark.parametrize("character", ["vleo", "human"])
def test_characters_can_do_all_that_the_bundled_script_asks_for(character):
    body, script = bundled_character(character), Talk.script
    assert not Talk.asked
    texts = [text for action in script.actions("say") for _, text in action.argument]
    names = {span.name for text in texts for span in TaggedText.read(text).spans}
    assert len(names) > 40
    assert names == set(meanings_of(body, names))
    felt = {item.argument[0] for item in script.actions("emotional_influence")}
    assert len(felt & OCC_FACES.keys()) > 15


def test_a_script_with_an_unknown_gesture_is_named_by_line(tmp_path):
    path = tmp_path / "my.xml"
    path.write_text(
        '<dialogue><unit name="u"><state name="q"><transition>\n'
        '<condition type="input_match">hi</condition>\n'
        '<action type="say"><begin_gesture id="g" anim="somersault"/>Hi<end_gesture id="g"/>'
        "</action></transition></state></unit></dialogue>"
    )
    scenario = find_scenario(str(path))
    vleo = bundled_character("vleo")
    assert "somersault" not in known_gestures(vleo)
    with pytest.raises(BadInputError, match=r"my\.xml:3: vleo has no gesture 'somersault'"):
        check_gestures(scenario(CUBE, ScenarioSettings()), vleo)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ('<action type="go">moon</action>', ":2: action go: 'moon' is none of cube, home"),
        ('<condition type="cube">flying</condition>', ":2: condition cube: 'flying' is no"),
    ],
)
def test_the_words_of_rules_are_checked_in_scripts(tmp_path, inside, message):
    path = tmp_path / "my.xml"
    path.write_text(
        '<dialogue><unit name="u"><state name="q"><transition>\n'
        f'<condition type="silence">1</condition>{inside}</transition></state></unit></dialogue>'
    )
    with pytest.raises(BadInputError) as refused:
        check_scenario(str(path))
    assert message in str(refused.value)


def test_a_script_sends_the_character_to_the_cube(tmp_path, hand):
    path = tmp_path / "my.xml"
    path.write_text(
        '<dialogue character="human"><unit name="u"><state name="q"><transition>'
        '<condition type="input_match">* come *</condition><condition type="cube">not lifted'
        '</condition><action type="go">cube</action><action type="hint">It comes</action>'
        '<action type="say">I come!</action></transition></state></unit></dialogue>'
    )
    talk = Conversation(hand, find_scenario(str(path)))
    character = type("Posed", (), {"table_from_character": np.eye(4)})()
    character.table_from_character[0, 3] = 0.5
    situation = replace(Situation(), character=character)
    hand.frame()
    outcome = talk.scenario.update(hand.frame(), situation, Inputs(typed="come here"))
    assert outcome.reply.text == "I come!"
    assert outcome.command.locomotion.target[0] == pytest.approx(0.1)
    assert talk.scenario.update(hand.frame(), situation, Inputs()).hint == "“come here”"
