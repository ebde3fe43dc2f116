"""What the panels show of known steps, robots and times, to the letter."""

import itertools
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.app.pipeline.frame_times import FrameTimes
from cubeling.app.pipeline.scenario import EmotionTarget, Outcome
from cubeling.app.pipeline.step import Performance, RobotView, Step
from cubeling.app.scenarios import find_scenario, scenario_names
from cubeling.app.session import SessionOptions
from cubeling.app.ui.panels import PANELS
from cubeling.app.ui.panels.content import Choice, Fact, Note, Plot, ShareBar, Slider
from cubeling.app.ui.panels.monitor import SessionMonitor
from cubeling.app.ui.panels.tracking import REFUSALS, stated_error
from cubeling.characters import CharacterCommand
from cubeling.characters.rendering import QUALITIES
from cubeling.robot import LinkCounts, Telemetry
from cubeling.tracking import CubeState, Frame, Intrinsics, LensEstimate

NO_LENS = LensEstimate()
OPTIONS = SessionOptions(scenario="companion", source="camera:0")


STATE = CubeState(
    visible=True,
    camera_from_cube=np.eye(4),
    velocity=np.zeros(6),
    covariance=np.diag([1e-6, 4e-6, 1e-6, 1e-4, 0.0, 0.0]),
    source="markers",
    faces=("front", "top"),
    reprojection_error=0.25,
    timestamp=0.0,
)


GUESS = Intrinsics.guess((1280, 720))


def feed(*frames, options=OPTIONS, lens=NO_LENS, intrinsics=GUESS):
    """Feed a monitor with one step a frame: changes of its state, an emotion, and a robot."""
    tracked = SimpleNamespace(lens=lens, measured_intrinsics=intrinsics)
    playground: Any = SimpleNamespace(tracked=tracked, quality=QUALITIES["reduced"])
    nothing: Any = None
    monitor = SessionMonitor(options, FrameTimes(itertools.count(step=0.01).__next__))
    for number, (changes, emotion, robot) in enumerate(frames):
        now = number / 10
        outcome = Outcome(CharacterCommand(now), EmotionTarget(emotion, now), "")
        frame = Frame(np.zeros((2, 2, 3), np.uint8), now, number)
        state = replace(STATE, timestamp=now, **changes)
        step = Step(frame, state, nothing, outcome, nothing, None)
        monitor.update(step, robot, playground)
    return monitor


Fed = tuple[dict[str, Any], Emotion, RobotView]
NEUTRAL = Emotion(0.0, 0.0, "neutral")
NO_ROBOT = RobotView("none", 0.0, "neutral")
SEEN: Fed = ({}, NEUTRAL, NO_ROBOT)
UNSEEN: Fed = ({"visible": False, "faces": ()}, NEUTRAL, NO_ROBOT)


def shown(panel, monitor):
    """Return the facts of a panel as a dictionary, and its other widgets."""
    widgets = PANELS[panel].content(monitor)
    facts = {each.name: each for each in widgets if isinstance(each, Fact)}
    return facts, [each for each in widgets if not isinstance(each, Fact)]


def test_tracking_shows_verdict_faces_residual_and_stated_error():
    facts, (plot,) = shown("tracking", feed(SEEN, SEEN, UNSEEN, SEEN))
    assert {name: (fact.value, fact.tone) for name, fact in facts.items()} == {
        "Cube": ("found", "good"),
        "Faces": ("front, top", "plain"),
        "Measured on": ("markers", "plain"),
        "Residual": ("0.25 px", "plain"),
        "Stated error": ("2.0 mm, 0.57°", "plain"),
        "Lens": ("1109 px ± 35 %, 60° wide", "warning"),
        "Seen lately": ("75 % at 10 frames/s", "warning"),
    }
    (curve,) = plot.curves
    np.testing.assert_allclose(curve.times, [-0.3, -0.2, -0.1, 0.0])
    np.testing.assert_array_equal(curve.values, [0.25, 0.25, np.nan, 0.25])


def test_tracking_shows_how_surely_play_has_measured_the_focal_length():
    measured = feed(SEEN, intrinsics=GUESS.lengthen(0.59, 0.012))
    assert shown("tracking", measured)[0]["Lens"] == Fact("Lens", "654 px ± 1.2 %, 89° wide")
    calibrated = feed(SEEN, intrinsics=GUESS.lengthen(0.59, None))
    assert shown("tracking", calibrated)[0]["Lens"] == Fact("Lens", "654 px, 89° wide")


@pytest.mark.parametrize("refused", REFUSALS)
def test_tracking_says_why_a_pose_is_refused(refused):
    facts, _ = shown("tracking", feed(({"visible": False, "refused": refused}, NEUTRAL, NO_ROBOT)))
    assert facts["Cube"] == Fact("Cube", REFUSALS[refused], "warning")
    assert facts["Stated error"].value == "none"


def test_tracking_tells_of_a_lens_that_is_not_as_it_claims():
    _, (_, note) = shown("tracking", feed(SEEN, lens=LensEstimate(0.1, 0.01)))
    assert isinstance(note, Note)
    assert note.text.startswith("This camera's lens bends straight lines by 12 pixels")
    assert "[" not in note.text


def test_the_stated_error_is_that_along_the_worst_axis():
    turned = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = turned @ np.diag([9e-6, 1e-6, 1e-6]) @ turned.T
    assert stated_error(replace(STATE, covariance=covariance)) == pytest.approx((3.0, 0.0))
    assert np.isnan(stated_error(replace(STATE, camera_from_cube=None))).all()


