"""The room's light on characters: `python -m tests.bench.light [-o FOLDER] [MODEL …]`.

Prints each bar with what it is today; exits with 1 if one is missed.

- White furnace: a white ball in a white room, of every roughness and metalness, in both ways of
  lighting. All light that falls on it leaves it: it is not seen.
- A coloured card is put beside a metal character in a picture of a bundled recording, at once, and
  taken away again. How long until it shows in the character, and how much one picture differs from
  the one before at most (ΔE76, the mean over the character). It is put there after a quiet while,
  and just after something else has changed.
- Time of measuring and preparing the light, as a multiple of OpenCV's detection of markers in a
  whole frame (CPU time of all threads, in turns), and of the whole line with and without it.

With `-o`, pictures of every character without and with the light; MODEL is any character's file or
name, made of metal with `:metal` after it.
"""

import argparse
import itertools
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import moderngl
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.choices import REALISM_CHOICES
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import Step
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import bundled_session
from cubeling.characters import Character, PosedCharacter
from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import (
    QUALITIES,
    CameraView,
    Quality,
    RoomMap,
    SceneCharacter,
    Stage,
    create_context,
    standing_pose,
)
from cubeling.characters.rendering.environment.room import RoomMaps
from cubeling.tracking import Frame, Intrinsics, open_source
from cubeling.tracking.appearance import MeasuredLight, RoomMeter
from tests.characters.rendering.room_maps import WHITE, even_light, light_of_ball, painted

Image = NDArray[np.uint8]
Array = NDArray[np.float64]

FURNACE_BAR, SHOWN_BAR_S, POP_BAR, COST_BAR, LINE_BAR = 0.005, 0.5, 1.0, 0.04, 1.0
"""The bars: lost light, time [s], ΔE of a picture to the next, shares of times."""

SEEN = 2.3
"""ΔE76 that is just seen (Mahy, Van Eycken and Oosterlinck 1994)."""

CHANGED = 5.0
"""ΔE76 from which on a pixel of the character belongs to what the card changes."""

RATE = 30
"""Pictures a second."""

METAL = Material(base_color=(0.8, 0.78, 0.74, 1.0), metallic=1.0, roughness=0.25)
"""Armour."""

CARD = np.array([(-0.1, 0.0, -0.1), (-0.18, 0.0, -0.02), (-0.18, 0.14, -0.02), (-0.1, 0.14, -0.1)])
CARD_BGR = (60, 30, 220)
"""A red card that stands to the left of the character, turned to it and to the camera: corners in
the table frame, (4, 3) [m], and its colour."""

MODELS = ("human:metal", "robot", "human")
"""Whom the pictures show unless others are named."""


@dataclass(frozen=True)
class Desk:
    """A moment of a bundled recording."""

    frame: Frame
    lens: Intrinsics
    table: Array
    light: MeasuredLight | None

    @classmethod
    def of(cls, name: str, frames: int = 150) -> "Desk":
        """Return one frame in which cube, table and light are known."""
        for playground, step in played(name, frames, ("light",)):
            if step.frame.index == frames - 1:
                table, seen = step.controls.camera_from_table, step.appearance
                assert table is not None
                light = None if seen is None else seen.light
                return cls(step.frame, playground.intrinsics, table, light)
        raise ValueError(name)

    def view(self, image: Image, room: RoomMap | None, now: float) -> CameraView:
        """Return what a stage draws on."""
        return CameraView(
            image,
            self.lens.matrix,
            self.lens.distortion,
            self.table,
            light=self.light,
            room=room,
            timestamp=now,
        )

    def with_card(self) -> Image:
        """Return the picture with the card."""
        at = CARD @ self.table[:3, :3].T + self.table[:3, 3]
        lens = self.lens
        pixels, _ = cv2.projectPoints(at, np.zeros(3), np.zeros(3), lens.matrix, lens.distortion)
        image = self.frame.image.copy()
        cv2.fillConvexPoly(image, np.rint(pixels).astype(np.int32), CARD_BGR)
        return image


def played(name: str, frames: int, realism: Sequence[str]) -> Iterator[tuple[Playground, Step]]:
    """Yield the steps of a bundled recording, measured, not drawn."""
    with open_source(str(bundled_session(name))) as source:
        lens = intrinsics_for(source.intrinsics, source.size)
        playground = Playground(name, lens, realism=tuple(realism), measured=True)
        for frame in itertools.islice(source, frames):
            yield playground, playground.step(frame, drawn=False, measured=True)


def character_of(name: str) -> Character:
    """Return a character by its name or file, with `:metal` in armour."""
    path, _, look = name.partition(":")
    character = Character.load(path)
    if look != "metal":
        return character
    meshes = (replace(each, material=METAL, colors=None) for each in character.meshes)
    return replace(character, meshes=tuple(meshes))


