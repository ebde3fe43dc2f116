"""Draws the bundled characters for the documentation: `python -m tools.cast`.

Each is drawn from all sides, with its facial morphs, and its clips frame by frame. Three more
pictures show all characters on one table, in every mood, and how they stand in each.
"""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
from rich.console import Console

from cubeling.affect import Emotion
from cubeling.affect.regions import SECTOR_WORDS
from cubeling.affect.words import WORD_PLACES, closest_word
from cubeling.app.ui.contact_sheets import ContactSheets, Image, save, stack
from cubeling.characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    Pose,
    PosedCharacter,
    RootDelta,
)
from cubeling.characters.face.lids import Lids
from cubeling.characters.rendering import CameraView, SceneCharacter, Stage, create_context
from cubeling.characters.rendering.portrait import PAPER_BGR
from cubeling.characters.rendering.portrait_camera import CharacterExtent, PortraitCamera

FOLDER = Path(__file__).parent.parent / "docs" / "pictures" / "cast"

CLIPS_PER_SHEET = 8

MAX_BYTES = 300_000
"""Size of a picture's file."""


def draw_cast(cast: Iterable[Character], folder: Path = FOLDER) -> Iterator[Path]:
    """Draw characters, and yield each file after it is written."""
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        sheets = ContactSheets(context)
        closing.callback(sheets.release)
        for character in cast:
            for kind, picture in _pages(sheets, character):
                path = folder / f"{character.name}{kind}.jpg"
                save(picture, path, MAX_BYTES)
                yield path


GROUP_MEMBERS: tuple[tuple[str, str, float, RootDelta], ...] = (
    ("vleo", "kiss", 1.7, RootDelta(-0.15, 0.0, 0.55)),
    ("human", "wave", 1.25, RootDelta(0.0, 0.02, 0.1)),
    ("robot", "happy", 0.5, RootDelta(0.15, 0.0, -0.55)),
)
"""The picture of all characters: name, action, time since it began [s], and place."""


def draw_group(context: moderngl.Context, size: tuple[int, int] = (1100, 520)) -> Image:
    """Return a picture of all characters on one table, (height, width, 3) BGR."""
    characters, points = [], []
    for name, action, seconds, place in GROUP_MEMBERS:
        character = Character.load(name)
        posed = _after(Animator(character, place=place), action, seconds)
        extent = CharacterExtent(character).points(posed.pose)
        matrix = posed.table_from_character
        points.append(extent @ matrix[:3, :3].T + matrix[:3, 3])
        characters.append(SceneCharacter(character, posed))
    camera = PortraitCamera.around(np.concatenate(points), 0.2, size, 0.05)
    paper = np.full((size[1], size[0], 3), PAPER_BGR, np.uint8)
    stage = Stage(context, size)
    try:
        view = CameraView(paper, camera.matrix, np.zeros(0), camera.camera_from_table)
        return stage.draw(view, characters)
    finally:
        stage.release()


SHEET_MOODS = ("neutral", "happy", "excited", "surprised", "angry", "afraid", "sad", "sleepy")
"""The columns of the sheet of moods."""

SETTLED_S = 4.0, 4.7
"""Times after the start of a mood between which it is drawn, when the eyes are open [s]."""


def draw_moods(sheets: ContactSheets, cast: Iterable[Character]) -> Image:
    """Return a sheet of every character in every mood."""
    rows = [
        sheets.moods(who, {label: _mood_pose(who, label) for label in SHEET_MOODS}) for who in cast
    ]
    return stack(*rows)


def _mood_pose(character: Character, label: str) -> Pose:
    """Return a character's pose in a settled mood, with its eyes open."""
    animator = Animator(character, place=RootDelta())
    emotion = Emotion(*WORD_PLACES[label], label)
    known = closest_word(animator.actions, emotion)
    action = known if known in WORD_PLACES and known is not None else "idle"
    gaze = np.array([0.1, 0.16, 1.0])
    first, last = (round(time * 30) for time in SETTLED_S)
    poses = [
        animator.update(
            CharacterCommand(number / 30, action=ActionIntent(action), gaze=gaze, emotion=emotion)
        ).pose
        for number in range(last + 1)
    ]
    lids = Lids.of(character.morphs)
    return min(poses[first:], key=lambda pose: lids.closure(pose.morphs))


STANDING_MOODS = ("neutral", *SECTOR_WORDS)
"""The columns of the sheet of standing: the middle of the plane, and its sectors."""

STANDING_S = 9.0
"""Time after the start of a mood at which it is drawn: every character rests [s]."""


def draw_standing(sheets: ContactSheets, cast: Iterable[Character]) -> Image:
    """Return a sheet of how every character stands in nine moods, all with one face."""
    rows = []
    for character in cast:
        poses = {word: _standing_pose(character, word) for word in STANDING_MOODS}
        rows.append(sheets.postures(character, poses))
    return stack(*rows)


def _standing_pose(character: Character, word: str) -> Pose:
    """Return how a character stands in a mood, without the mood on its face."""
    animator = Animator(character, place=RootDelta())
    emotion = None if word == "neutral" else Emotion(*WORD_PLACES[word], word)
    for number in range(round(STANDING_S * 30) + 1):
        posed = animator.update(CharacterCommand(number / 30, emotion=emotion))
    return replace(posed.pose, morphs=None)


def _after(animator: Animator, action: str, seconds: float) -> PosedCharacter:
    """Return a character some time after an action began, looking at the camera."""
    gaze = np.array([0.0, 0.2, 1.0])
    commands = (
        CharacterCommand(number / 60, action=ActionIntent(action, 1.0), gaze=gaze)
        for number in range(round(seconds * 60) + 1)
    )
    *_, posed = (animator.update(command) for command in commands)
    return posed


def _pages(sheets: ContactSheets, character: Character) -> Iterator[tuple[str, Image]]:
    yield "", sheets.turntable(character)
    if character.morphs and character.anatomy.joint("head") is not None:
        yield "-face", sheets.faces(character)
    clips = list(character.clips.values())
    for page, first in enumerate(range(0, len(clips), CLIPS_PER_SHEET), start=1):
        yield f"-clips-{page}", sheets.clips(character, clips[first : first + CLIPS_PER_SHEET])


if __name__ == "__main__":
    context = create_context()
    save(draw_group(context), FOLDER.parent / "cast.jpg", MAX_BYTES)
    sheets = ContactSheets(context)
    moods = draw_moods(sheets, map(Character.load, Character.bundled_names()))
    save(moods, FOLDER.parent / "moods-on-faces.jpg", MAX_BYTES)
    standing = draw_standing(sheets, map(Character.load, Character.bundled_names()))
    save(standing, FOLDER.parent / "moods-standing.jpg", MAX_BYTES)
    sheets.release()
    context.release()
    for path in draw_cast(map(Character.load, Character.bundled_names())):
        Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")
