"""What spring bones and constraints cost: `python -m tests.bench.springs`.

bones
    Joints that swing, and in how many levels: a level waits for the one above it.
60 fps, 30 fps
    Median time of an update; at 30 frames a second it makes two steps.
apart
    How far tails are from where they are at 60 frames a second after 3 s, as a part of their swing:
    root mean square over the bones, at 30 frames a second.
pose
    Median time of the placements of all joints (`Pose.globals`), to compare with in the same run.
"""

import math
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.body.constraints import ConstrainedJoints
from cubeling.characters.body.springs import SpringBody
from cubeling.characters.model.constraints import JointConstraint
from cubeling.characters.model.springs import SpringBone, SpringCollider
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

BODY_JOINTS, HEAD, SECONDS = 40, 10, 3.0
BALL = SpringCollider("0", (0.0, -0.3, 0.1), (0.0, -0.3, 0.1), 0.12)


def median_ms(work: Callable[[int], object], calls: int) -> float:
    """Return the median time of a call [ms]."""
    times = []
    for number in range(calls):
        start = time.perf_counter()
        work(number)
        times.append(time.perf_counter() - start)
    return 1e3 * float(np.median(times))


def haired(chains: int, length: int, collides: bool) -> tuple[Skeleton, list[SpringBone]]:
    """Return a body of 40 joints with chains of hair at its head."""
    parents = [-1, *((joint - 1) // 2 for joint in range(1, BODY_JOINTS))]
    bones = []
    for chain in range(chains):
        parents.append(HEAD)
        for link in range(length):
            joint = len(parents) - 1
            colliders = (BALL,) if collides else ()
            tail = (0.02 * math.cos(chain), -0.1, 0.02 * math.sin(chain))
            bones.append(SpringBone(str(joint), tail, 1.0, 0.3, (0.0, -0.2, 0.0), 0.02, colliders))
            if link + 1 < length:
                parents.append(joint)
    shifts = np.random.default_rng(0).normal(size=(len(parents), 3)) * 0.05
    rest = Pose(shifts, np.tile(rotations.IDENTITY, (len(parents), 1)))
    return Skeleton(tuple(map(str, range(len(parents)))), tuple(parents), rest), bones


def walking(skeleton: Skeleton, seconds: float) -> tuple[Pose, Array]:
    """Return a pose with a nodding head, and where the body stands."""
    turns, world = skeleton.rest.rotations.copy(), np.eye(4)
    turns[HEAD] = rotations.about("x", 0.3 * math.sin(6.0 * seconds))
    world[:3, 3] = [0.8 * seconds, 0.03 * math.sin(12.0 * seconds), 0.0]
    return Pose(skeleton.rest.translations, turns), world


def swung(skeleton: Skeleton, bones: list[SpringBone], rate: int) -> tuple[Array, Array, float]:
    """Return the tails' directions in the end, in the pose and swung, and the time [ms]."""
    body, shown = SpringBody(skeleton, bones), skeleton.rest

    frames = [walking(skeleton, frame / rate) for frame in range(round(SECONDS * rate) + 1)]

    def step(frame: int) -> None:
        nonlocal shown
        shown = body.update(*frames[frame], 1 / rate if frame else 0.0)

    elapsed = median_ms(step, len(frames))
    pose, _ = walking(skeleton, SECONDS)
    placed = [each.globals(skeleton) for each in (pose, shown)]
    ways = [
        np.array([one[skeleton.index(b.joint), :3, :3] @ b.tail for b in bones]) for one in placed
    ]
    return ways[0], ways[1], elapsed


def main() -> None:
    """Print the tables."""
    table = Table("bones", "60 fps [ms]", "30 fps [ms]", "apart", "pose [ms]")
    for chains, length, collides in (
        (30, 1, False),
        (10, 3, False),
        (6, 5, False),
        (10, 3, True),
    ):
        skeleton, bones = haired(chains, length, collides)
        still, fine, at_60 = swung(skeleton, bones, 60)
        _, coarse, at_30 = swung(skeleton, bones, 30)
        apart = np.linalg.norm(coarse - fine) / np.linalg.norm(fine - still)
        pose, _ = walking(skeleton, 0.0)
        placing = median_ms(lambda _, pose=pose, of=skeleton: pose.globals(of), 300)  # type: ignore[misc]
        what = f"{chains * length} in {length}" + (" with a collider" if collides else "")
        table.add_row(what, f"{at_60:.3f}", f"{at_30:.3f}", f"{apart:.1%}", f"{placing:.3f}")
    console = Console()
    console.print(table)
    skeleton, _ = haired(30, 1, False)
    rolls = [JointConstraint("roll", str(40 + n), str(1 + n), (1.0, 0.0, 0.0)) for n in range(12)]
    constrained, (pose, _) = ConstrainedJoints(skeleton, rolls), walking(skeleton, 1.0)
    console.print(
        f"12 roll constraints: {median_ms(lambda _: constrained.apply(pose), 500):.3f} ms"
    )


if __name__ == "__main__":
    main()
