"""Random motions of the benchmark's cube that keep it in view."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from tests.bench.tracking.light import UP
from tests.bench.tracking.optics import LensModel
from tests.bench.tracking.paper import AXES, BenchmarkCube
from tests.bench.tracking.paths import (
    Poses,
    halton,
    matrices,
    random_sines,
    speeds,
    uniform_rotation,
)
from tests.bench.tracking.plans import SequencePlan


def in_view(lens: LensModel, cube: BenchmarkCube, poses: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether the whole cube is in the picture at each pose (n, 4, 4), (n,)."""
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], cube.vertices) + poses[:, None, :3, 3]
    pixels = lens.project(there)
    inside = (pixels >= 0) & (pixels <= np.array(lens.size) - 1)
    return np.asarray((inside.all(-1) & (there[..., 2] > 0.1)).all(-1))


def _start(plan: SequencePlan, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pose (4, 4) of a Halton point (6,)."""
    depth = plan.depth[0] + point[0] * (plan.depth[1] - plan.depth[0])
    spread = 0.12 if plan.facing == "frontal" else 0.9 if plan.independent else 0.5
    lens = plan.camera.lens
    pixel = (point[1:3] - 0.5) * spread * np.array(lens.size) + lens.matrix[:2, 2]
    ray = np.append(lens.directions(pixel), 1.0)
    rotation = uniform_rotation(point[3:])
    if plan.facing == "frontal":
        roll = Rotation.from_rotvec([0, 0, 2 * np.pi * point[3]])
        tilt = Rotation.from_rotvec([*(0.2 * (point[4:] - 0.5)), 0])
        quarter = Rotation.from_euler("xyz", np.array([2, 0, 0]) * np.pi / 2)
        rotation = tilt * roll * quarter
    return np.asarray(matrices(Rotation.concatenate([rotation]), (ray * depth)[None])[0])


def _rested(
    plan: SequencePlan, cube: BenchmarkCube, point: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Pose (4, 4) of a Halton point (6,), on the table; it may be out of view."""
    up = UP / np.linalg.norm(UP)
    depth = plan.depth[0] + point[0] * (plan.depth[1] - plan.depth[0])
    x = plan.camera.lens.size[0] / plan.camera.lens.matrix[0, 0] * (point[1] - 0.5)
    # The cube's middle is half its edge above the table.
    y = ((cube.edge / 2 - plan.height) / depth - up[2]) / up[1]
    yaw = Rotation.from_rotvec(2 * np.pi * point[3] * up)
    across = yaw.apply([1.0, 0.0, 0.0])
    table = np.stack([across, np.cross(up, across), up], axis=1)
    upper = tuple(AXES.values())[int(point[4] * len(AXES))]
    rotation = Rotation.from_matrix((table @ np.stack(upper))[None])
    return np.asarray(matrices(rotation, np.array([[x, y, 1.0]]) * depth)[0])


def static_poses(
    plan: SequencePlan, cube: BenchmarkCube, first: int, count: int, shift: NDArray[np.float64]
) -> list[NDArray[np.float64]]:
    """`count` poses (4, 4), the whole cube in view: Halton points from number `first` on."""
    found: list[NDArray[np.float64]] = []
    index = first
    while len(found) < count:
        point = halton(index, shift)
        pose = _rested(plan, cube, point) if plan.resting and index % 2 else _start(plan, point)
        held = plan.facing != "one" or _faces_in_view(cube, pose[None], MIN_SLANT_OF_SLIVER)[0] == 1
        if held and in_view(plan.camera.lens, cube, pose[None])[0]:
            found.append(pose)
        index += 1
    return found


def drifting(
    pose: NDArray[np.float64], velocity: NDArray[np.float64] | None = None, middle: float = 0.0
) -> Poses:
    """Be at `pose` (4, 4) at the time `middle` [s], with a constant velocity (3,) [m/s]."""

    def path(times: NDArray[np.float64]) -> NDArray[np.float64]:
        poses = np.repeat(pose[None], len(times), axis=0)
        if velocity is not None:
            poses[:, :3, 3] += np.outer(times - middle, velocity)
        return poses

    return path


def smearing(
    plan: SequencePlan, pose: NDArray[np.float64], random: np.random.Generator
) -> NDArray[np.float64]:
    """Velocity (3,) [m/s] in a random direction that smears the cube as long as the plan says."""
    angle = random.uniform(0, 2 * np.pi)
    speed = plan.smear / plan.exposure * pose[2, 3] / plan.camera.lens.matrix[0, 0]
    return np.array([speed * np.cos(angle), speed * np.sin(angle), 0.0])


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
        share = float(in_view(plan.camera.lens, cube, path(times)).mean())
        if plan.facing == "corner":
            share *= float((_faces_in_view(cube, path(times)) >= 2).mean())
        if share > most:
            best, most = path, share
        if most == 1:
            break
    assert best is not None
    return best


MIN_SLANT_OF_SLIVER = 0.2
"""Least cosine between a face's normal and the line to the camera at which its marker is read."""


def _faces_in_view(
    cube: BenchmarkCube, poses: NDArray[np.float64], least: float = 0.35
) -> NDArray[np.int64]:
    """How many faces look at the camera, and not just past it, at each pose (n, 4, 4)."""
    normals = np.stack([side.normal for side in cube.sides])
    middles = normals * cube.edge / 2
    there = np.einsum("nij,kj->nki", poses[:, :3, :3], middles) + poses[:, None, :3, 3]
    out = np.einsum("nij,kj->nki", poses[:, :3, :3], normals)
    slant = -(there * out).sum(-1) / np.linalg.norm(there, axis=-1)
    return np.asarray((slant > least).sum(-1))


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
