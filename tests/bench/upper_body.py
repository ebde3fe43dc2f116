"""Self-collision and dependent joints of upper bodies: `python -m tests.bench.upper_body`.

colliding
    Frames in which the capsules of the bundled human meet, before and after damping, in clips of
    wide arm movements that the safe ranges were not made from, and in recordings of CMU and of
    AnimatedDrawings, which are not ours (`shared/data`).
hidden
    The spine, neck, head and shoulders of a gesture are held still; the filter predicts them from
    the arms. Correlation with their true movement, weighted by how much each moves, of gestures
    that the filter was not made from; linear regression beside it.
joining in
    The same joints of persons, ours and not ours, in each of their clips (of one clip: each half),
    by what the other clips have of them: mean error where they stay as they stand, and as the
    filter moves them, and how far arms are turned from the gesture.

Exits with 1 if a bar of issue 15 is missed: 80 % fewer colliding frames, a positive correlation.
"""

import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.workshop.reproduction.motion_graphs.summary import bootstrap_interval
from cubeling.characters import Character, Pose
from cubeling.characters.body.axes import Degrees, body_axes, rotation_vectors
from cubeling.characters.body.capsules import CapsuleBody
from cubeling.characters.body.dependent_joints import DependentJoints
from cubeling.characters.body.self_collision import SafeRanges
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.model.standing import idle_clips
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.idle.posture_space import PostureVectors

DATA = Path(__file__).parents[3] / "shared" / "data"
GESTURES = ("wave", "cheer", "jump", "nod", "shake")
HIDDEN = ("spine", "chest", "neck", "head", "leftShoulder", "rightShoulder")
STRANGERS = ("RobotExpressive", "CesiumMan", "BrainStem", "RiggedFigure")
SEEDS, HELD_OUT = range(1, 6), ((9, 1.0), (10, 1.4), (11, 0.8))
"""Seeds of the clips that the ranges are made from, and seeds and sizes of the others."""

SWINGS: tuple[dict[str, Degrees], ...] = (
    {"leftUpperArm": (0, -70, 0), "leftLowerArm": (0, -40, 0), "chest": (0, -8, 0)},
    {"rightUpperArm": (0, 70, 0), "rightLowerArm": (0, 40, 0), "chest": (0, 8, 0)},
    {"leftUpperArm": (-60, 0, 10), "rightUpperArm": (-60, 0, -10)},
    {"leftLowerArm": (-70, 0, 0), "rightLowerArm": (-70, 0, 0)},
    {"leftUpperArm": (0, 0, 60), "rightUpperArm": (0, 0, -60)},
    {"leftUpperArm": (-40, 0, 0), "rightUpperArm": (40, 0, 0)},
)
"""Wide movements: across the body, ahead, up, to the sides [degrees]."""


def wide_arms(character: Character, kind: PostureVectors, seed: int, size: float = 1.0) -> Pose:
    """Return fifty seconds of wide arm movements that overlap."""
    rng, count = np.random.default_rng(seed), 1500
    axes = body_axes(character.skeleton, np.array(kind.joints))
    vectors = np.repeat(kind.vectors(character.clips["idle"].poses[:1]), count, axis=0)
    at = 0
    while at < count:
        length, swing = int(rng.integers(40, 90)), SWINGS[rng.integers(len(SWINGS))]
        named = [character.anatomy.parts[joint] for joint in kind.joints]
        turn = rotation_vectors(axes, [swing.get(part, (0.0, 0.0, 0.0)) for part in named])
        bell = size * rng.uniform(-0.6, 1.0) * np.sin(np.pi * np.arange(length) / length) ** 2
        vectors[at : at + length] += (bell[:, None] * turn.reshape(-1))[: count - at]
        at += int(0.8 * length)
    return kind.poses(vectors)


def correlation(made: Array, true: Array) -> float:
    """Return the mean correlation of columns, weighted by the spread of the true ones."""
    a, b = made - made.mean(0), true - true.mean(0)
    size = np.linalg.norm(a, axis=0) * np.linalg.norm(b, axis=0)
    found = (a * b).sum(0) / np.maximum(size, 1e-12)
    return float((found * b.std(0)).sum() / b.std(0).sum())


def hidden(
    train: Sequence[Pose], test: Pose, kind: PostureVectors, parts: Sequence[str]
) -> tuple[float, float]:
    """Return how well the filter, and a linear regression, predict the hidden joints."""
    away = np.repeat([part in HIDDEN for part in parts], 3)
    known = np.concatenate([kind.vectors(poses) for poses in train])
    mean, true = known.mean(0), kind.vectors(test)
    seen = known[:, ~away] - mean[~away]
    square = seen.T @ seen
    ridge = 1e-2 * np.trace(square) / len(square) * np.eye(len(square))
    weights = np.linalg.solve(square + ridge, seen.T @ (known[:, away] - mean[away]))
    shown = np.where(away, mean, true)
    filtered = DependentJoints.of(train, kind).apply(shown)[:, away]
    regressed = (true[:, ~away] - mean[~away]) @ weights
    return correlation(filtered, true[:, away]), correlation(regressed, true[:, away])


