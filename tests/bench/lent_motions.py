"""Film persons without clips, who play lent motions: `python -m tests.bench.lent_motions FOLDER`.

The bundled human, saved as VRM 0 and as VRM 1 without clips, and each person of the folder with its
clips taken away stands, walks, runs, blows a kiss, speaks, points and stands again, all at once in
one film (`-o`, default: lent-motions.mp4). One row each is printed, at the size of a person:

lend, ready
    Seconds of CPU to lend the motions, and to make an `Animator` of them.
slide
    Mean slide of standing feet over the table [cm/s].
sinks
    How deep the soles are below the ground [cm].
hands
    How much lower the hands are than the shoulders at rest, in parts of the arm; less than 0.5 is
    no resting arm.
inside
    Share of the skin of hanging forearms and hands that is inside the body.
gap
    Greatest distance of a foot from the end of its shin, in parts of the leg.
tilt
    Greatest angle from hips to head against the vertical while it walks.

Exits with 1 if a figure is beyond its bar.
"""

import argparse
import json
import math
import struct
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from cubeling.app.behaving.camera import FollowingCamera
from cubeling.app.behaving.opening import open_lines
from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.recording import placed_pose
from cubeling.app.ui.video_file import VideoFile
from cubeling.characters import Animator, Character, Clip, PosedCharacter
from cubeling.characters.model.character import CHARACTER_READERS
from cubeling.characters.motion import stack
from cubeling.characters.rendering import PortraitRenderer, create_context
from cubeling.characters.retargeting import with_lent_motions
from cubeling.characters.retargeting.feet.footskate import find_foot_contacts
from cubeling.characters.retargeting.hanging_arms import share_inside
from cubeling.characters.retargeting.locomotion.grading import MAX_SINKING_CM, MAX_SLIDE_CM_S
from cubeling.characters.retargeting.measures import (
    foot_gap,
    hands_below_shoulders,
    sole_dip,
    trunk_tilt,
)
from cubeling.characters.retargeting.rig import Rig
from tests.bench.retarget import PERSON_HEIGHT_M

SCENES = (
    ("stands", '<wait duration="1.5"/>'),
    ("walks", '<locomotion target="0.05,0,0.45" manner="walk"/>'),
    ("runs", '<locomotion target="-0.1,0,-0.15" manner="run"/>'),
    ("walks back", '<locomotion target="0,0,0.1" manner="walk"/>'),
    ("kisses", '<gesture lexeme="BLOW_KISS"/>'),
    ("speaks", "<speech><text>Hello! I am here, and I move as she does.</text></speech>"),
    ("points", '<pointing target="left"/>'),
    ("stands again", '<wait duration="2.5"/>'),
)
"""What happens, in order: its caption, and its behaviour in BML."""

RATE_HZ = 25.0
FRAMES_DRAWN = 2  # one of so many: drawing takes most of the time
TILE_PX = 240, 320
COLUMNS = 5
MAX_TILT_DEG, MIN_HANDS, MAX_INSIDE, MAX_GAP = 20.0, 0.5, 0.02, 0.01
LONGEST_S = 60.0


@dataclass
class Take:
    """One person's performance."""

    name: str
    body: Character
    clip: Clip
    captions: list[str]
    """What it does in each frame."""

    cells: dict[str, float]
    """Figures by column."""


