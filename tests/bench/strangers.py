"""Grade models and motions that others made: `python -m tests.bench.strangers FOLDER`.

Every model of the folder learns to walk: from its own clips that are named as gaits, from a bundled
walk (an animal from the first gait of an animal in the folder), and from the first walk among the
folder's motions. Every motion makes a bundled character walk: the human, or Vleo for an animal; one
that is no gait is retargeted as a whole. Lengths and speeds are at the size of a person.

load, time
    Seconds to read the file, and to make all walking clips.
faces
    Angle between the body's front and +z: of a model at rest, else of the gait and its way.
size
    Greatest change of a limb bone in all clips made, against the model at rest.
steps
    Landings of each foot in one cycle of the walk.
slide, sinks, knees
    The worst of all clips made: mean slide of standing feet, depth of the soles below the ground,
    and bend of the knees beyond the motion's.
seam
    Distance of the joints where the cycle was closed.
gap, tilt
    Of the walk: greatest distance of a foot from the end of its shin, in parts of the leg, and
    angle from hips to head against that at rest.
hands
    How much lower the hands of a person at rest are than the shoulders, in parts of the arm.
morphs
    Least and greatest weight of all morphs of who looks about and feels at rest.

A refusal is shown with its reason, and anything unexpected as BROKE. Exits with 1 if something
broke, or a row is beyond the bar. With `-o PICTURES`, each row gets a picture there.
"""

import argparse
import math
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import track
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.app.ui.contact_sheets import ContactSheets, save
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    CharacterError,
    RootDelta,
    with_lent_motions,
)
from cubeling.characters.formats import is_motion_only
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import CHARACTER_READERS
from cubeling.characters.motion.clip import Clip
from cubeling.characters.rendering import create_context
from cubeling.characters.retargeting import Recording, load_recording, make_locomotion, retarget
from cubeling.characters.retargeting.feet.footskate import find_foot_contacts
from cubeling.characters.retargeting.locomotion.grading import (
    MAX_BONE_CHANGE,
    MAX_FACING_ERROR_DEG,
    MAX_KNEE_EXCESS_DEG,
    MAX_SEAM_CM,
    MAX_SINKING_CM,
    MAX_SLIDE_CM_S,
    PERSON_LEG_M,
    GaitReport,
)
from cubeling.characters.retargeting.measures import (
    bone_change,
    facing_error,
    foot_gap,
    hands_below_shoulders,
    sole_dip,
    trunk_tilt,
)
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import with_root_joint
from tests.bench.retarget import PERSON_HEIGHT_M, feet, knees_beyond, on_treadmill

GAIT_NAME = re.compile(r"walk|run|jog|gallop|trot|stroll", re.IGNORECASE)
"""Clips of models that are taken as gaits."""

COLUMNS = (
    *("load", "time", "faces", "size", "steps", "slide", "sinks", "knees", "seam"),
    *("gap", "tilt", "hands", "morphs"),
)
"""Measures of a row, in the order of the table."""


MAX_GAP, MAX_TILT_DEG, MIN_HANDS = 0.01, 20.0, 0.5
"""Bars of `gap`, `tilt` and `hands`."""

REST_FRAMES = 60
"""Frames in which a model looks about at rest."""


@dataclass
class Row:
    """One motion on one character: figures, or the reason why there are none."""

    character: str
    motion: str
    cells: dict[str, str]
    over: set[str]
    """Columns that are beyond the bar."""

    refused: str = ""
    broke: bool = False
    body: Character | None = None
    """The character with the clip that was made, for the picture."""

    clip: str = ""
    """Name of that clip."""


