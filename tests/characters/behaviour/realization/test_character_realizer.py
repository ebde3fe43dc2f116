"""BML performed by characters: natural times, what cannot be done, what stays, and late voices."""

import math

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.behaviour.bml import BmlWarning, Realizer, parse
from cubeling.characters.behaviour.expressivity import GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.realization.character_realizer import CharacterRealizer
from cubeling.characters.behaviour.realization.frame import CUBELING, RealizationContext
from cubeling.characters.behaviour.realization.speech_kind import estimate, retime_speeches
from cubeling.characters.behaviour.realization.surroundings import NamedPlaces
from cubeling.characters.behaviour.symbolic_gesture import HandKey, SymbolicGesture
from cubeling.characters.speech.speech import Utterance, Word
from tests.bundled_characters import bundled_character

WAVE = SymbolicGesture(
    "WAVE", right=(HandKey(0.0), HandKey(1.0)), one_handed=True, preparation=0.4, stroke=0.8,
    apex=0.5, hold=0.2, retraction=0.5,
)  # fmt: skip
HUMAN, VLEO = bundled_character("human"), bundled_character("vleo")


class Stage:
    """A character that performs blocks, in virtual time."""

    def __init__(self, character=HUMAN, utterance_of=lambda _text, _language: None, **changes):
        places = {"cube": np.array([0.2, 0.03, 0.1]), "viewer": np.array([0.0, 0.2, 0.7])}
        collection = GestureCollection({"WAVE": WAVE})
        self.who = RealizationContext(
            character, collection, NamedPlaces(places), utterance_of, **changes
        )
        self.performer = CharacterRealizer(self.who)
        self.realizer = Realizer(self.performer)
        self.feedback = []
        self.blocks = 0

    def perform(self, inside, head=""):
        space = f'xmlns="http://www.bml-initiative.org/bml/bml-1.0" xmlns:c="{CUBELING}"'
        self.blocks += 1
        self.realizer.accept(f'<bml {space} id="b{self.blocks}" {head}>{inside}</bml>')

    def at(self, now):
        self.feedback += self.realizer.update(now)
        retime_speeches(self.realizer, self.who, now)
        return self.performer.frame_of(self.realizer.active(now), now)

    @property
    def warnings(self):
        return [each for each in self.feedback if isinstance(each, BmlWarning)]

    def times(self, behaviour):
        return next(s.times for s in self.realizer.scheduled if s.behaviour.id == behaviour)


def test_a_gesture_has_its_own_times_and_the_hand_and_manner_that_are_asked_for():
    stage = Stage(expressivity=GestureExpressivity(power=0.4))
    stage.perform(
        '<gesture id="g" lexeme="wave" mode="LEFT_HAND" c:spatial="0.5"/>', 'c:openness="0.9"'
    )
    intent = stage.at(0.0).gestures[0]
    assert intent.hand == "left"
    assert intent.expressivity == GestureExpressivity(spatial=0.5, openness=0.9, power=0.4)
    times = intent.times
    assert (times.ready, times.stroke, times.stroke_end) == pytest.approx((0.4, 0.8, 1.2))
    assert (times.relax, times.end) == pytest.approx((1.4, 1.9))


@pytest.mark.parametrize(
    ("behaviour", "why"),
    [
        ('<gesture lexeme="MOONWALK"/>', "no gesture is called"),
        ('<gaze target="bluebox"/>', 'no target "bluebox"'),
        ('<pointing target="1,2"/>', 'no target "1,2"'),
        ('<pointing target="nan,0,0"/>', "no target"),
        ('<head lexeme="SPIN"/>', 'a head cannot "SPIN"'),
        ('<head lexeme="NOD" amount="much"/>', ""),
        ('<faceLexeme lexeme="GLOW"/>', "cannot show GLOW"),
        ("<faceFacs/>", "without a lexeme"),
        ('<posture><stance type="FLYING"/></posture>', "cannot take FLYING"),
        ('<gaze target="cube" offsetAngle="10" offsetDirection="INSIDE"/>', "INSIDE"),
        ('<juggle xmlns="urn:x"/>', "not known"),
    ],
)
def test_what_cannot_be_performed_is_a_warning_and_the_rest_goes_on(behaviour, why):
    stage = Stage()
    stage.perform(f'{behaviour}<head id="n" lexeme="NOD" start="0"/>')
    shown = stage.at(0.1)
    assert [each.key for each in shown.heads if each.lexeme == "NOD" and each.key.endswith(":n")]
    if why:
        assert why in stage.warnings[0].description
        assert "\n" not in stage.warnings[0].description


def test_a_body_without_arms_or_head_says_so():
    skeleton = HUMAN.skeleton
    legless = Character("box", skeleton, {}, (), semantics=dict.fromkeys(HUMAN.anatomy.joints, ""))
    stage = Stage(legless)
    stage.perform('<gesture lexeme="WAVE"/><gaze target="cube"/>')
    stage.at(0.0)
    assert [each.description for each in stage.warnings] == ["box has no arms", "box has no head"]


def test_a_shift_stays_until_another_one_has_come():
    stage = Stage()
    stage.perform('<gazeShift id="a" target="cube" influence="WAIST" start="0" end="0.5"/>')
    stage.at(0.0)
    kept = stage.at(9.0)
    assert kept.gazes[0].target.tolist() == [0.2, 0.03, 0.1]
    assert kept.gazes[0].times.relax is None
    stage.perform('<gazeShift id="b" target="viewer" start="1" end="2"/>')
    stage.at(9.5)
    both = stage.at(10.0)
    assert [each.times.relax for each in both.gazes] == [10.5, None] or len(both.gazes) == 1
    both = stage.at(11.0)
    assert [each.times.relax for each in both.gazes] == [pytest.approx(10.5), None]
    last = stage.at(20.0)
    assert [each.target.tolist() for each in last.gazes] == [[0.0, 0.2, 0.7]]


