"""A session's moods as a CSV table, for a spreadsheet or a statistics program."""

import csv
import math
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.workshop.moods.history import EmotionTrack, MoodHistory
from cubeling.app.workshop.moods.robot_traces import RobotTraces
from cubeling.files import whole_file

COLUMNS = (
    "time_s",
    "valence",
    "arousal",
    "label",
    "action",
    "weight",
    "speed",
    "visible",
    "acknowledged_valence",
    "acknowledged_arousal",
    "observed_valence",
    "observed_arousal",
    "observed_mood",
)
"""Columns of the table, which has one row for each frame; unknown cells are empty."""


def write_table(path: Path, history: MoodHistory, track: EmotionTrack, robot: RobotTraces) -> int:
    """Write a session with an emotion to a .csv file, and return its number of rows.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    acknowledged, _ = robot.acknowledged.at(track.times)
    observed, moods = robot.observed.at(track.times)
    with (
        whole_file(path, AppError) as partial,
        partial.open("w", encoding="utf-8", newline="") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for row, command in enumerate(history.commands):
            writer.writerow(
                (
                    f"{track.times[row]:.6f}",
                    *(_cell(value) for value in track.emotion[row]),
                    track.labels[row],
                    command.activity,
                    _cell(command.weight),
                    _cell(command.speed),
                    int(command.visible),
                    *(_cell(value) for value in acknowledged[row]),
                    *(_cell(value) for value in observed[row]),
                    moods[row],
                )
            )
    return len(track.times)


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"
