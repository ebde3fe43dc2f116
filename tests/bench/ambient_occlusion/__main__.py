"""Quality and time of ambient occlusion: `python -m tests.bench.ambient_occlusion`.

Prints, for pictures of `--size`:

1. The default settings against ray-traced pictures of the same surfaces, scene by scene. The
   constants were searched for on the scenes marked "tuned"; the gate counts the others.
2. What the program itself draws of the bundled characters at 1280×720, on the texels of the
   characters alone: the hardest part of a picture, with folds as wide as a texel.
3. All estimators, full and separable, with k = 5, 11 and 21, against the rays and against the full
   form; and how the patterns differ.
4. Table 3.1 of Huang 2013: times of the full and the separable form, blur included, and their fits.
   With software rendering they are CPU times of all threads: its timer query is the clock, which
   other programs slow down.

`--quick` leaves out the third part. Exits with 1 if the default settings miss a mean ΔE76 of 3 on
any scene that is held out, or a root mean squared error of 0.03 on a scene with a character or over
all of them.
"""

import argparse
import sys
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.workshop.reproduction.bodies.occlusion_timing import (
    THESIS_MS,
    OcclusionTiming,
    Variant,
    fit_line,
    measure,
)
from cubeling.characters.rendering import create_context, draws_in_software
from cubeling.characters.rendering.deferred.ambient_occlusion import ESTIMATORS
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.product import ProductQuality, product_quality
from tests.bench.ambient_occlusion.quality import (
    SAMPLES,
    SceneQuality,
    VariantQuality,
    scene_quality,
    variant_qualities,
)
from tests.bench.ambient_occlusion.scenes import CHARACTERS, HELD_OUT, TUNED, load
from tests.bench.ambient_occlusion.scoring import THESIS, TracedScene, buffer_of

MAX_RMSE, MAX_DELTA_E = 0.03, 3.0
"""The gate."""

RAYS = 128
"""Of the truth, for each pixel."""

COMPARED, COMPARED_SIZE, COMPARED_RAYS = ("balls", "boxes", "human"), (256, 192), 128
"""Scenes, size and rays of the third part: it draws 150 variants of each scene."""

TIMED = "spheres"
"""The scene of the fourth part: 48,000 triangles."""


def show_scenes(console: Console, qualities: list[SceneQuality]) -> None:
    """Print the first table."""
    table = Table(
        "scene",
        "",
        "nothing drawn",
        "noise of rays",
        "RMSE",
        "correlation",
        "ΔE76",
        "95 %",
        "of 648 samples",
        "character: RMSE",
        "ΔE76",
        title="Default settings against rays",
    )
    for each in qualities:
        body = each.character
        table.add_row(
            each.name,
            "tuned" if each.name in TUNED else "",
            f"{each.occluded:.3f}",
            f"{each.noise:.4f}",
            f"{each.all_pixels.rmse:.4f}",
            f"{each.all_pixels.correlation:.3f}",
            f"{each.all_pixels.delta_e:.2f}",
            f"{each.all_pixels.delta_e_95:.2f}",
            f"{each.dense.rmse:.4f}",
            "" if body is None else f"{body.rmse:.4f}",
            "" if body is None else f"{body.delta_e:.2f}",
        )
    console.print(table)


def gate(console: Console, qualities: list[SceneQuality]) -> bool:
    """Print whether the default settings are good enough, and return it."""
    held_out = [each for each in qualities if each.name in HELD_OUT]
    over_all = float(np.sqrt(np.mean([each.all_pixels.rmse**2 for each in held_out])))
    worst = max(each.all_pixels.delta_e for each in held_out)
    body = max(each.all_pixels.rmse for each in held_out if each.name in CHARACTERS)
    within = sum(each.all_pixels.rmse <= MAX_RMSE for each in held_out)
    console.print(
        f"Held out: RMSE {over_all:.4f} over all scenes, within {MAX_RMSE} in {within} of "
        f"{len(held_out)}; {body:.4f} at most with a character; greatest mean ΔE76 {worst:.2f}\n",
        soft_wrap=True,
    )
    return over_all <= MAX_RMSE and body <= MAX_RMSE and worst < MAX_DELTA_E


def show_product(console: Console, qualities: list[ProductQuality]) -> None:
    """Print the second table."""
    table = Table(
        "character",
        "texels",
        "surface apart [mm]",
        "nothing drawn",
        "RMSE",
        "correlation",
        "ΔE76",
        "95 %",
        title="The program's pictures against rays, characters alone",
    )
    for each in qualities:
        table.add_row(
            each.name,
            f"{each.texels}",
            f"{each.misplaced_mm:.5f}",
            f"{each.occluded:.3f}",
            f"{each.drawn.rmse:.4f}",
            f"{each.drawn.correlation:.3f}",
            f"{each.drawn.delta_e:.2f}",
            f"{each.drawn.delta_e_95:.2f}",
        )
    console.print(table)


