"""Left and right exchanged: for poses, steps, clips and motions of any symmetric skeleton.

The rest pose says how the frame of a joint and that of its partner belong together. With G the
rotation of a joint k to the character in the rest pose, p(k) its partner and M the reflection
x → −x, F(k) = Gᵀ(p(k)) M G(k) takes coordinates in the frame of k to those in its partner's. A
joint's rotation L and translation t in its parent q then become F(q) L Fᵀ(k) and F(q) t, those of
the partner. Every global position is so reflected exactly, whatever the joints' axes are.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from characters import rotations
from characters.clip import Clip
from characters.errors import CharacterError
from characters.motion import Motion, Step
from characters.phase import in_step, takes_steps
from characters.pose import Array, Pose, Skeleton

_REFLECTION = np.array([-1.0, 1.0, 1.0])
_PSEUDO = np.array([1.0, -1.0, -1.0, 1.0])  # what the reflection does to a rotation
_CROOKED = 0.05  # of the body's size: how far from symmetric a rest pose may be
_MISNAMED = 0.1  # of the body's size: how much farther a joint counts whose name does not fit
# "LeftFoot", "foot_l", "Foot.R.001", "FootL": words, and letters that stand alone or end a word.
_SIDES = re.compile(
    r"[Ll]eft|LEFT|[Rr]ight|RIGHT|(?<![A-Za-z])[LRlr](?![A-Za-z])|(?<=[a-z])[LR](?![a-z])"
)
_NONE: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True)
class Mirror:
    """Which joints and morphs of a skeleton change places, and how their frames do."""

    partners: NDArray[np.intp]
    """The joint on the other side, (joints,); of one in the middle, itself."""

    inner: Array
    """Rotation of F of each joint before the reflection, (joints, 4): see above."""

    outer: Array
    """The same of each joint's parent, (joints, 4)."""

    looks: NDArray[np.intp]
    """The morph of the other side, (morphs,); of one for both, itself."""

    @staticmethod
    def of(
        skeleton: Skeleton, morphs: tuple[str, ...] = (), pairs: Mapping[str, str] = _NONE
    ) -> "Mirror":
        """Return the mirror of a skeleton, its pairs found by places and names.

        Parameters
        ----------
        skeleton
            Its rest pose must be symmetric about the plane x = 0.
        morphs
            Names of the character's morphs; "blinkLeft" changes places with "blinkRight".
        pairs
            Joint to joint where they cannot be found; each counts both ways.

        Raises
        ------
        CharacterError
            If the rest pose is not symmetric, or a joint has no partner.
        """
        partners = _partners(skeleton, pairs)
        rest = skeleton.rest.globals(skeleton)
        _check_symmetry(skeleton, rest[:, :3, 3], partners)
        turns = rotations.from_matrix(_unscaled(rest[:, :3, :3]))
        # F = M Q, and so Q = M G(p)ᵀ M G.
        theirs = rotations.conjugate(turns[partners] * _PSEUDO)
        inner = rotations.multiply(theirs, turns)
        parents = np.array(skeleton.parents)
        outer = np.where(parents[:, None] >= 0, inner[parents], rotations.IDENTITY)
        return Mirror(partners, inner, outer, _paired_names(morphs))

    def pose(self, pose: Pose) -> Pose:
        """Return poses (…) mirrored."""
        turns = rotations.multiply(self.outer, pose.rotations)
        turns = rotations.multiply(turns, rotations.conjugate(self.inner)) * _PSEUDO
        shifts = rotations.rotate(self.outer, pose.translations) * _REFLECTION
        scales = pose.scales
        if scales is not None:
            # F S Fᵀ along the partner's axes; frames of partners differ by quarter turns at most.
            axes = rotations.to_matrix(self.inner) ** 2
            scales = (axes @ scales[..., None])[..., 0][..., self.partners, :]
        morphs = pose.morphs
        if morphs is not None and len(self.looks):
            morphs = morphs[..., self.looks]
        return Pose(shifts[..., self.partners, :], turns[..., self.partners, :], scales, morphs)

    @staticmethod
    def step(step: Step) -> Step:
        """Return a step mirrored."""
        return Step(-step.x, step.z, -step.yaw)

    def clip(self, clip: Clip, name: str = "") -> Clip:
        """Return a clip mirrored; its footfalls are then found anew by `phased`."""
        return replace(clip, name=name or clip.name, poses=self.pose(clip.poses))


