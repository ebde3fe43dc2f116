"""When the character says something."""

import dataclasses

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import EmotionTarget, Outcome
from cubeling.app.pipeline.step import Step
from cubeling.app.speaking.line_chooser import AGAIN_S, LineChooser, events_for
from cubeling.app.speaking.lines import ScenarioLines
from cubeling.characters import ActionIntent, CharacterCommand, Pose, PosedCharacter
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.speech.speech import Utterance
from cubeling.tracking import CubeState, Frame
from tests.characters.commands import command

LINES = ScenarioLines("en", {"kiss": ("One", "Two"), "shout": ("Hey",), "reached": ("Here",)})


@pytest.fixture
def play(hand):
    """Return a function that plays (seconds, icon, changes) and returns what is said, and when."""

    def steps(*parts):
        moments, said, time = LineChooser(LINES), [], 0.0
        for seconds, icon, changes in parts:
            for number in range(round(seconds * 30)):
                controls = hand.frame()
                events = changes.get("events", ()) if number == 0 else ()
                made = dataclasses.replace(
                    command(controls.timestamp, "idle"),
                    action=ActionIntent(icon, changes.get("weight", 0.0)),
                    speech=changes.get("speech"),
                )
                request = chosen(moments, step(controls, made, icon, events))
                time = controls.timestamp
                if request is not None:
                    said.append((round(time, 2), request))
        return said

    return steps


def chosen(chooser, seen):
    return chooser.update(seen.frame.timestamp, seen.cast[0], events_for(seen, 0))


def step(controls, made: CharacterCommand, icon, events=()):
    calm = EmotionTarget(Emotion(0.0, 0.0, "neutral"), made.timestamp)
    outcome = Outcome(made, calm, "", icon, events=events)
    frame = Frame(np.zeros((1, 1, 3), np.uint8), made.timestamp, 0)
    state = CubeState(False, None, np.zeros(6), np.zeros((6, 6)), "markers", (), 0.0, 0.0)
    pose = Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]))
    posed = PosedCharacter(pose, np.eye(4), made.visible, icon, 0.0, 0.0, 0.0, 0.0)
    return Step(frame, state, controls, outcome, posed, None, scenario="companion")


def texts(said):
    return [request.text for _, request in said]


def test_an_action_is_spoken_of_once_it_has_settled(play):
    said = play((1.0, "idle", {}), (0.1, "shout", {}), (2.0, "kiss", {}))
    assert texts(said) == ["One"]
    assert 1.4 < said[0][0] < 1.6


def test_lines_take_turns_while_an_action_goes_on(play):
    said = play((2.5 * AGAIN_S, "kiss", {}))
    assert texts(said) == ["One", "Two", "One"]


def test_another_action_interrupts_what_is_being_said(play):
    speech = SpeechIntent(Utterance("long", "en", 60.0), 0.0)
    said = play((2.0, "kiss", {"speech": speech}), (2.0, "shout", {"speech": speech}))
    assert texts(said) == ["One", "Hey"]


def test_an_event_waits_for_nothing_and_interrupts_nothing(play):
    speech = SpeechIntent(Utterance("long", "en", 60.0), 0.0)
    assert texts(play((1.0, "idle", {}), (1.0, "idle", {"events": ("reached",)}))) == ["Here"]
    assert not play((3.0, "idle", {"speech": speech, "events": ("reached",)}))


def test_a_stronger_action_is_spoken_of_in_a_livelier_way(play):
    ((_, strong),) = play((1.0, "kiss", {"weight": 1.0}))
    ((_, weak),) = play((1.0, "kiss", {"weight": -1.0}))
    assert strong.manner.rate > 1.0 > weak.manner.rate
    assert strong.manner.pitch > weak.manner.pitch


def test_what_has_no_line_is_not_spoken_of(play):
    assert not play((3.0, "walk", {"events": ("chased",)}))
