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
Generated motion is judged for three seeds.

histograms
    Distance of two histograms of the logarithm of the speed in the posture space, of the
    acceleration and of the jerk (Wasserstein, in octaves): of generated motion and the second half
    of the same person, of both halves of a person, and of the second halves of two people.
shifts
    Balance shifts a minute: in the half that was learned from, in the other one, and in five
    generated minutes.
repeats
    Ten minutes are generated from the whole recordings. How far apart are the two seconds that are
    most alike, ÷ how far she moves within a second (median): 0 would be a repetition.

Exits with 1 if a bar of issue 15 is missed: named in 3 × chance and within 10 points of recorded
motion, AUC ≤ 0.65, histograms nearer to her than people are to each other, no repeated second; or
that of issue 56: as many shifts as in the other half within 20 % in the median, and within a factor
of 2 for everyone.
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.workshop.reproduction.motion_graphs.summary import bootstrap_interval
from cubeling.app.workshop.reproduction.standing.idle_study import (
    WINDOW_S,
    generated,
    halves,
    study,
)
from cubeling.characters import Character, Clip
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.posture_space import PostureSpace, PostureVectors
from cubeling.characters.synthesis.idle.recordings import (
    StandingRecording,
    read_standing,
)

Array = NDArray[np.float64]

PEOPLE = Path(__file__).parents[3] / "shared" / "data" / "idle"
LONG_S, SHIFTING_S = 600.0, 300.0
MAX_AUC, REPEATED = 0.65, 0.1
"""Two seconds are the same if they differ by less than this, ÷ her movement within a second."""


def changes(vectors: Array, space: PostureSpace, rate: float, order: int) -> Array:
    """Return the quantiles of the logarithm of the speed, acceleration or jerk [octaves]."""
    rows = np.diff(space.project(vectors), order, axis=0) * rate**order
    sizes = np.log2(np.linalg.norm(rows, axis=1) + 1e-6)
    quantiles: Array = np.quantile(sizes, np.linspace(0.005, 0.995, 100))
    return quantiles


def histograms(recordings: list[StandingRecording], kind: PostureVectors) -> tuple[Table, bool]:
    """Return the table of distances of histograms, and whether generated ones are near enough."""
    table = Table(title="distances of histograms, mean of the people [octaves]")
    for heading in ("", "generated, herself", "recorded, herself", "recorded, others", "farthest"):
        table.add_column(heading, justify="left" if not heading else "right")
    pairs = [halves(each) for each in recordings]
    rate, good = recordings[0].rate, True
    space = PostureSpace.of(np.concatenate([second.vectors for _, second in pairs]))
    made = [generated(IdleDatabase.of([first], kind), n, "recorded")
            for n, (first, _) in enumerate(pairs)]  # fmt: skip
    for order, name in ((1, "speed"), (2, "acceleration"), (3, "jerk")):
        own, first, second = (
            np.stack([changes(each, space, rate, order) for each in rows])
            for rows in (made, [a.vectors for a, _ in pairs], [b.vectors for _, b in pairs])
        )
        between = np.abs(second[:, None] - second).mean(-1)
        others = between[~np.eye(len(pairs), dtype=bool)]
        herself = np.abs(own - second).mean(-1)
        halved = np.abs(first - second).mean(-1)
        good &= bool(herself.mean() < others.mean() and herself.max() <= others.max())
        means = (herself.mean(), halved.mean(), others.mean())
        farthest = f"{herself.max():.2f}, {halved.max():.2f}, {others.max():.2f}"
        table.add_row(name, *(f"{value:.2f}" for value in means), farthest)
    return table, good


def nearest_seconds(vectors: Array, rate: float) -> float:
    """Return how far apart the two most similar seconds are, ÷ the movement within a second."""
    length = round(rate)
    count = len(vectors) // length
    turns = vectors[: count * length, :-3].reshape(count, length, -1)
    moved = np.linalg.norm(turns - turns.mean(1, keepdims=True), axis=(1, 2))
    rows = turns.reshape(count, -1)
    squares = (rows**2).sum(1)
    apart = squares[:, None] + squares - 2.0 * rows @ rows.T
    near = np.abs(np.subtract.outer(np.arange(count), np.arange(count))) < 2
    return float(np.sqrt(np.maximum(apart[~near].min(), 0.0)) / np.median(moved))


