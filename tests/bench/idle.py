"""How idle motion of real people plays: `python -m tests.bench.idle`.

Each person of `shared/data/idle` is learned and played for two minutes on the bundled human.
Lengths are scaled to a person 1.7 m tall.

learning
    Time from the clip on the human's skeleton to all that is known of her; reading and retargeting
    the file are not in it.
a frame
    Mean time of `IdleMotion.sample`; frames are made at the rate of the recording.
speed
    Median, and 90 % quantile of the speed in the posture space: generated ÷ recorded.
slide
    Mean speed of planted feet, with the foot lock of the animation, as in `tests.bench.feet`.

With `-o people.jpg` it also draws eight moments of each person.

Exits with 1 if a bar of issue 15 is missed: 5 mm/s, 0.1 ms a frame, 10 s for three minutes.
"""

import argparse
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Animator, Character, CharacterCommand, Clip, Pose
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.portrait import PortraitRenderer
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.idle_motion import IdleMotion
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.recordings import read_standing
from tests.bench.feet import FRAME_RATE, measure, placed_take

PEOPLE = Path(__file__).parents[3] / "shared" / "data" / "idle"
PLAYED_S = 120.0
MOMENTS = 8
MAX_SLIDE_MM_S, MAX_FRAME_MS, MAX_LEARNING_SHARE = 5.0, 0.1, 10.0 / 180.0


def learned(clip: Clip, character: Character) -> IdleDatabase:
    """Return what is learned of a person from one clip."""
    kind = PostureVectors.of(character.skeleton, character.anatomy)
    return IdleDatabase.of([read_standing(clip, character.skeleton, character.anatomy)], kind)


def speeds(vectors: NDArray[np.float64], database: IdleDatabase, rate: float) -> tuple[float, ...]:
    """Return the median and the 90 % quantile of the speed in the posture space."""
    steps = np.linalg.norm(np.diff(database.space.project(vectors), axis=0), axis=1) * rate
    return tuple(np.quantile(steps, (0.5, 0.9)).tolist())


def slide(character: Character, database: IdleDatabase) -> float:
    """Return the mean speed of planted feet [mm/s]."""
    standing = replace(character, standing=partial(IdleMotion, database))
    animator = Animator(standing, scale=1.0, layers=FOOT_LAYERS)
    times = np.arange(0.0, PLAYED_S, 1 / FRAME_RATE).tolist()
    shown = [animator.update(CharacterCommand(now)) for now in times]
    poses = Pose.of_frames(posed.pose for posed in shown)
    placed = np.stack([posed.table_from_character for posed in shown])
    return measure(placed_take(character, poses, placed)).mean


def strip(character: Character, poses: Pose) -> NDArray[np.uint8]:
    """Return moments of a person side by side."""
    context = create_context()
    renderer = PortraitRenderer(context, (110, 168))
    picture = renderer.strip(character, Clip("idle", FRAME_RATE, poses), MOMENTS, azimuth=0.0)
    renderer.release()
    context.release()
    return picture


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="a .png or .jpg picture")
    output = parser.parse_args().output
    console = Console(width=110)
    if not PEOPLE.is_dir():
        console.print(f"no recordings at {PEOPLE}: nothing to measure")
        return 0
    character = Character.load("human")
    table = Table(title="idle motion of eight people")
    for heading in ("who", "recorded", "shifts", "learning", "a frame", "speed", "slide"):
        table.add_column(heading, justify="left" if heading == "who" else "right")
    good, strips = True, []
    for path in sorted(PEOPLE.glob("*.bvh")):
        (clip,) = read_motions([str(path)], character)
        start = time.perf_counter()
        database = learned(clip, character)
        learning = time.perf_counter() - start
        motion, poses, times = IdleMotion(database), [], []
        for now in np.arange(0.0, PLAYED_S, 1 / FRAME_RATE).tolist():
            start = time.perf_counter()
            poses.append(motion.sample(now))
            times.append(1e3 * (time.perf_counter() - start))
        made = Pose.of_frames(poses)
        if output is not None:
            strips.append(strip(character, made))
        recorded = read_standing(clip, character.skeleton, character.anatomy).vectors
        ours = speeds(database.kind.vectors(made), database, FRAME_RATE)
        ratios = np.divide(ours, speeds(recorded, database, clip.rate))
        sliding, frame = slide(character, database), float(np.mean(times))
        good &= sliding < MAX_SLIDE_MM_S and frame <= MAX_FRAME_MS
        good &= learning <= MAX_LEARNING_SHARE * clip.duration
        table.add_row(
            path.stem,
            f"{clip.duration:.0f} s",
            f"{len(database.shifts)}",
            f"{learning:.1f} s",
            f"{frame:.3f} ms",
            f"{ratios[0]:.2f}, {ratios[1]:.2f}",
            f"{sliding:.1f} mm/s",
        )
    console.print(table)
    if strips:
        cv2.imwrite(str(output), np.vstack(strips), [cv2.IMWRITE_JPEG_QUALITY, 88])
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
