"""How the bundled characters stand: `python -m tests.bench.standing`.

They are our own, so that these figures are upper bounds; `tests.bench.idle` has other people. Each
is played for two minutes, in three moods.

slide
    Mean speed of planted feet, scaled to a body 1.7 m tall [mm/s].
weight
    How far the hips go to both sides at most, 5 % of the time, between the middle and a foot (1).
head
    How far the head goes to the side with the hips, ÷ them (regression): below 1 it is calmer.
jolt
    Largest acceleration of hips, knees, feet or head [body heights/s²]; a knee that snaps has 30.
seeds
    Distance of two characters with different seeds at one time ÷ that of one of them at two times.
mood
    After how long the posture is nearer to those of a new mood, ÷ the longest pause of the old one;
    the median of the changes between nine moods.

Then five characters stand together for ten minutes, with blinks, breath and gaze: how much slower
the last minute is than the first, and how much memory is new in the last four minutes.

Exits with 1 if a bar of issue 15 is missed: 5 mm/s, within one pause, no growth.
"""

import gc
import itertools
import sys
import time
import tracemalloc

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.affect import NEUTRAL, Emotion
from cubeling.affect.regions import SECTOR_WORDS
from cubeling.affect.words import WORD_PLACES
from cubeling.characters import Animator, Character, CharacterCommand, Pose
from cubeling.characters.skeleton.anatomy import SIDES
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.standing import StandingPerson
from tests.bench.feet import FRAME_RATE, measure, placed_take

Array = NDArray[np.float64]

PLAYED_S, TOGETHER_S = 120.0, 600.0
MOODS = (None, Emotion(*WORD_PLACES["sad"]), Emotion(*WORD_PLACES["happy"]))
MAX_SLIDE_MM_S, MAX_SLOWER, MAX_GROWTH_KB = 5.0, 1.3, 200.0


def played(character: Character, seed: int) -> tuple[Pose, Array]:
    """Return how it stands, and where."""
    animator = Animator(character, scale=1.0, seed=seed)
    times = np.arange(0.0, PLAYED_S, 1 / FRAME_RATE)
    third = PLAYED_S / len(MOODS)
    shown = [animator.update(CharacterCommand(t, emotion=MOODS[int(t / third)])) for t in times]
    return (
        Pose.of_frames(posed.pose for posed in shown),
        np.stack([posed.table_from_character for posed in shown]),
    )


def weight(character: Character, poses: Pose) -> tuple[tuple[float, float], float]:
    """Return how far the hips go to both sides, and how far the head goes with them, ÷ them."""
    joints = character.anatomy.joints
    across = poses.globals(character.skeleton)[:, :, 0, 3]
    left, right, hips, head = (
        across[:, joints[part]] for part in ("leftFoot", "rightFoot", "hips", "head")
    )
    balance = (hips - (left + right) / 2) / ((left - right).mean() / 2)
    low, high = np.quantile(balance, (0.05, 0.95)).tolist()
    hips, head = np.diff(hips), np.diff(head)
    return (low, high), float((hips @ head) / (hips @ hips))


def jolt(character: Character, poses: Pose) -> float:
    """Return the largest acceleration of a few joints [body heights/s²]."""
    parts = ("hips", "head", *(s + p for s in SIDES for p in ("LowerLeg", "Foot")))
    joints = [character.anatomy.joints[part] for part in parts]
    placed = poses.globals(character.skeleton)[:, joints][..., :3, 3]
    change = np.linalg.norm(np.diff(placed, 2, axis=0), axis=-1) * FRAME_RATE**2
    return float(change.max()) / character.height