def repeats(recordings: list[StandingRecording], kind: PostureVectors) -> tuple[str, bool]:
    """Return a line on the seconds that are most alike, and whether none is repeated."""
    recorded = [nearest_seconds(each.vectors, each.rate) for each in recordings]
    made = [
        nearest_seconds(generated(IdleDatabase.of([each], kind), n, "recorded", LONG_S), each.rate)
        for n, each in enumerate(recordings)
    ]
    line = (
        f"most similar seconds, ÷ movement within a second: {min(made):.2f} … {max(made):.2f} in "
        f"{LONG_S / 60:.0f} generated minutes, {min(recorded):.2f} … {max(recorded):.2f} in the "
        "recordings"
    )
    return line, min(made) > REPEATED


def shift_rates(recordings: list[StandingRecording], character: Character) -> tuple[Table, bool]:
    """Return the table of shifts a minute, and whether the bar of issue 56 is met.

    It asks for 20 % of the recorded ones in the median, and for a factor of 2 for everyone.
    """
    skeleton, anatomy = character.skeleton, character.anatomy
    kind = PostureVectors.of(skeleton, anatomy)
    table = Table(title="balance shifts a minute")
    for heading in ("learned from", "recorded there", "in the other half", "generated"):
        table.add_column(heading, justify="left" if not table.columns else "right")
    ratios = []
    for number, recording in enumerate(recordings):
        pair = halves(recording)
        for name, own, other in (("first", *pair), ("second", *pair[::-1])):
            vectors = generated(IdleDatabase.of([own], kind), number, "recorded", SHIFTING_S)
            clip = Clip("generated", own.rate, kind.poses(vectors), root_motion=True)
            made = read_standing(clip, skeleton, anatomy)
            rates = [
                60.0 * len(each.shifts) * each.rate / len(each.vectors)
                for each in (own, other, made)
            ]
            table.add_row(f"{recording.name}, {name} half", *(f"{rate:.1f}" for rate in rates))
            if rates[1] > 0.0:
                ratios.append(rates[2] / rates[1])
    median, off = float(np.median(ratios)), [each for each in ratios if not 0.5 <= each <= 2.0]
    table.caption = (
        f"generated ÷ other half: median {median:.2f}, "
        f"{len(off)} of {len(ratios)} off by more than 2"
    )
    return table, 0.8 <= median <= 1.2 and not off


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
    kind = PostureVectors.of(*body)
    found = study(recordings, kind)
    table = Table(title=f"windows of {WINDOW_S:g} s of {len(files)} people, judged by classifiers")
    for heading in ("", "who (chance 12.5 %)", "95 %", "AUC against recorded", "95 %"):
        table.add_column(heading, justify="left" if not heading else "right")
    for name, results in found.items():
        row = [name]
        for values, style in ((results.named, "{:.0%}"), (results.unmasked, "{:.2f}")):
            if name == "recorded" and values is results.unmasked:
                row += ["", ""]
                continue
            low, high = bootstrap_interval(values)
            row += [style.format(values.mean()), f"{style} … {style}".format(low, high)]
        table.add_row(*row)
    console.print(table)
    named, real = found["generated"].named.mean(), found["recorded"].named.mean()
    unmasked = found["generated"].unmasked.mean()
    good = named >= 3 / 8 and abs(real - named) <= 0.1 and unmasked <= MAX_AUC
    table, within = histograms(recordings, kind)
    console.print(table)
    table, rested = shift_rates(recordings, character)
    console.print(table)
    line, fresh = repeats(recordings, kind)
    console.print(line)
    return int(not (good and within and fresh and rested))


if __name__ == "__main__":
    sys.exit(main())
