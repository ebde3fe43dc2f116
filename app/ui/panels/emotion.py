"""What character and robot feel, over the last minute."""

from cubeling.affect import Emotion
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
    """Return the emotions now, and their plots."""
    assert monitor.step is not None, "a panel is drawn after the first frame"
    feels, shown = monitor.step.emotion.emotion, monitor.robot.shown
    theirs = "no report" if shown is None else _words(monitor.robot.label, shown)
    table = monitor.emotions.table()
    plots = []
    for column, title, color in ((1, "Valence", INK), (2, "Arousal", AROUSAL_COLOR)):
        curves = (
            PlotCurve("robot", table[:, 0], table[:, column + 2], ROBOT_COLOR, 5.0),
            PlotCurve("character", table[:, 0], table[:, column], color),
        )
        plots.append(Plot(title, curves, EMOTION_SPAN_S, -1.0, 1.0, SCALE_MARKS[column - 1]))
    return (
        Fact("Character", _words(feels.label, feels)),
        Fact("Robot", theirs, "quiet" if shown is None else "plain"),
        *plots,
    )


def _words(label: str, emotion: Emotion) -> str:
    return f"{label} ({emotion.valence:+.2f}, {emotion.arousal:+.2f})"


EMOTION = Panel("emotion", "Emotion", 340.0, content)
