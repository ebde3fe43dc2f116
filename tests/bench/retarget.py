"""Quality of retargeting: `python -m tests.bench.retarget`.

Two tables: how well poses and feet are kept, and whether the body crouches or sinks. The second
has the retargeted motions and, where a motion has one, the gait cycles made of them.
"""

import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import Character, CharacterError, Clip
from cubeling.characters.model.bind_pose import with_bind_pose
from cubeling.characters.retargeting import Recording, load_recording, retarget
from cubeling.characters.retargeting.feet.footskate import ball_positions, find_foot_contacts
from cubeling.characters.retargeting.feet.ground_motion import find_ground_motion
from cubeling.characters.retargeting.locomotion.grading import MAX_BONE_CHANGE, MAX_KNEE_EXCESS_DEG
from cubeling.characters.retargeting.locomotion.recorded_gait import extract_gait
from cubeling.characters.retargeting.measures import bone_change, knee_quantiles, sole_dip
from cubeling.characters.retargeting.rig import Rig, leg_pairs
from cubeling.characters.retargeting.root import with_root_joint
from cubeling.characters.skeleton import rotations

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
    ("bvh/131_03.bvh", "gltf/CesiumMan.glb"),
    ("bvh/zombie.bvh", "human"),
    ("gltf/CesiumMan.glb", "human"),
    ("gltf/CesiumMan.glb", "gltf/RobotExpressive.glb"),
    ("gltf/RobotExpressive.glb#Walking", "human"),
    ("gltf/RobotExpressive.glb#Running", "gltf/CesiumMan.glb"),
    ("human#Walk", "gltf/CesiumMan.glb"),
    ("gltf/Fox.glb#Walk", "robot"),
    ("gltf/Fox.glb#Walk", "gltf/dino_apatosaurus.glb"),
    ("gltf/Fox.glb#Walk", "vleo"),
    ("gltf/Fox.glb#Run", "gltf/dino_apatosaurus.glb"),
    ("gltf/dino_apatosaurus.glb#Armature|Apatosaurus_Walk", "gltf/Fox.glb"),
]
MAX_HIPS_SHARE, MAX_DIP_CM = 0.03, 0.5
"""Bars of this bench; those of knees and bones are the ones of made gaits."""


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
    at = np.stack([ball_positions(made.poses, rig, leg) for _, leg in pairs], axis=1)
    rest = np.array([rig.standing_ankle_height(leg) + rig.sole(leg).ball[1] for _, leg in pairs])
    speeds = np.linalg.norm(np.diff(at[..., [0, 2]], axis=0), axis=-1) * made.rate
    held = speeds[down[1:] & down[:-1]] if down.any() else np.zeros(1)
    scale = 100 * PERSON_HEIGHT_M / height
    sunk = max(float((rest - at[..., 1]).max()), 0.0)
    return float(held.mean()) * scale, float(held.max()) * scale, sunk * scale


def on_treadmill(source: Recording) -> bool:
    """Return whether a motion walks in place."""
    rig = Rig(source.skeleton, source.anatomy)
    contacts = find_foot_contacts(source.clip, rig, rig.legs).ball
    return bool(find_ground_motion(source.clip, rig, rig.legs, contacts, 1.0).frame_poses.any())


def knees_beyond(source: Recording, made: Clip, rig: Rig) -> float:
    """Return how far knees bend beyond those of the source at most, of the quantiles [degrees].

    NaN for animals, whose legs have other bones: their knees need not bend alike.
    """
    if rig.anatomy.kind == "quadruped":
        return np.nan
    theirs = Rig(source.skeleton, source.anatomy)
    return max(
        float(np.degrees(knee_quantiles(made.poses, rig, b) - others).max())
        for a, b in leg_pairs(theirs, rig)
        for others in [knee_quantiles(source.clip.poses, theirs, a)]
    )


def hips_height(clip: Clip, rig: Rig) -> float:
    """Return the mean height of the hip joints above the lowest ankle [leg lengths]."""
    ankles, hips = [leg.foot for leg in rig.legs], [leg.upper for leg in rig.legs]
    found = []
    for placements in (clip.poses.globals(rig.skeleton), rig.skeleton.rest.globals(rig.skeleton)):
        heights = rotations.rotate(rig.common_from_skeleton, placements[..., :3, 3])[..., 1]
        found.append(float((heights[..., hips].mean(-1) - heights[..., ankles].min(-1)).mean()))
    return found[0] / (found[1] if rig.anatomy.kind == "quadruped" else rig.leg_length)


def stature(source: Recording, made: Clip, body: Character) -> tuple[float, float, float, float]:
    """Return knees beyond the source [°], hips against it, dip [cm] and change of bones."""
    rig = Rig(body.skeleton, body.anatomy)
    theirs = hips_height(source.clip, Rig(source.skeleton, source.anatomy))
    scale = 100 * PERSON_HEIGHT_M / body.height
    return (
        knees_beyond(source, made, rig),
        hips_height(made, rig) / theirs,
        sole_dip(made.poses, rig, body.meshes, len(made)) * scale,
        bone_change(made.poses, rig),
    )


