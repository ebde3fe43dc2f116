"""Libraries of beat gestures, and the .gestures file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.masks import Mask, mask_of, subtree
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from cubeling.characters.synthesis.archive import (
    ArchiveFormat,
    Arrays,
    Content,
    read_skeleton,
    skeleton_content,
    skeleton_identity,
)
from cubeling.characters.synthesis.choices import Database
from cubeling.files import FileKind

GESTURE_FORMAT = ArchiveFormat(
    "cubeling gestures",
    1,
    FileKind(
        "gesture library",
        (".gestures",),
        CharacterError,
        1 << 30,
        "cubeling.characters.synthesis.gestures.library:GestureLibrary.load",
    ),
    "cubeling gesture learn",
)
"""The format of `.gestures` files: `cubeling gesture learn` writes them."""

STEP_RAD = 1e-4
"""Resolution of rotation vectors in the file [rad]."""

Hand = Literal["left", "right", "both"]
"""Which hands make a stroke."""

Bounds = tuple[int, int, int, int, int, int]
"""Frames at which the five `PHASES` of a phrase begin, and the last frame of the last phase."""

DATABASE_SHARE = 2 / 3
"""Share of the phrases, by strength, in the databases "aggressive" and "neutral"."""

PHASES = ("preparation", "pre-hold", "stroke", "post-hold", "retraction")
"""The phases of a gesture phrase, in order (M4); all but the stroke may be empty."""


@dataclass(frozen=True)
class GesturePhrase:
    """One beat gesture in a recording; frames are those of the recording."""

    recording: int
    """Number of its recording in the library."""

    hand: Hand
    """Which hands make the stroke."""

    bounds: Bounds
    """Frames at which the five `PHASES` begin, and the last frame of the last phase."""

    apex: int
    """Frame of the greatest extension of the stroke."""

    strength: float
    """GSI of the stroke, mean variant: ln of degrees² a second², weighted by masses (M4)."""

    @property
    def stroke(self) -> tuple[int, int]:
        """First and last frame of the stroke."""
        return self.bounds[2], self.bounds[3]

    def phase(self, name: str) -> tuple[int, int]:
        """Return the first and the last frame of a phase; equal if the phrase has none."""
        number = PHASES.index(name)
        return self.bounds[number], self.bounds[number + 1]


@dataclass(frozen=True, eq=False)
class GestureRecording:
    """The upper body of a clip: one or more gesture phrases, often from rest to rest."""

    name: str
    """Name of the clip it was learned from."""

    turns: Array
    """Local rotations of the library's joints, (frames, joints, 4), with continuous signs."""


@dataclass(frozen=True, eq=False)
class GestureLibrary:
    """Gesture phrases of one body."""

    skeleton: Skeleton

    anatomy: Anatomy
    """Which joint is which body part."""

    joints: tuple[int, ...]
    """The joints that gestures move, parents first."""

    rate: float
    """Frame rate of all recordings [Hz]."""

    rest: Array
    """Local rotations of these joints in rest, (joints, 4)."""

    recordings: Sequence[GestureRecording]
    """The recordings that phrases refer to by index."""

    phrases: tuple[GesturePhrase, ...]
    """What is in it, in order of recordings and time."""

    def __post_init__(self) -> None:
        if not self.phrases:
            raise CharacterError("a gesture library needs at least one gesture phrase")

    @property
    def skeleton_identity(self) -> str:
        """A text that changes with the joints, their order and their rest pose."""
        return skeleton_identity(self.skeleton)

    @cached_property
    def strengths(self) -> Array:
        """GSI of each phrase, (phrases,)."""
        return np.array([phrase.strength for phrase in self.phrases])

    @cached_property
    def mask(self) -> Mask:
        """1 for each joint that gestures move, (joints of the skeleton,)."""
        return mask_of(self.skeleton, joints={self.skeleton.names[n]: 1.0 for n in self.joints})

    @cached_property
    def consecutive(self) -> tuple[bool, ...]:
        """Whether each phrase begins where the phrase before it ends (E1 of M7)."""
        pairs = zip(self.phrases, self.phrases[1:], strict=False)
        return False, *(a.recording == b.recording and a.bounds[5] == b.bounds[0] for a, b in pairs)

    def turns(self, phrase: GesturePhrase) -> Array:
        """Return the rotations of a phrase, (frames, joints, 4)."""
        return self.recordings[phrase.recording].turns[phrase.bounds[0] : phrase.bounds[5] + 1]

    def poses(self, turns: Array) -> Pose:
        """Return poses with these rotations (…, joints, 4); all other joints are at rest."""
        rest = self.skeleton.rest
        shape = turns.shape[:-2]
        whole = np.broadcast_to(rest.rotations, (*shape, *rest.rotations.shape)).copy()
        whole[..., list(self.joints), :] = turns
        return Pose(np.broadcast_to(rest.translations, whole.shape[:-1] + (3,)).copy(), whole)

    def database(self, name: Database) -> "GestureLibrary":
        """Return the library with the stronger or the weaker phrases only, or all.

        Raises
        ------
        CharacterError
            If there is no such database.
        """
        if name not in get_args(Database):
            known = ", ".join(get_args(Database))
            raise CharacterError(f"gesture database {name!r}; there are {known}")
        if name == "full":
            return self
        share = 1 - DATABASE_SHARE if name == "aggressive" else DATABASE_SHARE
        limit = np.quantile(self.strengths, share)
        kept = self.strengths >= limit if name == "aggressive" else self.strengths <= limit
        chosen = tuple(each for each, keep in zip(self.phrases, kept, strict=True) if keep)
        return replace(self, phrases=chosen)

    def save(self, path: Path) -> None:
        """Write a .gestures file."""
        content, arrays = map(dict, skeleton_content(self.skeleton, self.anatomy))
        content["rate"] = self.rate
        content["recordings"] = [each.name for each in self.recordings]
        content["phrases"] = [
            [each.recording, each.hand, [*each.bounds], each.apex, each.strength]
            for each in self.phrases
        ]
        arrays["joints"] = np.array(self.joints, np.int32)
        arrays["rest"] = _pack(self.rest)
        for number, each in enumerate(self.recordings):
            arrays[f"turns_{number}"] = _pack(each.turns)
        GESTURE_FORMAT.save(path, content, arrays)

    @staticmethod
    def load(path: Path) -> "GestureLibrary":
        """Read a .gestures file; the same one is read once.

        Raises
        ------
        CharacterError
            If it is missing, damaged, of another version, or something else.
        """
        return GESTURE_FORMAT.load_once(path, _library)