def main() -> None:
    """Print the table, and write the film."""
    parser = argparse.ArgumentParser(description="Film persons who play lent motions.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("lent-motions.mp4"))
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        cast = list(_cast(given.folder, Path(folder)))
    takes = [perform(name, body) for name, body in track(cast, "Playing", transient=True)]
    console = Console(width=120)
    console.print(_table(takes))
    write_film(takes, given.output)
    console.print(f"{given.output} is written")
    sys.exit(any(_beyond(take) for take in takes))


def _cast(folder: Path, scratch: Path) -> Iterator[tuple[str, Character]]:
    """Yield all persons without clips, by name."""
    for version in (0, 1):
        path = scratch / f"human-vrm{version}.vrm"
        save_vrm(Character.load("human"), path, version)
        yield path.stem, Character.load(path)
    for path in sorted(folder.rglob("*")):
        if path.suffix.lower() in CHARACTER_READERS:
            body = replace(Character.load(path), clips={})
            if body.lender is not None:
                yield path.stem, body


def save_vrm(character: Character, path: Path, version: int) -> None:
    """Save the body of a character as VRM 0 or 1, without its clips; VRM 0 looks along −z."""
    body = path.with_suffix(".glb")
    replace(character, clips={}).save(body)
    data = body.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    document = json.loads(data[20 : 20 + length])
    numbers = {node["name"]: number for number, node in enumerate(document["nodes"])}
    bones = {
        part: numbers[character.skeleton.names[joint]]
        for part, joint in character.anatomy.joints.items()
    }
    if version == 1:
        name = "VRMC_vrm"
        humanoid = {part: {"node": node} for part, node in bones.items()}
        content = {"specVersion": "1.0", "humanoid": {"humanBones": humanoid}}
    else:
        name = "VRM"
        listed = [{"bone": part, "node": node} for part, node in bones.items()]
        content = {"humanoid": {"humanBones": listed}}
        document["nodes"][numbers["root"]]["rotation"] = [0.0, 1.0, 0.0, 0.0]
    document |= {"extensionsUsed": [name], "extensions": {name: content}}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = data[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(binary))
    path.write_bytes(head + struct.pack("<I4s", len(text), b"JSON") + text + binary)


def perform(name: str, character: Character) -> Take:
    """Return what a person does, with its figures."""
    start = time.process_time()
    body = with_lent_motions(character)
    lend = time.process_time() - start
    Animator(body)
    ready = time.process_time() - start - lend
    lines = open_lines(None, "en")
    frames: list[PosedCharacter] = []
    captions: list[str] = []
    try:
        player = BehaviourPlayer(body, lines)
        player.settle(2.0, RATE_HZ)
        for caption, behaviour in SCENES:
            player.director.accept(_block(caption, behaviour))
            while True:
                now = len(frames) / RATE_HZ
                frames.append(player.update(now).posed)
                captions.append(caption)
                if player.director.over(now) or now > LONGEST_S:
                    break
    finally:
        lines.close()
    clip = Clip(name, RATE_HZ, stack([placed_pose(each) for each in frames]), False, True)
    return Take(
        name, body, clip, captions, {"lend": lend, "ready": ready, **_grades(body, clip, captions)}
    )


def _block(name: str, behaviour: str) -> str:
    key = name.replace(" ", "-")
    return f'<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="{key}">{behaviour}</bml>'


def _grades(body: Character, clip: Clip, captions: list[str]) -> dict[str, float]:
    rig = Rig(body.skeleton, body.anatomy, body.meshes)
    size = 100 * PERSON_HEIGHT_M / body.height
    walk = clip.poses[_frames(captions, "walks")]
    rest = clip.poses[_frames(captions, "stands again")[-5:]]
    grades = {
        "sinks": size * sole_dip(clip.poses, rig, body.meshes),
        "gap": foot_gap(clip.poses, rig),
        "tilt": math.degrees(float(trunk_tilt(walk, rig).max())),
    }
    if "Walk" in body.clips:
        grades["slide"] = size * _slide(rig, clip)  # others hop, over which feet stand nowhere
    hands = hands_below_shoulders(rest, rig)
    if body.anatomy.kind == "humanoid" and hands is not None:
        last = rest[len(rest.rotations) - 1]
        grades |= {"hands": hands, "inside": share_inside(rig, last)}
    return grades


def _frames(captions: list[str], caption: str) -> NDArray[np.intp]:
    return np.flatnonzero(np.array(captions) == caption)


def _slide(rig: Rig, clip: Clip) -> float:
    """Return the mean speed of standing feet over the table [m/s]."""
    contacts = find_foot_contacts(clip, rig, rig.legs).ball
    ends = [leg.end for leg in rig.legs]
    places = rig.placements(clip.poses, ends)[:, ends][..., [0, 2], 3]
    steps = np.linalg.norm(np.diff(places, axis=0), axis=-1) * clip.rate
    standing = contacts[1:] & contacts[:-1]
    return float(steps[standing].mean()) if standing.any() else 0.0


def _beyond(take: Take) -> list[str]:
    """Return the columns that are beyond their bars."""
    bars = {
        "slide": (MAX_SLIDE_CM_S, 1),
        "sinks": (MAX_SINKING_CM, 1),
        "tilt": (MAX_TILT_DEG, 1),
        "gap": (MAX_GAP, 1),
        "inside": (MAX_INSIDE, 1),
        "hands": (MIN_HANDS, -1),
    }
    return [
        column
        for column, (bar, sign) in bars.items()
        if column in take.cells and sign * (take.cells[column] - bar) > 0
    ]


def _table(takes: list[Take]) -> Table:
    forms = {
        **{"lend": "{:.2f} s", "ready": "{:.2f} s", "slide": "{:.2f} cm/s", "sinks": "{:.1f} cm"},
        **{"hands": "{:.2f}", "inside": "{:.1%}", "gap": "{:.1%}", "tilt": "{:.0f}°"},
    }
    table = Table(title="Persons without clips, at the size of a person")
    table.add_column("person")
    table.add_column("motions of")
    for column in forms:
        table.add_column(column, justify="right")
    for take in takes:
        beyond = _beyond(take)
        cells = [
            ("[red]{}[/]" if column in beyond else "{}").format(form.format(take.cells[column]))
            if column in take.cells
            else ""
            for column, form in forms.items()
        ]
        table.add_row(
            take.name, "human" if take.body.anatomy.kind == "humanoid" else "vleo", *cells
        )
    return table


def write_film(takes: list[Take], path: Path) -> None:
    """Write a film of all takes side by side; a shorter one waits in its last frame."""
    width, height = TILE_PX
    columns = min(COLUMNS, len(takes))
    rows = math.ceil(len(takes) / columns)
    context = create_context()
    renderer = PortraitRenderer(context, TILE_PX)
    cameras = [FollowingCamera(take.body, "body") for take in takes]
    count = max(len(take.clip) for take in takes)
    try:
        with VideoFile(path, (columns * width, rows * height), RATE_HZ / FRAMES_DRAWN) as video:
            for number in track(range(0, count, FRAMES_DRAWN), "Drawing", transient=True):
                sheet = np.full((rows * height, columns * width, 3), 255, np.uint8)
                for place, (take, camera) in enumerate(zip(takes, cameras, strict=True)):
                    frame = min(number, len(take.clip) - 1)
                    pose = take.clip.poses[frame]
                    focus = camera.focus(pose, number / RATE_HZ)
                    tile = renderer.portrait(
                        take.body, pose, azimuth=0.5, elevation=0.12, focus=focus
                    )
                    text = f"{take.name}: {take.captions[frame]}"
                    cv2.putText(tile, text, (6, 16), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (60, 60, 60), 1)
                    y, x = height * (place // columns), width * (place % columns)
                    sheet[y : y + height, x : x + width] = tile
                video.write(sheet, number / RATE_HZ)
    finally:
        renderer.release()
        context.release()


if __name__ == "__main__":
    main()
