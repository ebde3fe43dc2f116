"""A session's moods as a table for a spreadsheet or a statistics program."""

import csv
import math
from pathlib import Path

from app.errors import AppError
from app.moods.history import Felt, History
from app.moods.wire import Wire

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
"""One row a frame; a cell is empty where nothing is known."""


def write_table(path: Path, history: History, felt: Felt, wire: Wire) -> int:
    """Write a .csv file; return how many rows it has.

    Parameters
    ----------
    path
        Where to write.
    history, felt, wire
        What was done, what was felt of it, and what the robot made of it.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    acknowledged, _ = wire.acknowledged.at(felt.times)
    observed, moods = wire.observed.at(felt.times)
    try:
        with path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(COLUMNS)
            for row, command in enumerate(history.commands):
                numbers = (*acknowledged[row], *observed[row])
                writer.writerow(
                    (
                        f"{felt.times[row]:.6f}",
                        *(_cell(value) for value in felt.emotion[row]),
                        felt.labels[row],
                        command.activity,
                        _cell(command.weight),
                        _cell(command.speed),
                        int(command.visible),
                        *(_cell(value) for value in numbers),
                        moods[row],
                    )
                )
    except OSError as error:
        raise AppError(f"cannot write '{path}' ({error.strerror}): check the folder") from None
    return len(felt.times)


def _cell(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.6g}"