@dataclass(frozen=True)
class Mirrored:
    """A motion with left and right exchanged; `Cyclic`.

    Its left footfall is the right one of the motion: of a motion that takes steps, phases are half
    a cycle away. Times are the same.
    """

    motion: Motion
    """What is played."""

    mirror: Mirror
    """That of its skeleton."""

    @property
    def duration(self) -> float:
        """Time until it repeats or ends [s]."""
        return self.motion.duration

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        return self.mirror.pose(self.motion.sample(time))

    def travel(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two times [s]."""
        return self.mirror.step(self.motion.travel(start, end))

    def at(self, phase: float) -> Pose:
        """Return the pose at a phase."""
        return self.mirror.pose(in_step(self.motion).at(phase + self.lead))

    def between(self, start: float, end: float) -> Step:
        """Return how the root moves over the ground between two phases."""
        lead = self.lead
        return self.mirror.step(in_step(self.motion).between(start + lead, end + lead))

    @property
    def lead(self) -> float:
        """How far ahead of its own phase the motion is; back again where mirrored twice."""
        if isinstance(self.motion, Mirrored):
            return -self.motion.lead
        return 0.5 if takes_steps(self.motion) else 0.0


def _partners(skeleton: Skeleton, pairs: Mapping[str, str]) -> NDArray[np.intp]:
    """Return the partner of each joint, from the roots down: children of partners are partners."""
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    size = max(float(np.ptp(places, axis=0).max()), 1e-9)
    given = {skeleton.index(a): skeleton.index(b) for a, b in pairs.items()}
    given |= {b: a for a, b in given.items()}
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(skeleton.parents):
        children.setdefault(parent, []).append(joint)
    partners = np.full(len(skeleton), -1, np.intp)
    for parent in range(-1, len(skeleton)):
        other = int(partners[parent]) if parent >= 0 else -1
        ours, theirs = children.get(parent, []), children.get(other, [])
        apart = {
            (a, b): float(np.linalg.norm(places[a] * _REFLECTION - places[b])) / size
            + (0.0 if _swapped(skeleton.names[a]) == _plain(skeleton.names[b]) else _MISNAMED)
            + (0.0 if given.get(a, b) == b and given.get(b, a) == a else np.inf)
            for a in ours
            for b in theirs
        }
        for a, b in sorted(apart, key=apart.__getitem__):
            if partners[a] < 0 and partners[b] < 0 and np.isfinite(apart[a, b]):
                partners[a], partners[b] = b, a
        for joint in ours:
            if partners[joint] < 0:
                raise CharacterError(
                    f"mirror: joint {skeleton.names[joint]!r} has no partner on the other side; "
                    "name it in pairs, or mirror another skeleton"
                )
    return partners


def _swapped(name: str) -> str:
    """Return a joint's name on the other side, without its numbers.

    >>> _swapped("LeftUpLeg_01"), _swapped("foot.L"), _swapped("ArmR"), _swapped("collar")
    ('rightupleg', 'foot.r', 'arml', 'collar')
    """
    other = {"left": "right", "right": "left", "l": "r", "r": "l"}
    return _plain(_SIDES.sub(lambda side: other[side[0].lower()], name))


def _plain(name: str) -> str:
    return re.sub(r"[_\s\d]+", "", name).lower()


def _check_symmetry(skeleton: Skeleton, places: Array, partners: NDArray[np.intp]) -> None:
    """Refuse a rest pose that is not symmetric."""
    away = np.linalg.norm(places * _REFLECTION - places[partners], axis=-1)
    worst, size = int(away.argmax()), float(np.ptp(places, axis=0).max())
    if away[worst] > _CROOKED * size:
        raise CharacterError(
            f"mirror: the rest pose is not symmetric about x = 0: {skeleton.names[worst]!r} is "
            f"{away[worst]:.3f} m from the mirrored {skeleton.names[partners[worst]]!r}; "
            "give the skeleton a symmetric rest pose, or name pairs"
        )


def _unscaled(matrices: Array) -> Array:
    """Return the rotations in matrices (…, 3, 3)."""
    lengths: Array = np.linalg.norm(matrices, axis=-2, keepdims=True)
    return matrices / np.maximum(lengths, 1e-12)


def _paired_names(names: tuple[str, ...]) -> NDArray[np.intp]:
    """Return for each name the place of that of the other side; its own where there is none."""
    swapped = [_SIDES.sub(_other_side, name) for name in names]
    return np.array([names.index(n) if n in names else i for i, n in enumerate(swapped)], np.intp)


def _other_side(match: re.Match[str]) -> str:
    sides = ("left", "right"), ("Left", "Right"), ("l", "r"), ("L", "R"), ("LEFT", "RIGHT")
    for left, right in sides:
        if match[0] in (left, right):
            return right if match[0] == left else left
    return match[0]
