"""Several targets for one body of joints: mass-springs on a tree (S17, Algorithm 2).

Every bone is a spring, and every target pulls its joint by a spring of its own, as strong as its
weight; targets of the highest priority pin their joints. A joint of the trunk receives the forces
of all its springs, so no centroid of sub-chains is needed. The children of a joint are held
together by springs between them, for one rotation has to suit them all: Horn's, by the weights of
what hangs below (S15).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.solvers.methods.springs import verlet
from cubeling.characters.ik.solvers.orientation import horn
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array

_STIFFNESS, _PULL, _DAMPING = 0.3, 0.3, 0.4  # a joint with many springs is stable below 0.4
_MAX_STEPS, _MAX_LOOPS = 400, 12
_REST = 0.02  # of a tolerance: the energy at which the springs rest


@dataclass(frozen=True)
class Tree:
    """Joints that branch; each turns all bones that begin at it."""

    parents: tuple[int, ...]
    """Number of each joint's parent; −1 for joint 0, the base, and for no other."""

    offsets: Array
    """Each joint in the frame of its parent, (joints, 3) [m]; that of the base is not used."""

    def __post_init__(self) -> None:
        known = all(0 <= parent < joint for joint, parent in enumerate(self.parents[1:], start=1))
        if self.parents[:1] != (-1,) or not known or self.offsets.shape != (len(self), 3):
            raise CharacterError(
                f"tree: parents {self.parents} with offsets of shape {self.offsets.shape}; list "
                "the base first, with parent −1, and parents before children; give each an offset"
            )

    def __len__(self) -> int:
        return len(self.parents)

    @cached_property
    def children(self) -> list[list[int]]:
        """Children of each joint."""
        return [[c for c, p in enumerate(self.parents) if p == j] for j in range(len(self))]

    @cached_property
    def springs(self) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """Both ends of each spring, (springs,), and its length at rest [m]: bones and braces."""
        pairs = [(parent, child) for child, parent in enumerate(self.parents) if parent >= 0]
        lengths = [float(np.linalg.norm(self.offsets[child])) for _, child in pairs]
        for below in self.children:
            braces = [(a, b) for number, a in enumerate(below) for b in below[number + 1 :]]
            pairs += braces
            lengths += [float(np.linalg.norm(self.offsets[a] - self.offsets[b])) for a, b in braces]
        first, second = np.array(pairs).T
        return first, second, np.array(lengths)

    def points(self, local: Array) -> tuple[Array, Array]:
        """Return base-frame rotations and points of local rotations (batch, joints, 4)."""
        frames, points = local.copy(), np.zeros((*local.shape[:-1], 3))
        for joint, parent in enumerate(self.parents[1:], start=1):
            above = frames[..., parent, :]
            bone = rotations.rotate(above, self.offsets[joint])
            points[..., joint, :] = points[..., parent, :] + bone
            frames[..., joint, :] = rotations.multiply(above, local[..., joint, :])
        return frames, points


@dataclass(frozen=True)
class Target:
    """Where a joint of each tree of a batch is to be."""

    joint: int
    """Its number; an end, or any joint between."""

    places: Array
    """(batch, 3) [m] from the base."""

    weight: float = 1.0
    """How strongly, beside others of the same priority."""

    priority: int = 0
    """Targets of the highest priority are reached first; the others as far as these allow."""


@dataclass(frozen=True)
class TreeSolution:
    """What was found for a batch of trees."""

    rotations: Array
    """Local rotations, (batch, joints, 4); joints at the ends do not turn."""

    positions: Array
    """Points of the joints, (batch, joints, 3) [m]."""

    errors: Array
    """From each joint to its target, (batch, targets) [m]."""

    steps: int
    """Steps of the springs, of the slowest tree."""


def solve_tree(
    tree: Tree, targets: Sequence[Target], start: Array, tolerance: float = 1e-3
) -> TreeSolution:
    """Return rotations of trees that bring joints to several targets at once, as far as they go.

    Where targets of one priority contradict each other, the weighted sum of their squared errors is
    least: of two targets of one joint, the errors are in inverse proportion to the weights. A
    target out of reach is first moved towards the base, to where straight bones would reach.

    Parameters
    ----------
    tree
        The joints; they turn freely.
    targets
        One at least, with a weight above zero.
    start
        Local rotations to start from, (batch, joints, 4).
    tolerance
        How near is near enough, in lengths of all bones together.

    Raises
    ------
    CharacterError
        If a target is of no joint or not finite, or the arrays do not fit together.
    """
    used = [each for each in targets if each.weight > 0]
    _check(tree, used, start)
    used = [_within_reach(tree, each) for each in used]
    _, _, rest = tree.springs
    size = float(rest[: len(tree) - 1].sum())
    local, (frames, points) = start, tree.points(start)
    stretch, steps = np.zeros((len(start), len(rest))), 0
    for _ in range(_MAX_LOOPS):
        # Stretched springs get shorter at rest by as much: in the end, bones under tension have
        # their own length (method of multipliers).
        moved, more = _relax(tree, used, points, rest - stretch, _REST * tolerance * size)
        steps += more
        local = _rotations(tree, used, frames, points, moved)
        frames, after = tree.points(local)
        settled = np.abs(after - points).max() <= 0.1 * tolerance * size
        stretch += _lengths(tree, moved) - rest
        points = after
        if settled:
            break
    errors = [np.linalg.norm(points[:, each.joint] - each.places, axis=-1) for each in targets]
    return TreeSolution(local, points, np.stack(errors, -1), steps)


