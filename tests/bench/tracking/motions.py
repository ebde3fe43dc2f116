"""Random motions of the benchmark's cube that keep it in view."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.bench.tracking.optics import LensModel
from tests.bench.tracking.paper import BenchmarkCube
from tests.bench.tracking.paths import (
    Poses,
    halton,
    matrices,
    random_sines,
    speeds,
    uniform_rotation,
)
from tests.bench.tracking.plans import SequencePlan

LENS = LensModel(
    np.array([[902.3, 0.0, 645.2], [0.0, 900.8, 355.7], [0.0, 0.0, 1.0]]),
    np.array([-0.11, 0.06, 0.0006, -0.0004, -0.01]),
    (1280, 720),
)
"""The camera of all sequences: 71° from left to right, a barrel of a few pixels."""


def in_view(cube: BenchmarkCube, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the whole cube is in the picture at each pose (n, 4, 4), (n,)."""
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], cube.vertices) + poses[:, None, :3, 3]
    pixels = LENS.project(there)
    inside = (pixels >= 0) & (pixels <= np.array(LENS.size) - 1)
    return np.asarray((inside.all(-1) & (there[..., 2] > 0.1)).all(-1))


def _start(plan: SequencePlan, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pose (4, 4) of a Halton point (6,)."""
    depth = plan.depth[0] + point[0] * (plan.depth[1] - plan.depth[0])
    spread = 0.12 if plan.facing == "frontal" else 0.9 if plan.independent else 0.5
    pixel = (point[1:3] - 0.5) * spread * np.array(LENS.size) + LENS.matrix[:2, 2]
    ray = np.append(LENS.directions(pixel), 1.0)
    rotation = uniform_rotation(point[3:])
    if plan.facing == "frontal":
        roll = Rotation.from_rotvec([0, 0, 2 * np.pi * point[3]])
        tilt = Rotation.from_rotvec([*(0.2 * (point[4:] - 0.5)), 0])
        quarter = Rotation.from_euler("xyz", np.array([2, 0, 0]) * np.pi / 2)
        rotation = tilt * roll * quarter
    return np.asarray(matrices(Rotation.concatenate([rotation]), (ray * depth)[None])[0])


def static_poses(
    plan: SequencePlan, cube: BenchmarkCube, first: int, count: int, shift: NDArray[np.float64]
) -> list[Poses]:
    """`count` poses at rest, the whole cube in view: Halton points from number `first` on."""
    found: list[Poses] = []
    index = first
    while len(found) < count:
        pose = _start(plan, halton(index, shift))
        if in_view(cube, pose[None])[0]:
            found.append(_still(pose))
        index += 1
    return found


def _still(pose: NDArray[np.float64]) -> Poses:
    return lambda times: np.repeat(pose[None], len(times), axis=0)


def random_motion(
    plan: SequencePlan,
    cube: BenchmarkCube,
    index: int,
    shift: NDArray[np.float64],
    random: np.random.Generator,
    times: NDArray[np.float64],
) -> Poses:
    """Draw motions until one keeps the cube in view at all `times`; else the one that does most.

    Parameters
    ----------
    plan, cube
        What moves, and how.
    index, shift
        Number of the Halton point where the motion starts, and how all points are shifted.
    random
        The motion.
    times
        When the cube has to be in view [s], (n,).
    """
    best, most = None, -1.0
    for more in range(60):
        start = _start(plan, halton(index + 97 * more, shift))
        path = _moved(plan, start, float(times[-1]), random)
        share = float(in_view(cube, path(times)).mean())
        if plan.facing == "corner":
            share *= float((_faces_in_view(cube, path(times)) >= 2).mean())
        if share > most:
            best, most = path, share
        if most == 1:
            break
    assert best is not None
    return best


def _faces_in_view(cube: BenchmarkCube, poses: NDArray[np.float64]) -> NDArray[np.int64]:
    """How many faces look at the camera, and not just past it, at each pose (n, 4, 4)."""
    normals = np.stack([side.normal for side in cube.sides])
    middles = normals * cube.edge / 2
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], middles) + poses[:, None, :3, 3]
    out = np.einsum("nij,kj->nki", poses[:, :3, :3], normals)
    slant = -(there * out).sum(-1) / np.linalg.norm(there, axis=-1)
    return np.asarray((slant > 0.35).sum(-1))


def _moved(
    plan: SequencePlan, start: NDArray[np.float64], length: float, random: np.random.Generator
) -> Poses:
    """Motion from `start` whose peak speeds within `length` [s] are those of the plan."""
    way = random_sines(random, plan.reach, plan.pace)
    turn = random_sines(random, plan.turns, plan.pace)
    base, origin = Rotation.from_matrix(start[:3, :3]), start[:3, 3]
    long = np.arange(0.0, max(3.0, length), 1 / 90)

    def path(times: NDArray[np.float64]) -> NDArray[np.float64]:
        return matrices(Rotation.from_rotvec(turn(times)) * base, origin + way(times))

    for _ in range(5):  # The speed of turning is not quite linear in the height of the waves.
        found = speeds(path, long)
        top, spin = np.linalg.norm(found[:, :3], axis=1), np.linalg.norm(found[:, 3:], axis=1)
        way = way.scaled(plan.speed / max(float(top.max()), 1e-9))
        turn = turn.scaled(plan.turning / max(float(spin.max()), 1e-9))
    return path