def joining_in(character: Character) -> Array:
    """Return mean errors in each clip [degrees]: still, filtered, and of the arms; (clips, 3)."""
    kind = PostureVectors.of(character.skeleton, character.anatomy, "upper")
    parts = [character.anatomy.parts.get(joint, "") for joint in kind.joints]
    away = np.repeat([part in HIDDEN for part in parts], 3)
    standing = {clip.name for clip in idle_clips(character.clips)}
    clips = [(name, clip.poses) for name, clip in character.clips.items()]
    if len(clips) == 1:
        ((name, poses),) = clips
        half = len(poses.rotations) // 2
        clips = [(name, poses[:half]), (name, poses[half:])]
    found = []
    for number, (_, poses) in enumerate(clips):
        others = [each for place, each in enumerate(clips) if place != number]
        stands = [each for name, each in others if name in standing] or [each for _, each in others]
        still = np.concatenate([kind.vectors(each) for each in stands]).mean(0)
        true = kind.vectors(poses)
        shown = np.where(away, still, true)
        moved = DependentJoints.of([each for _, each in others], kind).apply(shown)
        errors = shown[:, away] - true[:, away], (moved - true)[:, away], (moved - true)[:, ~away]
        found.append([np.sqrt(3.0 * (each**2).mean(1)).mean() for each in errors])
    return np.degrees(found)


def joining_table() -> Table:
    """Return on whom dependent joints are better in clips that they were not learned from."""
    table = Table(title="spine, neck, head and shoulders in clips that were left out, mean error")
    for heading in ("who", "clips", "still", "joining in", "better in", "arms turned"):
        table.add_column(heading, justify="left" if heading == "who" else "right")
    strangers = [DATA / "gltf" / f"{name}.glb" for name in STRANGERS]
    for name in (*Character.bundled_names(), *(str(path) for path in strangers if path.exists())):
        character = Character.load(name)
        if character.anatomy.kind != "humanoid" or not character.clips:
            table.add_row(Path(name).stem, str(len(character.clips)), "no person with clips")
            continue
        errors = joining_in(character)
        means = [f"{mean:.1f}°" for mean in errors.mean(0)]
        better = f"{(errors[:, 1] < errors[:, 0]).sum()} of {len(errors)}"
        table.add_row(Path(name).stem, str(len(character.clips)), *means[:2], better, means[2])
        acts = [name for name in character.clips if name in GESTURES]
        if acts:
            gestures = errors[[list(character.clips).index(name) for name in acts]]
            means = [f"{mean:.1f}°" for mean in gestures.mean(0)]
            better = f"{(gestures[:, 1] < gestures[:, 0]).sum()} of {len(acts)}"
            table.add_row("  its gestures", str(len(acts)), *means[:2], better, means[2])
    return table


def main() -> int:
    """Print the tables and return an exit code."""
    console = Console(width=110)
    human = Character.load("human")
    skeleton = human.skeleton
    kind = PostureVectors.of(skeleton, human.anatomy, "upper")
    parts = [human.anatomy.parts[joint] for joint in kind.joints]
    clear = human.clips["idle"].poses
    own = {name: clip.poses for name, clip in human.clips.items()}
    body = CapsuleBody.of(skeleton, human.anatomy, human.meshes, clear)
    start = time.perf_counter()
    wide = [wide_arms(human, kind, seed) for seed in SEEDS]
    ranges = SafeRanges.of([*wide, *own.values()], kind, body, clear[:1])
    console.print(f"safe ranges in {time.perf_counter() - start:.1f} s")
    table = Table(title="colliding frames of the bundled human")
    for heading in ("clips", "frames", "before", "after", "fewer", "turned by", "a frame"):
        table.add_column(heading, justify="left" if heading == "clips" else "right")
    tests = {f"wide arms {n}, x {size:g}": wide_arms(human, kind, n, size) for n, size in HELD_OUT}
    folders = [DATA / name for name in ("cmu-mocap", "bvh") if (DATA / name).is_dir()]
    others = {clip.name: clip.poses for clip in read_motions([*map(str, folders)], human)}
    fewer = 1.0
    for name, clips in ({"wide arms": tests} | ({"not ours": others} if others else {})).items():
        poses = Pose.of_frames(
            clip[n] for clip in clips.values() for n in range(len(clip.rotations))
        )
        start = time.perf_counter()
        kept = ranges.keep(poses)
        took = 1e6 * (time.perf_counter() - start) / len(poses.rotations)
        counts = [int(body.collides(each, skeleton).sum()) for each in (poses, kept)]
        legs = [joint for joint in range(len(skeleton)) if joint not in kind.joints]
        assert np.array_equal(kept.rotations[:, legs], poses.rotations[:, legs])
        own_fewer = 1 - counts[1] / counts[0]
        fewer = own_fewer if name == "wide arms" else fewer
        turned = np.degrees(np.abs(kind.vectors(kept) - kind.vectors(poses)).mean())
        frames = f"{len(poses.rotations):,}"
        table.add_row(
            f"{name}, {len(clips)} clips",
            *(frames, *map(str, counts), f"{own_fewer:.0%}", f"{turned:.1f}°", f"{took:.0f} µs"),
        )
    console.print(table)
    table = Table(title="hidden joints of held-out gestures, correlation with the truth")
    for heading in ("gesture", "filter", "regression"):
        table.add_column(heading, justify="left" if heading == "gesture" else "right")
    every, results = own | others, []
    for name in (*GESTURES, *(n for n in others if not n[0].isdigit() or n.startswith("131"))):
        pool = own if name in own else every
        results.append(hidden([p for n, p in pool.items() if n != name], every[name], kind, parts))
        table.add_row(name, *(f"{value:.2f}" for value in results[-1]))
    found = np.array(results)
    means = [f"{column.mean():.2f} ({low:.2f} … {high:.2f})"
             for column in found.T for low, high in [bootstrap_interval(column)]]  # fmt: skip
    table.add_row("mean, 95 %", *means)
    console.print(table)
    console.print(joining_table())
    return int(fewer < 0.8 or found[:, 0].mean() <= 0.0)


if __name__ == "__main__":
    sys.exit(main())
