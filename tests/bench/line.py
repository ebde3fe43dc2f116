"""Time of the whole pipeline and of its parts: `python -m tests.bench.line [--frames N]`.

Tracking, gestures, decision, animation, rendering and read-back on the frames of the bundled
recordings at 1280×720. Decoding the recording, drawing the overlay, what is heard (finding the
cues, and mixing and encoding them for a video) and copying the state for a seek are listed
separately. The hand is looked for while the driver draws: that is a part of the line, but not of
drawing. Means count, as some frames take less than others: in those the hand is not looked for. The
last column is the mean time as a multiple of that of OpenCV's detection of markers in a whole frame
in the same run, as machines differ threefold.
"""

import argparse
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from unittest.mock import patch

import av
import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.choices import REALISM_CHOICES, realism_of
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.sound import Mixer, SessionSound, SoundBank
from cubeling.app.ui.cards.overlay import overlay, virtual_robot_side
from cubeling.app.ui.cards.virtual_robot import VirtualRobot
from cubeling.app.ui.video_file import AudioTrack
from cubeling.characters.rendering import FULL, QUALITIES, Quality, create_context
from cubeling.tracking import CubeState, open_source
from cubeling.tracking.appearance import HandFinder, HandMask

Image = NDArray[np.uint8]

Look = Callable[[HandFinder, Image, CubeState], HandMask | None]
"""`HandFinder.update`."""

TARGET_MS = 25.0

DETECTION = "(OpenCV's detection)"
"""What other times are compared with."""

HAND, DRAWING = "look for the hand", "draw, read back"
"""Two parts of the same span."""

FIRST_FRAMES = 10
"""Frames at the beginning that do not count: shaders are compiled in them."""

DETECTION_INTERVAL = 10
"""Only one frame of so many is searched by OpenCV."""


def measure(
    name: str, frames: int, realism: tuple[str, ...], quality: Quality
) -> dict[str, list[float]]:
    """Return the time of each part in every frame that counts [ms]."""
    detector = cv2.aruco.ArucoDetector(
        cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), cv2.aruco.DetectorParameters()
    )
    parts: dict[str, list[float]] = defaultdict(list)
    looks: list[float] = []  # how long the hand was looked for [s]
    context = create_context()
    sound = SessionSound(Mixer(SoundBank()))
    with (
        open_source(str(bundled_session(name))) as source,
        patch.object(HandFinder, "update", timed(HandFinder.update, looks)),
        tempfile.TemporaryDirectory() as folder,
        av.open(str(Path(folder) / "sound.mp4"), "w") as file,
    ):
        track = AudioTrack(file, "aac", sound.mixer.render)
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        playground = Playground(name, intrinsics, context=context, realism=realism)
        playground.quality = quality
        robot = RobotView("ready", 0.0, "neutral")
        virtual_robot = VirtualRobot(context, virtual_robot_side(source.size[1]))
        stream = iter(source)
        for number in range(frames):
            marks = [time.perf_counter()]
            frame = next(stream, None)
            if frame is None:
                break
            marks.append(time.perf_counter())
            playground.expect(frame)
            state = playground.tracked.track(frame)
            marks.append(time.perf_counter())
            controls = playground.players[0].gesture(state)
            cast = playground.cast
            outcome = cast.decide([SeenCube(state, controls)], [Inputs()])[0]
            marks.append(time.perf_counter())
            posed = cast.lead.perform(outcome.command).posed
            marks.append(time.perf_counter())
            appearance = playground.sight.see(frame, state, controls)
            step = Step(frame, state, controls, outcome, posed, None, appearance=appearance)
            picture = playground.draw(step)
            assert picture is not None
            marks.append(time.perf_counter())
            overlay(picture, step, robot, virtual_robot)
            marks.append(time.perf_counter())
            track.write_until(frame.timestamp)
            marks.append(time.perf_counter())
            sound.play(step, playground.character)
            marks.append(time.perf_counter())
            playground.checkpoint()
            marks.append(time.perf_counter())
            names = (
                "(decode)",
                "track",
                "gesture, decide",
                "animate",
                DRAWING,
                "(cards)",
                "(sound of a video)",
                "(cues)",
                "(checkpoint)",
            )
            if number < FIRST_FRAMES:
                continue
            for part, span in zip(names, np.diff(marks), strict=True):
                parts[part].append(1000 * span)
            parts[HAND].append(1000 * looks[-1])
            parts[DRAWING][-1] -= parts[HAND][-1]
            if number % DETECTION_INTERVAL == 0:
                began = time.perf_counter()
                detector.detectMarkers(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY))
                parts[DETECTION].append(1000 * (time.perf_counter() - began))
        track.finish(frames / source.rate)
        virtual_robot.close()
        playground.close()
    context.release()
    counted = [part for part in parts if not part.startswith("(")]
    parts["the line"] = np.sum([parts[part] for part in counted], axis=0).tolist()
    return parts


def timed(look: Look, spans: list[float]) -> Look:
    """Return a function that does the same, and appends how long each call takes [s]."""

    def look_timed(finder: HandFinder, image: Image, state: CubeState) -> HandMask | None:
        began = time.perf_counter()
        found = look(finder, image, state)
        spans.append(time.perf_counter() - began)
        return found

    return look_timed


def main() -> None:
    """Print a table for every scenario."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=600, help="frames of each recording")
    parser.add_argument("--scenario", choices=list(RECORDED_SCENARIOS), action="append")
    parser.add_argument("--realism", type=realism_of, default=tuple(REALISM_CHOICES))
    parser.add_argument("--quality", choices=list(QUALITIES), default=FULL.name)
    given = parser.parse_args()
    title = f"quality {given.quality}, realism {', '.join(given.realism) or 'none'}"
    table = Table(
        "scenario", "part", "mean ms", "median ms", "p95 ms", "share", "of detection", title=title
    )
    for name in given.scenario or RECORDED_SCENARIOS:
        parts = measure(name, given.frames, given.realism, QUALITIES[given.quality])
        detection, whole = np.mean(parts[DETECTION]), np.mean(parts["the line"])
        for part, times in parts.items():
            mean, median, slow = np.mean(times), np.median(times), np.percentile(times, 95)
            share = "" if part.startswith("(") else f"{100 * mean / whole:.0f} %"
            figures = (f"{each:.2f}" for each in (mean, median, slow))
            table.add_row(name, part, *figures, share, f"{mean / detection:.2f}")
        verdict = "reached" if whole <= TARGET_MS else "MISSED"
        table.add_row(name, f"target {TARGET_MS:.0f} ms: {verdict}", end_section=True)
    Console().print(table)


if __name__ == "__main__":
    main()