def show_variants(console: Console, qualities: list[VariantQuality]) -> None:
    """Print the tables of the third part."""
    table = Table(
        "estimator",
        "k",
        "form",
        "samples",
        "RMSE to rays",
        "ΔE76",
        "95 %",
        "RMSE to full",
        "correlation",
        "ΔE76",
        "95 %",
        title=f"Estimators with Hammersley's pattern over {', '.join(COMPARED)}",
    )
    for each in qualities:
        if each.pattern == "hammersley":
            table.add_row(
                each.estimator,
                str(each.samples),
                "separable" if each.separable else "full",
                str(each.samples * (2 if each.separable else each.samples)),
                *_figures(each.truth.rmse, each.truth.delta_e, each.truth.delta_e_95),
                *(
                    (
                        f"{each.full.rmse:.4f}",
                        f"{each.full.correlation:.3f}",
                        f"{each.full.delta_e:.2f}",
                        f"{each.full.delta_e_95:.2f}",
                    )
                    if each.separable
                    else ("", "", "", "")
                ),
            )
    console.print(table)
    patterns = list(dict.fromkeys(each.pattern for each in qualities))
    table = Table("estimator", "k", *patterns, title="Patterns: RMSE of the separable form to rays")
    for name in ESTIMATORS:
        for samples in SAMPLES:
            found = {
                each.pattern: each.truth.rmse
                for each in qualities
                if (each.estimator, each.samples, each.separable) == (name, samples, True)
            }
            table.add_row(name, str(samples), *(f"{found[each]:.4f}" for each in patterns))
    console.print(table)


def show_times(console: Console, times: dict[Variant, OcclusionTiming], software: bool) -> None:
    """Print Table 3.1 from this machine, and its fits."""
    table = Table(
        "estimator",
        "k",
        "full [ms]",
        "separable [ms]",
        "times faster",
        "thesis",
        "on the clock [ms]",
        "timer query [ms]",
        title=f"Table 3.1: {TIMED}, {'CPU time of all threads' if software else 'timer query'}",
    )
    fits = Table("estimator", "form", "constant [ms]", "per sample [µs]", "R²", title="Fits")
    for name in ESTIMATORS:
        for samples in SAMPLES:
            pair = full, separable = times[name, samples, False], times[name, samples, True]
            thesis = THESIS_MS.get(name, {}).get(samples)
            table.add_row(
                name,
                str(samples),
                *(f"{each.main_ms(software):.1f}" for each in pair),
                f"{full.main_ms(software) / separable.main_ms(software):.2f}",
                "" if thesis is None else f"{thesis[0] / thesis[1]:.2f}",
                ", ".join(f"{each.wall_ms:.1f}" for each in pair),
                ", ".join(f"{each.query_ms:.1f}" for each in pair),
            )
        for separable_form, label in ((False, "full, in k²"), (True, "separable, in 2k")):
            counts = [each * (2 if separable_form else each) for each in SAMPLES]
            fit = fit_line(
                counts, [times[name, each, separable_form].main_ms(software) for each in SAMPLES]
            )
            fits.add_row(
                name,
                label,
                f"{fit.constant_ms:.1f}",
                f"{fit.slope_us:.0f}",
                f"{fit.r_squared:.4f}",
            )
    console.print(table)
    console.print(fits)


def _figures(rmse: float, *differences: float) -> tuple[str, ...]:
    return f"{rmse:.4f}", *(f"{each:.2f}" for each in differences)


def main() -> None:
    """Measure, print, and check the gate."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--size", default="512x384", help="WIDTHxHEIGHT [px]")
    parser.add_argument("--quick", action="store_true", help="leave out the third part")
    parser.add_argument("--characters", nargs="+", help="names or files: the second part of these")
    options = parser.parse_args()
    width, height = (int(each) for each in options.size.split("x"))
    console, context = Console(width=140), create_context()
    if options.characters:
        show_product(console, [product_quality(context, who, RAYS) for who in options.characters])
        context.release()
        return
    programs = ShaderPrograms(context)
    scenes = [TracedScene(load(name), (width, height), RAYS) for name in TUNED + HELD_OUT]
    qualities = [
        scene_quality(context, programs, scene, scene.scene.name in CHARACTERS) for scene in scenes
    ]
    show_scenes(console, qualities)
    good = gate(console, qualities)
    show_product(console, [product_quality(context, name, RAYS) for name in CHARACTERS])
    if not options.quick:
        show_variants(
            console,
            variant_qualities(context, programs, COMPARED, COMPARED_SIZE, COMPARED_RAYS),
        )
    timed = next(scene for scene in scenes if scene.scene.name == TIMED)
    buffer = buffer_of(context, timed)
    variants = {
        (name, samples, separable): replace(
            THESIS,
            estimator=name,
            samples=samples,
            lines=2 if separable else None,
            radius_m=timed.scene.radius_m,
        )
        for name in ESTIMATORS
        for samples in SAMPLES
        for separable in (False, True)
    }
    renderer = context.info["GL_RENDERER"]
    show_times(console, measure(context, programs, buffer, variants), draws_in_software(context))
    console.print(f"{width}×{height}, {renderer}", soft_wrap=True)
    buffer.release()
    programs.release()
    context.release()
    sys.exit(not good)


if __name__ == "__main__":
    main()
