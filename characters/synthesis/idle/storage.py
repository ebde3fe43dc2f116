"""The .idle file: the recordings of one person who stands, with her rests."""

from pathlib import Path

import numpy as np

from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Pose, Skeleton
from characters.synthesis.archive import (
    ArchiveFormat,
    Arrays,
    Content,
    read_skeleton,
    skeleton_content,
)
from characters.synthesis.idle.posture_space import PostureVectors
from characters.synthesis.idle.recordings import BALANCES, Rest, StandingRecording

IDLE_FORMAT = ArchiveFormat("cubeling idle motion", 1, "idle motion", "cubeling idle learn")
"""The .idle file."""

Person = tuple[Skeleton, Anatomy, tuple[StandingRecording, ...]]
"""Recordings of one person, and the skeleton that they are on."""


def save_person(person: Person, path: Path) -> None:
    """Write an .idle file."""
    skeleton, anatomy, recordings = person
    content, arrays = map(dict, skeleton_content(skeleton, anatomy))
    content["recordings"] = [[each.name, each.rate] for each in recordings]
    kind = PostureVectors.of(skeleton, anatomy)
    for number, each in enumerate(recordings):
        poses = kind.poses(each.vectors)
        arrays[f"rotations_{number}"] = poses.rotations[:, kind.joints].astype(np.float32)
        arrays[f"hips_{number}"] = poses.translations[:, kind.hips].astype(np.float32)
        arrays[f"balance_{number}"] = each.balance.astype(np.float32)
        arrays[f"rests_{number}"] = np.array(
            [(rest.first, rest.end, BALANCES.index(rest.balance)) for rest in each.rests], np.int32
        )
    IDLE_FORMAT.save(path, content, arrays)


def load_person(path: Path) -> Person:
    """Read an .idle file.

    Raises
    ------
    CharacterError
        If it is missing, damaged, of another version, or something else.
    """
    return IDLE_FORMAT.load(path, _person)


def _person(content: Content, arrays: Arrays) -> Person:
    skeleton, anatomy = read_skeleton(content, arrays)
    recordings = tuple(
        _recording(skeleton, anatomy, str(name), float(rate), arrays, number)
        for number, (name, rate) in enumerate(content["recordings"])
    )
    if not recordings:
        raise ValueError("it has no recording")
    return skeleton, anatomy, recordings


def _recording(
    skeleton: Skeleton, anatomy: Anatomy, name: str, rate: float, arrays: Arrays, number: int
) -> StandingRecording:
    kind = PostureVectors.of(skeleton, anatomy)
    turns: Array = arrays[f"rotations_{number}"].astype(float)
    hips, balance = (arrays[f"{what}_{number}"].astype(float) for what in ("hips", "balance"))
    rests = arrays[f"rests_{number}"]
    frames = len(turns)
    if turns.shape[1:] != (len(kind.joints), 4) or hips.shape != (frames, 3) or not rate > 0:
        raise ValueError("its postures do not belong to its skeleton")
    if not (np.isfinite(turns).all() and np.isfinite(hips).all() and frames == len(balance)):
        raise ValueError("its postures are damaged")
    if rests.ndim != 2 or rests.shape[1] != 3 or not len(rests):
        raise ValueError("its rests are damaged")
    if rests[:, :2].min() < 0 or rests[:, :2].max() > frames or (rests[:, 1] <= rests[:, 0]).any():
        raise ValueError("its rests are not in its frames")
    rest = skeleton.rest
    moved = np.tile(rest.translations, (frames, 1, 1))
    turned = np.tile(rest.rotations, (frames, 1, 1))
    turned[:, kind.joints], moved[:, kind.hips] = rotations.normalize(turns), hips
    found = tuple(Rest(int(first), int(end), BALANCES[side]) for first, end, side in rests.tolist())
    return StandingRecording(name, rate, kind.vectors(Pose(moved, turned)), balance, found)


def as_clips(person: Person) -> list[Clip]:
    """Return the recordings of a person as clips that stay in place, for other skeletons."""
    skeleton, anatomy, recordings = person
    kind = PostureVectors.of(skeleton, anatomy)
    return [
        Clip(each.name, each.rate, kind.poses(each.vectors), root_motion=True)
        for each in recordings
    ]
