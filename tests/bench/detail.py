"""How a character with fewer triangles looks: `python -m tests.bench.detail [-o FOLDER] [NAME …]`.

Characters, the bundled ones if none is named, walk under a camera, seen from two sides, as high as
the first column says. The picture is compared with that of the finest triangles: the root mean
square difference, of 255, and the share of pixels that differ by more than 25, both over the pixels
of the character. The bundled ones and the views are our own: an upper bound of how well others do.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character
from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.rendering import (
    QUALITIES,
    CameraView,
    Quality,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.characters.rendering.geometry.detail_levels import with_levels
from cubeling.characters.rendering.geometry.vertices import CharacterVertices

TURNS = (0.4, 2.4)
"""Where the camera is, seen from the character [rad]."""

FOCAL_PX, DISTANCE_M, PITCH = 900.0, 0.6, np.deg2rad(25.0)
"""The camera: its focal length, how far away the character is, and how much it looks down [rad]."""

VISIBLE = 8.0
"""Difference from the empty picture from which on a pixel is the character's, of 255."""

MUCH = 25.0
"""Difference that is counted, of 255."""


@dataclass(frozen=True)
class Comparison:
    """The same view with fewer triangles, and with all."""

    coarse: NDArray[np.uint8]
    """(height, width, 3) BGR."""

    fine: NDArray[np.uint8]
    """(height, width, 3) BGR."""

    rms: float
    """Root mean square difference over the character's pixels, of 255."""

    much: float
    """Share of these pixels that differ by more than `MUCH`."""

    triangles: int
    """Number of triangles that were left."""


def compared(
    context: moderngl.Context, character: Character, height_px: int, quality: Quality
) -> list[Comparison]:
    """Return how a character of some height [px] looks, seen from all sides in `TURNS`."""
    side = height_px + 120
    matrix = np.array([[FOCAL_PX, 0, side / 2], [0, FOCAL_PX, side / 2], [0, 0, 1.0]])
    height = height_px * DISTANCE_M / FOCAL_PX
    table = np.eye(4)
    table[1, 1:3] = -np.cos(PITCH), np.sin(PITCH)
    table[2, 1:3] = -np.sin(PITCH), -np.cos(PITCH)
    table[:3, 3] = 0.0, 0.5 * height, DISTANCE_M
    view = CameraView(
        np.full((side, side, 3), (150, 170, 160), np.uint8), matrix, np.zeros(5), table
    )
    stage = Stage(context, (side, side))
    stage.quality = quality
    actors = [_walker(character, height / character.height, turn) for turn in TURNS]
    coarse = [stage.draw(view, [actor]) for actor in actors]
    triangles = stage.triangles
    stage.quality = replace(quality, max_error_px=0.0)
    fine = [stage.draw(view, [actor]) for actor in actors]
    empty = stage.draw(view, []).astype(float)
    stage.release()
    return [
        Comparison(*pair, *_difference(*pair, empty), triangles)
        for pair in zip(coarse, fine, strict=True)
    ]


def _walker(character: Character, scale: float, turn: float) -> SceneCharacter:
    clip = character.clips.get("Walk") or next(iter(character.clips.values()))
    cos, sin = scale * np.cos(turn), scale * np.sin(turn)
    place = np.diag([cos, scale, cos, 1.0])
    place[0, 2], place[2, 0] = sin, -sin
    pose = clip.sample(0.3 * clip.duration)
    return SceneCharacter(character, PosedCharacter(pose, place, True, "walk", 0.0, 0.0, 0.0, 0.0))


def _difference(
    coarse: NDArray[np.uint8], fine: NDArray[np.uint8], empty: NDArray[np.float64]
) -> tuple[float, float]:
    difference = coarse.astype(float) - fine
    seen = np.maximum(np.abs(coarse - empty), np.abs(fine - empty)).max(axis=2) > VISIBLE
    off = difference[seen]
    return float(np.sqrt((off**2).mean())), float((np.abs(off).max(axis=1) > MUCH).mean())


def _seconds(character: Character) -> float:
    """Return the least CPU time that finding the levels of detail takes [s]."""
    vertices, times = CharacterVertices.of(character.meshes), []
    for _ in range(3):
        start = time.process_time()
        with_levels(vertices)
        times.append(time.process_time() - start)
    return min(times)


def _side_by_side(pairs: Sequence[Comparison]) -> NDArray[np.uint8]:
    """Return fewer triangles, all, and four times the difference, three times as large."""
    rows = [
        np.hstack([p.coarse, p.fine, cv2.convertScaleAbs(cv2.absdiff(p.coarse, p.fine), alpha=4)])
        for p in pairs
    ]
    large = cv2.resize(np.vstack(rows), None, fx=3, fy=3, interpolation=cv2.INTER_NEAREST)
    return np.asarray(large, np.uint8)


def main() -> None:
    """Print a row for each character, height and quality."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for enlarged pictures")
    parser.add_argument(
        "characters",
        nargs="*",
        default=Character.bundled_names(),
        help="names or files of characters",
    )
    options = parser.parse_args()
    headings = (
        "character",
        "height [px]",
        "quality",
        "triangles",
        "RMS",
        "more than 25",
        "levels, CPU",
    )
    table = Table(*headings)
    context = create_context()
    for name in options.characters:
        character = Character.load(name)
        seconds = _seconds(character)
        for height in (120, 240, 480):
            for quality in (QUALITIES["full"], QUALITIES["reduced"]):
                pairs = compared(context, character, height, quality)
                table.add_row(
                    character.name,
                    str(height),
                    quality.name,
                    f"{pairs[0].triangles} of {sum(len(m.triangles) for m in character.meshes)}",
                    f"{max(pair.rms for pair in pairs):.2f}",
                    f"{100 * max(pair.much for pair in pairs):.2f} %",
                    f"{1000 * seconds:.0f} ms",
                )
                if options.output:
                    options.output.mkdir(parents=True, exist_ok=True)
                    path = options.output / f"{character.name} {height} {quality.name}.png"
                    cv2.imwrite(str(path), _side_by_side(pairs))
    Console(width=110).print(table)
    context.release()


if __name__ == "__main__":
    main()
