"""How solvers of inverse kinematics do on chains of 6 and 10 joints: what table 7.1 measures."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion import (
    REACH_M,
    ReachingProblem,
    SingleChain,
    arc_targets,
    joint_change,
    solve,
    target_path,
    twist,
    violations,
    zig_zag,
)

CHAIN_SIZES = (6, 10)
"""Joints of the chains of the tables."""

_NEAR_BASE = 0.25  # of the length of a chain: targets nearer than this are near the base
_PATH_FRAMES, _PATHS, _FOLLOWED, _STEP_M = 100, 5, 20, 0.01
_REPEATS, _SINGLES = 5, 30  # of timings, of which the shortest and the middle one count


@dataclass(frozen=True)
class AloneFigures:
    """What one method does alone on chains of one size, without limits but where stated."""

    method: str
    """A name of `SOLVERS`."""

    joints: int
    """Joints of a chain."""

    iterations: float
    """Mean number of iterations of a solution."""

    single_ms: float
    """Median time of one chain [ms]."""

    batch_us: float
    """Time of each chain of the batch [µs]."""

    solved: float
    """Share of the targets that are reached."""

    in_limits: float
    """Share that is reached within the limits."""

    change_deg: float
    """Mean summed turn of the joints from the start."""

    zig_zag: float
    """Mean changes of the sense of the bend, for targets near the base."""

    twist_deg: float
    """Twist of a bone for a centimetre of its target, from the same start; 99 % are less."""


@dataclass(frozen=True)
class SureFigures:
    """What one method does within the limits, with what all methods share."""

    method: str
    """A name of `SOLVERS`."""

    joints: int
    """Joints of a chain."""

    solved: float
    """Share of the targets that are reached."""

    violations: int
    """Joints beyond a limit, here and by the method alone."""

    iterations: float
    """Mean iterations, those of all stages together."""

    batch_us: float
    """Time of each chain of the batch [µs]."""

    change_deg: float
    """Mean summed turn of the joints from the start."""

    zig_zag: float
    """Mean changes of the sense of the bend, for targets near the base, without limits."""

    twist_deg: float
    """Twist of a bone for a centimetre of a target that a chain follows; 99.9 % are less."""


def measure_alone(method: str, joints: int, count: int, seed: int = 0) -> AloneFigures:
    """Return the figures of a method alone, on chains of a size with random targets."""
    problem = ReachingProblem.random(joints, count, np.random.default_rng(seed))
    free, start, targets = problem.free, problem.start, problem.targets
    found = solve(free, targets, start, method=method, alone=True)
    limited = solve(problem.chains, targets, start, method=method, alone=True)
    batch = shortest(lambda: solve(free, targets, start, method=method, alone=True))
    return AloneFigures(
        method,
        joints,
        float(found.iterations.mean()),
        1e3 * single_s(problem, method),
        1e6 * batch / count,
        float(found.solved.mean()),
        float(limited.solved.mean()),
        float(joint_change(start, found.rotations)[found.solved].mean()),
        zig_zag_near_base(problem, method, alone=True),
        twist_along_paths(problem, method, np.random.default_rng(seed)),
    )


def measure_sure(method: str, joints: int, count: int, seed: int = 0) -> SureFigures:
    """Return the figures of a method within limits, with what all methods share."""
    problem = ReachingProblem.random(joints, count, np.random.default_rng(seed))
    chains, start, targets = problem.chains, problem.start, problem.targets
    alone = solve(chains, targets, start, method=method, alone=True)
    found = solve(chains, targets, start, method=method, seed=seed)
    batch = shortest(lambda: solve(chains, targets, start, method=method, seed=seed))
    return SureFigures(
        method,
        joints,
        float(found.solved.mean()),
        violations(chains, alone) + violations(chains, found),
        float(found.iterations.mean()),
        1e6 * batch / count,
        float(joint_change(start, found.rotations).mean()),
        zig_zag_near_base(problem, method, alone=False),
        twist_while_following(problem, method, np.random.default_rng(seed)),
    )


def shortest(action: Callable[[], object]) -> float:
    """Return the shortest time of an action [s]: the one least disturbed by other programs."""
    times = []
    for _ in range(_REPEATS):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return min(times)


def single_s(problem: ReachingProblem, method: str) -> float:
    """Return the median time of one chain [s]; by the scalar solver where there is one."""
    one, times = SingleChain(problem.free), []
    for target, start in zip(problem.targets[:_SINGLES], problem.start, strict=False):
        place, turns = tuple(target.tolist()), start.tolist()
        begin = time.perf_counter()
        if method == "damped":
            one.solve(place, turns)
        else:
            solve(problem.free, target[None], start[None], method=method, alone=True)
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def zig_zag_near_base(problem: ReachingProblem, method: str, *, alone: bool) -> float:
    """Return the mean zig-zag of chains whose targets are near the base, without limits."""
    random = np.random.default_rng(1)
    directions = random.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    targets = directions * random.uniform(0.05, _NEAR_BASE, (200, 1)) * REACH_M
    start = arc_targets(problem.chains.joints, 200)
    found = solve(problem.free, targets, start, method=method, alone=alone)
    return float(zig_zag(found.positions)[found.solved].mean()) if found.solved.any() else np.nan


def twist_along_paths(problem: ReachingProblem, method: str, random: np.random.Generator) -> float:
    """Return the twist in a step of a target, each solved from the same start [deg].

    99 % of the twists are smaller; without limits.
    """
    twists = []
    start = arc_targets(problem.chains.joints, _PATH_FRAMES)
    for _ in range(_PATHS):
        path = target_path(_PATH_FRAMES, _STEP_M, random)
        found = solve(problem.free, path, start, method=method, alone=True)
        twists.append(twist(problem.free, start[0], found.rotations))
    return float(np.nanquantile(np.concatenate(twists), 0.99))


def twist_while_following(
    problem: ReachingProblem, method: str, random: np.random.Generator
) -> float:
    """Return the twist in a step of chains that follow targets, within limits [deg].

    99.9 % of the twists are smaller; the largest ones are jumps to another posture, where the
    limits leave no other way.
    """
    paths = np.stack([target_path(_PATH_FRAMES, _STEP_M, random) for _ in range(_FOLLOWED)], 1)
    start = arc_targets(problem.chains.joints, _FOLLOWED)
    postures = [start]
    for places in paths:
        found = solve(problem.chains, places, postures[-1], method=method)
        postures.append(found.rotations)
    ways = np.stack(postures[2:])  # the first one is still on its way to the path
    twists = [twist(problem.chains, start[0], ways[:, number]) for number in range(_FOLLOWED)]
    return float(np.nanquantile(twists, 0.999))
