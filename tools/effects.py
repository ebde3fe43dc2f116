"""Draws what each deferred effect does, off and on: `python -m tools.effects`."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.ui.contact_sheets import save
from cubeling.characters import Character
from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.rendering import (
    QUALITIES,
    CameraView,
    Effect,
    Focus,
    Quality,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic.source import look_at
from tools.captions import framed

Image = NDArray[np.uint8]

PATH = Path(__file__).parent.parent / "docs" / "pictures" / "effects.jpg"

SIZE = (380, 340)
"""Of one picture, (width, height) [px]."""

COLUMNS = 2
"""Pairs of pictures in a row."""

MAX_BYTES = 300_000
"""Size of the file."""

RICH = QUALITIES["rich"]
PLAIN = replace(RICH, effects=frozenset())
LENS = Focus(0.5, 0.52, 0.03)


@dataclass(frozen=True)
class Shot:
    """One pair of pictures: without something, and with it."""

    caption: str
    """What the second picture has."""

    character: str
    """Name of a bundled character."""

    on: Quality
    """Of the second picture."""

    off: Quality = PLAIN
    """Of the first picture."""

    height: float = 0.26
    """Of the character [m]."""

    places: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    """Of the character and its copies on the table: x and z [m]."""

    look_at: float = 0.45
    """What is in the middle of the picture, as a share of the character's height."""

    zoom: float = 1.0
    """How much the camera enlarges."""

    opacity: float = 1.0
    """Of the character."""

    focus: Focus | None = None
    """The camera's lens."""


SHOTS = (
    Shot("soft shadows", "human", replace(RICH, effects=frozenset([Effect.SOFT_SHADOWS]))),
    Shot(
        "ambient occlusion",
        "robot",
        replace(RICH, effects=frozenset([Effect.AMBIENT_OCCLUSION])),
        height=0.19,
        zoom=1.25,
    ),
    Shot(
        "skin",
        "human",
        replace(RICH, effects=frozenset([Effect.SOFT_SHADOWS, Effect.SKIN_SCATTERING])),
        off=replace(RICH, effects=frozenset([Effect.SOFT_SHADOWS])),
        look_at=0.8,
        zoom=3.6,
    ),
    Shot(
        "depth of field",
        "human",
        RICH,
        off=replace(RICH, effects=RICH.effects - {Effect.DEPTH_OF_FIELD}),
        height=0.18,
        places=((-0.09, 0.13), (0.0, 0.0), (0.1, -0.14)),
        look_at=0.5,
        focus=LENS,
    ),
    Shot("coloured shadow", "vleo", RICH, off=QUALITIES["full"], height=0.19, opacity=0.5),
    Shot("all", "vleo", RICH, off=QUALITIES["full"], height=0.19, zoom=1.25),
)


def main() -> None:
    """Write the picture."""
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        pairs = [_pair(context, shot) for shot in SHOTS]
    rows = [np.hstack(pairs[i : i + COLUMNS]) for i in range(0, len(pairs), COLUMNS)]
    save(np.vstack(rows), PATH, MAX_BYTES)
    Console().print(f"{PATH.name}: {PATH.stat().st_size / 1e3:.0f} kB")


def _pair(context: moderngl.Context, shot: Shot) -> Image:
    """Return both pictures of a shot, with captions below."""
    view, actors = _scene(shot)
    pictures = []
    for quality in (shot.off, shot.on):
        stage = Stage(context, SIZE)
        stage.quality = quality
        pictures.append(stage.draw(view, actors))
        stage.release()
    captions = "off", shot.caption
    return np.hstack([framed(*each) for each in zip(pictures, captions, strict=True)])


def _scene(shot: Shot) -> tuple[CameraView, Sequence[SceneCharacter]]:
    """Return a plain desk under a camera, and the characters of a shot on it."""
    character = Character.load(shot.character)
    if shot.opacity < 1.0:
        character = _glass(character, shot.opacity)
    clip = character.clips.get("Walk") or next(iter(character.clips.values()))
    pose = clip.sample(0.25 * clip.duration)
    scale = shot.height / character.height
    actors = []
    for x, z in shot.places:
        place = np.diag([scale, scale, scale, 1.0])
        place[:3, 3] = x, 0.0, z
        place[:3, :3] = place[:3, :3] @ se3.rotation(np.array([0.0, -0.35, 0.0]))
        posed = PosedCharacter(pose, place, True, "walk", 0.0, 0.0, 0.0, 0.0)
        actors.append(SceneCharacter(character, posed))
    pitch = np.deg2rad(28.0)
    eye = 0.62 * np.array([0.0, np.sin(pitch), np.cos(pitch)])
    table = look_at(eye, np.zeros(3))
    width, height = SIZE
    focal = 620.0 * shot.zoom
    seen = table[:3, :3] @ [0.0, shot.look_at * shot.height, 0.0] + table[:3, 3]
    middle = np.array([width / 2, height / 2]) - focal * seen[:2] / seen[2]
    matrix = np.array([[focal, 0.0, middle[0]], [0.0, focal, middle[1]], [0.0, 0.0, 1.0]])
    return CameraView(_desk(), matrix, np.zeros(0), table, focus=shot.focus), actors


def _glass(character: Character, opacity: float) -> Character:
    """Return a character whose surfaces are partly transparent."""
    meshes = [
        replace(
            mesh,
            material=replace(
                mesh.material, base_color=(1.0, 1.0, 1.0, opacity), alpha_cutoff=0.49, blended=True
            ),
        )
        for mesh in character.meshes
    ]
    return replace(character, meshes=tuple(meshes))


def _desk() -> Image:
    """Return the camera's picture of a desk of light wood."""
    width, height = SIZE
    rng = np.random.default_rng(3)
    grain = cv2.GaussianBlur(rng.normal(0.0, 60.0, (height, width)), (0, 0), 30.0, sigmaY=1.0)
    noise = rng.normal(0.0, 1.5, (height, width, 3))
    return np.clip(np.array([176, 192, 204]) + grain[..., None] + noise, 0, 255).astype(np.uint8)


if __name__ == "__main__":
    main()
