"""The solvers by name, and `solve`: any of them, with what makes it sure."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.chains import Chains, Solution
from cubeling.characters.ik.solvers.methods.ccd import CyclicCoordinateDescent
from cubeling.characters.ik.solvers.methods.curling import curl
from cubeling.characters.ik.solvers.methods.fabrik import Fabrik
from cubeling.characters.ik.solvers.methods.jacobian import JacobianSolver
from cubeling.characters.ik.solvers.methods.positional import PositionalSolver
from cubeling.characters.ik.solvers.methods.springs import MassSprings
from cubeling.characters.ik.solvers.orientation import orient, straight
from cubeling.characters.ik.solvers.rules import Damped, pseudo_inverse, transpose
from cubeling.characters.ik.solvers.task import Limiting, Solver, Task
from cubeling.characters.skeleton.pose import Array

SOLVERS: dict[str, Solver] = {
    "springs-force": PositionalSolver(MassSprings(pinned=False)),
    "springs": PositionalSolver(MassSprings(pinned=True)),
    "ccd": CyclicCoordinateDescent(),
    "fabrik": PositionalSolver(Fabrik()),
    "transpose": JacobianSolver(transpose),
    "pseudo-inverse": JacobianSolver(pseudo_inverse),
    "damped": JacobianSolver(Damped(), max_steps=20),
}
"""The solvers by name. A solver of your own is one more entry."""

TOLERANCE = 1e-3
"""How near is near enough, in lengths of the chain."""

RESTARTS = 16
"""Random starts of what is left unsolved."""

_POLISH = JacobianSolver(Damped(), max_steps=20)
_MAX_EXTENSION = 1 - 1e-9  # of a chain's length, to which a target beyond it is moved
_FARTHEST_M = 1e100  # of a target; the squares of farther ones overflow
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
        Whether the method is left alone. Otherwise chains curl up for targets near their base, and
        damped least squares goes on from what the method leaves unsolved, also from random postures
        (as TRAC-IK does).
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
    reach = np.broadcast_to(chains.reach, len(targets))
    usable = (np.abs(targets) < _FARTHEST_M).all(-1) & (reach > columns.TINY)
    goals = np.where(usable[:, None], targets, 0.0)
    task = Task.of(chains, goals, start, tolerance * reach, limits)
    reachable = _with_reachable_targets(_nudge(task))
    if not alone:
        reachable = curl(reachable)
    turns, points, iterations = solver(reachable)
    beyond = np.flatnonzero(columns.length(task.targets) >= task.reach)
    if task.bounds is None and len(beyond):
        turns[..., beyond], points[..., beyond] = _straighten(reachable.select(beyond))
    if not alone:
        _made_sure(reachable, turns, points, iterations, np.random.default_rng(seed))
    errors = columns.length(points[-1] - task.targets)
    if not usable.all():
        turns[..., ~usable] = task.start[..., ~usable]
        points[..., ~usable] = task.points_at_start[..., ~usable]
        errors = np.where(usable, errors, np.inf)
        iterations[~usable] = 0
    return Solution(
        task.local_rotations(turns, chains),
        columns.to_rows(points),
        iterations,
        errors,
        errors <= task.tolerance,
    )


def _check(chains: Chains, targets: Array, start: Array) -> None:
    count = len(targets)
    if targets.shape != (count, 3) or start.shape != (count, chains.joints, 4):
        raise CharacterError(
            f"targets of shape {targets.shape} and a start of shape {start.shape}; give (batch, 3) "
            f"and (batch, {chains.joints}, 4)"
        )
    if chains.offsets.ndim == 3 and len(chains.offsets) != count:
        raise CharacterError(f"{len(chains.offsets)} chains for {count} targets")


def _with_reachable_targets(task: Task) -> Task:
    """Return the task with targets moved to where chains without limits reach (7.3.7).

    Too far: towards the base, onto the sphere of the straight chain. The thesis prints the inverse
    ratio, which moves the target farther away. Too near, for a chain with one bone longer than the
    others together: away from the base.
    """
    far = columns.length(task.targets)
    least = np.maximum(2 * task.lengths.max(0) - task.reach, 0.0)
    wanted = np.clip(far, least, task.reach * _MAX_EXTENSION)
    if (wanted == far).all():
        return task
    direction = np.where(far > columns.TINY, task.targets, task.points_at_start[-1])
    size = np.maximum(columns.length(direction), columns.TINY)
    moved = np.where(wanted == far, task.targets, direction * (wanted / size))
    return replace(task, targets=moved)


def _straighten(task: Task) -> tuple[Array, Array]:
    """Return the rotations and points of chains that point straight to their targets.

    A solver is done earlier: bones bent by 2° shorten a chain by less than its tolerance.
    """
    points = straight(task)
    return orient(task, task.frames_at_start, task.points_at_start, points), points


def _nudge(task: Task) -> Task:
    """Return the task with chains that lie on the line to their target bent a little.

    On that line every direction of a solver is along it, and the chain would never bend.
    """
    points = task.points_at_start[1:]
    away = columns.cross(points, task.targets[None])
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
    return task.with_start(np.where(on_line, columns.from_euler(bent), task.start))


def _made_sure(
    task: Task,
    turns: Array,
    points: Array,
    iterations: NDArray[np.intp],
    random: np.random.Generator,
) -> None:
    """Polish what is left unsolved, then start it again, in place."""
    for copies in (1, RESTARTS):
        errors = columns.length(points[-1] - task.targets)
        left = np.flatnonzero(errors > task.tolerance)
        if len(left) == 0:
            break
        part = task.select(np.repeat(left, copies))
        begin = turns[..., left] if copies == 1 else _random_start(part, random)
        again, ends, used = _POLISH(part.with_start(begin))
        now = columns.length(ends[-1] - part.targets).reshape(-1, copies)
        best = _nearest_solved(part, again, now)
        better = now[np.arange(len(left)), best] < errors[left]
        source = (np.arange(len(left)) * copies + best)[better]
        turns[..., left[better]] = again[..., source]
        points[..., left[better]] = ends[..., source]
        iterations[left] += used.reshape(-1, copies)[np.arange(len(left)), best]


def _nearest_solved(task: Task, turns: Array, errors: Array) -> NDArray[np.intp]:
    """Return which copy of each chain is best, from errors (chains, copies): (chains,).

    Of those that are solved, the one that is nearest to the start; else the one of least error.
    """
    likeness = np.abs(np.einsum("jqb,jqb->jb", turns, task.start)).sum(0)
    cost = np.where(errors <= task.tolerance.reshape(errors.shape), -1.0, errors)
    nearest = likeness.reshape(errors.shape) / (10.0 * task.joints)
    best: NDArray[np.intp] = np.where(cost < 0, cost - nearest, cost).argmin(-1)
    return best


def _random_start(task: Task, random: np.random.Generator) -> Array:
    low, high = (-np.pi, np.pi) if task.bounds is None else (task.bounds.low, task.bounds.high)
    return columns.from_euler(random.uniform(low, high, (task.joints, 3, task.count)))
