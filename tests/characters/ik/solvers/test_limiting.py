"""Joint limits by propagation and by cutting off (S16), in the experiment of the specification."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.ik.solvers import columns
from cubeling.characters.ik.solvers.chains import Chains
from cubeling.characters.ik.solvers.measures import arc_targets
from cubeling.characters.ik.solvers.methods.positional import PositionalSolver, propagate
from cubeling.characters.ik.solvers.methods.springs import MassSprings
from cubeling.characters.ik.solvers.task import Limiting, Task
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.joint_limits import AngleLimits
from cubeling.characters.skeleton.pose import Array

COUNT = 200


def planar_chains(first_deg: float = 120.0, others_deg: float = 50.0) -> Chains:
    """Return a chain of six joints that turn about z only."""
    high = np.zeros((6, 3))
    high[:, 2] = np.radians([first_deg, *[others_deg] * 5])
    return Chains.straight(np.full(6, 1 / 6), AngleLimits.of_angles(-high, high))


def planar_task(limiting: Limiting) -> Task:
    chains = planar_chains()
    _, points = chains.frames(chains.random(COUNT, np.random.default_rng(4)))
    return Task.of(chains, points[:, -1], arc_targets(6, COUNT), np.full(COUNT, 1e-3), limiting)


def errors(limiting: Limiting, loops: int) -> Array:
    """Return how far ends are from their targets, in lengths of the chain."""
    task = planar_task(limiting)
    _, points, _ = PositionalSolver(MassSprings(pinned=True), max_loops=loops)(task)
    return columns.length(points[-1] - task.targets)


def test_propagation_beats_cutting_off_in_a_single_pass() -> None:
    propagate, clamp = errors("propagate", 1), errors("clamp", 1)
    assert propagate.mean() < clamp.mean()
    assert (propagate < 0.05).mean() > (clamp < 0.05).mean()


def test_twenty_loops_bring_nine_of_ten_near_their_targets() -> None:
    assert (errors("propagate", 20) < 0.05).mean() >= 0.9


def test_parent_takes_what_its_child_cannot() -> None:
    chains = planar_chains()
    turned = rotations.about("z", np.radians([[0.0, 0.0, 0.0, 0.0, 0.0, 80.0]]))
    target = np.array([[0.9, 0.3, 0.0]])
    task = Task.of(chains, target, arc_targets(6, 1), np.full(1, 1e-3), "propagate")
    _, points = task.frames(columns.to_columns(turned))
    angles = np.degrees(columns.to_euler(propagate(task, columns.to_columns(turned), points)))
    levers = np.linalg.norm(target - points[:-1, :, 0], axis=-1)
    assert angles[5, 2, 0] == pytest.approx(50.0)
    assert angles[4, 2, 0] == pytest.approx(30.0 * levers[5] / levers[4])


def test_what_the_base_cannot_take_is_lost() -> None:
    task = planar_task("propagate")
    wild = rotations.about("z", np.random.default_rng(1).uniform(-3, 3, (COUNT, 6)))
    turns = columns.to_columns(wild)
    kept = propagate(task, turns, task.frames(turns)[1])
    angles = columns.to_euler(kept)
    assert task.bounds is not None
    assert np.maximum(task.bounds.low - angles, angles - task.bounds.high).max() < 1e-9


def test_axes_of_limits_may_differ_from_those_of_joints() -> None:
    """The same limits in other axes, with the joints' frames turned accordingly: same postures."""
    chains, random = planar_chains(), np.random.default_rng(6)
    plain = chains.limits
    assert plain is not None
    turn = rotations.normalize(random.normal(size=(6, 4)))
    above = np.concatenate([rotations.IDENTITY[None], turn[:-1]])
    before = rotations.multiply(rotations.conjugate(above), np.tile(rotations.IDENTITY, (6, 1)))
    turned = replace(plain, before=before, after=turn)
    offsets = rotations.rotate(rotations.conjugate(turn), chains.offsets)
    other = Chains(offsets, turned)
    local = chains.random(10, random)
    moved = rotations.multiply(rotations.multiply(rotations.conjugate(above), local), turn)
    assert np.allclose(other.frames(moved)[1], chains.frames(local)[1])
    assert turned.excess(moved).max() < 1e-9
    task = Task.of(other, chains.frames(local)[1][:, -1], moved, np.full(10, 1e-3), "clamp")
    assert np.allclose(columns.to_rows(task.points_at_start), chains.frames(local)[1])
