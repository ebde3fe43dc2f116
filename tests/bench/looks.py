"""Cost of surface features and morphs: `python -m tests.bench.looks [--frames N]`.

One character is drawn with each feature in turn, so that the ratios hold on a busy machine. The
textures are noise; a face of `FACE_VERTICES` vertices has as many morphs as VRM has expressions.
"""

import argparse
import statistics
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.model.character import Character
from cubeling.characters.model.mesh import Material, Mesh, Morph
from cubeling.characters.rendering import SceneCharacter, Stage, create_context
from tests.bench.picture import SIZE, scene

FACE_VERTICES = 3000
MORPH_COUNT = 18
MAX_RATIO = 1.1
"""Largest ratio of the time with all morphs at zero to the time without morphs: about 1, with room
for the noise of a busy machine."""


def with_material(character: Character, **changes: Any) -> Character:
    """Return a character whose every surface has some looks, and texture coordinates for them."""

    def dressed(mesh: Mesh) -> Mesh:
        uvs = mesh.positions[:, :2] if mesh.uvs is None else mesh.uvs
        return replace(mesh, uvs=uvs, material=replace(mesh.material, **changes))

    return replace(character, meshes=tuple(dressed(mesh) for mesh in character.meshes))


def with_morphs(character: Character, rng: np.random.Generator) -> Character:
    """Return a character whose highest vertices are a face."""
    names = tuple(f"m{number}" for number in range(MORPH_COUNT))
    share = FACE_VERTICES / sum(len(mesh.positions) for mesh in character.meshes)

    def faced(mesh: Mesh) -> Mesh:
        count = max(round(share * len(mesh.positions)), 1)
        highest = np.sort(np.argsort(mesh.positions[:, 1])[-count:]).astype(np.uint32)
        displacements = rng.normal(0, 1e-3, (MORPH_COUNT, 2, count, 3)).astype(np.float32)
        morphs = (Morph(n, highest, *row) for n, row in zip(names, displacements, strict=True))
        return replace(mesh, morphs=tuple(morphs))

    return replace(character, meshes=tuple(map(faced, character.meshes)), morphs=names)


def table_rows(character: Character, rng: np.random.Generator) -> dict[str, tuple[Character, int]]:
    """Return each row of the table: who is drawn, and how many morphs are on."""
    noise = rng.integers(0, 256, (1024, 1024, 4), dtype=np.uint8)
    bumps = np.dstack([noise[..., :2] // 8 + 112, np.full((1024, 1024), 250)]).astype(np.uint8)
    looks: dict[str, dict[str, Any]] = {
        "plain": vars(Material()),
        "texture": {"base_color_texture": noise},
        "texture, roughness and metalness": {
            "base_color_texture": noise,
            "metallic_roughness_texture": noise,
        },
        "texture, normal map": {"base_color_texture": noise, "normal_texture": bumps},
        "texture, holes": {"base_color_texture": noise, "alpha_cutoff": 0.1},
    }
    looks["all of it, glowing"] = {"emissive": (0.1, 0.0, 0.0)}
    for name in list(looks)[1:-1]:
        looks["all of it, glowing"] |= looks[name]
    rows = {name: (with_material(character, **changes), 0) for name, changes in looks.items()}
    faced = with_morphs(rows["plain"][0], rng)
    rows |= {
        f"plain, {on} of {MORPH_COUNT} morphs on": (faced, on) for on in (0, 1, 4, MORPH_COUNT)
    }
    rows["plain, once more"] = rows["plain"]
    return rows


def main() -> None:
    """Print the table; end with 1 if morphs that are off cost anything."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=40)
    parser.add_argument("--character", default="human")
    options = parser.parse_args()
    context = create_context()
    rng = np.random.default_rng(5)
    character = Character.load(options.character)
    rows = table_rows(character, rng)
    stages = {name: Stage(context, SIZE) for name in rows}
    spent: dict[str, list[float]] = {name: [] for name in rows}
    view, actor = scene(character)
    for frame in range(options.frames + 3):
        posed = actor(frame).posed
        for name in rng.permutation(list(rows)):  # each finds the caches that another left
            who, on = rows[name]
            weights = np.zeros(len(who.morphs))
            weights[:on] = rng.uniform(0.1, 1.0, on)
            morphs = weights if len(weights) else None
            seen = SceneCharacter(who, replace(posed, pose=replace(posed.pose, morphs=morphs)))
            start = time.perf_counter()
            stages[name].draw(view, [seen])
            spent[name].append(1e3 * (time.perf_counter() - start))
    off = print_table(options.character, {name: times[3:] for name, times in spent.items()})
    raise SystemExit(off > MAX_RATIO)


def print_table(name: str, spent: dict[str, Sequence[float]]) -> float:
    """Print the table, and return the ratio of the row with all morphs off."""
    table = Table(title=f"{name}, one picture of {SIZE[0]}×{SIZE[1]}")
    for heading in ("looks", "median [ms]", "against plain"):
        table.add_column(heading, justify="left" if heading == "looks" else "right")
    ratios = {}
    for row, times in spent.items():
        each = (time / plain for time, plain in zip(times, spent["plain"], strict=True))
        ratios[row] = statistics.median(each)
        table.add_row(row, f"{statistics.median(times):.2f}", f"{ratios[row]:.3f}")
    Console().print(table)
    return ratios[f"plain, 0 of {MORPH_COUNT} morphs on"]


if __name__ == "__main__":
    main()
