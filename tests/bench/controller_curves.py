"""Draws how controllers move: `python -m tests.bench.controller_curves -o curves.png`.

Strips of the character and curves of hips, knees and wrists while it is asked to walk, run, turn,
walk and stand, for each controller, and on CMU recordings (`shared/data/cmu-mocap`) where these are
there, or on those of one `--set` of `tests.bench.controllers`. Needs the extra `plots`. With
`-o side-by-side.mp4` it is a video of all side by side, over dots on the ground that show feet that
slide; `--set 16 -o film.mp4` is the tree beside the other three on recordings of one person.
"""

import argparse
import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from cubeling.app.ui.output_formats import VIDEO_FORMATS
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import (
    CONTROLLER_CHOICES,
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    Clip,
    LocomotionIntent,
    Pose,
    PosedCharacter,
    choose_controller,
)
from cubeling.characters.control.controllers import ControllerFactory
from cubeling.characters.control.layers import FOOT_LAYERS
from cubeling.characters.rendering import (
    CameraView,
    FloorPath,
    SceneCharacter,
    Stage,
    create_context,
)
from cubeling.characters.rendering.portrait import PAPER_BGR, PortraitRenderer, side_by_side
from cubeling.characters.rendering.portrait_camera import CharacterExtent, PortraitCamera
from cubeling.characters.skeleton import rotations
from tests.bench.controllers import CMU, SETS
from tests.bench.feet import FRAME_RATE

SCRIPT = (
    ("stand", 0.0, 0.0, 0.8),
    ("walk", 2.0, 0.0, 1.7),
    ("run", 4.5, 0.0, 1.7),
    ("turn", 2.0, 1.57, 1.8),
    ("walk", 2.0, 1.57, 1.0),
    ("stand", 0.0, 1.57, 1.5),
)
"""What is asked for: a name, Speed, heading [rad], and for how long [s]."""

CELL, VIDEO_RATE = (480, 360), 30
"""Size of each controller's picture in a video [px], and pictures a second."""

TABLE_HEIGHT_M, ROOM = 0.17, np.array([2.2, 1.1, 2.2])
"""Height of the character as the renderer lights it, and how much room there is around it."""

DOTS_M, DOTS = 0.5, np.stack(np.meshgrid(range(-3, 4), range(-3, 4)), axis=-1).reshape(-1, 2)
"""Distance of the dots on the ground [m], and their numbers around the character."""

FONT = (cv2.FONT_HERSHEY_SIMPLEX, 0.6, (60, 60, 60), 1, cv2.LINE_AA)

STRIP_FRAMES = 8
CURVES = (("hips", 1), ("leftLowerLeg", 2), ("rightLowerLeg", 2), ("leftHand", 2), ("rightHand", 2))
"""Body parts, and the axis that is drawn: 1 for the height, 2 for ahead."""


def walked(character: Character, controller: ControllerFactory) -> list[PosedCharacter]:
    """Return what is shown in the script."""
    animator = Animator(character, scale=1.0, layers=FOOT_LAYERS, controller=controller)
    shown: list[PosedCharacter] = []
    for _, speed, yaw, seconds in SCRIPT:
        for _ in range(round(seconds * FRAME_RATE)):
            x, z = shown[-1].table_from_character[[0, 2], 3] if shown else (0.0, 0.0)
            target = np.array([x + 99 * math.sin(yaw), z + 99 * math.cos(yaw)])
            going = LocomotionIntent(speed, target, stop=False)
            stand = None if speed else ActionIntent("idle")
            shown.append(animator.update(CharacterCommand(len(shown) / FRAME_RATE, going, stand)))
    return shown


