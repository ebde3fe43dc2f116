"""Motions that a bundled character lends to one that has none to stand, and gestures of speech.

Files of persons often have no clips (VRM, VRoid, Ready Player Me), or one walk or dance; without a
loan they would stand in the pose in which they were modelled, or in mid-stride. Clips of their own
come before lent ones of the same name. A clip is retargeted when it is first asked for.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from importlib import resources
from typing import overload

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.retargeting.attached_limbs import (
    with_attached_limbs,
    with_toe_ends,
    without_rest_scales,
)
from cubeling.characters.retargeting.hanging_arms import ArmClearance
from cubeling.characters.retargeting.mapping import map_joints
from cubeling.characters.retargeting.retarget import retarget_between
from cubeling.characters.retargeting.rig import Rig
from cubeling.characters.retargeting.root import with_root_joint
from cubeling.characters.retargeting.transfer import local_rotations, transferred_rotations
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.gestures.library import (
    GestureLibrary,
    GestureRecording,
    gesture_joints,
)

MIN_RATE_HZ = 30.0
"""Clips are lent with as few frames as this allows: half of them take half the time."""

IDLE_CLIP = "idle"
"""The clip of the lender in which arms hang."""


def with_lent_motions(character: Character) -> Character:
    """Return a character with the clips and gestures of `Character.lender`, if it has one.

    The result has a root joint on the ground, so that it can walk. A character that can stand by
    itself, or a body that the lender's motions do not fit, is returned as it is.
    """
    if character.lender is None:
        return character
    moving = {name: clip for name, clip in character.clips.items() if clip.duration > 0.0}
    body = with_root_joint(replace(character.with_stated_anatomy, clips=moving))
    # A file may rest in mid-stride: then its feet, arms and height would be those of a stride.
    body = with_attached_limbs(replace(body, skeleton=with_bind_pose(body)))
    if not moving:
        body = with_toe_ends(without_rest_scales(body))
    try:
        loan = MotionLoan(character.lender, body)
    except CharacterError:  # its legs or hips are not known: it stays in its rest pose
        return character
    clips = LentClips(loan, body.clips)
    return replace(body, clips=clips, gestures=body.gestures or loan.gestures())


class MotionLoan:
    """Takes motions of a bundled character to another body, which rests as it was modelled.

    Raises CharacterError if that has no hips or no legs, or is of another kind.
    """

    def __init__(self, lender: str, body: Character) -> None:
        self._body = body
        self._library = _gestures_of(lender)
        self._lender = lender
        self._target = Rig(body.skeleton, body.anatomy, body.meshes)
        self._source = Rig(self._library.skeleton, self._library.anatomy)
        self._mapping = map_joints(self._source, self._target)

    @property
    def lender(self) -> Character:
        """Who lends; its file is read when a clip is first asked for."""
        return _lender(self._lender)

    def clip(self, name: str) -> Clip:
        """Return a clip of the lender for the body.

        Raises
        ------
        KeyError
            If the lender has no such clip.
        """
        made = self._retarget(_thin(self.lender.clips[name]))
        return replace(made, poses=self._arms.hold(made.poses))

    @cached_property
    def _arms(self) -> ArmClearance:
        standing = self.lender.clips[IDLE_CLIP]
        first = replace(standing, poses=standing.poses[:1], loop=False)
        return ArmClearance.of(self._target, self._retarget(first).poses[0])

    def _retarget(self, clip: Clip) -> Clip:
        return retarget_between(clip, self._source, self._target)

    def gestures(self) -> GestureLibrary | None:
        """Return the lender's gestures of speech for the body; None if nothing of it could move."""
        joints = gesture_joints(self._body.skeleton, self._body.anatomy)
        if not joints:
            return None
        return GestureLibrary(
            self._body.skeleton,
            self._body.anatomy,
            joints,
            self._library.rate,
            self._turns(self._library.rest[None], joints)[0],
            LentRecordings(self, self._library.recordings, joints),
            self._library.phrases,
        )

    def _turns(self, turns: Array, joints: Sequence[int]) -> Array:
        """Return rotations (frames, n, 4) of the lender's library for joints of the body."""
        clip = Clip("gestures", self._library.rate, self._library.poses(turns), loop=False)
        found = transferred_rotations(clip, self._source, self._target, self._mapping)
        turned = rotations.multiply(rotations.conjugate(self._target.common_from_skeleton), found)
        return local_rotations(turned, self._target.skeleton.parents)[:, list(joints)]

    def recording(self, recording: GestureRecording, joints: Sequence[int]) -> GestureRecording:
        """Return a recording of the lender's library for joints of the body."""
        return replace(recording, turns=self._turns(recording.turns, joints))


class LentClips(Mapping[str, Clip]):
    """A character's own clips and, after them, those of a loan under names that it has not."""

    def __init__(self, loan: MotionLoan, own: Mapping[str, Clip]) -> None:
        self._loan = loan
        self._own = own
        self._made: dict[str, Clip] = {**own}

    def __getitem__(self, name: str) -> Clip:
        if name not in self._made:
            self._made[name] = self._loan.clip(name)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys([*self._own, *self._loan.lender.clips]))

    def __len__(self) -> int:
        return len(self._own.keys() | self._loan.lender.clips.keys())

    def __contains__(self, name: object) -> bool:
        # A Mapping's own would make the clip.
        return name in self._own or name in self._loan.lender.clips


class LentRecordings(Sequence[GestureRecording]):
    """The recordings of a lent gesture library."""

    def __init__(
        self, loan: MotionLoan, recordings: Sequence[GestureRecording], joints: Sequence[int]
    ) -> None:
        self._loan, self._recordings, self._joints = loan, recordings, joints
        self._made: dict[int, GestureRecording] = {}

    def __len__(self) -> int:
        return len(self._recordings)

    @overload
    def __getitem__(self, number: int) -> GestureRecording: ...

    @overload
    def __getitem__(self, number: slice) -> Sequence[GestureRecording]: ...

    def __getitem__(self, number: int | slice) -> GestureRecording | Sequence[GestureRecording]:
        if isinstance(number, slice):
            return [self[each] for each in range(len(self))[number]]
        if number not in self._made:
            self._made[number] = self._loan.recording(self._recordings[number], self._joints)
        return self._made[number]


@lru_cache(maxsize=2)
def _lender(name: str) -> Character:
    return Character.load(name)


def _gestures_of(name: str) -> GestureLibrary:
    """Return the gestures of a bundled character; their skeleton is its own."""
    asset = resources.files("cubeling.characters") / "assets" / f"{name}.gestures"
    with resources.as_file(asset) as file:
        return GestureLibrary.load(file)


def _thin(clip: Clip) -> Clip:
    """Return a clip with every n-th frame, so that it begins and ends as before."""
    last = len(clip) - 1
    steps = [n for n in range(1, last + 1) if last % n == 0 and clip.rate / n >= MIN_RATE_HZ]
    step = max(steps, default=1)
    return replace(clip, rate=clip.rate / step, poses=clip.poses[np.arange(0, last + 1, step)])