def standing(character: Character, height: float = 0.17) -> SceneCharacter:
    """Return a character that stands where the cube first rested, and looks at the camera."""
    place = np.diag([*[height / character.height] * 3, 1.0])
    pose = standing_pose(character)
    return SceneCharacter(character, PosedCharacter(pose, place, True, "idle", 0.0, 0.0, 0.0, 0.0))


def furnace(context: moderngl.Context, view: CameraView) -> float:
    """Return the largest error of the light of a white ball in a white room."""
    qualities = QUALITIES["full"], replace(QUALITIES["rich"], effects=frozenset())
    errors = []
    with even_light():
        for quality, metallic, roughness in itertools.product(
            qualities, (0.0, 0.4, 1.0), (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
        ):
            material = Material(metallic=metallic, roughness=roughness)
            light, drawn = light_of_ball(context, view, quality, material, painted(WHITE))
            errors.append(float(np.abs(light[drawn] - 1.0).max()))
    return max(errors)


def lab(picture: Image) -> NDArray[np.float32]:
    """Return CIELab of a picture, whose differences are ΔE76."""
    return np.asarray(cv2.cvtColor(picture.astype(np.float32) / 255.0, cv2.COLOR_BGR2LAB))


@dataclass(frozen=True)
class CardResult:
    """What a card does to a character."""

    shown_s: float
    """Time until it is just seen where it changes anything [s]."""

    half_s: float
    """Time until half of the change is there [s]."""

    pop: float
    """Most that the character differs from one picture to the next: the mean ΔE76."""

    worst_pop: float
    """The same of the hundredth of its pixels that changes most."""


def card(
    context: moderngl.Context, desk: Desk, character: Character, quality: Quality, busy: bool
) -> CardResult:
    """Put a card beside a character, and take it away; `busy` says that all is in motion before."""
    plain, carded = desk.frame.image, desk.with_card()
    other = plain.copy()
    other[: len(other) // 5, :300] //= 2
    meter, stage = RoomMeter(desk.lens), Stage(context, desk.lens.size)
    stage.quality = quality
    actor, empty = [standing(character)], Stage(context, desk.lens.size)
    drawn = lab(stage.draw(desk.view(plain, None, 0.0), actor))
    drawn = np.linalg.norm(drawn - lab(empty.draw(desk.view(plain, None, 0.0), [])), axis=2) > 1.0
    empty.release()
    stage.forget()
    appears, goes, count = RATE, 4 * RATE, 7 * RATE
    seen = []
    for number in range(count):
        image = carded if appears <= number < goes else plain
        if busy and appears - 4 <= number < appears:
            image = other
        room = meter.update(image, desk.table, desk.light, number / RATE)
        # The light that stands for the lamp and for what is scattered is not the subject.
        view = replace(desk.view(plain, room, number / RATE), softness=None)
        seen.append(lab(stage.draw(view, actor))[drawn])
    stage.release()
    before, after = seen[appears - 5], seen[goes - 1]
    change = np.linalg.norm(after - before, axis=1)
    counted = change > CHANGED
    if not counted.any():
        raise SystemExit(f"the card is not seen in {character.name}")
    since = [np.linalg.norm(each - before, axis=1)[counted].mean() for each in seen[appears:goes]]
    steps = [np.linalg.norm(b - a, axis=1) for a, b in itertools.pairwise(seen[2:])]
    return CardResult(
        next(n for n, each in enumerate(since) if each > SEEN) / RATE,
        next(n for n, each in enumerate(since) if each > since[-1] / 2) / RATE,
        max(float(step.mean()) for step in steps),
        max(float(np.quantile(step, 0.99)) for step in steps),
    )


EYES, ARMOUR, ANY = (0.15, 0.15), (0.25, 0.25), (0.0, 1.0)
"""Least and greatest roughness of what mirrors the room: the human's eyes, `METAL`, and all."""


def cost(
    context: moderngl.Context, name: str, roughness: tuple[float, float], frames: int
) -> tuple[float, float, float]:
    """Return CPU times a frame of measuring, of preparing, and of OpenCV's detection [ms]."""
    detector = cv2.aruco.ArucoDetector(
        cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), cv2.aruco.DetectorParameters()
    )
    maps, meter, spent = RoomMaps(context), None, np.zeros((0, 3))
    for playground, step in played(name, frames, ("light",)):
        meter = meter or RoomMeter(playground.intrinsics)
        light = None if step.appearance is None else step.appearance.light
        image, now = step.frame.image, step.frame.timestamp
        marks = [time.process_time()]
        room = meter.update(image, step.controls.camera_from_table, light, now)
        marks.append(time.process_time())
        maps.update(room, now, [roughness])
        marks.append(time.process_time())
        detector.detectMarkers(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
        marks.append(time.process_time())
        if room is not None:
            spent = np.vstack([spent, np.diff(marks)])
    maps.release()
    measuring, preparing, detecting = (1e3 * spent[3:].mean(axis=0)).tolist()
    return measuring, preparing, detecting


def line(context: moderngl.Context, name: str, who: str | None, frames: int) -> float:
    """Return the CPU time of the whole line with the room's light over that without, in turns."""
    choices = tuple(REALISM_CHOICES)
    with open_source(str(bundled_session(name))) as source:
        lens = intrinsics_for(source.intrinsics, source.size)
        character = None if who is None else character_of(who)
        lines = [
            Playground(name, lens, context=context, realism=realism, character=character)
            for realism in (choices, tuple(each for each in choices if each != "room"))
        ]
        spent: list[list[float]] = [[], []]
        for frame in itertools.islice(source, frames):
            for number in (0, 1) if frame.index % 2 else (1, 0):
                began = time.process_time()
                lines[number].step(frame)
                context.finish()
                spent[number].append(time.process_time() - began)
        for each in lines:
            each.close()
    on, off = (sum(each[10:]) for each in spent)
    return on / off


def pictures(
    context: moderngl.Context, desk: Desk, names: Sequence[str], quality: Quality
) -> Iterator[tuple[str, Image]]:
    """Yield a picture of each character: without the light, with it, and with a card beside it."""
    for name in names:
        row = []
        for image, mirrored in (
            (desk.frame.image, False),
            (desk.frame.image, True),
            (desk.with_card(), True),
        ):
            stage = Stage(context, desk.lens.size)
            stage.quality = quality
            meter = RoomMeter(desk.lens)
            meter.update(desk.frame.image, desk.table, desk.light, 0.0)
            room = meter.update(image, desk.table, desk.light, 1.0)
            view = desk.view(image, room if mirrored else None, 0.0)
            for _ in range(60):  # until the lamp is where it was measured
                stage.draw(view, [])
            picture = stage.draw(view, [standing(character_of(name))])
            stage.release()
            x, y = _foot(desk)
            row.append(picture[max(y - 330, 0) : y + 60, max(x - 170, 0) : x + 170])
        yield name, np.hstack(row)


def _foot(desk: Desk) -> tuple[int, int]:
    """Return the pixel where characters stand."""
    point = desk.lens.matrix @ (desk.table[:3, 3] / desk.table[2, 3])
    return round(point[0]), round(point[1])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*", default=MODELS, metavar="MODEL")
    parser.add_argument("-o", "--output", type=Path, help="a folder for pictures")
    parser.add_argument("--quality", choices=list(QUALITIES), default="full")
    parser.add_argument("--frames", type=int, default=300, help="of each recording that is timed")
    given = parser.parse_args()
    context, quality = create_context(), QUALITIES[given.quality]
    desk = Desk.of("companion")
    if given.output is not None:
        given.output.mkdir(parents=True, exist_ok=True)
        for name, picture in pictures(context, desk, given.models, quality):
            cv2.imwrite(str(given.output / f"{Path(name).stem.replace(':', '-')}.png"), picture)
        return
    table = Table("what", "today", "bar", "")
    missed = False

    def add(what: str, value: float, bar: float | None, unit: str = "") -> None:
        nonlocal missed
        over = bar is not None and value > bar
        missed |= over
        bound = "" if bar is None else f"≤ {bar:g}"
        table.add_row(what, f"{value:.3g} {unit}", bound, "MISSED" if over else "")

    small = desk.view(np.asarray(cv2.resize(desk.frame.image, (320, 180)), np.uint8), None, 0.0)
    small = replace(small, matrix=desk.lens.matrix * np.array([[0.25], [0.25], [1.0]]))
    add("white furnace, largest error", furnace(context, small), FURNACE_BAR)
    metal = [name for name in given.models if name.endswith(":metal")]
    for name, busy in itertools.product(metal, (False, True)):
        found = card(context, desk, character_of(name), quality, busy)
        when = "just after another change" if busy else "after a quiet while"
        add(
            f"{Path(name).stem}, card {when}: shown",
            found.shown_s,
            SHOWN_BAR_S,
            "s",
        )
        add("  half of it", found.half_s, None, "s")
        add("  most from one picture to the next, mean ΔE", found.pop, POP_BAR)
        add("  the same of 1 % of its pixels", found.worst_pop, POP_BAR)
    mirrors = {"eyes": EYES, "armour": ARMOUR, "mirrors of any roughness": ANY}
    for name, (who, roughness) in itertools.product(("companion", "follow"), mirrors.items()):
        measuring, preparing, detecting = cost(context, name, roughness, given.frames)
        add(f"{name}, {who}: measuring, of detection", measuring / detecting, None)
        add("  measuring and preparing", (measuring + preparing) / detecting, COST_BAR)
    for name, body in (("follow", None), ("companion", None), ("companion", "human:metal")):
        ratio = line(context, name, body, given.frames)
        add(f"{name}, {body or 'as it is'}: the line with it over without", ratio, None)
    context.release()
    Console().print(table)
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
