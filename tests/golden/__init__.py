"""What the program makes of the bundled recordings: text that is compared with a tolerance.

`python -m tests.golden` compares, `python -m tests.golden --renew` writes the files again. A line
that is within the tolerance stays as it is: a diff shows what a change moved, and nothing else.
"""

import re
from collections.abc import Iterator
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import messages, session_info
from cubeling.app.session.encoding import MESSAGE_TYPES, decode
from cubeling.characters import Character, CharacterCommand, PosedCharacter
from cubeling.tracking import CubeControls, CubeState

FOLDER = Path(__file__).parent

EVERY = 10
"""Every how many frames one is described."""

TOLERANCES = {2: 0.1, 3: 0.002, 4: 0.00175}
"""How far a number may be off, by its decimals: 2 for mm and °, 4 for the components of a unit
vector (0.1°), 3 for turns, speeds, intensities and emotions."""

JOINTS = ("head", "leftHand", "leftFrontFoot", "rightFoot")
"""Parts of the body whose joints are described, of those that the character has."""

FLAGS = ("visible", "resting", "placed", "lifted")
"""Fields of the controls that are named where they hold."""

NUMBER = re.compile(r"(-?\d+\.(\d+))(°?)")


def describe(session: Path) -> str:
    """Return what is in a session with every channel, as a line for each part of a frame."""
    options = session_info(session).options
    character = Character.load(options.character or find_scenario(options.scenario).character)
    frame: list[Any] = []
    lines, count = [], 0
    for topic, _, data in messages(session, *MESSAGE_TYPES):
        if count % EVERY == 0:
            frame.append(decode(MESSAGE_TYPES[topic], data))
        if topic == "/robot/emotion":  # the last of a frame
            if frame:
                lines += [f"frame {count}", *_frame(character, *frame)]
            count, frame = count + 1, []
    return "\n".join([*lines, ""])


def _frame(
    character: Character,
    state: CubeState,
    controls: CubeControls,
    command: CharacterCommand,
    posed: PosedCharacter,
    emotion: EmotionTarget,
) -> Iterator[str]:
    pose = state.camera_from_cube
    if pose is None:
        yield f"  cube {state.verdict}"
    else:
        yield (
            f"  cube {state.verdict} by {state.source} {','.join(state.faces)}"
            f" at {_mm(pose[:3, 3])} x {_direction(pose[:3, 0])} y {_direction(pose[:3, 1])}"
        )
    flags = [name for name in FLAGS if getattr(controls, name)]
    yield (
        f"  controls {controls.top_face} heading {_angle(controls.heading)}"
        f" camera {_angle(controls.camera_angle)} turns {controls.turns:.3f}"
        f" at {_mm(controls.position)} {' '.join((*flags, *controls.gestures))}".rstrip()
    )
    target = None if command.locomotion is None else command.locomotion.target
    yield (
        f"  action {command.activity} {command.weight:.3f} speed {command.speed:.3f}"
        f" to {_mm(target)}{'' if command.visible else ' hidden'}"
    )
    table = posed.table_from_character
    yaw = np.arctan2(table[0, 2], table[2, 2])
    yield (
        f"  character {posed.state} {posed.weight:.3f} speed {posed.speed:.3f}"
        f" at {_mm(table[[0, 2], 3])} yaw {_angle(yaw)}"
    )
    joints = table @ posed.pose.globals(character.skeleton)
    places = (
        f"{part} {_mm(joints[joint, :3, 3])}"
        for part in JOINTS
        if (joint := character.anatomy.joint(part)) is not None
    )
    yield f"  joints {' '.join(places)}"
    felt = emotion.emotion
    yield f"  emotion {felt.label} {felt.valence:.3f} {felt.arousal:.3f}"


def _mm(place: NDArray[np.float64] | None) -> str:
    return "-" if place is None else " ".join(_rounded(1e3 * each, 2) for each in place)


def _direction(vector: NDArray[np.float64]) -> str:
    return " ".join(_rounded(each, 4) for each in vector)


def _angle(radians: float) -> str:
    return f"{_rounded(np.degrees(radians), 2)}°"


def _rounded(number: float, decimals: int) -> str:
    """Return a number without the sign of a zero."""
    text = f"{number:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0.0 else text


def differences(golden: str, now: str) -> list[str]:
    """Return the lines that differ by more than the tolerances, with the frame of each."""
    found, frame = [], ""
    for old, new in zip_longest(golden.splitlines(), now.splitlines(), fillvalue="nothing"):
        frame = new if new.startswith("frame") else frame
        if not agrees(old, new):
            found.append(f"{frame}\n- {old.strip()}\n+ {new.strip()}")
    return found


def renewed(golden: str, now: str) -> str:
    """Return the present text, with the lines of the golden one that agree with it."""
    pairs = zip_longest(golden.splitlines(), now.splitlines())
    lines = (old if old and new and agrees(old, new) else new for old, new in pairs)
    return "\n".join([*(line for line in lines if line is not None), ""])


def agrees(old: str, new: str) -> bool:
    """Return whether two lines have the same words, and the same numbers within the tolerances."""
    if NUMBER.sub("#", old) != NUMBER.sub("#", new):
        return False
    for (one, decimals, degrees), (other, *_) in zip(
        NUMBER.findall(old), NUMBER.findall(new), strict=True
    ):
        off = abs(float(one) - float(other))
        off = min(off, abs(off - 360.0)) if degrees else off
        if off > TOLERANCES[len(decimals)] + 1e-9:
            return False
    return True
