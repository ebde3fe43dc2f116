"""Egges' study of idle motion, with machines for subjects: `python -m tests.bench.idle_study`.

Source: Egges 2006, section 3.3.2 (S25): people named a person in a third of the films, of eight,
and took 46 % of the generated ones for recorded. Here classifiers judge windows of 5 s of the eight
people of `shared/data/idle`. They are no people, and see other things.

Each recording is cut into halves. The database is learned from the first one, the classifiers from
the second one, so no frame is in both. Intervals of 95 % are over the people (bootstrap).

who
    How often a classifier that knows the second halves names the person: of real windows of the
    first halves, and of generated ones. Chance is 12.5 %.
AUC
    How well a classifier tells generated windows from real ones of a person whom it has not seen:
    0.5 is chance. Baselines move the mean posture of the first half by Perlin noise for each
    joint or for each component, or repeat a piece of 8 s of it.

It sees, for ten components: mean, and logarithms of spread, speed, acceleration and jerk.
"""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from characters import Character, Pose
from characters.control.controllers.recordings import read_motions
from characters.synthesis.idle.database import IdleDatabase
from characters.synthesis.idle.idle_motion import IdleMotion, Small
from characters.synthesis.idle.posture_space import PostureSpace, PostureVectors
from characters.synthesis.idle.recordings import StandingRecording, find_rests, read_standing
from characters.synthesis.transitions.comparison import bootstrap_interval

Array = NDArray[np.float64]

PEOPLE = Path(__file__).parents[3] / "shared" / "data" / "idle"
WINDOW_S, GENERATED_S, LOOP_S, COMPONENTS = 5.0, 120.0, 8.0, 10
RIDGE = 0.1
"""Part of the mean variance that is added to each variance of the classifiers."""


def halves(recording: StandingRecording) -> tuple[StandingRecording, StandingRecording]:
    """Return the halves of a recording as recordings."""
    middle = len(recording.vectors) // 2
    parts = []
    for own in (slice(None, middle), slice(middle, None)):
        balance = recording.balance[own]
        rests = find_rests(balance, recording.rate)
        parts.append(
            StandingRecording(
                recording.name, recording.rate, recording.vectors[own], balance, rests
            )
        )
    return parts[0], parts[1]


def generated(database: IdleDatabase, seed: int, small: Small) -> Array:
    """Return posture vectors of generated motion, (frames, size)."""
    motion = IdleMotion(database, seed, small)
    poses = [motion.sample(n / database.rate) for n in range(round(GENERATED_S * database.rate))]
    return database.kind.vectors(Pose.of_frames(poses))


def perlin(count: int, columns: int, rate: float, rng: np.random.Generator) -> Array:
    """Return smooth noise of unit variance, (count, columns): three octaves from 0.3 Hz."""
    times = np.arange(count) / rate
    total = np.zeros((count, columns))
    for octave in range(3):
        at = times * 0.3 * 2**octave
        knots = rng.normal(size=(int(at[-1]) + 2, columns)) / 2**octave
        low, u = at.astype(int), (at % 1.0)[:, None]
        total += knots[low] + (knots[low + 1] - knots[low]) * (u**3 * (u * (u * 6 - 15) + 10))
    noise: Array = total / total.std(0)
    return noise


def by_joint(half: StandingRecording, database: IdleDatabase, seed: int) -> Array:
    """Return the mean posture moved by noise, the same for all values."""
    rng, vectors = np.random.default_rng(seed), half.vectors
    noise = perlin(round(GENERATED_S * half.rate), vectors.shape[1], half.rate, rng)
    moved: Array = vectors.mean(0) + noise * vectors.std()
    return moved


def by_component(half: StandingRecording, database: IdleDatabase, seed: int) -> Array:
    """Return the mean posture moved by noise along each component, as much as she moves."""
    rng, space = np.random.default_rng(seed), database.space
    noise = perlin(round(GENERATED_S * half.rate), COMPONENTS, half.rate, rng)
    return space.restore(noise * np.sqrt(space.variances[:COMPONENTS]))


def looped(half: StandingRecording, database: IdleDatabase, seed: int) -> Array:
    """Return a piece of the half, over and over."""
    count = round(LOOP_S * half.rate)
    first = int(np.random.default_rng(seed).integers(len(half.vectors) - count))
    times = np.arange(round(GENERATED_S * half.rate))
    return half.vectors[first : first + count][times % count]


SOURCES: dict[str, Callable[[StandingRecording, IdleDatabase, int], Array]] = {
    "generated": lambda half, database, seed: generated(database, seed, "recorded"),
    "generated, extrema": lambda half, database, seed: generated(database, seed, "extrema"),
    "Perlin, joints": by_joint,
    "Perlin, components": by_component,
    "looped clip": looped,
}


