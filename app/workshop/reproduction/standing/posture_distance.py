"""Figures 3.3 to 3.6 of Egges 2006: few components of a posture find its nearest neighbour (S5)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.workshop.idle_plot import body_of
from cubeling.app.workshop.moods.colors import CURVE_STYLES, SECONDARY_COLOR
from cubeling.app.workshop.pages.report_table import ReportTable, figure, percent
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.characters import Character, CharacterError, Clip, read_motions
from cubeling.characters.motion import Array, PostureSpace, PostureVectors
from cubeling.characters.rendering import PortraitRenderer, create_context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SETS = (
    ("two who stand", ("idle/007_acted.bvh", "idle/011_acted.bvh")),
    ("two others", ("idle/003_acted.bvh", "idle/014_acted.bvh")),
    ("walking and running", ("cmu-mocap/02", "cmu-mocap/16/16_17.amc", "cmu-mocap/49")),
    ("gestures", ("bvh/wave_hello.bvh", "bvh/zombie.bvh", "bvh/131_03.bvh", "bvh/131_01.bvh")),
)
"""Four sets of recordings, as there are in the thesis."""

FRAMES = 800
"""Postures of each set, evenly spread: 600 to 1,000 in the thesis."""

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


def posture_sets(request: ReproductionRequest) -> tuple[PostureVectors, dict[str, list[Clip]]]:
    """Return what posture vectors hold, and the clips of each set on the human; raises AppError."""
    human = Character.load("human")
    found: dict[str, list[Clip]] = {}
    for name, files in SETS:
        request.progress(f"reading {name}")
        paths = [request.folder(each.partition("/")[0]) / each.partition("/")[2] for each in files]
        try:
            found[name] = read_motions([str(path) for path in paths], human)
        except CharacterError as error:
            raise AppError(str(error)) from error
    return PostureVectors.of(human.skeleton, human.anatomy), found


def postures_of(kind: PostureVectors, clips: Sequence[Clip]) -> Array:
    """Return posture vectors of clips, evenly spread over them, (`FRAMES`, size)."""
    rows = np.concatenate([kind.vectors(clip.in_place) for clip in clips])
    found: Array = rows[np.linspace(0, len(rows) - 1, FRAMES).astype(int)]
    return found


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return success and errors by the number of components, beside what the thesis says."""
    kind, clips = posture_sets(request)
    chosen = [postures_of(kind, own) for own in clips.values()]
    space = PostureSpace.of(np.concatenate(chosen))
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
        f"four sets of {FRAMES} postures, of 'idle', 'cmu-mocap' and 'bvh': "
        f"{', '.join(name for name, _ in SETS)}; {kind.size} values each",
        "Other people. The thesis weights components by their variances, as in the second table "
        "(equation 3.7; in Egges et al. 2004, over the first one). How many of ten succeed depends "
        "on how varied the postures are: of people who only stand, more do. The printed bounds are "
        "for those weights; errors of the other tables are in other units. Consecutive frames are "
        "in a set, as there.",
        (
            DrawnFigure(
                "Figures 3.3 to 3.5: success, mean and greatest error by the number of components",
                partial(_draw_curves, curves),
            ),
            DrawnFigure(
                "Figure 3.6: pairs of postures at the printed distances, weights: variances",
                partial(_draw_pairs, kind, chosen[0], coordinates[0] * np.sqrt(space.variances)),
                (8.8, 2.2),
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


def _draw_pairs(kind: PostureVectors, vectors: Array, rows: Array, sheet: "Figure") -> None:
    """Draw pairs of postures, (n, size), whose weighted coordinates are so far apart."""
    body = body_of(kind.skeleton)
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
