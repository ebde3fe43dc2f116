"""Stimuli of the experiment with single facial actions, drawn by our renderer.

128 pictures and animations: each action strong and weak, with and without wrinkles, at its maximum
and as it comes and goes (Huang 2013, section 4.4; specification S7).
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.ui.video_file import VideoFile
from cubeling.app.workshop.study.manifest import MANIFEST, write_rows
from cubeling.app.workshop.study.protocols.protocol import Stimulus
from cubeling.app.workshop.study.protocols.protocol_file import load_protocol
from cubeling.characters import Character, Pose
from cubeling.characters.rendering import PortraitRenderer, create_context
from cubeling.files import write_whole

Array = NDArray[np.float64]

PROTOCOL = "single-facial-actions"

RECIPES: Mapping[str, Sequence[Mapping[str, float]]] = {
    "AU4": ({"browDown": 1.0},),
    "AU1+2": ({"browInnerUp": 1.0, "browOuterUp": 1.0},),
    # The brows of sadness alone; with ARKit's morphs, inner brows that go up and brows that knit.
    "AU1+4": ({"sad": 1.0, "sadMouth": -1.0}, {"browInnerUp": 1.0, "browDown": 0.5}),
    "AU6": ({"cheekSquint": 1.0, "eyeSquint": 0.6}, {"happy": 1.0, "happyMouth": -1.0}),
    "AU20": ({"mouthStretch": 1.0}, {"viseme_I": 1.0}),
    "AU12": ({"mouthSmile": 1.0}, {"happyMouth": 1.0}),
    "AU5": ({"eyeWide": 1.0},),
    "AU7": ({"eyeSquint": 1.0}, {"blink": 0.35}),
    "AU9": ({"noseSneer": 1.0}, {"angryMouth": 1.0}),
    "AU15": ({"mouthFrown": 1.0}, {"sadMouth": 1.0}),
}
"""What moves each action: weights of morphs, the first that a character has. Morphs with a name for
each side ("browDownLeft") count as both."""

STRENGTH = {"high": 1.0, "low": 0.45}

RATE, ONSET_S, APEX_S = 25.0, 0.4, 1.0
"""Pictures a second, how long an action takes to come or go, and how long it stays [s]."""

SIZE_PX = (360, 360)


def morph_weights(morphs: Sequence[str], action: str, strength: float) -> Array:
    """Return the weights of all morphs that show an action, (morphs,); raises AppError.

    >>> morph_weights(["blink", "browDownLeft", "browDownRight"], "AU4", 0.5).tolist()
    [0.0, 0.5, 0.5]
    """
    plain = [re.sub(r"[\W_]", "", name.rpartition(".")[2]).lower() for name in morphs]
    for recipe in RECIPES[action]:
        found = np.zeros(len(morphs))
        for name, weight in recipe.items():
            wanted = re.compile(re.escape(name.replace("_", "").lower()) + "(left|right|l|r)?")
            moved = [index for index, each in enumerate(plain) if wanted.fullmatch(each)]
            whole = [index for index in moved if plain[index] == name.replace("_", "").lower()]
            if not moved:
                break
            found[whole or moved] = weight * strength
        else:
            return found
    needed = " or ".join(" and ".join(recipe) for recipe in RECIPES[action])
    raise AppError(f"the character cannot show {action}: it has no morph {needed}")


def draw_faces(
    agents: Mapping[str, str],
    folder: Path,
    wanted: Callable[[Stimulus], bool] = lambda stimulus: True,
    drawn: Callable[[], None] = lambda: None,
) -> int:
    """Draw the stimuli into a folder, with a manifest, and return their number.

    Parameters
    ----------
    agents
        The character of each agent of the protocol: a bundled one or a file.
    folder
        An existing folder.
    wanted
        Says which are drawn.
    drawn
        Called after each.

    Raises
    ------
    AppError, CharacterError
        A character cannot be read or cannot show an action, or a file cannot be written.
    """
    (faces,) = load_protocol(PROTOCOL)[0].stimuli.values()
    stimuli = [stimulus for stimulus in faces.stimuli if wanted(stimulus)]
    people = {agent: Character.load(name) for agent, name in agents.items()}
    for stimulus in stimuli:  # before anything is drawn
        morph_weights(people[stimulus["agent"]].morphs, stimulus["action"], 1.0)
    rows = []
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        renderer = PortraitRenderer(context, SIZE_PX)
        closing.callback(renderer.release)
        for stimulus in stimuli:
            name = "-".join(
                stimulus[key] for key in ("action", "agent", "intensity", "wrinkles", "mode")
            )
            poses = list(_poses(people[stimulus["agent"]], stimulus))
            draw = _drawing(renderer, people[stimulus["agent"]], stimulus)
            if stimulus["mode"] == "picture":
                path = folder / f"{name}.png"
                write_whole(path, cv2.imencode(".png", draw(poses[0]))[1].tobytes(), AppError)
            else:
                path = folder / f"{name}.mp4"
                with VideoFile(path, SIZE_PX, RATE) as video:
                    for number, pose in enumerate(poses):
                        video.write(draw(pose), number / RATE)
            rows.append({**stimulus, "character": agents[stimulus["agent"]], "file": path.name})
            drawn()
    write_rows(folder / MANIFEST, rows)
    return len(rows)


def course(seconds: float) -> float:
    """Return how much of an action is there in an animation, 0…1, at a time from its start [s].

    It comes and goes as a cosine does.

    >>> [round(course(t), 2) for t in (0.0, 0.2, 0.4, 1.4, 1.6, 1.8)]
    [0.0, 0.5, 1.0, 1.0, 0.5, 0.0]
    """
    rise = min(seconds, ONSET_S + APEX_S + ONSET_S - seconds) / ONSET_S
    return float(0.5 - 0.5 * np.cos(np.pi * np.clip(rise, 0.0, 1.0)))


def _poses(character: Character, stimulus: Stimulus) -> Iterator[Pose]:
    """Yield the pose at the maximum of an action, or those of its animation."""
    strength = STRENGTH[stimulus["intensity"]]
    weights = morph_weights(character.morphs, stimulus["action"], strength)
    if stimulus["mode"] == "picture":
        yield replace(character.skeleton.rest, morphs=weights)
        return
    count = round((2 * ONSET_S + APEX_S) * RATE) + 1
    for number in range(count):
        yield replace(character.skeleton.rest, morphs=course(number / RATE) * weights)


def _drawing(
    renderer: PortraitRenderer, character: Character, stimulus: Stimulus
) -> Callable[[Pose], NDArray[np.uint8]]:
    wrinkles = stimulus["wrinkles"] != "without"

    def draw(pose: Pose) -> NDArray[np.uint8]:
        return renderer.portrait(
            character, pose, azimuth=0.0, elevation=0.0, focus="face", wrinkles=wrinkles
        )

    return draw
