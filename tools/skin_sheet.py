"""Draws wrinkles, blush and pallor for the documentation: `python -m tools.skin_sheet`."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.ui.contact_sheets import save
from cubeling.characters import Character
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.rendering import create_context
from cubeling.characters.rendering.portrait import PortraitRenderer, side_by_side
from tools.authoring.human.skull import SKIN
from tools.captions import underlined

Image = NDArray[np.uint8]

FOLDER = Path(__file__).parent.parent / "docs" / "pictures"

MOVED: dict[str, Sequence[str]] = {
    "neutral": (),
    "AU1+2": ("browInnerUp", "browOuterUp"),
    "AU4": ("browDown",),
    "AU6+12": ("happy",),
    "AU4+10": ("angry",),
    "AU1+4": ("sad",),
}
"""Morphs at full weight in each column, by the action units that they move."""

BLOOD = {"afraid": -1.0, "sad": -0.6, "at rest": 0.0, "happy": 0.45, "excited": 0.8, "angry": 1.0}
"""Blood in each column."""

DARK_SKIN = (0.26, 0.20, 0.18)
"""By what the colour of the skin is multiplied for the second row [linear RGB]."""

FOCUS = (np.array([0.0, 1.45, 0.0]), 0.20)
"""Centre and radius of what is shown [m]."""

SIZE_PX = (216, 216)
CAPTION_PX = 20
MAX_BYTES = 300_000


def main() -> None:
    """Write both pictures."""
    human = Character.load("human")
    dark = replace(human, meshes=tuple(map(_darkened, human.meshes)))
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        renderer = PortraitRenderer(context, SIZE_PX)
        closing.callback(renderer.release)

        def face(
            character: Character, morphs: Sequence[str], wrinkles: bool, blood: float
        ) -> Image:
            weights = np.array([float(name in morphs) for name in character.morphs])
            pose = replace(character.skeleton.rest, morphs=weights)
            return renderer.portrait(
                character, pose, azimuth=0.3, elevation=0.03, focus=FOCUS,
                wrinkles=wrinkles, blood=blood,
            )  # fmt: skip

        wrinkles = [
            face(human, morphs, on, 0.0) for on in (False, True) for morphs in MOVED.values()
        ]
        complexion = [
            face(each, (), True, blood) for each in (human, dark) for blood in BLOOD.values()
        ]
    _save("wrinkles.jpg", wrinkles, [*MOVED, *(f"{name}, wrinkles" for name in MOVED)])
    _save("blush.jpg", complexion, [*BLOOD, *BLOOD])


def _darkened(mesh: Mesh) -> Mesh:
    """Return a mesh whose skin is darker: that of the face has texture coordinates."""
    if mesh.colors is None or mesh.uvs is None:
        return mesh
    skin = mesh.uvs.any(axis=1) | (np.abs(mesh.colors[:, :3] - SKIN).max(axis=1) < 1e-3)
    factors = np.where(skin[:, None], DARK_SKIN, 1.0)
    colors = mesh.colors * np.column_stack([factors, np.ones(len(factors))])
    return replace(mesh, colors=colors.astype(np.float32))


def _save(name: str, pictures: Sequence[Image], captions: Sequence[str]) -> None:
    labelled = [
        underlined(*each, CAPTION_PX, 0.45) for each in zip(pictures, captions, strict=True)
    ]
    path = FOLDER / name
    save(side_by_side(labelled, len(MOVED)), path, MAX_BYTES)
    Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
