"""Draws the picture of docs/rendering.md: `python -m tests.bench.ambient_occlusion.picture`."""

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.workshop.reproduction.bodies.occlusion_buffer import lab_difference
from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.deferred.ambient_occlusion import ESTIMATORS
from cubeling.characters.rendering.programs import ShaderPrograms
from tests.bench.ambient_occlusion.scenes import load
from tests.bench.ambient_occlusion.scoring import (
    THESIS,
    Floats,
    TracedScene,
    buffer_of,
    drawn,
)

PATH = Path(__file__).parents[3] / "docs" / "pictures" / "ambient-occlusion.jpg"

SIZE, RAYS, SAMPLES = (640, 480), 256, 11

SHOWN = {"human": (208, 40, 222, 390), "vleo": (196, 70, 258, 370), "boxes": (150, 170, 330, 250)}
"""Scenes, and the part of each picture that is shown: x, y, width, height [px]."""

COMPARED = "boxes"
"""The scene whose difference in CIE Lab is shown too: white is no difference, black `BLACK_DELTA_E`
or more."""

BLACK_DELTA_E = 30.0

COLUMN_PX, CAPTION_PX, GAP_PX = 240, 30, 4


def captioned(text: str, picture: Floats) -> NDArray[np.uint8]:
    """Return one column of a row: a picture of values 0…1 under its caption."""
    height = round(COLUMN_PX * picture.shape[0] / picture.shape[1])
    scaled = cv2.resize(picture, (COLUMN_PX, height), interpolation=cv2.INTER_CUBIC)
    column = np.full((height + CAPTION_PX + GAP_PX, COLUMN_PX + GAP_PX), 255, np.uint8)
    column[CAPTION_PX:-GAP_PX, :-GAP_PX] = np.clip(255 * scaled, 0, 255).round()
    cv2.putText(column, text, (4, 21), cv2.FONT_HERSHEY_SIMPLEX, 0.55, 0, 1, cv2.LINE_AA)
    return column


def main() -> None:
    """Draw the scenes as the rays and as each estimator sees them."""
    context = create_context()
    programs = ShaderPrograms(context)
    rows = []
    for name, (x, y, width, height) in SHOWN.items():
        traced = TracedScene(load(name), SIZE, RAYS)
        buffer = buffer_of(context, traced)
        part = np.s_[y : y + height, x : x + width]
        columns = [captioned("ray-traced", traced.truth[part])]
        differences = [captioned("Lab difference:", np.ones_like(traced.truth[part]))]
        for estimator in ESTIMATORS:
            settings = replace(
                THESIS,
                estimator=estimator,
                samples=SAMPLES,
                radius_m=traced.scene.radius_m,
            )
            found = drawn(context, programs, buffer, settings)
            error = (found - traced.truth)[traced.surfaces.seen]
            rmse = float(np.sqrt(np.mean(error**2)))
            columns.append(captioned(f"{estimator}: {rmse:.3f}", found[part]))
            difference = lab_difference(found, traced.truth)
            mean = float(difference[traced.surfaces.seen].mean())
            shown = (1.0 - difference[part] / BLACK_DELTA_E).astype(np.float32)
            differences.append(captioned(f"mean {mean:.1f}", shown))
        buffer.release()
        rows.append(np.hstack(columns))
        if name == COMPARED:
            rows.append(np.hstack(differences))
    cv2.imwrite(str(PATH), np.vstack(rows), (cv2.IMWRITE_JPEG_QUALITY, 90))
    Console().print(f"{PATH.name}: {PATH.stat().st_size / 1e3:.0f} kB")
    programs.release()
    context.release()


if __name__ == "__main__":
    main()
