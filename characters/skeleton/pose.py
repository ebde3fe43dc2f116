"""Skeletons and poses as arrays over joints."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations

Array = NDArray[np.float64]

_WORLD: Array = np.eye(4)


@dataclass(frozen=True)
class Pose:
    """The local transform of every joint; leading axes are frames."""

    translations: Array
    """(…, joints, 3) [m]."""

    rotations: Array
    """Unit quaternions xyzw, (…, joints, 4)."""

    scales: Array | None = None
    """(…, joints, 3), or None for all ones."""

    morphs: Array | None = None
    """Weights of the character's morph targets, (…, morphs), or None for zeros."""

    @staticmethod
    def of_frames(poses: "Iterable[Pose]") -> "Pose":
        """Return single poses as the frames of one, without their scales and morphs."""
        parts = [(pose.translations, pose.rotations) for pose in poses]
        translations, turns = zip(*parts, strict=True)
        return Pose(np.stack(translations), np.stack(turns))

    def with_rotations(self, turns: Array) -> "Pose":
        """Return the pose with other rotations, (…, joints, 4)."""
        # A layer does so in every frame: to set frozen fields one by one takes longer.
        pose = object.__new__(Pose)
        pose.__dict__.update(self.__dict__, rotations=turns)
        return pose

    def with_morphs(self, weights: Array) -> "Pose":
        """Return the pose with other weights of its morphs, (…, morphs)."""
        pose = object.__new__(Pose)
        pose.__dict__.update(self.__dict__, morphs=weights)
        return pose

    @property
    def scales_or_ones(self) -> Array:
        """The scales, (…, joints, 3); all ones if there are none."""
        return np.ones_like(self.translations) if self.scales is None else self.scales

    def locals(self) -> Array:
        """Return `parent_from_joint` of every joint, (…, joints, 4, 4)."""
        matrices = np.zeros((*self.rotations.shape[:-1], 4, 4))
        matrices[..., :3, :3] = rotations.to_matrix(self.rotations)
        if self.scales is not None:
            matrices[..., :3, :3] *= self.scales[..., None, :]
        matrices[..., :3, 3] = self.translations
        matrices[..., 3, 3] = 1.0
        return matrices

    def globals(self, skeleton: "Skeleton", world: Array | None = None) -> Array:
        """Return `character_from_joint` of every joint, (…, joints, 4, 4).

        With `world_from_character` (4, 4), they are `world_from_joint`.

        By pointer doubling instead of a walk down the tree: after round n each matrix reaches 2ⁿ
        joints up, so a hierarchy of twelve levels takes four products over all joints.
        """
        locals_ = self.locals()
        # One more joint, the fixed world, is the parent of all roots.
        shape = (*locals_.shape[:-3], len(skeleton.parents) + 1, 4, 4)
        matrices = np.empty(shape)
        matrices[..., :-1, :, :] = locals_
        matrices[..., -1, :, :] = _WORLD
        if world is not None:
            for root in skeleton.roots:
                matrices[..., root, :, :] = world @ matrices[..., root, :, :]
        for ancestors in skeleton.doubled_ancestors:
            matrices = matrices.take(ancestors, -3) @ matrices
        return matrices[..., :-1, :, :]

    def turned_in_character(self, skeleton: "Skeleton") -> "Pose":
        """Return the pose with rotations `character_from_joint` instead of `parent_from_joint`."""
        world = np.broadcast_to(rotations.IDENTITY, (*self.rotations.shape[:-2], 1, 4))
        turns = np.concatenate([self.rotations, world], axis=-2)
        for ancestors in skeleton.doubled_ancestors:
            turns = rotations.multiply(turns.take(ancestors, -2), turns)
        return replace(self, rotations=turns[..., :-1, :])

    def turned_in_parents(self, skeleton: "Skeleton") -> "Pose":
        """Return what `turned_in_character` was made of."""
        parents = np.array(skeleton.parents)
        turns, children = self.rotations.copy(), parents >= 0
        above = rotations.conjugate(turns[..., parents[children], :])
        turns[..., children, :] = rotations.multiply(above, turns[..., children, :])
        return replace(self, rotations=turns)

    def __getitem__(self, frames: "int | slice | NDArray[np.intp] | None") -> "Pose":
        """Return some of the poses, selected along the first leading axis; None adds an axis."""
        return Pose(
            self.translations[frames],
            self.rotations[frames],
            None if self.scales is None else self.scales[frames],
            None if self.morphs is None else self.morphs[frames],
        )


@dataclass(frozen=True)
class Skeleton:
    """Names, parents and rest pose of a hierarchy of joints."""

    names: tuple[str, ...]
    """Name of each joint."""

    parents: tuple[int, ...]
    """Number of each joint's parent, −1 for a root; parents come before their children."""

    rest: Pose
    """The rest pose in the file."""

    def __post_init__(self) -> None:
        joints = len(self.names)
        if len(self.parents) != joints or self.rest.rotations.shape != (joints, 4):
            raise CharacterError(
                f"skeleton: {joints} names, {len(self.parents)} parents and a rest pose of shape "
                f"{self.rest.rotations.shape}; give one of each for every joint"
            )
        for joint, parent in enumerate(self.parents):
            if not -1 <= parent < joint:
                raise CharacterError(
                    f"skeleton: joint {self.names[joint]!r} comes before its parent; "
                    "list parents first"
                )

    def __len__(self) -> int:
        return len(self.names)

    def index(self, name: str) -> int:
        """Return the number of the joint with a name."""
        try:
            return self.names.index(name)
        except ValueError:
            raise CharacterError(
                f"skeleton has no joint {name!r}; it has {', '.join(self.names)}"
            ) from None

    def with_ancestors(self, joints: Iterable[int]) -> list[int]:
        """Return joints and all their ancestors, parents first."""
        wanted = set(joints)
        for joint in reversed(range(len(self))):
            if joint in wanted and self.parents[joint] >= 0:
                wanted.add(self.parents[joint])
        return sorted(wanted)

    @property
    def has_root_motion(self) -> bool:
        """Whether joint 0 carries the planar root motion, as in the bundled characters."""
        return self.names[0] == "root" and self.parents[0] == -1

    @cached_property
    def roots(self) -> tuple[int, ...]:
        """The joints without a parent."""
        return tuple(joint for joint, parent in enumerate(self.parents) if parent < 0)

    @cached_property
    def doubled_ancestors(self) -> tuple[NDArray[np.intp], ...]:
        """Ancestors 1, 2, 4, … levels up, each (joints + 1,); the last joint is the world."""
        world = len(self.parents)
        ancestors = np.array([*(p if p >= 0 else world for p in self.parents), world])
        rounds: list[NDArray[np.intp]] = []
        while (ancestors != world).any():
            rounds.append(ancestors)
            ancestors = ancestors[ancestors]
        return tuple(rounds)
