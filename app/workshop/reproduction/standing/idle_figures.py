"""Figures 3.8 and 3.12 of Egges 2006: a person's balance shifts, and her small variations."""

from collections.abc import Callable
from functools import partial

import numpy as np

from cubeling.app.workshop.pages.report_table import ReportTable, figure
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.app.workshop.reproduction.standing.idle_study import generated, perlin
from cubeling.app.workshop.reproduction.standing.people import read_people
from cubeling.characters import Character, Clip
from cubeling.characters.motion import (
    Array,
    IdleDatabase,
    PostureVectors,
    StandingRecording,
    StretchStream,
    VariationStream,
    read_standing,
)

PEOPLE, GENERATED_S, VARIED_S = 4, 300.0, 120.0
"""People that are measured; seconds of generated motion, and of small variations alone."""


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return recorded and generated shifts and variations, and the plot of one person."""
    human = Character.load("human")
    people, kind = read_people(request.folder("idle"), request.progress, PEOPLE)
    databases = [IdleDatabase.of([each], kind) for each in people]
    shifts, variations = [], []
    for number, (person, database) in enumerate(zip(people, databases, strict=True)):
        request.progress(person.name)
        vectors = generated(database, number, "recorded", GENERATED_S)
        clip = Clip("generated", person.rate, kind.poses(vectors), root_motion=True)
        made = read_standing(clip, human.skeleton, human.anatomy)
        shifts.append((person.name, *_shift_cells(person), *_shift_cells(made)))
        variations.append((person.name, *_variation_cells(database, kind, number)))
    differences = [[float(cell) for cell in row[1:]] for row in variations]
    nearer = [sum(row[kind] < row[2] for row in differences) for kind in (0, 1)]
    from cubeling.app.workshop.idle_plot import draw

    return Reproduction(
        (
            ReportTable(
                "Figure 3.8: balance shifts",
                (
                    *("person", "recorded: shifts a minute", "median rest [s]"),
                    *("generated: shifts a minute", "median rest [s]"),
                ),
                tuple(shifts),
            ),
            ReportTable(
                "Small variations while resting: how joints go together, difference from recorded",
                ("person", "ours", "extrema as published", "Perlin's noise for each joint"),
                tuple(variations),
            ),
        ),
        f"{len(people)} people in 'idle', acted; {GENERATED_S / 60:.0f} generated minutes each",
        "The plotted and tabulated numbers of figures 3.8 to 3.12 are lost, but for the mean of a "
        "component, 0.045, which depends on person and base posture. Differences are those of the "
        "matrices of correlations of all values (Frobenius, 0 is alike); the thesis says, "
        "without a number, that its noise keeps how joints go together and Perlin's does not. "
        f"Nearer than Perlin's are ours in {nearer[0]} of {len(people)}, its own extrema in "
        f"{nearer[1]}.",
        (
            DrawnFigure(
                f"Figures 3.8 and 3.12, ours: {people[0].name}; arrows show how often which "
                "balance follows",
                partial(_draw, draw, databases[0]),
                (11.5, 8.2),
            ),
        ),
    )


def _shift_cells(recording: StandingRecording) -> tuple[str, str]:
    seconds = len(recording.vectors) / recording.rate
    rests = [(rest.end - rest.first) / recording.rate for rest in recording.rests]
    return f"{60.0 * len(recording.shifts) / seconds:.1f}", f"{np.median(rests):.1f}"


def _variation_cells(database: IdleDatabase, kind: PostureVectors, seed: int) -> tuple[str, ...]:
    """Return how far the correlations of each kind of variations are from the recorded ones."""
    count, rate = round(VARIED_S * database.rate), database.rate
    stretches = StretchStream(database.stretches, np.random.default_rng(seed))
    extrema = VariationStream(database.variations, database.space, np.random.default_rng(seed))
    times = [number / rate for number in range(count)]
    made = {
        "ours": np.stack([stretches.at(each) for each in times]),
        "extrema": np.stack([extrema.at(each) for each in times]),
        "Perlin": perlin(count, kind.size, rate, np.random.default_rng(seed)),
    }
    recorded = _correlations(np.concatenate([rest - rest.mean(0) for rest in database.rests]))
    return tuple(
        figure(float(np.linalg.norm(_correlations(each) - recorded)), 1) for each in made.values()
    )


def _correlations(vectors: Array) -> Array:
    """Return the correlations of the values of posture vectors; 0 where one is still."""
    moved = vectors - vectors.mean(0)
    spread = moved.std(0)
    scaled = np.where(spread > 1e-6, moved / np.maximum(spread, 1e-6), 0.0)
    found: Array = scaled.T @ scaled / len(scaled)
    return found


def _draw(draw: Callable[..., None], database: IdleDatabase, figure: object) -> None:
    draw(figure, database)
