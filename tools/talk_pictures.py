"""Draws the pictures of a talk and of a play, each a moment of it at the drawn desk."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.affect import LABEL_SETS
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.running.asked_scenario import load_cast, scenario_of
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.speaker import LiveSpeaker
from cubeling.app.ui.cards.layout import CardLayout
from cubeling.app.ui.cards.overlay import overlay, virtual_robot_side
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.playback.corner_buttons import ROOM_BELOW
from cubeling.app.ui.playback.layer import PlaybackLayer
from cubeling.app.ui.playback.status import SessionStatus
from cubeling.characters.rendering import create_context
from cubeling.characters.speech import DEFAULT_PROFILE, espeak
from cubeling.tracking import open_source

Picture = NDArray[np.uint8]

TALK = {5.8: "Do you know a dinosaur with horns?"}
"""What is typed in the picture of a talk, by the time [s]."""

TALK_S, TALK_TYPED = 8.2, "And what about eggs"
"""When it is taken [s], and what is in the field then."""

PLAY_S = 13.5
"""When the picture of the play is taken [s]."""

SETTLING_S = 0.5
"""For how long light is measured before [s]."""


def draw_talk(folder: Path) -> Step:
    """Let Vleo talk, save a moment of it, and return its step."""
    step, picture = moment("talk", TALK, TALK_S)
    layer = PlaybackLayer(("talk",), Path(), {}, lambda: None)
    layer.report(SessionStatus("talk", listens=True))
    for character in TALK_TYPED:
        layer.type(character)
    height, width = picture.shape[:2]
    for card in layer.cards((width, height)):
        card.blend_over(picture)
    cv2.imwrite(str(folder / "talk.jpg"), picture, (cv2.IMWRITE_JPEG_QUALITY, 88))
    return step


def draw_play(folder: Path) -> None:
    """Let Antigone and Creon play, and save a moment of it."""
    play = Path(__file__).parent.parent / "app" / "show" / "antigone.show"
    _, picture = moment(str(play), {}, PLAY_S)
    cv2.imwrite(str(folder / "antigone.jpg"), picture, (cv2.IMWRITE_JPEG_QUALITY, 88))


def moment(scenario: str, typed: Mapping[float, str], at: float) -> tuple[Step, Picture]:
    """Return the step at a time [s], and its picture with the cards."""
    asked, options = (
        sorted(typed.items()),
        SessionOptions(source="synthetic:talk", scenario=scenario),
    )
    lead, *others = load_cast(options, scenario_of(options, scenario))
    with ExitStack() as closing:
        source = closing.enter_context(open_source("synthetic:talk"))
        context = create_context()
        closing.callback(context.release)
        playground = Playground(
            scenario,
            intrinsics_for(source.intrinsics, source.size),
            character=lead,
            others=others,
            context=context,
        )
        closing.callback(playground.close)
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        closing.callback(virtual_robot.close)
        speaker = LiveSpeaker(espeak(), lambda *_: None, ("en",), DEFAULT_PROFILE, waits=True)
        closing.callback(speaker.close)
        for frame in source:
            now = frame.timestamp
            text = asked.pop(0)[1] if asked and now >= asked[0][0] else ""
            inputs = Inputs(typed=text).with_lines(speaker.lines(now))
            step = playground.step(frame, inputs, drawn=now > at - SETTLING_S)
            speaker.hear(step)
            if now >= at:
                break
        emotion = step.emotion.emotion
        label = LABEL_SETS["thesis"].next("neutral", emotion, 0.05)  # a robot has three words
        view = RobotView("ready", emotion.valence, label)
        assert step.picture is not None
        return step, overlay(step.picture, step, view, virtual_robot, CardLayout(ROOM_BELOW))
