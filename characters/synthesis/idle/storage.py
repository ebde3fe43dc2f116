"""The .idle file: the recordings of one person who stands, with her rests."""

from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np

from cubeling.affect.regions import Region, RegionBox, Sector
from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.characters.synthesis.archive import (
    ArchiveFormat,
    Arrays,
    Content,
    read_skeleton,
    skeleton_content,
)
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.recordings import BALANCES, RestSpan, StandingRecording
from cubeling.files import FileKind

IDLE_FORMAT = ArchiveFormat(
    "cubeling idle motion",
    2,
    FileKind(
        "idle motion",
        (".idle",),
        CharacterError,
        1 << 30,
        "cubeling.characters.synthesis.idle.storage:load_person",
    ),
    "cubeling idle learn",
)
"""The format of `.idle` files: `cubeling idle learn` writes them."""

STEP = 1e-4
"""Resolution of postures in the file [rad and m]."""

Person = tuple[Skeleton, Anatomy, tuple[StandingRecording, ...]]
"""Recordings of one person, and the skeleton that they are on."""


def save_person(person: Person, path: Path) -> None:
    """Write an .idle file."""
    skeleton, anatomy, recordings = person
    content, arrays = map(dict, skeleton_content(skeleton, anatomy))
    content["recordings"] = [
        [each.name, each.rate, *(_write_region(end) for end in (each.feeling, each.before) if end)]
        for each in recordings
    ]
    for number, each in enumerate(recordings):
        arrays[f"vectors_{number}"] = np.rint(each.vectors / STEP).astype(np.int16)
        arrays[f"balance_{number}"] = each.balance.astype(np.float32)
        arrays[f"rests_{number}"] = np.array(
            [(rest.first, rest.end, BALANCES.index(rest.balance)) for rest in each.rests], np.int32
        )
    IDLE_FORMAT.save(path, content, arrays)


def load_person(path: Path) -> Person:
    """Read an .idle file; the same one is read once.

    Raises
    ------
    CharacterError
        If it is missing, damaged, of another version, or something else.
    """
    return IDLE_FORMAT.load_once(path, _person)


def _person(content: Content, arrays: Arrays) -> Person:
    skeleton, anatomy = read_skeleton(content, arrays)
    size = PostureVectors.of(skeleton, anatomy).size
    recordings = tuple(
        _recording(
            str(name), float(rate), [_region(*each) for each in feeling], size, arrays, number
        )
        for number, (name, rate, *feeling) in enumerate(content["recordings"])
    )
    if not recordings:
        raise ValueError("it has no recording")
    return skeleton, anatomy, recordings


def _write_region(region: Region) -> list[str | list[float]]:
    """Return a region as it is written: its kind and its numbers."""
    # Names of the file format, whatever the classes are called.
    return ["Box" if isinstance(region, RegionBox) else "Sector", *astuple(region)]


def _region(kind: str, *values: Any) -> Region:
    if kind == "Box":
        (a, b), (c, d) = values
        return RegionBox((float(a), float(b)), (float(c), float(d)))
    middle, width, inner = map(float, values)
    return Sector(middle, width, inner)


def _recording(
    name: str, rate: float, feelings: list[Region], size: int, arrays: Arrays, number: int
) -> StandingRecording:
    vectors, balance = (arrays[f"{what}_{number}"].astype(float) for what in ("vectors", "balance"))
    vectors *= STEP
    rests = arrays[f"rests_{number}"]
    frames = len(balance)
    if vectors.shape != (frames, size) or not rate > 0:
        raise ValueError("its postures do not belong to its skeleton")
    if not (np.isfinite(vectors).all() and np.isfinite(balance).all()):
        raise ValueError("its postures are damaged")
    if rests.ndim != 2 or rests.shape[1] != 3 or not len(rests):
        raise ValueError("its rests are damaged")
    if rests[:, :2].min() < 0 or rests[:, :2].max() > frames or (rests[:, 1] <= rests[:, 0]).any():
        raise ValueError("its rests are not in its frames")
    found = tuple(
        RestSpan(int(first), int(end), BALANCES[side]) for first, end, side in rests.tolist()
    )
    return StandingRecording(name, rate, vectors, balance, found, *feelings[:2])


def as_clips(person: Person) -> list[Clip]:
    """Return the recordings of a person as clips that stay in place, for other skeletons."""
    skeleton, anatomy, recordings = person
    kind = PostureVectors.of(skeleton, anatomy)
    return [
        Clip(each.name, each.rate, kind.poses(each.vectors), root_motion=True)
        for each in recordings
    ]
