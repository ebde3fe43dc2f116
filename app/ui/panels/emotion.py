"""What character and robot feel, over the last minute."""

from cubeling.affect import Emotion
from cubeling.app.pipeline.step import RobotView
from cubeling.app.ui.palette import INK, ROBOT_COLOR, bgr
from cubeling.app.ui.panels.content import Fact, Panel, Plot, PlotCurve, Widget
from cubeling.app.ui.panels.monitor import EMOTION_SPAN_S, SessionMonitor

AROUSAL_COLOR = bgr("#d55e00")
"""Colour of the character's arousal, as in the mood plot."""

SCALE_MARKS = (
    ((1.0, "pleasant"), (0.0, ""), (-1.0, "unpleasant")),
    ((1.0, "excited"), (0.0, ""), (-1.0, "calm")),
)
"""Values with a word, of valence and of arousal."""


def content(monitor: SessionMonitor) -> tuple[Widget, ...]:
    """Return the emotions of all now, and the plots of the first character and its robot."""
    assert monitor.step is not None, "a panel is drawn after the first frame"
    step, robot = monitor.step, monitor.robot
    cast = [("Character", step.emotion), *((each.name, each.emotion) for each in step.others)]
    robots = [("Robot", robot)]
    if robot.second is not None:
        robots.append((robot.second.name, robot.second))
    table = monitor.emotions.table()
    plots = []
    for column, title, color in ((1, "Valence", INK), (2, "Arousal", AROUSAL_COLOR)):
        curves = (
            PlotCurve("robot", table[:, 0], table[:, column + 2], ROBOT_COLOR, 5.0),
            PlotCurve("character", table[:, 0], table[:, column], color),
        )
        plots.append(Plot(title, curves, EMOTION_SPAN_S, -1.0, 1.0, SCALE_MARKS[column - 1]))
    return (
        *(Fact(name, _words(felt.emotion.label, felt.emotion)) for name, felt in cast),
        *(_robot(name, view) for name, view in robots),
        *plots,
    )


def _robot(name: str, view: RobotView) -> Fact:
    if view.shown is None:
        return Fact(name, "no report", "quiet")
    return Fact(name, _words(view.label, view.shown))


def _words(label: str, emotion: Emotion) -> str:
    return f"{label} ({emotion.valence:+z.2f}, {emotion.arousal:+z.2f})"


EMOTION = Panel("emotion", "Emotion", 340.0, content)
