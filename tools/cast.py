"""Draws the bundled characters, to look at and to judge: `python -m tools.cast`.

Each is drawn from all sides, with the faces that it makes, and its clips frame by frame; and all
of them together, as they are on a table, and in every mood.
"""

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path

import moderngl
import numpy as np
from rich.console import Console

from affect import Emotion
from affect.words import PLACES, closest_word
from app.ui.album import Album, Image, save, stacked
from characters import (
    ActionIntent,
    Animator,
    Character,
    CharacterCommand,
    Pose,
    PosedCharacter,
    RootDelta,
)
from characters.face.lids import Lids
from characters.rendering import SceneCharacter, Stage, View, create_context
from characters.rendering.portrait import PAPER_BGR
from characters.rendering.portrait_camera import CharacterExtent, PortraitCamera

FOLDER = Path(__file__).parent.parent / "docs" / "pictures" / "cast"

ROWS = 8
"""Clips on a page."""

MOST = 300_000
"""Bytes of a picture."""


def draw_cast(cast: Iterable[Character], folder: Path = FOLDER) -> Iterator[Path]:
    """Draw some characters, and yield each file when it is written."""
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        album = Album(context)
        closing.callback(album.release)
        for character in cast:
            for kind, picture in _pages(album, character):
                path = folder / f"{character.name}{kind}.jpg"
                save(picture, path, MOST)
                yield path


GROUP: tuple[tuple[str, str, float, RootDelta], ...] = (
    ("vleo", "kiss", 1.7, RootDelta(-0.15, 0.0, 0.55)),
    ("human", "wave", 1.25, RootDelta(0.0, 0.02, 0.1)),
    ("robot", "happy", 0.5, RootDelta(0.15, 0.0, -0.55)),
)
"""Who is in the picture of all: what they do, how long they have done it [s], where they stand."""


def draw_group(context: moderngl.Context, size: tuple[int, int] = (1100, 520)) -> Image:
    """Return a picture of the whole cast on one table, (height, width, 3) BGR."""
    actors, points = [], []
    for name, action, seconds, place in GROUP:
        character = Character.load(name)
        posed = _after(Animator(character, place=place), action, seconds)
        reach = CharacterExtent(character).points(posed.pose)
        matrix = posed.table_from_character
        points.append(reach @ matrix[:3, :3].T + matrix[:3, 3])
        actors.append(SceneCharacter(character, posed))
    framing = PortraitCamera.around(np.concatenate(points), 0.2, size, 0.05)
    paper = np.full((size[1], size[0], 3), PAPER_BGR, np.uint8)
    stage = Stage(context, size)
    try:
        view = View(paper, framing.matrix, np.zeros(0), framing.camera_from_table)
        return stage.draw(view, actors)
    finally:
        stage.release()


MOODS = ("neutral", "happy", "excited", "surprised", "angry", "afraid", "sad", "sleepy")
"""What is shown on the sheet of moods."""

SETTLED = 4.0, 4.7
"""Between these times after a mood has begun it is drawn, when it does not blink [s]."""


def draw_moods(album: Album, cast: Iterable[Character]) -> Image:
    """Return a sheet of how everyone looks in every mood."""
    return stacked(*(album.moods(who, {word: _moody(who, word) for word in MOODS}) for who in cast))


def _moody(character: Character, word: str) -> Pose:
    """Return how a character stands that has felt so for a while, with its eyes open."""
    animator = Animator(character, place=RootDelta())
    emotion = Emotion(*PLACES[word], word)
    known = closest_word(animator.actions, emotion)
    action = known if known in PLACES and known is not None else "idle"
    gaze = np.array([0.1, 0.16, 1.0])
    first, last = (round(time * 30) for time in SETTLED)
    poses = [
        animator.update(
            CharacterCommand(number / 30, action=ActionIntent(action), gaze=gaze, emotion=emotion)
        ).pose
        for number in range(last + 1)
    ]
    lids = Lids.of(character.morphs)
    return min(poses[first:], key=lambda pose: lids.closed(pose.morphs))


def _after(animator: Animator, action: str, seconds: float) -> PosedCharacter:
    """Return a character that has acted for a while, and looks at the camera."""
    gaze = np.array([0.0, 0.2, 1.0])
    commands = (
        CharacterCommand(number / 60, action=ActionIntent(action, 1.0), gaze=gaze)
        for number in range(round(seconds * 60) + 1)
    )
    *_, posed = (animator.update(command) for command in commands)
    return posed


def _pages(album: Album, character: Character) -> Iterator[tuple[str, Image]]:
    yield "", album.turntable(character)
    if character.morphs and character.anatomy.joint("head") is not None:
        yield "-face", album.faces(character)
    clips = list(character.clips.values())
    for page, first in enumerate(range(0, len(clips), ROWS), start=1):
        yield f"-clips-{page}", album.clips(character, clips[first : first + ROWS])


if __name__ == "__main__":
    context = create_context()
    save(draw_group(context), FOLDER.parent / "cast.jpg", MOST)
    album = Album(context)
    moods = draw_moods(album, map(Character.load, Character.bundled()))
    save(moods, FOLDER.parent / "moods-on-faces.jpg", MOST)
    album.release()
    context.release()
    for path in draw_cast(map(Character.load, Character.bundled())):
        Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")