def test_a_shift_that_is_cut_off_does_not_stay():
    stage = Stage()
    stage.perform('<postureShift><stance type="SITTING"/></postureShift>')
    assert stage.at(0.5).postures
    stage.perform("", 'composition="REPLACE"')
    stage.at(0.6)
    assert not stage.at(9.0).postures


def test_stance_and_pose_are_one_posture():
    stage = Stage()
    stage.perform(
        '<posture start="0" end="3"><stance type="SITTING"/><pose lexeme="LEANING_LEFT"/></posture>'
    )
    assert [each.name for each in stage.at(1.0).postures] == ["SITTING+LEANING_LEFT"]


def test_a_way_takes_its_time_and_whoever_is_late_goes_on():
    stage = Stage(walk_time=lambda target, manner: 2.5 if manner == "walk" else 1.0)
    stage.perform('<locomotion id="w" target="0.3,0,0.1"/>')
    assert stage.at(0.0).going.target.tolist() == [0.3, 0.1]
    assert stage.times("w")["end"] == 2.5
    assert stage.at(4.0).going.target.tolist() == [0.3, 0.1]
    stage.perform('<locomotion target="cube" manner="run"/>')
    assert stage.at(4.1).going.manner == "run"


def test_a_longer_nod_has_more_swings_unless_they_are_counted():
    stage = Stage()
    stage.perform('<head lexeme="NOD" start="0" end="5"/>')
    stage.perform('<head lexeme="NOD" start="0" end="5" repetition="1"/>')
    free, counted = stage.at(0.1).heads
    assert free.repeats > 3
    assert counted.repeats == 1


def test_a_paw_may_point_where_a_body_on_four_legs_has_no_arms():
    stage = Stage(VLEO)
    stage.perform('<pointing id="p" target="cube"/>')
    assert stage.at(0.1).reaches[0].kind == "point"
    assert not stage.warnings


TEXT = "One two three four"


def spoken(pace):
    """Return an utterance with a word every `pace` seconds."""
    words, offset = [], 0
    for number, word in enumerate(TEXT.split()):
        words.append(Word(word, number * pace, (number + 0.8) * pace, offset))
        offset += len(word) + 1
    return Utterance(TEXT, "en", 4 * pace, tuple(words))


SPEECH = """<speech id="s" start="0"><text>One <sync id="m"/>two three four</text></speech>
    <head id="n" lexeme="NOD" stroke="s:m"/><gaze id="g" target="cube" end="s:end"/>"""


def test_marks_are_where_the_words_after_them_begin():
    stage = Stage(utterance_of=lambda _text, _language: spoken(0.5))
    stage.perform(SPEECH)
    said = stage.at(0.0).sayings[0]
    assert said.start == 0.0
    assert stage.times("s") == {"start": 0.0, "m": 0.5, "end": 2.0}
    assert stage.times("n")["stroke"] == pytest.approx(0.5)


def test_a_slower_voice_moves_the_rest_and_no_sync_point_is_out_of_order():
    voice: dict[str, Utterance] = {}
    stage = Stage(utterance_of=lambda text, _language: voice.get(text))
    stage.perform(SPEECH)
    assert not stage.at(0.0).sayings
    guess = estimate(TEXT)
    assert stage.times("s")["m"] == pytest.approx(guess.words[1].start)
    stage.at(0.08)
    voice[TEXT] = spoken(0.7)
    said = stage.at(0.12).sayings[0]
    assert said.start == 0.12
    assert stage.times("s") == {
        "start": 0.0, "m": pytest.approx(0.82), "end": pytest.approx(2.92),
    }  # fmt: skip
    assert stage.times("n")["stroke"] == pytest.approx(0.82)
    assert stage.times("g")["end"] == pytest.approx(2.92)
    for scheduled in stage.realizer.scheduled:
        assert [*scheduled.times.values()] == sorted(scheduled.times.values())
    assert not stage.at(3.0).sayings


def test_without_a_voice_the_estimate_counts():
    stage = Stage()
    stage.perform(SPEECH)
    stage.at(0.0)
    stage.at(30.0)
    assert stage.realizer.idle
    assert not stage.warnings


def test_a_target_of_an_offset_is_beside_it():
    point = NamedPlaces(eyes=np.array([0.0, 0.1, 0.0])).point_aside(
        np.array([0.0, 0.1, 1.0]), math.radians(90), 0.0
    )
    assert point == pytest.approx(np.array([1.0, 0.1, 0.0]))


def test_every_kind_of_the_standard_is_performed():
    document = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b">
        <speech><text>Hi</text></speech><gesture lexeme="WAVE"/><pointing target="cube"/>
        <gaze target="cube" start="3"/><gazeShift target="viewer" start="9"/>
        <head lexeme="SHAKE"/><headDirectionShift target="cube" start="12"/>
        <face type="happy"/><faceLexeme lexeme="SMILE"/><faceFacs au="1" side="LEFT"/>
        <faceShift lexeme="happy"/><posture><pose part="ARMS" lexeme="WAVE"/></posture>
        <postureShift><stance type="STANDING"/></postureShift>
        <locomotion target="cube"/><wait duration="2"/></bml>"""
    block = parse(document)
    performer = Stage().performer
    for behaviour in block.behaviours:
        timing = performer.timing(behaviour, block)
        assert sum(timing.spans) > 0.0
