"""Moods of a recorded session: read, computed for other personalities, plotted and tabulated."""

from cubeling.app.workshop.moods.appraisal import appraise, without_emotions
from cubeling.app.workshop.moods.history import read_history, replay_with
from cubeling.app.workshop.moods.robot_traces import read_robot_traces
from cubeling.app.workshop.moods.table import write_table

__all__ = [
    "appraise",
    "read_history",
    "read_robot_traces",
    "replay_with",
    "without_emotions",
    "write_table",
]