def _check(tree: Tree, targets: Sequence[Target], start: Array) -> None:
    if start.shape[1:] != (len(tree), 4) or not targets:
        raise CharacterError(
            f"start of shape {start.shape} and {len(targets)} targets with a weight; give (batch, "
            f"{len(tree)}, 4) and one target at least"
        )
    for each in targets:
        if not 0 < each.joint < len(tree) or not np.isfinite(each.places).all():
            raise CharacterError(
                f"target of joint {each.joint}: not a joint after the base, or a place is not "
                "finite; leave it out"
            )


def _within_reach(tree: Tree, target: Target) -> Target:
    """Return a target moved towards the base, to where straight bones would reach (7.3.7)."""
    reach, joint = 0.0, target.joint
    while joint > 0:
        reach += float(np.linalg.norm(tree.offsets[joint]))
        joint = tree.parents[joint]
    far = np.linalg.norm(target.places, axis=-1, keepdims=True)
    return replace(target, places=target.places * np.minimum(1.0, reach / np.maximum(far, 1e-12)))


def _lengths(tree: Tree, points: Array) -> Array:
    first, second, _ = tree.springs
    lengths: Array = np.linalg.norm(points[:, second] - points[:, first], axis=-1)
    return lengths


def _relax(
    tree: Tree, targets: Sequence[Target], points: Array, rest: Array, energy: float
) -> tuple[Array, int]:
    """Return the points at which the springs, of lengths `rest`, are in balance, and the steps."""
    first, second, _ = tree.springs
    count = len(tree)
    incidence = np.zeros((count, len(first)))
    incidence[first, np.arange(len(first))], incidence[second, np.arange(len(first))] = 1.0, -1.0
    least, top = (select(each.priority for each in targets) for select in (min, max))
    pinned = [each for each in targets if least < each.priority == top]
    pulling = [each for each in targets if each.priority < top or least == top]
    strongest = max((each.weight for each in pulling), default=1.0)
    fixed = [0, *(each.joint for each in pinned)]
    points = points.copy()
    for each in pinned:
        points[:, each.joint] = each.places
    before = points
    for step in range(_MAX_STEPS):
        bones = points[:, second] - points[:, first]
        now = np.linalg.norm(bones, axis=-1, keepdims=True)
        forces = incidence @ (_STIFFNESS * bones * (1.0 - rest[..., None] / np.maximum(now, 1e-12)))
        for each in pulling:
            pull = _PULL * each.weight / strongest
            forces[:, each.joint] += pull * (each.places - points[:, each.joint])
        forces[:, fixed] = 0.0
        points, before = verlet(points, before, forces, _DAMPING), points
        if np.linalg.norm(forces, axis=-1).sum(-1).max() <= energy:
            return points, step + 1
    return points, _MAX_STEPS


def _rotations(
    tree: Tree, targets: Sequence[Target], frames: Array, before: Array, after: Array
) -> Array:
    """Return local rotations (batch, joints, 4) that put joints as near to points as they go."""
    weights = _weights_below(tree, targets)
    local, turned = np.empty_like(frames), np.empty_like(frames)
    for joint, below in enumerate(tree.children):
        way = rotations.IDENTITY
        if len(below) == 1:
            (child,) = below
            way = _between(before[:, child] - before[:, joint], after[:, child] - after[:, joint])
        elif below:
            old = before[:, below] - before[:, joint, None]
            way = horn(old, after[:, below] - after[:, joint, None], weights[below])
        else:
            way = _following(tree, joint, turned, frames)
        turned[:, joint] = rotations.multiply(way, frames[:, joint])
        parent = tree.parents[joint]
        above = turned[:, parent] if parent >= 0 else rotations.IDENTITY
        local[:, joint] = rotations.multiply(rotations.conjugate(above), turned[:, joint])
    return rotations.normalize(local)


def _following(tree: Tree, joint: int, turned: Array, frames: Array) -> Array:
    """Return how the parent of a joint at an end has turned: the joint does not turn itself."""
    parent = tree.parents[joint]
    return rotations.multiply(turned[:, parent], rotations.conjugate(frames[:, parent]))


def _between(old: Array, new: Array) -> Array:
    """Return the shortest rotations; none where a bone has no length."""
    short = (np.linalg.norm(old, axis=-1) < 1e-12) | (np.linalg.norm(new, axis=-1) < 1e-12)
    if not short.any():
        return rotations.between(old, new)
    axis = np.array([1.0, 0.0, 0.0])
    keep = short[:, None]
    return rotations.between(np.where(keep, axis, old), np.where(keep, axis, new))


def _weights_below(tree: Tree, targets: Sequence[Target]) -> Array:
    """Return the weights of the targets at each joint and below, (joints,); a little for others."""
    weights = np.full(len(tree), 1e-3)
    top = max(each.priority for each in targets)
    for each in targets:
        joint = each.joint
        while joint > 0:  # the way up to the base
            weights[joint] += each.weight if each.priority == top else 1e-2 * each.weight
            joint = tree.parents[joint]
    return weights
