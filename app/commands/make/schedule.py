"""The command `cubeling schedule`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape

from cubeling.app.commands.output import OverwriteOption, VideoCodecOption, chosen_output
from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.input_path import check_character, check_input
from cubeling.app.ui.output_formats import VIDEO_FORMATS, check_video_codec
from cubeling.files import FileKind, is_there

if TYPE_CHECKING:
    from collections.abc import Callable

    from cubeling.characters import Character, Clip
    from cubeling.characters.motion import Motion, Schedule

SCHEDULE_FILE = FileKind(
    "schedule",
    (".xml",),
    AppError,
    1_000_000,
    "cubeling.app.commands.make.schedule:read_schedule",
)
"""A blending schedule; a larger one is not written by hand."""

MAX_SECONDS = 3600.0

VIDEO_SIZE = 480, 560


def schedule(
    file: Annotated[Path, typer.Argument(help="A blending schedule, in XML.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="A .bvh, .glb or video file; default: schedule.bvh."),
    ] = None,
    overwrite: OverwriteOption = False,
    codec: VideoCodecOption = "auto",
    character: Annotated[
        str, typer.Option(help="Who plays it: bundled, or a .glb file.")
    ] = "human",
    rate: Annotated[float, typer.Option(help="Frames a second.", min=1.0, max=240.0)] = 25.0,
    seconds: Annotated[
        float | None,
        typer.Option(help="How long, if an action has no end.", min=0.1, max=MAX_SECONDS),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of idle motions.")] = 0,
) -> None:
    """Render a blending schedule in XML to a motion file or a video.

    A schedule puts motions on a time line, where they share the joints of a body.

    Names of motions in it are those of files beside it, or a character and its clip: human#wave.

    Example: cubeling schedule docs/schedules/gesture.xml -o gesture.mp4
    """
    suffixes = (".bvh", ".glb", *VIDEO_FORMATS)
    target = chosen_output(output, "schedule.bvh", "schedule", suffixes, overwrite)
    check_video_codec(target, codec)
    check_input(file, "schedule")
    check_character(character)
    from cubeling.characters.motion import bake

    body = _body(character)
    found = read_schedule(file, body, seed)
    length = seconds or _length(file, found)
    clip = bake(found, rate, length, file.stem)
    _write(clip, body, target, codec)
    Console(highlight=False).print(
        f"[bold]{escape(str(target))}[/] is written: {quantity(len(clip), 'frame')}, "
        f"{length:.2f} s",
        soft_wrap=True,
    )


def read_schedule(file: Path, body: Character | None = None, seed: int = 0) -> Schedule:
    """Read a schedule for a body, that of the bundled human if it is left out.

    Raises
    ------
    AppError, CharacterError
        It cannot be read, is no schedule, or names what is not there.
    """
    from cubeling.characters import Character, dependent_joints_of, safe_ranges_of
    from cubeling.characters.motion import ScheduleReader

    mover = body or _body("human")
    # Thousands of actions may name one file: it is read once.
    load = cache(Character.load)
    motion = cache(lambda name: _motion(name, mover, load))
    reader = ScheduleReader(
        mover.skeleton,
        mover.anatomy,
        lambda name: motion(_beside(file, name)),
        cache(lambda name: _idle(file, name, mover, seed)),
        {
            "dependentjoints": lambda: dependent_joints_of(mover).move,
            "selfcollision": lambda: safe_ranges_of(mover).keep,
        },
    )
    return reader.read(SCHEDULE_FILE.read(file), str(file))


@lru_cache(maxsize=1)
def _body(character: str) -> Character:
    from cubeling.characters import Character
    from cubeling.characters.model import with_root_joint

    return with_root_joint(Character.load(character))


def _length(file: Path, found: Schedule) -> float:
    """Return when the last action of a schedule ends [s]."""
    import numpy as np

    ends = [action.end for action in found.actions if np.isfinite(action.end)]
    if not ends:
        raise AppError(f"{file}: no action has an end; say how long with --seconds")
    length = max(ends)
    if not 0.0 < length <= MAX_SECONDS:
        raise AppError(f"{file}: its last action ends at {length:g} s; give 0 to {MAX_SECONDS:g} s")
    return length


def _beside(file: Path, name: str) -> str:
    """Return the motion of a name in a schedule: a file beside it, else the name as it is."""
    path, mark, clip = name.partition("#")
    beside = file.parent / path
    return f"{beside}{mark}{clip}" if is_there(beside) else name


def _motion(name: str, body: Character, load: Callable[[str], Character]) -> Motion:
    """Return the motion of a file or clip, retargeted if it is on another skeleton."""
    from cubeling.characters import read_motions
    from cubeling.characters.model import load_recording, with_bind_pose
    from cubeling.characters.motion import skeleton_identity

    recording = load_recording(name, load=load)
    same = skeleton_identity(recording.skeleton) == skeleton_identity(with_bind_pose(body))
    return recording.clip if same else read_motions([name], body)[0]


def _idle(file: Path, name: str, body: Character, seed: int) -> Callable[[], Motion]:
    """Return what begins the idle motion of an .idle file, or of a bundled character."""
    from cubeling.characters import Character, CharacterError, standing_as

    if name.endswith(".idle"):
        motion = standing_as(body, Path(_beside(file, name))).standing
    else:
        who = Character.load(_beside(file, name))
        if len(who.skeleton) != len(body.skeleton):
            raise CharacterError(f"{who.name} and {body.name} have different bodies")
        motion = who.standing
    if motion is None:
        raise CharacterError(f"{name} has no idle motion; make it with cubeling idle learn")
    return partial(motion, seed)


def _write(clip: Clip, body: Character, target: Path, codec: str) -> None:
    """Write a clip of a character to a file; its suffix says which kind."""
    match target.suffix.lower():
        case ".bvh":
            from cubeling.characters.model import save_bvh

            save_bvh(clip, body.skeleton, body.anatomy, target)
        case ".glb":
            replace(body, clips={clip.name: clip}).save(target)
        case _:
            from cubeling.app.ui.clip_video import write_clip

            write_clip(target, body, clip, VIDEO_SIZE, codec=codec)