def gesture_joints(skeleton: Skeleton, anatomy: Anatomy) -> tuple[int, ...]:
    """Return the joints that gestures move, parents first: spine, head, arms and fingers.

    On four legs they are those of neck, head and tail: the trunk carries legs that stand. A body
    without spine or head has none.
    """
    four_legs = anatomy.kind == "quadruped"
    base, head = anatomy.joint("neck" if four_legs else "spine"), anatomy.joint("head")
    if base is None or head is None:
        return ()
    hands = [anatomy.joints[f"{side}Hand"] for side in SIDES if f"{side}Hand" in anatomy.joints]
    moved = set(skeleton.with_ancestors([head, *hands])) & set(subtree(skeleton, base))
    moved.update(joint for hand in hands for joint in subtree(skeleton, hand))
    if four_legs:
        moved.update(joint for part, joint in anatomy.joints.items() if part.startswith("tail"))
    return tuple(sorted(moved))


def _pack(turns: Array) -> Array:
    """Return rotations as integers: their rotation vectors in steps of `STEP_RAD`."""
    packed: Array = np.rint(rotations.to_rotation_vector(turns) / STEP_RAD).astype(np.int16)
    return packed


def _unpack(packed: Array) -> Array:
    return rotations.from_rotation_vector(packed.astype(float) * STEP_RAD)


def _library(content: Content, arrays: Arrays) -> GestureLibrary:
    skeleton, anatomy = read_skeleton(content, arrays)
    joints = tuple(int(joint) for joint in arrays["joints"])
    recordings = tuple(
        GestureRecording(str(name), rotations.continuous(_unpack(arrays[f"turns_{number}"])))
        for number, name in enumerate(content["recordings"])
    )
    if not joints or not 0 <= min(joints) <= max(joints) < len(skeleton):
        raise ValueError("its joints do not belong to its skeleton")
    for each in recordings:
        if each.turns.shape[1:] != (len(joints), 4):
            raise ValueError("its rotations do not belong to its joints")
    lengths = [len(each.turns) for each in recordings]
    phrases = tuple(_phrase(each, lengths) for each in content["phrases"])
    rate, rest = float(content["rate"]), _unpack(arrays["rest"])
    if not rate > 0 or rest.shape != (len(joints), 4):
        raise ValueError("its rest or its rate is damaged")
    return GestureLibrary(skeleton, anatomy, joints, rate, rest, recordings, phrases)


def _phrase(row: list[Any], lengths: list[int]) -> GesturePhrase:
    """Return the phrase of a row of the file; refuse one that is not in its recording."""
    recording, hand, bounds, apex, strength = row
    a, b, c, d, e, f = map(int, bounds)
    found = next((each for each in get_args(Hand) if each == hand), None)
    if found is None:
        raise ValueError("a phrase has no such hand")
    ordered = (
        recording >= 0 and 0 <= a <= b <= c < d <= e <= f < lengths[recording] and c <= apex <= f
    )
    if not ordered or not np.isfinite(strength):
        raise ValueError("a phrase is not in its recording")
    return GesturePhrase(int(recording), found, (a, b, c, d, e, f), int(apex), float(strength))
