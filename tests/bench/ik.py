"""How the solvers of inverse kinematics do: `python -m tests.bench.ik`.

The tables of `cubeling reproduce ik-methods`; then for chains of six joints with limits:

oracle
    `scipy.optimize.least_squares` with bounds on the same problems: share solved, time, and summed
    turn of the joints. It starts from where our solver starts, once.
wrists
    Paths of both wrists in recorded motions, as the chest sees them, with the performer's own
    bones: how far the elbow is from the recorded one, of the arm that characters reach with, of
    that which reaches from the first frame and keeps what its elbow has of its own, and of a chain
    of two joints.
campaign
    With `--solves 1000000` that many solves: share solved, not-a-numbers, joints beyond limits.

Exits with 1 if a bar of issue 17 is missed.
"""

import argparse
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.commands.study.reproduce import shown_table
from cubeling.app.workshop.reproduction.bodies.ik_figures import (
    CHAIN_SIZES,
    AloneFigures,
    SureFigures,
    measure_alone,
    measure_sure,
)
from cubeling.app.workshop.reproduction.bodies.ik_methods import (
    alone_table,
    printed_table,
    sure_table,
)
from cubeling.characters.errors import CharacterError
from cubeling.characters.ik.reaching import UpperBody
from cubeling.characters.ik.reaching.arms import (
    Arm,
    Effector,
    bend,
    effector_of,
    to_vector,
)
from cubeling.characters.ik.reaching.swivel import natural_elbow, own_elbow
from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.ik.solvers.measures import (
    ReachingProblem,
    arc_targets,
    joint_change,
    violations,
)
from cubeling.characters.ik.solvers.solving import SOLVERS, TOLERANCE, solve
from cubeling.characters.retargeting.recording import load_recording
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.skeleton.scalar_quaternions import IDENTITY, Vector

DATA = Path(__file__).parents[3] / "shared" / "data"
BLOCK = 5000
MIN_SOLVED, MAX_SINGLE_MS, MAX_BATCH_US, MAX_TWIST_DEG = 0.995, 0.5, 5.0, 5.0
DEFAULT = "damped"


def oracle_table(count: int) -> Table:
    """Return what scipy finds beside what we find."""
    from scipy.optimize import least_squares

    problem = ReachingProblem.random(6, count, np.random.default_rng(9))
    limits = problem.chains.limits
    assert limits is not None
    begin = np.clip(limits.angles(problem.start[0]), limits.low, limits.high).ravel()
    bounds = limits.low.ravel() - 1e-12, limits.high.ravel() + 1e-12
    found = []
    start = time.perf_counter()
    for target in problem.targets:

        def miss(angles: Array, target: Array = target) -> Array:
            local = limits.rotations(angles.reshape(-1, 3))
            difference: Array = problem.chains.frames(local)[1][-1] - target
            return difference

        found.append(least_squares(miss, begin, bounds=bounds).x.reshape(-1, 3))
    theirs_s = time.perf_counter() - start
    local = limits.rotations(np.array(found))
    ends = problem.chains.frames(local)[1][:, -1]
    near = np.linalg.norm(ends - problem.targets, axis=-1) <= TOLERANCE * problem.chains.reach
    start = time.perf_counter()
    ours = solve(problem.chains, problem.targets, problem.start)
    ours_s = time.perf_counter() - start
    table = Table(title="beside scipy's least_squares with bounds, six joints with limits")
    for heading in ("", "solved", "each", "change"):
        table.add_column(heading, justify="right" if heading else "left")
    for name, solved, seconds, posture in (
        ("scipy", near, theirs_s, local),
        (DEFAULT, ours.solved, ours_s, ours.rotations),
    ):
        change = joint_change(problem.start, posture)[solved].mean()
        each = f"{1e3 * seconds / count:.3f} ms"
        table.add_row(name, f"{solved.mean():.1%}", each, f"{change:.0f}°")
    return table


class RecordedArm(NamedTuple):
    """The arm of a performer in one recording, seen from the chest at rest."""

    arm: Arm

    wrist: Effector

    elbows: Array
    """From the shoulder, (frames, 3) [m]."""

    wrists: Array
    """From the shoulder, (frames, 3) [m]."""


def recorded_arms() -> Iterator[RecordedArm]:
    """Yield the arms of recorded people at 30 frames a second."""
    files = [*sorted((DATA / "bvh").glob("*.bvh")), *sorted((DATA / "cmu-mocap").rglob("*.amc"))]
    for file in files:
        try:
            recording = load_recording(str(file))
        except CharacterError:
            continue
        skeleton = recording.skeleton
        step = max(round(recording.clip.rate / 30), 1)
        frames = recording.clip.poses.globals(skeleton)[::step]
        rest = skeleton.rest.globals(skeleton)
        for arm in UpperBody.of(skeleton, recording.anatomy).arms.values():
            if arm.carrier < 0:
                continue
            chest = frames[:, arm.carrier, :3, :3] @ rest[arm.carrier, :3, :3].T
            shoulder, elbow, wrist = (frames[:, joint, :3, 3] for joint in arm.joints[1:])
            own = [np.einsum("fji,fj->fi", chest, each - shoulder) for each in (elbow, wrist)]
            yield RecordedArm(arm, effector_of(arm, arm.wrist), *own)


