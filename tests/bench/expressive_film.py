"""Film what makes motion expressive: `python -m tests.bench.expressive_film -o expressive.mp4`.

Five gestures at both ends of each of the six sliders, beside the gesture as it is written, at full
and at half speed; one sentence with the body that speaks and with all but the face frozen; and a
person without clips, the bundled human saved as VRM, who speaks, reaches and holds a cube with both
hands. Some two minutes, to be watched frame by frame.
"""

import argparse
import math
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track

from cubeling.app.behaving.camera import FollowingCamera
from cubeling.app.behaving.opening import open_lines
from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.recording import BehaviourRecording, placed_pose, record_behaviour
from cubeling.app.behaving.voice import LineSource, SilentSource
from cubeling.app.show.blocks import BehaviourOptions
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.speaking.speech_video import sound_blocks
from cubeling.app.speaking.view import View
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Animator, Character, CharacterCommand, Pose, RootDelta
from cubeling.characters.behaviour.expressivity import NEUTRAL, GestureExpressivity
from cubeling.characters.behaviour.intents import (
    BehaviourIntent,
    GazeIntent,
    Hand,
    ReachIntent,
    Times,
)
from cubeling.characters.rendering import PortraitRenderer, create_context
from cubeling.characters.retargeting import with_lent_motions
from tests.bench.lent_motions import save_vrm

GESTURES = ("BEAT", "WAVE", "OPEN_ARMS", "CIRCLE", "POINT")

SENTENCE = (
    "We built this cube for you, and it really listens! Turn it, and I walk. "
    "But never, never drop it: that hurts."
)

MOODS = (
    "How could you forget me in the rain? I was so sad. "
    "But look, the sun is out, and I am happy that you are here: let us play again!"
)

RATE_HZ = 25.0
FRAMES_DRAWN = 2  # one of so many: drawing takes most of the time
SIZE_PX = 1280, 670
TITLE_PX = 30
EDGE_SHARE = 0.2
"""Edge of the cube that is held, as a part of the body's height."""

STEPS = (
    (0.5, ""),
    (4.0, "reach low"),
    (7.5, "reach far"),
    (11.0, "reach high"),
    (14.5, "reach aside"),
    (20.5, "hold"),
    (30.5, "carry"),
    (33.5, ""),
)
"""Until when [s] the stranger reaches for what."""

PLACES = {
    "reach low": (0.15, 0.12, 0.3),
    "reach far": (-0.3, 0.75, 0.45),
    "reach high": (0.1, 1.15, 0.25),
    "reach aside": (-0.45, 0.25, 0.2),
    "hold": (0.0, 0.5, 0.26),
}
"""Where, in parts of the body's height: left, up and ahead."""

CARRY = (0.12, 0.2, 1.8)
"""How far a held cube goes aside and down, in parts of the body's height, and its pace [rad/s]."""

HANDS: tuple[tuple[Hand, float], ...] = (("left", 1.0), ("right", -1.0))
"""Each hand, and on which side of the cube it is: left is positive."""


@dataclass(frozen=True)
class Take:
    """What one tile of a scene shows."""

    caption: str
    body: Character
    poses: list[Pose]


@dataclass(frozen=True)
class Scene:
    """Takes side by side, and what is heard with them."""

    title: str
    takes: list[Take]
    columns: int
    sound: NDArray[np.float32] | None = None
    view: View = "body"

    @property
    def frames(self) -> int:
        """Length of the longest take."""
        return max(len(take.poses) for take in self.takes)


def main() -> None:
    """Write the film."""
    parser = argparse.ArgumentParser(description="Film what makes motion expressive.")
    parser.add_argument("-o", "--output", type=Path, default=Path("expressive.mp4"))
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    human = Character.load("human")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "human.vrm"
        save_vrm(human, path, 1)
        stranger = with_lent_motions(Character.load(path))
    scenes = []
    for name in track(GESTURES, "Gestures", transient=True):
        takes = list(_sliders(human, name))
        scenes.append(Scene(f"{name}, each slider at both ends", takes, 7, view="hands"))
        slow = [replace(take, poses=[p for p in take.poses for _ in range(2)]) for take in takes]
        scenes.append(Scene(f"{name}, at half speed", slow, 7, view="hands"))
    lines = open_lines(None, "en")
    try:
        scenes += [
            _speaker(human, lines, SENTENCE, "A sentence, all but the face frozen", frozen=True),
            _speaker(human, lines, SENTENCE, "The same sentence, alive"),
            _speaker(stranger, lines, SENTENCE, "A person of a VRM without clips speaks"),
            _speaker(stranger, lines, MOODS, "Her face follows her words"),
        ]
    finally:
        lines.close()
    scenes.append(Scene("She reaches and holds", [_reaching(stranger)], 1))
    _write(scenes, given.output)
    seconds = sum(scene.frames for scene in scenes) / RATE_HZ
    Console().print(f"{given.output} is written: {seconds:.0f} s")


def _sliders(human: Character, gesture: str) -> Iterator[Take]:
    """Yield a gesture as it is written, and with each slider at both ends, low ones first."""
    sliders = [field.name for field in fields(GestureExpressivity)]
    for sign in (-1.0, 1.0):
        yield Take("as written", human, _gesture(human, gesture, NEUTRAL))
        for name in sliders:
            value = max(sign, 0.0) if name in ("openness", "power") else sign
            how = replace(NEUTRAL, **{name: value})
            yield Take(
                f"{name} {value:+g}" if value else f"{name} 0", human, _gesture(human, gesture, how)
            )


