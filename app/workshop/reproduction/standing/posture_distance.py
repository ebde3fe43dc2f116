"""Figures 3.3 to 3.6 of Egges 2006: few components of a posture find its nearest neighbour (S5)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.idle_plot import body_of
from cubeling.app.workshop.moods.colors import CURVE_STYLES, SECONDARY_COLOR
from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.reproduction.result import Plot, Reproduction, ReproductionRequest
from cubeling.app.workshop.reproduction.standing.people import read_people
from cubeling.characters.motion import Array, PostureSpace, PostureVectors
from cubeling.characters.rendering import PortraitRenderer, create_context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SETS, FRAMES = 4, 800
"""Sets of postures, of different clips, and postures of each: 600 to 1,000 in the thesis."""

CHOSEN, PRINTED = 10, ("about 80 %", "< 0.1", "< 0.4")
"""Components that are enough, and what they give: success, mean and maximum of the error."""

COLUMNS = (
    *("components", "printed success", "ours", "printed mean error", "ours"),
    *("printed greatest error", "ours"),
)

SHOWN = (1, 2, 5, 10, 20, 40)
"""Components in the table, besides all."""

WEIGHTS = {"one": "none", "eigen": "variances", "eigen_norm": "variances ÷ the first"}
"""Weights of the components, and what they are called."""

DISTANCES = {
    0.1: "almost invisible",
    0.4: "visible, minor",
    0.7: "significantly different",
    1.0: "significantly different",
}
"""How far apart the postures of the pairs in figure 3.6 are, and how they look there."""

PORTRAIT_PX = (130, 210)


@dataclass(frozen=True)
class NeighbourCurves:
    """What each number of components finds, over all sets, (components,)."""

    success: Array
    """Share of postures whose nearest other one is found."""

    mean_error: Array
    """Mean of the full distance between the found and the nearest posture."""

    max_error: Array
    """Greatest distance of a found posture from the nearest one."""


def neighbour_curves(sets: Sequence[Array]) -> NeighbourCurves:
    """Return the curves for sets of weighted coordinates, (postures, components)."""
    success, mean, most = [], [], []
    full = [_squares(own) for own in sets]
    running = [np.zeros_like(each) for each in full]
    nearest = [_nearest(each) for each in full]
    for number in range(sets[0].shape[1]):
        right, errors = [], []
        for own, whole, sums, best in zip(sets, full, running, nearest, strict=True):
            sums += np.subtract.outer(own[:, number], own[:, number]) ** 2
            found = _nearest(sums)
            right.append(found == best)
            errors.append(np.sqrt(whole[best, found]))
        success.append(np.concatenate(right).mean())
        mean.append(np.concatenate(errors).mean())
        most.append(np.concatenate(errors).max())
    return NeighbourCurves(np.array(success), np.array(mean), np.array(most))


def _squares(rows: Array) -> Array:
    squares = (rows**2).sum(1)
    found: Array = np.maximum(squares[:, None] + squares - 2.0 * rows @ rows.T, 0.0)
    np.fill_diagonal(found, 0.0)  # which rounding leaves near it
    return found


def _nearest(squares: Array) -> NDArray[np.intp]:
    """Return the nearest other row of each; the diagonal is left out."""
    found: NDArray[np.intp] = (squares + np.diag(np.full(len(squares), np.inf))).argmin(1)
    return found


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return success and errors by the number of components, beside what the thesis says."""
    people, kind = read_people(request.folder("idle"), request.progress, SETS)
    chosen = [
        each.vectors[np.linspace(0, len(each.vectors) - 1, FRAMES).astype(int)] for each in people
    ]
    space = PostureSpace.of(np.concatenate([each.vectors for each in people]))
    coordinates = [space.project(each) for each in chosen]
    curves: dict[str, NeighbourCurves] = {}
    for mode in WEIGHTS:
        request.progress(f"weights: {WEIGHTS[mode]}")
        roots = np.sqrt(space.weights(mode))  # type: ignore[arg-type]
        curves[mode] = neighbour_curves([each * roots for each in coordinates])
    tables = tuple(
        ReportTable(f"Nearest neighbours, weights: {WEIGHTS[mode]}", COLUMNS, _rows(own))
        for mode, own in curves.items()
    )
    return Reproduction(
        tables,
        f"{len(people)} of the people in 'idle', {FRAMES} postures each, {kind.size} values",
        "Other people, acted, with 17 recorded joints: a third of the components is nearly 0. "
        "Weighted by their variances, ten components find nearly every neighbour; the printed "
        "80 % are nearer to no weights at all (specification, S5). Errors with weights are in "
        "other units than the printed ones. Consecutive frames are in a set, as there.",
        (
            Plot(
                "Figures 3.3 to 3.5: success, mean and greatest error by the number of components",
                partial(_draw_curves, curves),
            ),
            Plot(
                "Figure 3.6: pairs of postures at the printed distances (no weights)",
                partial(_draw_pairs, kind, chosen, coordinates),
                (8.8, 3.0),
            ),
        ),
    )