def gait_figures(source: Recording, character: Character) -> tuple[float, float, float] | None:
    """Return the same of the gait cycle of a motion: knees beyond the source [°], dip and slide.

    [cm, cm/s]; None if the motion has no cycle.
    """
    body = with_root_joint(character)
    with suppress(CharacterError):
        gait = extract_gait(source, character, body)
        own = [knee_quantiles(gait.clip.poses, gait.rig, leg) for leg in gait.legs]
        knees = np.nan if gait.source_knees is None else float((own - gait.source_knees).max())
        scale = 100 * PERSON_HEIGHT_M / body.height
        dip = sole_dip(gait.clip.poses, gait.rig, body.meshes, len(gait.clip))
        return float(np.degrees(knees)), dip * scale, gait.mean_slide * scale
    return None


def stature_table() -> Table:
    """Return the table of knees, hips and soles."""
    bars = f"bars: {MAX_KNEE_EXCESS_DEG:.0f}°, ±{MAX_HIPS_SHARE:.0%}, {MAX_DIP_CM} cm, "
    table = Table(title="Crouching and sinking", caption=bars + f"{MAX_BONE_CHANGE:.0%}")
    table.add_column("motion")
    table.add_column("on")
    for heading in ("knee beyond", "hips", "soles dip", "bones", "gait: knee", "dips", "slides"):
        table.add_column(heading, justify="right")
    found: list[NDArray[np.float64]] = []
    for source, character in cases():
        rig = Rig(character.skeleton, character.anatomy)
        made = retarget(
            source.clip,
            source.skeleton,
            source.anatomy,
            rig.skeleton,
            rig.anatomy,
            meshes=character.meshes,
        )
        measures = stature(source, made, character)
        gait = gait_figures(source, character)
        found.append(np.array(measures))
        if gait is not None:
            found.append(np.array([gait[0], np.nan, gait[1], np.nan]))
        table.add_row(
            source.origin,
            character.name,
            *_stature_cells(measures),
            *(_gait_cells(*gait) if gait else ()),
        )
    knees, hips, dips, bones = np.array(found).T  # unknown figures are not beyond a bar
    over = [
        (knees > MAX_KNEE_EXCESS_DEG).sum(),
        (np.abs(hips - 1) > MAX_HIPS_SHARE).sum(),
        (dips > MAX_DIP_CM).sum(),
        (bones > MAX_BONE_CHANGE).sum(),
    ]
    table.add_section()
    worst = np.nanmax(knees), 1 + np.nanmax(np.abs(hips - 1)), dips.max(), np.nanmax(bones)
    table.add_row("worst", "", *_stature_cells(worst))
    table.add_row(f"beyond the bar, of {len(found)}", "", *map(str, over))
    return table


def _stature_cells(measures: tuple[float, float, float, float]) -> tuple[str, str, str, str]:
    knee, hips, sunk, bones = measures
    return "" if np.isnan(knee) else f"{knee:.1f}°", f"{hips:.3f}", f"{sunk:.2f} cm", f"{bones:.2%}"


def _gait_cells(knee: float, sunk: float, slide: float) -> tuple[str, str, str]:
    return "" if np.isnan(knee) else f"{knee:.1f}°", f"{sunk:.2f} cm", f"{slide:.2f} cm/s"


def cases() -> Iterator[tuple[Recording, Character]]:
    """Yield the recordings and the characters, at rest in their bind poses; absent files not."""
    for motion, model in CASES:
        name, _, _ = motion.partition("#")
        names = [str(SHARED / each) if "/" in each else each for each in (motion, model)]
        if "/" in name and not (SHARED / name).exists():
            continue
        character = Character.load(names[1])
        yield load_recording(names[0]), replace(character, skeleton=with_bind_pose(character))


def main() -> None:
    """Print the tables."""
    console = Console(width=120)
    console.print(feet_table())
    console.print(stature_table())


def feet_table() -> Table:
    """Return the table of limbs and feet."""
    table = Table(title="Retargeted motions, measured at the size of a person 1.7 m tall")
    table.add_column("motion")
    table.add_column("on")
    headings = ("limbs off, bare", "limbs off", "slide, bare", "slide", "worst", "sinks", "ms/s")
    for heading in headings:
        table.add_column(heading, justify="right")
    for source, character in cases():
        rig = Rig(character.skeleton, character.anatomy, character.meshes)
        args = (source.clip, source.skeleton, source.anatomy, rig.skeleton, rig.anatomy)
        bare = retarget(*args, hold_feet=False)
        start = time.perf_counter()
        made = retarget(*args, meshes=character.meshes)
        took = (time.perf_counter() - start) / max(made.duration, 1e-9)
        before, _, _ = feet(source, bare, rig, character.height)
        mean, worst, sunk = feet(source, made, rig, character.height)
        person = rig.anatomy.kind == "humanoid"
        in_place = on_treadmill(source)
        table.add_row(
            source.origin,
            character.name,
            f"{limb_error(source, bare, rig):.2f}°" if person else "",
            f"{limb_error(source, made, rig):.2f}°" if person else "",
            "treadmill" if in_place else f"{before:.1f} cm/s",
            "treadmill" if in_place else f"{mean:.2f} cm/s",
            "treadmill" if in_place else f"{worst:.2f} cm/s",
            f"{sunk:.2f} cm",
            f"{1e3 * took:.0f}",
        )
    return table


if __name__ == "__main__":
    main()
