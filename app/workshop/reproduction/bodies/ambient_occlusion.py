"""Table 3.1 and figure 3.10 of Huang 2013: ambient occlusion in full and in separable form."""

from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from cubeling.app.workshop.moods.colors import CURVE_STYLES, SECONDARY_COLOR
from cubeling.app.workshop.pages.report_table import ReportTable, figure
from cubeling.app.workshop.reproduction.bodies.occlusion_buffer import (
    Floats,
    GBuffer,
    lab_difference,
)
from cubeling.app.workshop.reproduction.bodies.occlusion_timing import (
    THESIS_MS,
    Fit,
    Variant,
    fit_line,
    measure,
)
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest
from cubeling.characters.motion import Array
from cubeling.characters.rendering import (
    AmbientOcclusion,
    AmbientOcclusionSettings,
    ShaderPrograms,
    create_context,
    draws_in_software,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE_PX, SOFTWARE_SIZE_PX = (1024, 768), (512, 384)
"""Size of the pictures, as printed; and where the processor draws, which takes long."""

TIMED_ROUNDS = 3
SAMPLE_COUNTS = (5, 11, 21)
"""k: samples on a line."""

SETTINGS = AmbientOcclusionSettings(pattern_size=4, blur_size=4, radius_m=0.7)
"""Tile and blur of the thesis, in a scene of metres."""

SHOWN = "hbao", 21
"""Estimator and k of the pictures."""

FOCAL_SHARE, EYE_M, PITCH = 0.95, np.array([0.0, 1.5, -3.4]), 0.35
"""Focal length over the width of the picture, where the camera is, and how far it looks down
[rad]."""


@dataclass(frozen=True)
class SeenSpheres:
    """Spheres on a floor as a camera sees them, exactly: `Surfaces`."""

    normal_id: Floats
    position: Floats

    @property
    def flat_normal(self) -> Floats:
        """The normals: there are no triangles."""
        return self.normal_id[..., :3]

    @staticmethod
    def of(size: tuple[int, int], seed: int = 1) -> "SeenSpheres":
        """Return fifteen spheres, some of them afloat or sunk in, as in the benchmark."""
        width, height = size
        rng = np.random.default_rng(seed)
        focal = FOCAL_SHARE * width
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        rays = np.stack([(x - width / 2) / focal, (y - height / 2) / focal, np.ones_like(x)], -1)
        # The camera looks down: up, and from there to the floor, in its frame.
        up = np.array([0.0, -np.cos(PITCH), -np.sin(PITCH)])
        ahead = np.array([0.0, -np.sin(PITCH), np.cos(PITCH)])
        right = np.array([1.0, 0.0, 0.0])

        def placed(at: Array) -> Array:
            """Return a point of the room in the camera frame."""
            moved = at - EYE_M
            found: Array = moved[0] * right + moved[1] * up + moved[2] * ahead
            return found

        depth = np.full((height, width), np.inf)
        normals, numbers = np.zeros((height, width, 3)), np.zeros((height, width))
        down = rays @ up
        floor = np.where(down < 0.0, -EYE_M[1] / np.minimum(down, -1e-9), np.inf)
        on_floor = floor < 12.0
        depth[on_floor], normals[on_floor], numbers[on_floor] = floor[on_floor], up, 1
        for number in range(15):
            radius = rng.uniform(0.12, 0.45)
            across, away = rng.uniform(-1.4, 1.4), rng.uniform(-1.4, 1.2)
            center = placed(np.array([across, radius * rng.uniform(0.5, 1.6), away]))
            along = (rays @ center) / (rays**2).sum(-1)
            off = np.linalg.norm(along[..., None] * rays - center, axis=-1)
            half = np.sqrt(np.maximum(radius**2 - off**2, 0.0)) / np.linalg.norm(rays, axis=-1)
            hit = (off < radius) & (along - half < depth) & (along - half > 0.0)
            depth[hit] = (along - half)[hit]
            normals[hit] = (depth[hit][:, None] * rays[hit] - center) / radius
            numbers[hit] = number + 2
        seen = np.isfinite(depth)
        position = np.where(seen, depth, 0.0)[..., None] * rays
        return SeenSpheres(
            np.concatenate([normals, numbers[..., None]], -1).astype(np.float32),
            np.concatenate([position * seen[..., None], np.zeros((height, width, 1))], -1).astype(
                np.float32
            ),
        )


def variants() -> dict[Variant, AmbientOcclusionSettings]:
    """Return what the table has: each estimator, k and form."""
    return {
        (name, samples, separable): replace(
            SETTINGS, estimator=name, samples=samples, lines=2 if separable else None
        )
        for name in THESIS_MS
        for samples in SAMPLE_COUNTS
        for separable in (False, True)
    }


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return times and fits of this machine beside the printed ones, and both forms' pictures."""
    request.progress("drawing")
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        software = draws_in_software(context)
        renderer = context.info["GL_RENDERER"]
        size = SOFTWARE_SIZE_PX if software else SIZE_PX
        surfaces = SeenSpheres.of(size)
        programs = ShaderPrograms(context)
        closing.callback(programs.release)
        buffer = GBuffer(context, surfaces, FOCAL_SHARE * size[0])
        closing.callback(buffer.release)
        times = measure(context, programs, buffer, variants(), TIMED_ROUNDS)
        pictures = {}
        for separable in (False, True):
            effect = AmbientOcclusion(context, programs, variants()[*SHOWN, separable])
            pictures[separable] = buffer.draw(effect)
            effect.release()
    seen = surfaces.normal_id[..., 3] > 0.5
    apart = np.where(seen, lab_difference(pictures[False], pictures[True]), 0.0)
    took = {key: each.main_ms(software) for key, each in times.items()}
    differences = (
        ("mean ΔE76", "low", figure(float(apart[seen].mean()))),
        ("95th percentile", "", figure(float(np.percentile(apart[seen], 95)))),
    )
    name, samples = SHOWN
    return Reproduction(
        (
            _times(took),
            _fits(took),
            ReportTable(
                f"Figure 3.10: full and separable form, {name}, k = {samples}",
                ("", "printed", "ours"),
                differences,
            ),
        ),
        f"fifteen spheres on a floor, {size[0]}×{size[1]}, {renderer}; the blur is in it; "
        f"{'time of all cores' if software else 'by timer queries'}, the least of {TIMED_ROUNDS}",
        "Printed: a GeForce GTX 480, 1024×768, scenes of 50,000 triangles; the time depends on the "
        "picture, not on them. Compare how much faster the separable form is, and that it grows "
        "with k where the full one grows with k². "
        + ("Here the processor draws, and on fewer pixels. " if software else "")
        + 'Of figure 3.10, made by Yee\'s measure, only "remains low" is printed; ours is ΔE76.',
        (
            DrawnFigure(
                "Table 3.1: time by k, over that of the full form with k = 5",
                partial(_draw_times, took),
            ),
            DrawnFigure(
                f"Figure 3.10: {name}, k = {samples}; full, separable, and their difference "
                "in Lab (white: none)",
                partial(_draw_pictures, pictures, apart),
                (8.8, 2.4),
            ),
        ),
    )


def _times(took: Mapping[Variant, float]) -> ReportTable:
    rows = []
    for name, printed in THESIS_MS.items():
        for samples, (full_ms, separable_ms) in printed.items():
            full, separable = took[name, samples, False], took[name, samples, True]
            rows.append(
                (
                    f"{name}, k = {samples}",
                    *(f"{full_ms:.1f}", f"{full:.1f}"),
                    *(f"{separable_ms:.1f}", f"{separable:.1f}"),
                    *(f"{full_ms / separable_ms:.2f}", f"{full / separable:.2f}"),
                )
            )
    columns = (
        *("estimator", "printed full [ms]", "ours", "printed separable [ms]", "ours"),
        *("printed times faster", "ours"),
    )
    return ReportTable("Table 3.1", columns, tuple(rows))


def _fits(took: Mapping[Variant, float]) -> ReportTable:
    rows = []
    for name, printed in THESIS_MS.items():
        for separable, words in ((False, "full, by k²"), (True, "separable, by 2k")):
            counts = [each * (2 if separable else each) for each in SAMPLE_COUNTS]
            theirs = fit_line(counts, [printed[each][separable] for each in SAMPLE_COUNTS])
            ours = fit_line(counts, [took[name, each, separable] for each in SAMPLE_COUNTS])
            rows.append((f"{name}, {words}", *_fit_cells(theirs, ours)))
    columns = (
        *("straight line", "printed: constant [ms]", "ours"),
        *("printed: each sample [µs]", "ours", "printed: R²", "ours"),
    )
    return ReportTable("Time by the samples of a pixel", columns, tuple(rows))


def _fit_cells(theirs: Fit, ours: Fit) -> tuple[str, ...]:
    pairs = (
        (figure(theirs.constant_ms), figure(ours.constant_ms)),
        (figure(theirs.slope_us, 0), figure(ours.slope_us, 0)),
        (figure(theirs.r_squared, 4), figure(ours.r_squared, 4)),
    )
    return tuple(cell for both in pairs for cell in both)


def _draw_times(took: Mapping[Variant, float], sheet: "Figure") -> None:
    panels = sheet.subplots(1, len(THESIS_MS), sharey=True)
    for axes, (name, printed) in zip(panels, THESIS_MS.items(), strict=True):
        for separable, marker in ((False, "o"), (True, "s")):
            form = "separable" if separable else "full"
            theirs = [printed[each][separable] / printed[5][0] for each in SAMPLE_COUNTS]
            ours = [took[name, each, separable] / took[name, 5, False] for each in SAMPLE_COUNTS]
            axes.plot(
                SAMPLE_COUNTS,
                theirs,
                marker,
                linestyle="-",
                color=SECONDARY_COLOR,
                label=f"printed, {form}",
            )
            axes.plot(
                SAMPLE_COUNTS,
                ours,
                marker,
                linestyle="--",
                color=CURVE_STYLES[2 if separable else 1][0],
                label=f"ours, {form}",
            )
        axes.set_title(name)
        axes.set_xticks(SAMPLE_COUNTS)
        axes.set_xlabel("k")
    panels[0].set_yscale("log")
    panels[0].yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    panels[0].set_ylabel("time ÷ that of full, k = 5")
    panels[0].legend(fontsize=8)


def _draw_pictures(pictures: Mapping[bool, Floats], apart: Array, sheet: "Figure") -> None:
    full, separable, difference = sheet.subplots(1, 3)
    for axes, separable_form, title in ((full, False, "full"), (separable, True, "separable")):
        axes.imshow(pictures[separable_form], cmap="gray", vmin=0.0, vmax=1.0)
        axes.set_title(title)
    shown = difference.imshow(apart, cmap="gray_r", vmin=0.0, vmax=20.0)
    difference.set_title("ΔE76")
    sheet.colorbar(shown, ax=difference)
    for axes in (full, separable, difference):
        axes.set_axis_off()