def _rows(curves: NeighbourCurves) -> tuple[tuple[str, ...], ...]:
    rows = []
    for count in (*SHOWN, len(curves.success)):
        printed = PRINTED if count == CHOSEN else ("", "", "")
        ours = (
            percent(float(curves.success[count - 1])),
            figure(float(curves.mean_error[count - 1]), 3),
            figure(float(curves.max_error[count - 1]), 3),
        )
        pairs = zip(printed, ours, strict=True)
        rows.append((f"{count}", *(cell for both in pairs for cell in both)))
    return tuple(rows)


def _draw_curves(curves: Mapping[str, NeighbourCurves], sheet: "Figure") -> None:
    panels = sheet.subplots(1, 3)
    for (mode, own), (color, dashes) in zip(curves.items(), CURVE_STYLES, strict=False):
        for axes, values in zip(panels, (own.success, own.mean_error, own.max_error), strict=True):
            axes.plot(
                np.arange(1, len(values) + 1),
                values,
                color=color,
                linestyle=(0, dashes or None),
                label=f"weights: {WEIGHTS[mode]}",
            )
    for axes, name, printed in zip(
        panels, ("success", "mean error", "greatest error"), (0.8, 0.1, 0.4), strict=True
    ):
        axes.plot([CHOSEN], [printed], "o", color=SECONDARY_COLOR, label="printed, 10 components")
        axes.set_xlabel("components")
        axes.set_title(name)
    panels[0].legend(loc="lower right", fontsize=8)


def _draw_pairs(
    kind: PostureVectors, chosen: Sequence[Array], coordinates: Sequence[Array], sheet: "Figure"
) -> None:
    body = body_of(kind.skeleton)
    vectors, rows = chosen[0], coordinates[0]
    apart = np.sqrt(_squares(rows))
    poses = []
    for wanted in DISTANCES:
        one, other = np.unravel_index(np.abs(apart - wanted).argmin(), apart.shape)
        poses += [kind.poses(vectors[one]), kind.poses(vectors[other])]
    context = create_context()
    renderer = PortraitRenderer(context, PORTRAIT_PX)
    try:
        pictures = renderer.portraits(body, poses, azimuth=0.0)
    finally:
        renderer.release()
        context.release()
    for axes, number, (wanted, words) in zip(
        sheet.subplots(1, len(DISTANCES)), range(len(DISTANCES)), DISTANCES.items(), strict=True
    ):
        pair = np.concatenate(pictures[2 * number : 2 * number + 2], axis=1)
        axes.imshow(cv2.cvtColor(pair, cv2.COLOR_BGR2RGB))
        axes.set_axis_off()
        axes.set_title(f"e = {wanted:g}\nprinted: {words}", fontsize=8.5)