def test_emotion_plots_character_and_robot():
    happy = Emotion(0.5, 0.25, "happy")
    telemetry = Telemetry("ready", observed=happy)
    robot = RobotView("ready", 0.5, "happy", shown=happy, telemetry=telemetry)
    facts, (valence, arousal) = shown("emotion", feed(SEEN, ({}, Emotion(-1, 1, "angry"), robot)))
    assert facts["Character"].value == "angry (-1.00, +1.00)"
    assert facts["Robot"].value == "happy (+0.50, +0.25)"
    for plot, theirs, ours in ((valence, 0.5, [0.0, -1.0]), (arousal, 0.25, [0.0, 1.0])):
        assert isinstance(plot, Plot)
        below, above = plot.curves
        assert (below.name, above.name) == ("robot", "character")
        np.testing.assert_array_equal(below.values, [np.nan, theirs])
        np.testing.assert_array_equal(above.values, ours)


def test_the_emotions_of_a_cast_and_of_both_robots_are_named():
    sad = Emotion(-0.5, -0.5, "sad")
    second = RobotView("ready", 0.5, "happy", shown=Emotion(0.5, 0.25, "happy"), name="tim")
    monitor = feed(({}, NEUTRAL, replace(NO_ROBOT, second=second)))
    nothing: Any = None
    other = Performance(
        "human", Outcome(CharacterCommand(0.0), EmotionTarget(sad, 0.0), ""), nothing
    )
    assert monitor.step is not None
    monitor.step = replace(monitor.step, others=(other,))
    facts, _ = shown("emotion", monitor)
    assert facts["human"].value == "sad (-0.50, -0.50)"
    assert facts["tim"].value == "happy (+0.50, +0.25)"


def test_a_minute_of_emotions_is_kept_and_no_more():
    monitor = feed(*[SEEN] * 1000)
    assert len(monitor.emotions.table()) <= 601
    assert len(monitor.tracking.table()) <= 101
    facts, _ = shown("emotion", monitor)
    assert facts["Robot"] == Fact("Robot", "no report", "quiet")


def test_the_line_of_a_robot_shows_health_and_messages():
    telemetry = Telemetry(
        "degraded", round_trip=0.0123, silence=0.2, battery=0.87,
        counts=LinkCounts(retries=2, crc_errors=1, sessions=2),
    )  # fmt: skip
    robot = RobotView("degraded", 0.0, "neutral", telemetry=telemetry, time=5.0)
    second = RobotView("lost", 0.0, "neutral", telemetry=Telemetry("lost"), name="tim")
    robot = replace(robot, second=second)
    options = replace(OPTIONS, robot="opencat:COM3", second_robot="sim:pleo")
    monitor = feed(({}, NEUTRAL, robot), options=options)
    monitor.wire("tx", b"ksit\n", 4.5)
    monitor.wire("rx", b"k\n\x1b[31mred\n", 4.75)
    facts, (log,) = shown("serial", monitor)
    assert {name: (fact.value, fact.tone) for name, fact in facts.items()} == {
        "Link": ("degraded on opencat:COM3", "warning"),
        "Round trip": ("12.3 ms, last heard 200 ms ago", "plain"),
        "To robot": ("0 messages/s, 2 bytes/s", "plain"),
        "From robot": ("1 messages/s, 6 bytes/s", "plain"),
        "Repeated, damaged, reconnected": ("2, 1, 1", "warning"),
        "Battery": ("87 %", "plain"),
        "Link of tim": ("lost on sim:pleo", "bad"),
        "Round trip of tim": ("not measured, last heard never", "plain"),
    }
    assert log.rows == (
        ("0.5 s", "to robot", "ksit"),
        ("0.2 s", "from robot", "k"),
        ("0.2 s", "from robot", "[31mred"),
    )
    assert isinstance(shown("serial", feed(SEEN))[1][0], Note)


def test_frame_time_shows_the_mean_of_each_part():
    monitor = feed(SEEN)
    assert isinstance(PANELS["frame-time"].content(monitor)[0], Note)
    for _ in range(2):
        for part in ("tracking", "waiting", "tracking", "something new"):
            monitor.times.lap(part)
        monitor.times.end_frame()
    facts, (bar,) = shown("frame-time", monitor)
    assert facts["A frame"].value == "40.0 ms, 25 frames/s"
    assert facts["Quality"].value == "reduced"
    assert isinstance(bar, ShareBar)
    assert [(share.name, share.value) for share in bar.shares] == [
        ("tracking", "20.0 ms"),
        ("waiting", "10.0 ms"),
        ("something new", "10.0 ms"),
    ]


@pytest.mark.parametrize("name", scenario_names())
def test_a_scenario_shows_the_settings_that_it_reads(name):
    _, widgets = shown("scenario", feed(SEEN, options=replace(OPTIONS, scenario=name)))
    settings = [each.setting for each in widgets]
    assert settings == [*getattr(find_scenario(name), "adjustable", ()), "look"]
    assert all(each.enabled for each in widgets)


def test_the_settings_are_those_of_the_session_and_stay_in_a_recording():
    options = replace(OPTIONS, turns=3.0, personality="my.toml", look="cube")
    _, widgets = shown("scenario", feed(SEEN, options=options))
    turns, personality, look = widgets
    assert (turns.value, personality.value, look.value) == (3.0, "my.toml", "cube")
    assert "my.toml" in personality.choices
    monitor = feed(SEEN, options=options)
    monitor.fixed = True
    _, (*widgets, note) = shown("scenario", monitor)
    assert not any(each.enabled for each in widgets if isinstance(each, Choice | Slider))
    assert isinstance(note, Note)