def _gesture(body: Character, gesture: str, how: GestureExpressivity) -> list[Pose]:
    player = BehaviourPlayer(body, SilentSource(""), BehaviourOptions(how))
    return _poses(record_behaviour(player, [_block(f'<gesture lexeme="{gesture}"/>')], RATE_HZ))


def _block(behaviours: str) -> str:
    bml = "http://www.bml-initiative.org/bml/bml-1.0"
    return f'<bml xmlns="{bml}" id="take"><wait duration="0.6"/>{behaviours}</bml>'


def _poses(recording: BehaviourRecording) -> list[Pose]:
    return [recording.clip.poses[number] for number in range(len(recording.clip))]


def _speaker(
    body: Character, lines: LineSource, text: str, title: str, *, frozen: bool = False
) -> Scene:
    player = BehaviourPlayer(body, lines)
    block = _block(f"<speech><text>{text}</text></speech>")
    recording = record_behaviour(player, [block], RATE_HZ)
    poses = _poses(recording)
    if frozen:
        poses = [replace(poses[0], morphs=each.morphs) for each in poses]
    return Scene(title, [Take("", body, poses)], 1, recording.sound())


def _reaching(body: Character) -> Take:
    """Return a person who reaches low and far, then holds a cube with both hands."""
    animator = Animator(body, place=RootDelta())
    size = animator.scale * body.height
    poses: list[Pose] = []
    begun: dict[str, float] = {}
    for number in range(round(STEPS[-1][0] * RATE_HZ)):
        now = number / RATE_HZ
        doing = next(what for end, what in STEPS if now < end)
        begun.setdefault(doing, now)
        held = begun["hold" if doing == "carry" else doing]  # hands that carry do not let go first
        times = Times(held, held + 0.9)
        intent = _intent(doing, times, size, now - begun[doing]) if doing else None
        poses.append(placed_pose(animator.update(CharacterCommand(now, behaviour=intent))))
    return Take("", body, poses)


def _intent(doing: str, times: Times, size: float, since: float) -> BehaviourIntent:
    """Return what asks for one thing, `since` so long [s]; `size` is the body's height [m]."""
    if doing in ("hold", "carry"):
        middle = np.array(PLACES["hold"])
        if doing == "carry":
            aside, down, rate = CARRY
            turn = rate * since
            middle += [aside * math.sin(turn), -down * (1.0 - math.cos(turn)) / 2.0, 0.0]
        middle *= size
        out = np.array([1.0, 0.0, 0.0])
        half = size * EDGE_SHARE / 2
        reaches = tuple(
            ReachIntent(
                f"hold {hand}", middle + sign * half * out, times, "hold", hand, palm=-sign * out
            )
            for hand, sign in HANDS
        )
    else:
        middle = size * np.array(PLACES[doing])
        reaches = (ReachIntent(doing, middle, times),)
    return BehaviourIntent(reaches=reaches, gazes=(GazeIntent(doing, middle, times, "HEAD"),))


def _write(scenes: list[Scene], path: Path) -> None:
    """Write the scenes one after the other; a shorter take waits in its last frame."""
    context = create_context()
    sound = np.concatenate([_sound(scene) for scene in scenes])
    try:
        with VideoFile(path, SIZE_PX, RATE_HZ / FRAMES_DRAWN, sound_blocks(sound)) as video:
            begin = 0
            for scene in track(scenes, "Drawing", transient=True):
                for frame, picture in _pictures(scene, context):
                    video.write(picture, (begin + frame) / RATE_HZ)
                begin += FRAMES_DRAWN * math.ceil(scene.frames / FRAMES_DRAWN)
    finally:
        context.release()


def _sound(scene: Scene) -> NDArray[np.float32]:
    """Return what is heard with a scene, for as long as it lasts, (n, 2)."""
    seconds = FRAMES_DRAWN * math.ceil(scene.frames / FRAMES_DRAWN) / RATE_HZ
    heard = np.zeros((round(seconds * SAMPLE_RATE), 2), np.float32)
    if scene.sound is not None:
        count = min(len(heard), len(scene.sound))
        heard[:count] = scene.sound[:count]
    return heard


def _pictures(scene: Scene, context: moderngl.Context) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Yield the frames that are drawn, and their pictures."""
    rows = math.ceil(len(scene.takes) / scene.columns)
    width, height = SIZE_PX[0] // scene.columns, (SIZE_PX[1] - TITLE_PX) // rows
    renderer = PortraitRenderer(context, (width, height))
    cameras = [FollowingCamera(take.body, scene.view) for take in scene.takes]
    try:
        for frame in range(0, scene.frames, FRAMES_DRAWN):
            picture = np.full((SIZE_PX[1], SIZE_PX[0], 3), 255, np.uint8)
            _write_text(picture, scene.title, (10, 24), 0.7)
            for place, (take, camera) in enumerate(zip(scene.takes, cameras, strict=True)):
                pose = take.poses[min(frame, len(take.poses) - 1)]
                tile = renderer.portrait(
                    take.body,
                    pose,
                    azimuth=0.5,
                    elevation=0.12,
                    focus=camera.focus(pose, frame / RATE_HZ),
                )
                _write_text(tile, take.caption, (6, 16), 0.45)
                y, x = TITLE_PX + height * (place // scene.columns), width * (place % scene.columns)
                picture[y : y + height, x : x + width] = tile
            yield frame, picture
    finally:
        renderer.release()


def _write_text(picture: NDArray[np.uint8], text: str, place: tuple[int, int], size: float) -> None:
    cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, size, (60, 60, 60), 1, cv2.LINE_AA)


if __name__ == "__main__":
    main()
