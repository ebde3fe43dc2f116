"""Draws how controllers move: `python -m tests.bench.controller_curves -o curves.png`.

Strips of the character and curves of hips, knees and wrists while it is asked to walk, run, turn,
walk and stand, for each controller, and on CMU recordings (`shared/data/cmu-mocap`) where these are
there. Needs the extra `plots`.
"""

import argparse
import math
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from characters import (
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
from characters.control.controllers import ControllerFactory
from characters.control.layers import FOOT_LAYERS
from characters.rendering import create_context
from characters.rendering.portrait import PortraitRenderer
from tests.bench.controllers import CMU
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
    parser.add_argument("-o", "--output", required=True, help="the picture, a .png or .jpg file")
    output = parser.parse_args().output
    character = Character.load("human")
    runs: dict[str, list[PosedCharacter]] = {}
    for name in CONTROLLER_CHOICES:
        runs[name] = walked(character, choose_controller(name, character))
        if name != "tree" and CMU.is_dir():
            label = f"{name} on CMU recordings"
            runs[label] = walked(character, choose_controller(name, character, [str(CMU)]))
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


def _clip(shown: Sequence[PosedCharacter]) -> Clip:
    shifts = np.stack([posed.pose.translations for posed in shown])
    turns = np.stack([posed.pose.rotations for posed in shown])
    return Clip("shown", FRAME_RATE, Pose(shifts, turns), loop=False)


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
