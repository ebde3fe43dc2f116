"""Draws what `--realism` does, each part off and on: `python -m tools.realism`."""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.ui.contact_sheets import save
from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand, RootDelta
from cubeling.characters.rendering import Box, CameraView, SceneCharacter, Stage, create_context
from cubeling.characters.rendering.camera_picture.haze import haze_table
from cubeling.characters.rendering.camera_picture.light import LINEAR_FROM_SRGB
from cubeling.tracking import CubeControls, CubeGestures, CubeState, CubeTracker, Frame
from cubeling.tracking.appearance import AppearanceMeter
from cubeling.tracking.synthetic import SyntheticSource, open_synthetic
from tools.captions import framed

Image = NDArray[np.uint8]

FOLDER = Path(__file__).parent.parent / "docs" / "pictures"

SCENE = "companion"
"""The synthetic scene: a hand turns the cube."""

FRAMES = 215
"""Frames before the picture: the cube lies, and a hand has taken it."""

PLACE = RootDelta(0.1, -0.1, -0.4)
"""Place of the character: behind cube and hand."""

ROWS: tuple[tuple[str, ...], ...] = (
    (),
    ("hand",),
    ("hand", "light"),
    ("hand", "light", "softness"),
)
"""What each picture follows."""

CROP = (slice(150, 560), slice(440, 1010))
"""The part of each picture that is shown: rows and columns."""

GLARE, PAPER = 0.3, 0.75
"""Haze, and light of the paper, of the lens that sees the scene of the second picture."""

DIM = 0.08
"""Light in the dark room of the third picture, relative to that in the others."""

MAX_BYTES = 300_000
"""Size of a file."""


def main() -> None:
    """Write the pictures."""
    source = open_synthetic(SCENE)
    seen = _seen(source)
    hazed = [(_hazed(frame), state, controls) for frame, state, controls in seen]
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        captions = ["off", *(" + ".join(chosen) for chosen in ROWS[1:])]
        lit = [_drawn(context, source, seen, chosen)[CROP] for chosen in ROWS]
        parts = [framed(each, text) for each, text in zip(lit, captions, strict=True)]
        _save([np.hstack(parts[:2]), np.hstack(parts[2:])], "realism.jpg")
        parts = [
            framed(_drawn(context, source, hazed, chosen)[CROP], text)
            for chosen, text in zip(ROWS[2:], ("through a hazy lens", "softness"), strict=True)
        ]
        _save([np.hstack(parts)], "haze.jpg")
        dimmed = [(_dimmed(frame), state, controls) for frame, state, controls in seen]
        dark = _drawn(context, source, dimmed, ROWS[-1])[CROP]
        parts = [framed(lit[-1], "a lit room"), framed(dark, "a dark room")]
        _save([np.hstack(parts)], "dark.jpg")


def _save(rows: Sequence[Image], name: str) -> None:
    """Write a picture of the documentation."""
    save(np.vstack(rows), FOLDER / name, MAX_BYTES)
    Console().print(f"{name}: {(FOLDER / name).stat().st_size / 1e3:.0f} kB")


def _hazed(frame: Frame) -> Frame:
    """Return a frame as a hazy lens shows it."""
    table = haze_table(GLARE, PAPER)
    assert table is not None
    return replace(frame, image=table[frame.image])


def _dimmed(frame: Frame) -> Frame:
    """Return a frame as a camera with the same exposure shows it in a dark room."""
    table = np.searchsorted(LINEAR_FROM_SRGB, DIM * LINEAR_FROM_SRGB).astype(np.uint8)
    return replace(frame, image=table[frame.image])


def _seen(source: SyntheticSource) -> list[tuple[Frame, CubeState, CubeControls]]:
    """Return the frames, and what was tracked in them."""
    assert source.intrinsics is not None
    tracker, gestures = CubeTracker(source.cube, source.intrinsics), CubeGestures(source.cube)
    found = []
    for index in range(FRAMES):
        frame = source.frame(index)
        state = tracker.update(frame)
        found.append((frame, state, gestures.update(state)))
    return found


def _drawn(
    context: moderngl.Context,
    source: SyntheticSource,
    seen: Sequence[tuple[Frame, CubeState, CubeControls]],
    chosen: Sequence[str],
) -> Image:
    """Return the last picture of the scene with a character."""
    assert source.intrinsics is not None
    character = Character.load("human")
    animator = Animator(character, place=PLACE)
    meter = AppearanceMeter(source.cube, source.intrinsics, chosen)
    stage = Stage(context, source.intrinsics.size)
    gaze = np.array([0.0, 0.25, 0.6])
    for frame, state, controls in seen:
        command = CharacterCommand(frame.timestamp, action=ActionIntent("idle"), gaze=gaze)
        posed = animator.update(command)
        found, pose = meter.update(frame, state, controls.camera_from_table), state.camera_from_cube
        view = CameraView(
            frame.image,
            source.intrinsics.matrix,
            source.intrinsics.distortion,
            controls.camera_from_table,
            () if pose is None else (Box(pose, source.cube.edge),),
            found.hand,
            found.light,
            found.softness,
        )
        picture = stage.draw(view, [SceneCharacter(character, posed)])
    stage.release()
    return picture


if __name__ == "__main__":
    main()