def apart(one: Array, other: Array) -> float:
    """Return how unlike two motions are at one time, ÷ how unlike one is to itself later."""
    shifted = np.linalg.norm(np.roll(one, len(one) // 7, axis=0) - one, axis=1)
    return float(np.linalg.norm(one - other, axis=1).mean() / shifted.mean())


def reaction(character: Character) -> tuple[float, float]:
    """Return after how much of a pause a new mood shows: the median, and the longest."""
    places = [NEUTRAL, *(Emotion(*WORD_PLACES[word]) for word in SECTOR_WORDS)]
    shares = []
    for number, (old, new) in enumerate(itertools.permutations(places, 2)):
        standing = character.standing
        assert standing is not None
        person = standing(number)
        assert isinstance(person, StandingPerson)
        person.feel(old)
        database = person.idle.database
        begin, motion = 20.0 + number % 7, person.idle
        motion.feel(old)
        motion.sample(begin)
        means = [np.mean([p.vector for p in database.for_emotion(each).postures], axis=0)
                 for each in (old, new)]  # fmt: skip
        pause = max(p.duration for p in database.for_emotion(old).postures)
        motion.feel(new)
        for after in np.arange(0.0, 2.0 * pause, 0.1).tolist():
            at = database.kind.vectors(motion.sample(begin + after))
            far = [np.linalg.norm(at - mean) for mean in means]
            if far[1] < far[0]:
                break
        shares.append(after / pause)
    return float(np.median(shares)), float(max(shares))


def together() -> tuple[float, float, float]:
    """Return a frame's time [ms], how much slower the last minute is, and what memory is new [kB].

    Time is that without, memory that with tracing; each takes half of the minutes.
    """
    names = ("human", "vleo", "robot", "human", "vleo")
    group = [Animator(Character.load(name), seed=seed) for seed, name in enumerate(names)]
    minutes, half, rate, memory = [], round(TOGETHER_S / 120.0), 30, []
    for minute in range(2 * half):
        if minute == half:
            tracemalloc.start()
        start = time.perf_counter()
        for frame in range(60 * rate):
            now = 60.0 * minute + frame / rate
            mood = MOODS[int(now / 15.0) % len(MOODS)]
            gaze = np.array([0.3 * np.sin(now), 0.2, 0.5])
            for animator in group:
                animator.update(CharacterCommand(now, emotion=mood, gaze=gaze))
        minutes.append(time.perf_counter() - start)
        gc.collect()
        memory.append(tracemalloc.get_traced_memory()[0] / 1e3)
    tracemalloc.stop()
    frame_ms = 1e3 * min(minutes[:half]) / (60 * rate * len(group))
    slower = max(minutes[half - 1] / minutes[0], minutes[-1] / minutes[half])
    return frame_ms, slower, memory[-1] - memory[half]


def main() -> int:
    """Print the table and return an exit code."""
    console = Console(width=100)
    table = Table(title="how the bundled characters stand")
    for heading in ("who", "slide", "weight", "head", "jolt", "seeds", "mood", "longest"):
        table.add_column(heading, justify="left" if heading == "who" else "right")
    good = True
    for name in Character.bundled_names():
        character = Character.load(name)
        kind = PostureVectors.of(character.skeleton, character.anatomy)
        poses, places = played(character, 0)
        other, _ = played(character, 1)
        sliding = measure(placed_take(character, poses, places)).mean
        (low, high), head = weight(character, poses)
        unlike = apart(kind.vectors(poses), kind.vectors(other))
        middle, longest = reaction(character)
        good &= sliding < MAX_SLIDE_MM_S and longest <= 1.0
        jolted = jolt(character, poses)
        cells = f"{low:.2f} … {high:.2f}", f"{head:.2f}", f"{jolted:.1f}", f"{unlike:.2f}"
        table.add_row(name, f"{sliding:.2f}", *cells, f"{middle:.2f}", f"{longest:.2f}")
    console.print(table)
    frame_ms, slower, grown = together()
    console.print(
        f"five characters, ten minutes: {frame_ms:.2f} ms for one in a frame, the last minute "
        f"{slower:.2f} × the first one, {grown:+.0f} kB of memory"
    )
    return int(not (good and slower < MAX_SLOWER and grown < MAX_GROWTH_KB))


if __name__ == "__main__":
    sys.exit(main())
