"""Quality of retargeting: `python -m tests.bench.retarget`."""

import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from characters import Character, Clip
from characters.model.bind_pose import with_bind_pose
from characters.retargeting import Recording, load_recording, retarget
from characters.retargeting.footskate import find_foot_contacts
from characters.retargeting.rig import Rig, leg_pairs

SHARED = Path(__file__).parents[3] / "shared" / "data"
PERSON_HEIGHT_M = 1.7
"""Slides are scaled to a body of this height."""

LIMBS = [
    (side + start, side + end)
    for side in ("left", "right")
    for start, end in (
        ("UpperArm", "LowerArm"),
        ("LowerArm", "Hand"),
        ("UpperLeg", "LowerLeg"),
        ("LowerLeg", "Foot"),
    )
]
CASES = [
    (f"cmu-mocap/{clip}.amc", model)
    for clip in ("16/16_15", "16/16_35", "02/02_01", "49/49_01")
    for model in ("human", "gltf/RobotExpressive.glb", "gltf/CesiumMan.glb")
]
CASES += [
    ("bvh/131_01.bvh", "human"),
    ("bvh/zombie.bvh", "human"),
    ("gltf/Fox.glb#Walk", "gltf/dino_apatosaurus.glb"),
    ("gltf/Fox.glb#Walk", "vleo"),
]


def directions(clip: Clip, rig: Rig) -> NDArray[np.float64]:
    """Return unit vectors of the limbs, (frames, limbs, 3); zeros for missing limbs."""
    at = clip.poses.globals(rig.skeleton)[..., :3, 3]
    found = np.zeros((len(clip), len(LIMBS), 3))
    for number, (start, end) in enumerate(LIMBS):
        a, b = rig.anatomy.joint(start), rig.anatomy.joint(end)
        if a is not None and b is not None:
            bone = at[:, b] - at[:, a]
            found[:, number] = bone / np.linalg.norm(bone, axis=-1, keepdims=True)
    return found


def limb_error(source: Recording, made: Clip, rig: Rig) -> float:
    """Return the mean angle between the limbs of both rigs [degrees]."""
    theirs = directions(source.clip, Rig(source.skeleton, source.anatomy))
    cosines = np.clip((directions(made, rig) * theirs).sum(-1), -1.0, 1.0)
    return float(np.degrees(np.arccos(cosines)).mean())


def feet(source: Recording, made: Clip, rig: Rig, height: float) -> tuple[float, float, float]:
    """Return mean and greatest slide of standing feet [cm/s], and the depth of sinking feet [cm].

    Scaled to a person 1.7 m tall; a foot stands when its ball does in the source.
    """
    theirs = Rig(source.skeleton, source.anatomy)
    pairs = leg_pairs(theirs, rig)
    down = find_foot_contacts(source.clip, theirs, [leg for leg, _ in pairs]).ball
    ends = [leg.end for _, leg in pairs]
    at = made.poses.globals(rig.skeleton)[:, ends][..., :3, 3]
    rest = rig.rest_positions[ends, 1]
    speeds = np.linalg.norm(np.diff(at[..., [0, 2]], axis=0), axis=-1) * made.rate
    held = speeds[down[1:] & down[:-1]] if down.any() else np.zeros(1)
    scale = 100 * PERSON_HEIGHT_M / height
    sunk = max(float((rest - at[..., 1]).max()), 0.0)
    return float(held.mean()) * scale, float(held.max()) * scale, sunk * scale


def main() -> None:
    """Print the table."""
    table = Table(title="Retargeted motions, measured at the size of a person 1.7 m tall")
    table.add_column("motion")
    table.add_column("on")
    headings = ("limbs off, bare", "limbs off", "slide, bare", "slide", "worst", "sinks", "ms/s")
    for heading in headings:
        table.add_column(heading, justify="right")
    for motion, model in CASES:
        name = str(SHARED / model) if model.startswith("gltf") else model
        if not (SHARED / motion.split("#")[0]).exists():
            continue
        source = load_recording(str(SHARED / motion))
        character = Character.load(name)
        character = replace(character, skeleton=with_bind_pose(character))
        rig = Rig(character.skeleton, character.anatomy)
        args = (source.clip, source.skeleton, source.anatomy, rig.skeleton, rig.anatomy)
        bare = retarget(*args, hold_feet=False)
        start = time.perf_counter()
        made = retarget(*args)
        took = (time.perf_counter() - start) / max(made.duration, 1e-9)
        before, _, _ = feet(source, bare, rig, character.height)
        mean, worst, sunk = feet(source, made, rig, character.height)
        person = rig.anatomy.kind == "humanoid"
        in_place = source.clip.root_motion and source.clip.cycle.length < 0.1 * character.height
        table.add_row(
            Path(motion).name,
            Path(model).stem,
            f"{limb_error(source, bare, rig):.2f}°" if person else "",
            f"{limb_error(source, made, rig):.2f}°" if person else "",
            "treadmill" if in_place else f"{before:.1f} cm/s",
            "treadmill" if in_place else f"{mean:.2f} cm/s",
            "treadmill" if in_place else f"{worst:.2f} cm/s",
            f"{sunk:.2f} cm",
            f"{1e3 * took:.0f}",
        )
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
