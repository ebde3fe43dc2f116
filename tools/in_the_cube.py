"""Draws a cube that opens, and looks into it from several places: `python -m tools.in_the_cube`."""

from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.ui.contact_sheets import save
from cubeling.characters.rendering import create_context
from cubeling.tracking.synthetic import open_synthetic
from cubeling.tracking.synthetic.source import look_at
from tools.captions import framed

Image = NDArray[np.uint8]

PATH = Path(__file__).parent.parent / "docs" / "pictures" / "in-the-cube.jpg"

OPENED_AT = 31
"""The frame in which the player presses I: the table is known by then."""

SIZE = "size=1920x1080"
"""Of the camera's pictures: the cube is some 130 pixels large in them."""

CROP_PX = (400, 320)
"""Width and height of what is shown of them."""

MAX_BYTES = 300_000
"""Size of the file."""


@dataclass(frozen=True)
class Shot:
    """One picture."""

    caption: str
    """What is written below it."""

    scenario: str
    """Which is played."""

    scene: str
    """The synthetic scene."""

    frame: int
    """Number of the frame that is shown."""

    eye: tuple[float, float, float] = (0.0, 0.37, 0.53)
    """Where the camera is in the table frame [m]."""

    beside_px: tuple[int, int] = (0, 0)
    """From the cube to the middle of what is shown, to the right and down."""


SHOTS = (
    Shot("a key, and Vleo leaves", "companion", "companion", 35, beside_px=(-116, -45)),
    Shot("the walls open", "companion", "companion", 42),
    Shot("and Vleo is inside", "companion", "companion", 56),
    Shot("from the left", "companion", "companion", 56, (-0.21, 0.24, 0.47)),
    Shot("from above", "companion", "companion", 56, (0.16, 0.56, 0.20)),
    Shot("in the hand", "follow", "fingers", 112),
)
"""The pictures, row by row."""


def main() -> None:
    """Write the picture."""
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        parts = [framed(_drawn(context, shot), shot.caption) for shot in SHOTS]
    picture = np.vstack([np.hstack(parts[:3]), np.hstack(parts[3:])])
    save(picture, PATH, MAX_BYTES)
    Console().print(f"{PATH.name}: {PATH.stat().st_size / 1e3:.0f} kB")


def _drawn(context: moderngl.Context, shot: Shot) -> Image:
    """Play a scene up to its frame, and return what is around the cube."""
    source = open_synthetic(f"{shot.scene}?{SIZE}")
    source.camera_from_table = look_at(np.array(shot.eye), np.array([0.05, 0.04, 0.0]))
    intrinsics = intrinsics_for(source.intrinsics, source.size)
    playground = Playground(shot.scenario, intrinsics, cube=source.cube, context=context)
    for index in range(shot.frame + 1):
        step = playground.step(source.frame(index), Inputs(inside=index == OPENED_AT))
    playground.close()
    pose, picture = step.state.camera_from_cube, step.picture
    assert pose is not None
    assert picture is not None
    x, y, _ = np.rint(intrinsics.matrix @ pose[:3, 3] / pose[2, 3]).astype(int).tolist()
    left = x + shot.beside_px[0] - CROP_PX[0] // 2
    top = y + shot.beside_px[1] - CROP_PX[1] // 2
    return picture[top : top + CROP_PX[1], left : left + CROP_PX[0]]


if __name__ == "__main__":
    main()