def main() -> None:
    """Draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", required=True, type=Path,
                        help="a .png or .jpg picture, or a .mp4 video")  # fmt: skip
    parser.add_argument("--set", choices=[name.replace(", ", "+") for name in SETS],
                        help="recordings that all but the tree walk with")  # fmt: skip
    options = parser.parse_args()
    output = options.output
    character = Character.load("human")
    runs: dict[str, list[PosedCharacter]] = {}
    for name in CONTROLLER_CHOICES:
        if options.set is not None:
            motions = () if name == "tree" else SETS[options.set.replace("+", ", ")]
            controller = choose_controller(name, character, [str(path) for path in motions])
            runs[name if name == "tree" else f"{name}, {options.set}"] = walked(
                character, controller
            )
            continue
        runs[name] = walked(character, choose_controller(name, character))
        if name != "tree" and CMU.is_dir():
            label = f"{name} on CMU recordings"
            runs[label] = walked(character, choose_controller(name, character, [str(CMU)]))
    if output.suffix.lower() in VIDEO_FORMATS:
        _draw_video(output, character, runs)
    else:
        _draw_picture(output, character, runs)


def _draw_picture(
    output: Path, character: Character, runs: dict[str, list[PosedCharacter]]
) -> None:
    mpl.use("Agg")
    figure = Figure(figsize=(14, 2.2 * len(runs) + 1.2 * (len(CURVES) + 1)), layout="constrained")
    heights = [2.2] * len(runs) + [1.2] * (len(CURVES) + 1)
    axes = figure.subplots(len(heights), 1, height_ratios=heights)
    context = create_context()
    renderer = PortraitRenderer(context, (220, 260))
    for axis, (name, shown) in zip(axes, runs.items(), strict=False):
        picture = renderer.strip(character, _clip(shown), STRIP_FRAMES, azimuth=1.1)
        axis.imshow(picture[..., ::-1], aspect="auto")
        axis.set_axis_off()
        axis.set_title(name, loc="left")
    renderer.release()
    context.release()
    _draw_curves(axes[len(runs) :], character, runs)
    figure.savefig(output, dpi=70)


def _draw_video(output: Path, character: Character, runs: dict[str, list[PosedCharacter]]) -> None:
    asked = [name for name, *_, seconds in SCRIPT for _ in range(round(seconds * FRAME_RATE))]
    context = create_context()
    stage = Stage(context, CELL)
    columns = math.ceil(math.sqrt(len(runs)))
    size = CELL[0] * columns, CELL[1] * math.ceil(len(runs) / columns)
    films = [_filmed(stage, character, name, shown) for name, shown in runs.items()]
    with VideoFile(output, size, VIDEO_RATE) as file:
        for number, cells in enumerate(zip(*films, strict=True)):
            picture = side_by_side(cells, columns)
            second = number / VIDEO_RATE
            what = f"{second:4.1f} s: {asked[number * (FRAME_RATE // VIDEO_RATE)]}"
            cv2.putText(picture, what, (10, size[1] - 14), *FONT)
            file.write(picture, second)
    stage.release()
    context.release()


def _filmed(
    stage: Stage, character: Character, name: str, shown: list[PosedCharacter]
) -> Iterator[NDArray[np.uint8]]:
    """Draw one controller from the side; the camera goes along."""
    scale = TABLE_HEIGHT_M / character.height
    points = CharacterExtent(character).points(character.skeleton.rest) * scale * ROOM
    camera = PortraitCamera.around(points, 0.25, CELL)
    paper = np.full((CELL[1], CELL[0], 3), PAPER_BGR, np.uint8)
    view = CameraView(paper, camera.matrix, np.zeros(0), camera.camera_from_table)
    side = np.eye(4)
    side[:3, :3] = scale * rotations.to_matrix(rotations.about("y", 1.1))
    for posed in shown[:: FRAME_RATE // VIDEO_RATE]:
        middle = np.eye(4)
        middle[[0, 2], 3] = -posed.table_from_character[[0, 2], 3]
        followed = side @ middle
        near = np.rint(-middle[[0, 2], 3] / DOTS_M) + DOTS
        dots = np.insert(near * DOTS_M, 1, 0.0, axis=1) @ followed[:3, :3].T + followed[:3, 3]
        floor = [FloorPath(dot[None, [0, 2]], color=(0.5, 0.55, 0.6)) for dot in dots]
        placed = replace(posed, table_from_character=followed @ posed.table_from_character)
        picture = stage.draw(view, [SceneCharacter(character, placed)], floor)
        cv2.putText(picture, name, (10, 24), *FONT)
        yield picture


def _clip(shown: Sequence[PosedCharacter]) -> Clip:
    return Clip("shown", FRAME_RATE, Pose.of_frames(posed.pose for posed in shown), loop=False)


def _draw_curves(
    axes: "Sequence[mpl.axes.Axes]", character: Character, runs: dict[str, list[PosedCharacter]]
) -> None:
    for name, shown in runs.items():
        at = _clip(shown).poses.globals(character.skeleton)[..., :3, 3]
        times = np.arange(len(shown)) / FRAME_RATE
        ways = np.array([posed.table_from_character[[0, 2], 3] for posed in shown])
        axes[0].plot(times[1:], np.linalg.norm(np.diff(ways, axis=0), axis=1) * FRAME_RATE)
        for axis, (part, along) in zip(axes[1:], CURVES, strict=True):
            axis.plot(times, at[:, character.anatomy.joints[part], along], label=name)
            axis.set_ylabel(f"{part} [m]")
    axes[0].set_ylabel("speed [m/s]")
    axes[1].legend(loc="lower right", ncols=len(runs))
    asked = np.cumsum([0.0, *(seconds for *_, seconds in SCRIPT)])
    for axis in axes:
        axis.set_xlim(0, asked[-1])
        for start in asked:
            axis.axvline(float(start), color="0.8", linewidth=0.8)
    for start, (what, *_) in zip(asked, SCRIPT, strict=False):
        axes[0].text(float(start) + 0.02, 0.1, what)


if __name__ == "__main__":
    main()
