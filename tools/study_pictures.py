"""Draws the pictures of a study: what participants see, and the plot of their times."""

import tempfile
from pathlib import Path

import cv2
import numpy as np

from cubeling.app.workshop.pages.box_plot import box_plot
from cubeling.app.workshop.pages.page import STYLE
from cubeling.app.workshop.study.bundled.single_facial_actions import INTENSITY
from cubeling.app.workshop.study.face_stimuli import RECIPES as ACTIONS, draw_faces
from cubeling.app.workshop.study.participants.running import run_simulated
from cubeling.app.workshop.study.participants.stimulus_files import pictures_of
from cubeling.app.workshop.study.participants.study_log import StudyFolder
from cubeling.app.workshop.study.protocols.protocol_file import protocol_text, read_protocol
from cubeling.app.workshop.study.protocols.questionnaires import FACES, Item
from cubeling.app.workshop.study.reporting.tables import gather
from cubeling.app.workshop.study.window.sheet import Sheet


def draw_times(pictures: Path) -> None:
    """Plot the times of simulated participants of the study that `cubeling study new` writes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "turns.toml"
        path.write_text(protocol_text(None), "utf-8")
        study = StudyFolder(Path(folder) / "trial", read_protocol(path), path, "simulated")
        run_simulated(study, 8)
        rows = gather(study.protocol, "simulated", study.people).tables["tasks"]
    times = [
        (name, [row["time_s"] for row in rows if row["condition"] == name])
        for name in study.protocol.conditions
    ]
    plot = box_plot(times, "simulated participants: time until the robot is happy [s]", (0.0, 30.0))
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="720" height="132"><style>{STYLE}</style>'
    )
    drawn = plot.replace("<svg ", '<svg width="720" height="132" ')
    (pictures / "study-times.svg").write_text(f"{head}{drawn}</svg>\n", "utf-8")


def draw_sheets(pictures: Path) -> None:
    """Draw what a participant sees in the window."""
    scale = Item("easy", "The cube was easy to use.", anchors=("totally disagree", "totally agree"))
    liked = Item("liked", "How did you like it?", pictures=(FACES,))
    words = Item("rigid", "", anchors=("moving rigidly", "moving elegantly"))
    better = Item(
        "better",
        "Which one suits the speech better?",
        anchors=("left, much", "left", "same", "right", "right, much"),
    )
    shown = [
        np.asarray(cv2.imread(str(pictures / f"companion-{name}.jpg")))
        for name in ("kiss", "shout")
    ]
    sheets = [
        Sheet("Experience", item=scale),
        Sheet("Experience", item=liked, pictures=pictures_of(liked, pictures)),
        Sheet("Your impression of the robot", item=words),
        Sheet("Pairs", item=better, captions=("left", "right")),
    ]
    for sheet, count in zip(sheets, (4, 5, 3, 2), strict=True):
        for _ in range(count):
            sheet.press("→")
    drawn = [sheet.draw(0.5, shown if sheet is sheets[-1] else ()) for sheet in sheets]
    picture = np.vstack([np.hstack(drawn[:2]), np.hstack(drawn[2:])])
    cv2.imwrite(str(pictures / "study-window.jpg"), picture, (cv2.IMWRITE_JPEG_QUALITY, 88))


FACE_ROWS = (("high", "with"), ("high", "without"), ("low", "with"))
"""Intensity and wrinkles of each row of faces."""

FACE_FILE = "{}-woman-{}-{}-picture.png"

FACE_PX = 160
"""Side of a face in the picture of all [px]."""


def draw_stimuli(pictures: Path) -> None:
    """Draw the pictures of the experiment with facial actions that are analysed."""
    with tempfile.TemporaryDirectory() as folder:
        shown = [action for action in ACTIONS if action in INTENSITY]
        draw_faces(
            {"woman": "human", "man": "human"},
            Path(folder),
            lambda stimulus: stimulus["mode"] == "picture" and stimulus["agent"] == "woman",
        )
        rows = [
            [
                cv2.resize(
                    np.asarray(cv2.imread(str(Path(folder) / FACE_FILE.format(action, *row)))),
                    (FACE_PX, FACE_PX),
                    interpolation=cv2.INTER_AREA,
                )
                for action in shown
            ]
            for row in FACE_ROWS
        ]
    picture = np.vstack([np.hstack(row) for row in rows])
    cv2.imwrite(str(pictures / "study-faces.jpg"), picture, (cv2.IMWRITE_JPEG_QUALITY, 88))