def elbow_misses(recorded: RecordedArm) -> dict[str, Array]:
    """Return how far the elbows of solved arms are from the recorded ones, (frames,) [m]."""
    upper, lower = recorded.elbows[0], recorded.wrists[0] - recorded.elbows[0]
    chains = Chains(np.stack([upper, lower]))
    start = np.tile(rotations.IDENTITY, (len(recorded.wrists), 2, 1))
    arm, shoulder = recorded.arm, (0.0, 0.0, 0.0)
    natural: list[Vector] = []
    kept: list[Vector] = []
    first = to_vector(recorded.elbows[0]), to_vector(recorded.wrists[0])
    own = own_elbow(arm, shoulder, *first, IDENTITY)
    for place in recorded.wrists:
        wrist = to_vector(place)
        for each, found in ((None, natural), (own, kept)):
            elbow = natural_elbow(arm, shoulder, wrist, IDENTITY, each)
            found.append(bend(arm, recorded.wrist, shoulder, wrist, IDENTITY, elbow).elbow)
    chain = solve(chains, recorded.wrists, start).positions[:, 1]
    ways = {
        "arm": natural,
        "arm, as reached from the first frame": kept,
        f"chain ({DEFAULT}), from the first frame": chain,
    }
    return {
        way: np.linalg.norm(np.asarray(found) - recorded.elbows, axis=-1)
        for way, found in ways.items()
    }


def wrist_table() -> Table:
    """Return how near the elbows of solved arms are to recorded ones."""
    misses = [elbow_misses(recorded) for recorded in recorded_arms()]
    title = f"wrist paths of {len(misses)} recorded arms: distance of the elbow from the true one"
    table = Table(title=title)
    for heading in ("", "median", "90 %"):
        table.add_column(heading, justify="right" if heading else "left")
    for way in misses[0] if misses else ():
        quantiles = np.quantile(np.concatenate([each[way] for each in misses]), (0.5, 0.9))
        table.add_row(way, *(f"{100 * value:.2f} cm" for value in quantiles))
    return table


def campaign(solves: int, console: Console) -> bool:
    """Solve many random problems with limits; return whether the bars are met."""
    solved = bad = beyond = 0
    start = time.perf_counter()
    for block in range(-(-solves // BLOCK)):
        joints = 4 + block % 7
        problem = ReachingProblem.random(joints, BLOCK, np.random.default_rng(block))
        begin = problem.chains.random(BLOCK, np.random.default_rng([block, 1]))
        begin = begin if block % 2 else arc_targets(joints, BLOCK)
        found = solve(problem.chains, problem.targets, begin, seed=block)
        solved += int(found.solved.sum())
        bad += int((~np.isfinite(found.rotations)).sum() + (~np.isfinite(found.positions)).sum())
        beyond += violations(problem.chains, found)
    total = -(-solves // BLOCK) * BLOCK
    each = 1e6 * (time.perf_counter() - start) / total
    console.print(
        f"campaign: {total} solves of chains of 4 to 10 joints with limits: {solved / total:.4%} "
        f"solved, {bad} not finite, {beyond} joints beyond limits, {each:.0f} µs each",
        highlight=False,
    )
    return solved >= MIN_SOLVED * total and bad == 0 and beyond == 0


def missed(alone: list[AloneFigures], sure: list[SureFigures]) -> list[str]:
    """Return the bars that are missed, in words."""
    own = [each for each in alone if each.method == DEFAULT]
    checks = {
        f"{MIN_SOLVED:.1%} solved within limits": all(s.solved >= MIN_SOLVED for s in sure),
        "no joint beyond its limits": all(s.violations == 0 for s in sure),
        "zig-zag 0 near the base": all(s.zig_zag == 0 for s in sure),
        f"one chain of six in {MAX_SINGLE_MS} ms": own[0].single_ms <= MAX_SINGLE_MS,
        f"a chain of a batch in {MAX_BATCH_US} µs": own[0].batch_us <= MAX_BATCH_US,
        "joints change no more than by CCD": all(
            each.change_deg <= other.change_deg
            for each in alone
            for other in alone
            if (other.method, other.joints) == ("ccd", each.joints)
        ),
        f"twist below {MAX_TWIST_DEG}°/cm by the default": max(
            *(each.twist_deg for each in own),
            *(each.twist_deg for each in sure if each.method == DEFAULT),
        )
        < MAX_TWIST_DEG,
    }
    return [name for name, met in checks.items() if not met]


def main() -> int:
    """Print the tables and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--targets", type=int, default=1000, help="of each row")
    parser.add_argument("--solves", type=int, default=50_000, help="of the campaign")
    options = parser.parse_args()
    console = Console(width=120)
    alone, sure = [], []
    for joints in CHAIN_SIZES:
        for method in SOLVERS:
            alone.append(measure_alone(method, joints, options.targets))
            sure.append(measure_sure(method, joints, options.targets))
    console.print(shown_table(printed_table(alone)))
    console.print(shown_table(alone_table(alone)))
    console.print(shown_table(sure_table(sure)))
    console.print(oracle_table(min(options.targets, 100)))
    if DATA.is_dir():
        console.print(wrist_table())
    else:
        console.print(f"no recordings at {DATA}: wrists are not measured")
    met = campaign(options.solves, console)
    missing = missed(alone, sure)
    for name in missing:
        console.print(f"[red]missed:[/] {name}", highlight=False)
    return int(not met or bool(missing))


if __name__ == "__main__":
    sys.exit(main())
