"""The solvers by name, and `solve`: any of them, with what makes it sure."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from characters.errors import CharacterError
from characters.ik.solvers import columns
from characters.ik.solvers.ccd import CyclicCoordinateDescent
from characters.ik.solvers.chains import Chains, Solution
from characters.ik.solvers.fabrik import Fabrik
from characters.ik.solvers.jacobian import (
    DampedLeastSquares,
    JacobianSolver,
    pseudo_inverse,
    transpose,
)
from characters.ik.solvers.positional import PositionalSolver
from characters.ik.solvers.springs import MassSprings
from characters.ik.solvers.task import Limiting, Solver, Task
from characters.skeleton.pose import Array

SOLVERS: dict[str, Solver] = {
    "springs-force": PositionalSolver(MassSprings(pinned=False)),
    "springs": PositionalSolver(MassSprings(pinned=True)),
    "ccd": CyclicCoordinateDescent(),
    "fabrik": PositionalSolver(Fabrik()),
    "transpose": JacobianSolver(transpose),
    "pseudo-inverse": JacobianSolver(pseudo_inverse),
    "damped": JacobianSolver(DampedLeastSquares()),
}
"""The solvers by name. A solver of your own is one more entry."""

TOLERANCE = 1e-3
"""How near is near enough, in lengths of the chain."""

RESTARTS = 8
"""Most random starts of what is left unsolved."""

_POLISH = JacobianSolver(DampedLeastSquares(), max_iterations=40)
_MAX_EXTENSION = 1 - 1e-9  # of a chain's length, to which a target beyond it is moved
_NUDGE_RAD = 0.05  # by which a chain that lies on the line to its target is bent


def solve(
    chains: Chains,
    targets: Array,
    start: Array | None = None,
    *,
    method: str = "damped",
    tolerance: float = TOLERANCE,
    limits: Limiting | None = "propagate",
    alone: bool = False,
    seed: int = 0,
) -> Solution:
    """Return the rotations that bring the ends of chains to targets, or as near as they come.

    Parameters
    ----------
    chains
        One chain for all targets, or one for each.
    targets
        (batch, 3) [m] from the base of each chain. One that is not finite is left unsolved.
    start
        Local rotations to start from, (batch, joints, 4); by default those at rest.
    method
        A name of `SOLVERS`.
    tolerance
        How near is near enough, in lengths of the chain.
    limits
        What becomes of a rotation beyond the limits of the chains; None to ignore the limits.
    alone
        Whether the method is left alone. Otherwise damped least squares goes on from what it leaves
        unsolved, and starts again from random postures (as TRAC-IK does).
    seed
        Of the random postures.

    Raises
    ------
    CharacterError
        If there is no such method, or the arrays do not fit together.

    >>> chains = Chains.straight(np.full(6, 0.1))
    >>> solution = solve(chains, np.array([[0.1, 0.3, 0.2]]))
    >>> bool(solution.solved[0]), bool(solution.errors[0] < 6e-4)
    (True, True)
    """
    solver = SOLVERS.get(method)
    if solver is None:
        raise CharacterError(f"no solver {method!r}; there are {', '.join(SOLVERS)}")
    targets = np.asarray(targets, float)
    start = chains.rest(len(targets)) if start is None else np.asarray(start, float)
    _check(chains, targets, start)
    if chains.limits is not None and limits is not None:
        start = chains.limits.clamp(start)
    reach = np.broadcast_to(chains.reach, len(targets))
    usable = np.isfinite(targets).all(-1) & (reach > columns.TINY)
    found = np.flatnonzero(usable)
    part = Task.of(
        _some(chains, found), targets[found], start[found], tolerance * reach[found], limits
    )
    part = _with_reachable_targets(_nudged(part))
    turns, used = solver(part) if len(found) else (part.start, np.zeros(0, np.intp))
    if not alone:
        turns, used = _made_sure(part, turns, used, np.random.default_rng(seed))
    local = start.copy()
    local[found] = part.local_rotations(turns, chains)
    iterations = np.zeros(len(targets), np.intp)
    iterations[found] = used
    _, positions = chains.frames(local)
    errors = np.linalg.norm(positions[:, -1] - targets, axis=-1)
    errors = np.where(np.isfinite(errors), errors, np.inf)
    return Solution(local, positions, iterations, errors, errors <= tolerance * reach)


def _check(chains: Chains, targets: Array, start: Array) -> None:
    count = len(targets)
    if targets.shape != (count, 3) or start.shape != (count, chains.joints, 4):
        raise CharacterError(
            f"targets of shape {targets.shape} and a start of shape {start.shape}; give (batch, 3) "
            f"and (batch, {chains.joints}, 4)"
        )
    if chains.offsets.ndim == 3 and len(chains.offsets) != count:
        raise CharacterError(f"{len(chains.offsets)} chains for {count} targets")


def _some(chains: Chains, which: NDArray[np.intp]) -> Chains:
    if chains.offsets.ndim == 2:
        return chains
    return replace(chains, offsets=chains.offsets[which])


def _with_reachable_targets(task: Task) -> Task:
    """Return the task with targets moved to where chains without limits reach (7.3.7).

    Too far: towards the base, onto the sphere of the straight chain. The thesis prints the inverse
    ratio, which moves the target farther away. Too near, for a chain with one bone longer than the
    others together: away from the base.
    """
    far = columns.length(task.targets)
    longest = task.lengths.max(0)
    least = np.maximum(2 * longest - task.reach, 0.0)
    wanted = np.clip(far, least, task.reach * _MAX_EXTENSION)
    ahead = task.frames(task.start)[1][-1]
    direction = np.where(far > columns.TINY, task.targets, ahead)
    size = np.maximum(columns.length(direction), columns.TINY)
    moved = np.where(wanted == far, task.targets, direction * (wanted / size))
    return replace(task, targets=moved)


def _nudged(task: Task) -> Task:
    """Return the task with chains that lie on the line to their target bent a little.

    On that line every direction of a solver is along it, and the chain would never bend.
    """
    _, points = task.frames(task.start)
    away = columns.cross(points[1:], np.broadcast_to(task.targets, points[1:].shape))
    size = columns.length(task.targets) * task.reach
    on_line = (columns.length(away) <= 1e-6 * np.maximum(size, columns.TINY)).all(0)
    if not on_line.any():
        return task
    angles = columns.to_euler(task.start)
    nudge = np.zeros_like(angles)
    nudge[:, 1:] = _NUDGE_RAD
    bent = angles + nudge
    if task.bounds is not None:
        low, high = task.bounds.low, task.bounds.high
        bent = np.clip(np.where(bent > high, angles - nudge, bent), low, high)
    start = np.where(on_line, columns.from_euler(bent), task.start)
    return replace(task, start=start)


def _made_sure(
    task: Task, turns: Array, used: NDArray[np.intp], random: np.random.Generator
) -> tuple[Array, NDArray[np.intp]]:
    """Return rotations and iterations with what was left unsolved polished, then started again."""
    turns, used = turns.copy(), used.copy()
    errors = _errors(task, turns)
    for number in range(1 + RESTARTS):
        left = np.flatnonzero(errors > task.tolerance)
        if len(left) == 0:
            break
        part = task.select(left)
        begin = turns[..., left] if number == 0 else _random_start(part, random)
        again, more = _POLISH(replace(part, start=begin))
        now = _errors(part, again)
        better = now < errors[left]
        turns[..., left[better]] = again[..., better]
        errors[left] = np.where(better, now, errors[left])
        used[left] += more
    return turns, used


def _random_start(task: Task, random: np.random.Generator) -> Array:
    low, high = (-np.pi, np.pi) if task.bounds is None else (task.bounds.low, task.bounds.high)
    return columns.from_euler(random.uniform(low, high, (task.joints, 3, task.count)))


def _errors(task: Task, turns: Array) -> Array:
    return columns.length(task.frames(turns)[1][-1] - task.targets)
