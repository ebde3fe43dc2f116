"""Quality of ambient occlusion: `python -m tests.bench.ambient_occlusion`.

Prints, for pictures of `--size`:

1. The default settings against ray-traced pictures of the same surfaces, scene by scene. The
   constants were searched for on the scenes marked "tuned"; the gate counts the others.
2. What the program itself draws of the bundled characters at 1280×720, on the texels of the
   characters alone: the hardest part of a picture, with folds as wide as a texel.
3. All estimators, full and separable, with k = 5, 11 and 21, against the rays and against the full
   form; and how the patterns differ.

Times, Table 3.1 of Huang 2013, are those of `cubeling reproduce ambient-occlusion`.

`--quick` leaves out the third part. Exits with 1 if the default settings miss a mean ΔE76 of 3 on
any scene that is held out, or a root mean squared error of 0.03 on a scene with a character or over
all of them.
"""

import argparse
import sys

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.rendering import create_context
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
from tests.bench.ambient_occlusion.scoring import TracedScene

MAX_RMSE, MAX_DELTA_E = 0.03, 3.0
"""The gate."""

RAYS = 128
"""Of the truth, for each pixel."""

COMPARED, COMPARED_SIZE, COMPARED_RAYS = ("balls", "boxes", "human"), (256, 192), 128
"""Scenes, size and rays of the third part: it draws 150 variants of each scene."""


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
    programs.release()
    context.release()
    sys.exit(not good)


if __name__ == "__main__":
    main()
