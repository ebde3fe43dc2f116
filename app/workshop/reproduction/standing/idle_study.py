"""Section 3.3.2 of Egges 2006: whose idle motion is it, and is it recorded (specification S25).

People were asked there. Here classifiers judge: they are no people, and see other things.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.moods.colors import CURVE_STYLES, SECONDARY_COLOR
from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.reproduction.motion_graphs.summary import bootstrap_interval
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.app.workshop.reproduction.standing.people import read_people
from cubeling.app.workshop.study.bundled import whose_idle_motion
from cubeling.characters import Pose
from cubeling.characters.motion import (
    Array,
    IdleDatabase,
    IdleMotion,
    PostureSpace,
    PostureVectors,
    StandingRecording,
    find_rests,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WINDOW_S, GENERATED_S, LOOP_S, COMPONENTS = 5.0, 120.0, 8.0, 10
SEEDS = 3

RIDGE = 0.1
"""Part of the mean variance that is added to each variance of the classifiers."""


@dataclass(frozen=True)
class Judged:
    """How windows of one source were judged, a value for each person."""

    named: Array
    """How often the person is named rightly."""

    unmasked: Array
    """How well it is told from recorded motion of a person not seen before (AUC); 0.5 is chance."""

    recorded_right: Array
    """How often recorded windows are called recorded beside it."""

    made_right: Array
    """How often its own are called generated."""


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


def generated(
    database: IdleDatabase,
    seed: int,
    small: Literal["recorded", "extrema"],
    seconds: float = GENERATED_S,
) -> Array:
    """Return posture vectors of generated motion, (frames, size)."""
    motion = IdleMotion(database, seed, small)
    poses = [motion.sample(n / database.rate) for n in range(round(seconds * database.rate))]
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


def study(recordings: Sequence[StandingRecording], kind: PostureVectors) -> dict[str, Judged]:
    """Return how classifiers judge the windows of each source.

    Each recording is cut into halves. The database is learned from the first one, the classifiers
    from the second one, so that no frame is in both.
    """
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
        rows[name] = [
            np.concatenate(
                [features(make(first, database, n + 100 * k), space, rate) for k in range(SEEDS)]
            )
            for n, ((first, _), database) in enumerate(zip(pairs, databases, strict=True))
        ]
    found = {}
    for name, windows in rows.items():
        named = [
            float((naming.scores(own).argmax(1) == person).mean())
            for person, own in enumerate(windows)
        ]
        told = [
            _unmasked(real, windows, person) if name != "recorded" else (0.5, 0.5, 0.5)
            for person in range(len(windows))
        ]
        found[name] = Judged(np.array(named), *np.array(told).T)
    return found


def _unmasked(real: list[Array], made: list[Array], person: int) -> tuple[float, float, float]:
    """Return AUC and both rates of a classifier that learned from all other people."""
    others = [n for n in range(len(real)) if n != person]
    rows = np.concatenate([*(real[n] for n in others), *(made[n] for n in others)])
    count = sum(len(real[n]) for n in others)
    labels = (np.arange(len(rows)) >= count).astype(np.intp)
    judged = Discriminant(rows, labels).scores(np.concatenate([real[person], made[person]]))
    score = judged[:, 1] - judged[:, 0]
    fake = np.arange(len(judged)) >= len(real[person])
    return area(score, fake), float((score[~fake] <= 0).mean()), float((score[fake] > 0).mean())


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the printed rates beside those of classifiers."""
    people, kind = read_people(request.folder("idle"), request.progress)
    request.progress("judging windows")
    found = study(people, kind)
    generated, recorded = found["generated"], found["recorded"]
    (printed,) = whose_idle_motion.printed_tables()
    right = float(generated.recorded_right.mean()), float(generated.made_right.mean())
    ours = {
        "recorded called recorded": percent(right[0], 0),
        "generated called generated": percent(right[1], 0),
        "generated called recorded": percent(1 - right[1], 0),
        "recorded called generated": percent(1 - right[0], 0),
        "right in all": percent(sum(right) / 2),
        "d′": figure(whose_idle_motion.d_prime(*np.clip(right, 0.01, 0.99).tolist())),
        "person recognised": f"{percent(float(recorded.named.mean()), 0)}, "
        f"{percent(float(generated.named.mean()), 0)}",
        "by chance": percent(1 / len(people)),
    }
    rates = tuple((*row, ours.get(row[0], "–")) for row in printed.rows)
    sources = tuple(
        (
            name,
            _spread(each.named, percent),
            "" if name == "recorded" else _spread(each.unmasked, figure),
        )
        for name, each in found.items()
    )
    return Reproduction(
        (
            ReportTable(
                "Rates", ("rate", "printed", "printed: what follows", "classifiers"), rates
            ),
            ReportTable(
                f"Windows of {WINDOW_S:g} s, judged by classifiers",
                ("source", "person named (95 %)", "told from recorded: AUC (95 %)"),
                sources,
            ),
        ),
        f"{len(people)} people in 'idle', acted, 17 joints, retargeted to the human; intervals "
        "over the people, by the bootstrap",
        f"{whose_idle_motion.SUBJECTS} people judged films there; nobody was asked here. "
        "Linear discriminants see mean, spread, speed, acceleration and jerk of ten components: "
        "they know every person's habits by heart, and name more than people can, first in "
        "recorded and then in generated motion. Nothing judges gender here. AUC: 0.5 is chance; "
        "the learned half and the judged half share no frame. The last three sources are "
        "baselines: noise for each joint or component, and a repeated clip.",
        (DrawnFigure("How often the person is named, by source", partial(_draw, found)),),
    )


def _spread(values: Array, words: Callable[..., str]) -> str:
    low, high = bootstrap_interval(values)
    return f"{words(float(values.mean()))} ({words(low)} … {words(high)})"


def _draw(found: dict[str, Judged], sheet: "Figure") -> None:
    axes = sheet.subplots()
    for row, each in enumerate(found.values()):
        axes.plot(
            each.named,
            [row] * len(each.named),
            "o",
            color=CURVE_STYLES[2][0],
            alpha=0.5,
            label="a person" if not row else None,
        )
        axes.plot(
            each.named.mean(),
            row,
            "|",
            color="black",
            markersize=18,
            markeredgewidth=2.5,
            label="mean" if not row else None,
        )
    people, chance = whose_idle_motion.RECOGNISED, whose_idle_motion.CHANCE
    axes.axvline(people, color=SECONDARY_COLOR, label="printed: people")
    axes.axvline(chance, color=SECONDARY_COLOR, linestyle=":", label="chance")
    axes.set_yticks(range(len(found)), list(found))
    axes.set_xlabel("share of windows whose person is named")
    axes.set_xlim(0.0, 1.0)
    axes.invert_yaxis()
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
