"""What symbolic gestures cost: `python -m tests.bench.symbolic_gestures`.

planning
    Time to plan all key postures of a gesture when it first appears: median and longest of all
    bundled ones; it is spread over frames.
a frame
    Least time to lay a gesture over a pose, half faded in; and ÷ that of `np.copy` of the pose,
    which is the same on a busy machine.
largest step
    Largest turn of a joint in a frame at 30 Hz, of all gestures: no joint flips.
sweep, torso, speed
    Largest extent of the palm's way, largest turn of the chest, and peak speed of the palm in
    BEAT_BOTH: wide and powerful ÷ as it is written.

Exits with 1 if a frame of the whole body takes more than 1 ms (Huang 2013, section 8.6), or a
joint flips.
"""

import sys
import time
import timeit

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character
from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.planning import FLIP_RAD, GestureRealizer
from cubeling.characters.skeleton import rotations

MAX_FRAME_MS = 1.0
RATE_HZ = 30.0
STRONG = GestureExpressivity(spatial=0.3, power=1.0)


def planning_ms(character: Character) -> list[float]:
    """Return how long each bundled gesture takes to plan [ms]."""
    performer = GestureRealizer.measure(character)
    spans = []
    for gesture in GestureCollection.load_bundled():
        start = time.perf_counter()
        planning = performer.planning(gesture)
        planning.advance(len(planning.numbers))
        spans.append(1e3 * (time.perf_counter() - start))
    return spans


def frame_ms(performer: GestureRealizer) -> tuple[float, float]:
    """Return the least time of a frame [ms], and ÷ that of a copy of the rotations."""
    motion, pose = (
        performer.plan(GestureCollection.load_bundled().get("OPEN_ARMS")),
        performer.posture,
    )
    now = motion.times.in_stroke(0.37)
    frame = min(timeit.repeat(lambda: motion.over(pose, now, 0.5), number=100, repeat=30)) / 100
    copied = min(timeit.repeat(pose.rotations.copy, number=100, repeat=30)) / 100
    return 1e3 * frame, frame / copied


def largest_step(performer: GestureRealizer) -> float:
    """Return the largest turn of a joint in a frame [rad]."""
    largest = 0.0
    for gesture in GestureCollection.load_bundled():
        motion = performer.plan(gesture)
        times = np.arange(0.0, motion.duration, 1.0 / RATE_HZ)
        turns = np.array([motion.sample(float(each)).rotations for each in times])
        cosines = np.abs(np.vecdot(turns[1:], turns[:-1]))
        largest = max(largest, 2.0 * float(np.arccos(np.clip(cosines, 0.0, 1.0)).max()))
    return largest


def measured_way(
    performer: GestureRealizer, style: GestureExpressivity
) -> tuple[float, float, float]:
    """Return sweep [m], turn of the chest [rad] and peak speed [m/s] of BEAT_BOTH."""
    motion = performer.plan(GestureCollection.load_bundled().get("BEAT_BOTH"), "right", style)
    times = np.linspace(motion.times.stroke_start, motion.times.stroke_end, 201)
    poses = [motion.sample(float(each)) for each in times]
    palms = np.array([performer.body.palm(pose, "right") for pose in poses])
    skeleton, chest = performer.character.skeleton, performer.chest
    frames = np.array([pose.globals(skeleton)[chest, :3, :3] for pose in poses])
    turns = rotations.from_matrix(frames / np.linalg.norm(frames, axis=1, keepdims=True))
    turned = rotations.multiply(turns, rotations.conjugate(turns[0]))
    speed = np.linalg.norm(np.diff(palms, axis=0), axis=1).max() / (times[1] - times[0])
    return (
        float(np.ptp(palms, axis=0).max()),
        float(np.linalg.norm(rotations.to_rotation_vector(turned), axis=1).max()),
        float(speed),
    )


def main() -> int:
    """Print the table; return 1 if a bar is missed."""
    gestures = GestureCollection.load_bundled()
    table = Table(title=f"{len(gestures)} symbolic gestures")
    for heading in (
        *("character", "planning", "longest", "a frame", "÷ copy", "largest step"),
        *("sweep", "torso", "speed"),
    ):
        table.add_column(heading, justify="right" if table.columns else "left")
    missed = False
    for name in ("human", "vleo", "robot"):
        character = Character.load(name)
        spans, performer = planning_ms(character), GestureRealizer.of(character)
        (frame, ratio), step = frame_ms(performer), largest_step(performer)
        written, strong = (measured_way(performer, style) for style in (NEUTRAL, STRONG))
        missed = missed or frame > MAX_FRAME_MS or step > FLIP_RAD
        table.add_row(
            name,
            f"{np.median(spans):.1f} ms",
            f"{max(spans):.1f} ms",
            f"{frame:.3f} ms",
            f"{ratio:.0f}",
            f"{np.degrees(step):.0f}°",
            *(f"x {b / a:.2f}" for a, b in zip(written, strong, strict=True)),
        )
    Console().print(table)
    return int(missed)


if __name__ == "__main__":
    sys.exit(main())