def main() -> None:
    """Print the table and its totals."""
    parser = argparse.ArgumentParser(description="Grade models and motions of others.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="folder for pictures")
    given = parser.parse_args()
    console = Console(width=210)
    if not given.folder.is_dir():
        console.print(f"{given.folder} is no folder")
        sys.exit(2)
    warnings.simplefilter("ignore")
    jobs = list(jobs_of(given.folder))
    rows = [job() for job in track(jobs, "Grading", console=Console(stderr=True), transient=True)]
    console.print(table_of(rows))
    over = {column: sum(column in row.over for row in rows) for column in COLUMNS}
    broke, refused = (sum(bool(getattr(r, name)) for r in rows) for name in ("broke", "refused"))
    beyond = ", ".join(f"{column} {count}" for column, count in over.items() if count)
    console.print(
        f"{len(rows)} rows: {len(rows) - refused - broke} graded, {refused} refused, "
        f"{broke} broke; beyond the bar: {beyond or 'none'}"
    )
    if given.output is not None:
        draw(rows, given.output)
    sys.exit(bool(broke or beyond))


def jobs_of(folder: Path) -> Iterator[Callable[[], Row]]:
    """Yield the work of each row."""
    files = [path for path in sorted(folder.rglob("*")) if path.is_file()]
    models, motions = [], []
    for path in files:
        suffix = path.suffix.lower()
        if is_motion_only(path) and suffix != ".asf":
            motions += [str(path)] if suffix not in CHARACTER_READERS else _clips_of(path)
        elif suffix in CHARACTER_READERS or suffix in (".fbx", ".dae", ".blend"):
            models.append(path)
    gaits: dict[str, list[str]] = {}
    for path in models:
        for name in _named_gaits(path):
            gaits.setdefault(_kind(name), []).append(name)
    walks = {"humanoid": ["human#Walk"], "quadruped": gaits.get("quadruped", [])[:1]}
    strange = next((name for name in motions if _walks(name)), None)
    for path in models:
        own = _named_gaits(path)
        others = walks.get(_kind_of_model(path), walks["humanoid"])
        if strange is not None and others == walks["humanoid"]:
            others = [*others, strange]
        for name in own + [name for name in others if name not in own] or ["human#Walk"]:
            yield partial(graded, str(path), name, folder)
    for name in motions + [name for names in gaits.values() for name in names]:
        body = "vleo" if _kind(name) == "quadruped" else "human"
        yield partial(graded, body, name, folder)


def graded(character: str, motion: str, folder: Path) -> Row:
    """Return the row of a motion on a character; it never raises."""
    shown = [each.removeprefix(f"{folder}/") for each in (character, motion)]
    row = Row(shown[0], shown[1], {}, set())
    try:
        _grade(row, character, motion)
    except CharacterError as error:
        row.refused = str(error).replace(f"{folder}/", "")
    except Exception as error:  # whatever their files do is to be shown
        row.refused, row.broke = f"BROKE: {type(error).__name__}: {error}", True
    return row


def _grade(row: Row, name: str, motion: str) -> None:
    start = time.perf_counter()
    character = Character.load(name)
    row.cells["load"] = f"{time.perf_counter() - start:.1f} s"
    recording = load_recording(motion)
    loaded = Rig(character.skeleton, character.anatomy)
    if name.endswith(tuple(CHARACTER_READERS)):
        _grade_rest(row, name)
    start = time.perf_counter()
    try:
        made = make_locomotion(replace(character, clips={}), [recording])
    except CharacterError as error:
        row.refused = str(error)
        if not motion.startswith(name):  # its own motions stay as they are
            _grade_whole(row, character, recording)
        return
    row.cells["time"] = f"{time.perf_counter() - start:.1f} s"
    gaits = [*made.recordings, *made.clips]
    row.body, row.clip = made.character, "Walk"
    walk, rig = made.character.clips["Walk"], Rig(made.character.skeleton, made.character.anatomy)
    turn = _turn(loaded, made.recordings[0], is_model=name.endswith(tuple(CHARACTER_READERS)))
    size = 100 * PERSON_LEG_M / made.recordings[0].leg_length
    _fill(
        row,
        faces=turn,
        size=max(bone_change(walk.poses, rig), *(gait.bone_change for gait in made.clips)),
        slide=size * max(gait.slide for gait in gaits),
        sinks=size * max(gait.sinking for gait in gaits),
        knees=math.degrees(max(gait.knee_excess for gait in gaits)),
        gap=foot_gap(walk.poses, rig),
        tilt=math.degrees(float(trunk_tilt(walk.in_place, rig).max())),
        seam=size * made.recordings[0].seam,
    )
    row.cells["steps"] = _landings(walk, rig)


def _grade_rest(row: Row, name: str) -> None:
    """Grade the arms and morphs of a model that stands, looks about and feels."""
    hands, low, high = _rest_of(name)
    if hands is not None:
        row.cells["hands"] = f"{hands:.2f}"
        row.over |= {"hands"} if hands < MIN_HANDS else set()
    row.cells["morphs"] = f"{low:.1f}…{high:.1f}"
    row.over |= {"morphs"} if low < 0.0 or high > 1.0 else set()


@lru_cache(maxsize=1)
def _rest_of(name: str) -> tuple[float | None, float, float]:
    """Return how low the hands of a model at rest are, and its least and greatest morph weight."""
    character = Character.load(name)
    body = with_lent_motions(replace(character, clips={}))
    animator = Animator(body, place=RootDelta())
    poses = []
    for number in range(REST_FRAMES):
        aside = np.array([0.3 * math.sin(number / 5), 0.05, 0.3])
        feeling = Emotion(math.cos(number / 9), math.sin(number / 7))
        asked = CharacterCommand(number / 30, gaze=aside, emotion=feeling)
        poses.append(animator.update(asked).pose)
    weights = np.array([pose.morphs for pose in poses if pose.morphs is not None])
    rig = Rig(body.skeleton, body.anatomy)
    hands = hands_below_shoulders(poses[0][None], rig) if rig.anatomy.kind == "humanoid" else None
    return hands, float(weights.min(initial=0.0)), float(weights.max(initial=0.0))


def _turn(loaded: Rig, report: GaitReport, is_model: bool) -> float:
    """Return how far a model at rest looks away from +z, or a gait from its way [degrees]."""
    at_rest = facing_error(loaded.skeleton.rest[None], loaded) if is_model else 0.0
    return max(abs(math.degrees(at_rest)), abs(math.degrees(report.facing)))


def _landings(clip: Clip, rig: Rig) -> str:
    """Return how often each foot lands in a cycle."""
    standing = find_foot_contacts(clip, rig, rig.legs).any[:-1]
    return " ".join(str(int(n)) for n in (standing & ~np.roll(standing, 1, axis=0)).sum(0))


def _grade_whole(row: Row, character: Character, recording: Recording) -> None:
    """Measure a motion that is no gait as it is retargeted, if it can be."""
    with suppress(CharacterError):
        body = with_root_joint(replace(character, skeleton=with_bind_pose(character)))
        rig = Rig(body.skeleton, body.anatomy)
        clip = retarget(
            recording.clip,
            recording.skeleton,
            recording.anatomy,
            rig.skeleton,
            rig.anatomy,
            meshes=body.meshes,
        )
        slide = 0.0 if on_treadmill(recording) else feet(recording, clip, rig, body.height)[0]
        _fill(
            row,
            size=bone_change(clip.poses, rig),
            slide=slide,
            sinks=100 * PERSON_HEIGHT_M / body.height * sole_dip(clip.poses, rig, body.meshes),
            knees=np.fmax(knees_beyond(recording, clip, rig), 0.0),  # NaN for animals
        )
        row.body, row.clip = replace(body, clips={"whole": replace(clip, name="whole")}), "whole"


def _fill(row: Row, **figures: float) -> None:
    """Write figures into a row, and note those beyond the bar."""
    bars = {
        "faces": (MAX_FACING_ERROR_DEG, "{:.0f}°"),
        "size": (MAX_BONE_CHANGE, "{:.1%}"),
        "slide": (MAX_SLIDE_CM_S, "{:.2f} cm/s"),
        "sinks": (MAX_SINKING_CM, "{:.1f} cm"),
        "knees": (MAX_KNEE_EXCESS_DEG, "{:.1f}°"),
        "seam": (MAX_SEAM_CM, "{:.1f} cm"),
        "gap": (MAX_GAP, "{:.1%}"),
        "tilt": (MAX_TILT_DEG, "{:.0f}°"),
    }
    for column, figure in figures.items():
        bar, form = bars[column]
        row.cells[column] = form.format(figure)
        if figure > bar:
            row.over.add(column)


def table_of(rows: list[Row]) -> Table:
    """Return the table; figures beyond the bar are red."""
    table = Table(title="Models and motions of others, at the size of a person")
    table.add_column("character", overflow="fold")
    table.add_column("motion", overflow="fold")
    for column in COLUMNS:
        table.add_column(column, justify="right", no_wrap=True)
    table.add_column("refused", overflow="fold", style="dim")
    for row in rows:
        cells = [
            f"[red]{row.cells[c]}[/]" if c in row.over else row.cells.get(c, "") for c in COLUMNS
        ]
        reason = f"[red]{escape(row.refused)}[/]" if row.broke else escape(row.refused)
        table.add_row(escape(row.character), escape(row.motion), *cells, reason)
    return table


def draw(rows: list[Row], folder: Path) -> None:
    """Write a picture of each clip that was made."""
    context = create_context()
    sheets = ContactSheets(context)
    for number, row in enumerate(
        track(rows, "Drawing", console=Console(stderr=True), transient=True)
    ):
        if row.body is not None:
            name = re.sub(r"[^\w.#-]+", "_", f"{number:03d}-{row.motion}-on-{row.character}")
            save(sheets.clips(row.body, [row.body.clips[row.clip]]), folder / f"{name}.png")
    sheets.release()
    context.release()


def _clips_of(path: Path) -> list[str]:
    """Return the clips of a file without a mesh, with its name."""
    try:
        load_recording(str(path))
    except CharacterError as error:
        found = re.search(r"has (.*); say which one", str(error))
        names = found.group(1).split(", ") if found else []
        return [f"{path}#{name}" for name in names] or [str(path)]
    return [str(path)]


def _named_gaits(path: Path) -> list[str]:
    """Return the clips of a model that are named as gaits, at most two."""
    with suppress(Exception):
        clips: dict[str, Clip] = dict(Character.load(path).clips)
        names = [name for name in clips if GAIT_NAME.search(name)]
        if len(clips) == 1:
            names = list(clips)
        return [f"{path}#{name}" for name in names[:2]]
    return []


def _kind(motion: str) -> str:
    """Return whether a motion is of a "humanoid" or a "quadruped"."""
    with suppress(Exception):
        return str(load_recording(motion).anatomy.kind)
    return "humanoid"


def _kind_of_model(path: Path) -> str:
    with suppress(Exception):
        return str(Character.load(path).anatomy.kind)
    return "humanoid"


def _walks(motion: str) -> bool:
    """Return whether the bundled human walks by a motion."""
    with suppress(Exception):
        make_locomotion(Character.load("human"), [load_recording(motion)])
        return True
    return False


if __name__ == "__main__":
    main()