def features(vectors: Array, space: PostureSpace, rate: float) -> Array:
    """Return what a classifier sees of each window, (windows, 5 · components)."""
    at, count = space.project(vectors, COMPONENTS), round(WINDOW_S * rate)
    windows = at[: len(at) // count * count].reshape(-1, count, COMPONENTS)
    rows = [windows.mean(1), np.log(windows.std(1) + 1e-5)]
    for order in (1, 2, 3):
        change = np.abs(np.diff(windows, order, axis=1)).mean(1) * rate**order
        rows.append(np.log(change + 1e-5))
    return np.concatenate(rows, axis=1)


class Discriminant:
    """Linear discriminant analysis with a ridge."""

    def __init__(self, rows: Array, labels: NDArray[np.intp]) -> None:
        self.middle, self.scale = rows.mean(0), rows.std(0) + 1e-9
        scaled = (rows - self.middle) / self.scale
        self.means = np.stack(
            [scaled[labels == label].mean(0) for label in range(labels.max() + 1)]
        )
        rest = scaled - self.means[labels]
        within = rest.T @ rest / len(rows)
        within += RIDGE * np.trace(within) / len(within) * np.eye(len(within))
        self.weights = np.linalg.solve(within, self.means.T)
        self.offsets = -0.5 * (self.means * self.weights.T).sum(1)

    def scores(self, rows: Array) -> Array:
        """Return how well each label suits, (rows, labels)."""
        found: Array = (rows - self.middle) / self.scale @ self.weights + self.offsets
        return found


def area(scores: Array, positive: NDArray[np.bool_]) -> float:
    """Return the area under the curve of a classifier: how often a positive one scores higher."""
    return float((scores[positive][:, None] > scores[~positive]).mean())


def study(recordings: list[StandingRecording], kind: PostureVectors) -> dict[str, Array]:
    """Return for each source and person: named rightly, and AUC; (people, 2)."""
    pairs = [halves(each) for each in recordings]
    rate = recordings[0].rate
    space = PostureSpace.of(np.concatenate([second.vectors for _, second in pairs]))
    known = [features(second.vectors, space, rate) for _, second in pairs]
    labels = np.repeat(np.arange(len(known)), list(map(len, known)))
    naming = Discriminant(np.concatenate(known), labels)
    databases = [IdleDatabase.of([first], kind) for first, _ in pairs]
    real = [features(first.vectors, space, rate) for first, _ in pairs]
    rows = {"recorded": real}
    for name, make in SOURCES.items():
        made = [make(pairs[n][0], databases[n], n) for n in range(len(pairs))]
        rows[name] = [features(each, space, rate) for each in made]
    found = {}
    for name, windows in rows.items():
        results = []
        for person, own in enumerate(windows):
            named = float((naming.scores(own).argmax(1) == person).mean())
            results.append((named, _unmasked(real, windows, person) if name != "recorded" else 0.5))
        found[name] = np.array(results)
    return found


def _unmasked(real: list[Array], made: list[Array], person: int) -> float:
    """Return the AUC of a classifier that learned from all other people."""
    others = [n for n in range(len(real)) if n != person]
    rows = np.concatenate([*(real[n] for n in others), *(made[n] for n in others)])
    count = sum(len(real[n]) for n in others)
    labels = (np.arange(len(rows)) >= count).astype(np.intp)
    judged = Discriminant(rows, labels).scores(np.concatenate([real[person], made[person]]))
    fake = np.arange(len(judged)) >= len(real[person])
    return area(judged[:, 1] - judged[:, 0], fake)


def main() -> int:
    """Print the table and return an exit code."""
    console = Console(width=110)
    if not PEOPLE.is_dir():
        console.print(f"no recordings at {PEOPLE}: nothing to measure")
        return 0
    character = Character.load("human")
    body = character.skeleton, character.anatomy
    files = sorted(PEOPLE.glob("*.bvh"))
    recordings = [read_standing(read_motions([str(f)], character)[0], *body) for f in files]
    found = study(recordings, PostureVectors.of(*body))
    table = Table(title=f"windows of {WINDOW_S:g} s of {len(files)} people, judged by classifiers")
    for heading in ("", "who (chance 12.5 %)", "95 %", "AUC against recorded", "95 %"):
        table.add_column(heading, justify="left" if not heading else "right")
    for name, results in found.items():
        row = [name]
        for column, style in ((0, "{:.0%}"), (1, "{:.2f}")):
            if name == "recorded" and column == 1:
                row += ["", ""]
                continue
            low, high = bootstrap_interval(results[:, column])
            row += [style.format(results[:, column].mean()), f"{style} … {style}".format(low, high)]
        table.add_row(*row)
    console.print(table)
    named, real = found["generated"][:, 0].mean(), found["recorded"][:, 0].mean()
    good = named >= 3 / 8 and abs(real - named) <= 0.1 and found["generated"][:, 1].mean() <= 0.65
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
