"""How the bundled characters move: `python -m tests.bench.cast [FOLDER]`.

FOLDER has other versions of the characters, human.glb and so on, to compare with.

Gaits, of a character that walks:

bob
    How far the hips rise and fall [cm].
air
    Part of the cycle in which no sole is within 5 mm of the ground.
near
    Part of the cycle in which both soles are within 15 mm of the ground.
strike, down
    Bend of the knee of the front leg when it lands, and the greatest while it carries [degrees].
lean
    Mean angle between the vertical and the line from the hips to the neck, forward [degrees].
slide
    Greatest speed along the ground of the slowest point of a sole within 1 mm of it [mm/s], over
    33 ms, without the first and the last 33 ms of each stay, in which a foot lands and leaves.
halves
    How unlike the second half of a cycle is to the mirrored first [degrees], root mean square over
    the joints.

Other clips:

slide, begins, acts, ends
    The same, sampled at 144 Hz, with landing and leaving: of the clip, and of a whole animated
    character around the start of the action, in it, and around its end.
turn, pitch
    How far the head turns to both sides, and up and down [degrees].

Exits with 1 if a bar of issue 18 is missed: 9 to 11 cm and air in a run, 10 mm/s in every clip.
"""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.characters import ActionIntent, Animator, Character, CharacterCommand, Pose, RootDelta
from cubeling.characters.control.controllers.actions import clips_of_actions
from cubeling.characters.locomotion.gaits import RUN_CLIPS, WALK_CLIPS
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.feet import find_feet
from tools.authoring.modelling.rig import mirrored

Array = NDArray[np.float64]

RATE_HZ = 144.0
ON_GROUND_M, IN_AIR_M, NEAR_M = 0.001, 0.005, 0.015
SOLE_THICKNESS_M = 0.006
"""Height of the vertices of the rest pose that are a sole [m]."""

RUN_BOB_CM, MAX_SLIDE_MM_S = (9.0, 11.0), 10.0
EDGE_S = 0.033
SETTLED_S, AROUND_S = 2.0, 0.5
"""How long a character stands before an action, and what counts as its start and end [s]."""


class Soles:
    """The vertices under the feet of a character, skinned as the renderer does."""

    def __init__(self, character: Character) -> None:
        self._skeleton = character.skeleton
        self._feet = [
            [self._under(mesh, foot) for mesh in character.meshes]
            for foot in find_feet(character.skeleton)
        ]

    @staticmethod
    def _under(mesh: Mesh, foot: Sequence[int]) -> tuple[Mesh, NDArray[np.intp]]:
        """Return a mesh and its vertices under a foot, about thirty.

        Where a sole bends, between foot and toes, its vertices creep by themselves.
        """
        held = [(mesh.weights * (mesh.joints == joint)).sum(axis=1) for joint in foot]
        rigid = np.max(held, axis=0) > 0.9
        sole = np.flatnonzero(rigid & (mesh.positions[:, 1] < SOLE_THICKNESS_M))
        return mesh, sole[:: max(len(sole) // 30, 1)]

    def places(self, poses: Pose, placed: Array | None = None) -> list[Array]:
        """Return the places of each foot's vertices in poses, (frames, points, 3) [m]."""
        joints = poses.globals(self._skeleton)
        if placed is not None:
            joints = placed[:, None] @ joints
        return [
            np.concatenate([_skinned(*each, joints) for each in foot], 1) for foot in self._feet
        ]

    def slides(self, poses: Pose, placed: Array | None = None) -> Array:
        """Return the greatest speed of the slowest point of a foot before each frame [mm/s].

        Only points on the ground count; a foot rolls about its slowest one.
        """
        fastest = np.zeros(len(poses.rotations) - 1)
        for places in self.places(poses, placed):
            down = places[..., 1] < ON_GROUND_M
            speed = np.linalg.norm(np.diff(places[..., [0, 2]], axis=0), axis=-1) * RATE_HZ
            slowest = np.where(down[1:] & down[:-1], speed, np.inf).min(axis=1)
            fastest = np.maximum(fastest, np.where(np.isfinite(slowest), slowest, 0.0))
        return 1e3 * fastest

    def gait_slide(self, poses: Pose) -> float:
        """Return the greatest speed of the slowest vertex of a foot in its stance [mm/s].

        It is measured over `EDGE_S`, and does not count so long after the foot lands and before it
        leaves.
        """
        fastest, span = 0.0, round(EDGE_S * RATE_HZ)
        for places in self.places(poses):
            down = places[..., 1] < ON_GROUND_M
            for _ in range(span):
                down[1:-1] &= down[:-2] & down[2:]
            way = np.linalg.norm((places[span:] - places[:-span])[..., [0, 2]], axis=-1)
            least = np.where(down[span:] & down[:-span], way, np.inf).min(axis=1)
            fastest = max(fastest, least[np.isfinite(least)].max(initial=0.0))
        return 1e3 * fastest * RATE_HZ / span


def _skinned(mesh: Mesh, vertices: NDArray[np.intp], joints: Array) -> Array:
    """Return some vertices of a mesh for joint placements (frames, joints, 4, 4)."""
    points = np.c_[mesh.positions[vertices].astype(float), np.ones(len(vertices))]
    matrices = (joints @ mesh.inverse_bind)[:, mesh.joints[vertices], :3]
    return np.asarray(
        np.einsum("fvkij,vj,vk->fvi", matrices, points, mesh.weights[vertices], optimize=True)
    )


def sampled(clip: Clip) -> Pose:
    """Return the poses of a clip at `RATE_HZ`, where it is over the ground."""
    times = np.arange(round(clip.duration * RATE_HZ)) / RATE_HZ
    poses = Pose.of_frames(clip.sample(time) for time in times)
    if not clip.root_motion:
        return poses
    steps = [clip.travel(0.0, time) for time in times]
    places, turns = poses.translations.copy(), poses.rotations.copy()
    yaw = rotations.about("y", np.array([step.yaw for step in steps]))
    moved = np.array([[step.x, 0.0, step.z] for step in steps])
    places[:, 0] = rotations.rotate(yaw, places[:, 0]) + moved
    turns[:, 0] = rotations.multiply(yaw, turns[:, 0])
    return Pose(places, turns, poses.scales, poses.morphs)


def gait_row(character: Character, soles: Soles, clip: Clip) -> tuple[list[str], bool]:
    """Return the measures of a gait, and whether they meet the bars."""
    skeleton, parts = character.skeleton, character.anatomy.joints
    poses = sampled(clip)
    posed = poses.globals(skeleton)
    hips, neck = posed[:, parts["hips"], :3, 3], posed[:, parts["neck"], :3, 3]
    lowest = np.array([places[..., 1].min(axis=1) for places in soles.places(poses)])
    bob = 100 * float(np.ptp(hips[:, 1]))
    air = float((lowest.min(axis=0) > IN_AIR_M).mean())
    near = float((lowest.max(axis=0) < NEAR_M).mean())
    slide = soles.gait_slide(poses)
    strikes, downs = zip(*(_knees(character, posed, low, foot) for foot, low in enumerate(lowest)),
                         strict=True)  # fmt: skip
    ahead = np.diff(hips, axis=0, append=hips[-1:] + hips[-1:] - hips[-2:-1])[:, [0, 2]]
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    over = ((neck - hips)[:, [0, 2]] * ahead).sum(axis=1)
    lean = math.degrees(np.arctan2(over, (neck - hips)[:, 1]).mean())
    first, second = clip.in_place[: (len(clip) - 1) // 2], clip.in_place[(len(clip) - 1) // 2 :]
    image = mirrored(first, skeleton).rotations
    other = second.rotations[: len(image)]
    apart = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(image), other))
    halves = math.degrees(np.sqrt((apart**2).sum(axis=-1).mean()))
    good = slide <= MAX_SLIDE_MM_S
    if clip.name == "Run":
        good &= RUN_BOB_CM[0] <= bob <= RUN_BOB_CM[1] and air > 0.0
    cells = [clip.name, f"{bob:.1f}", f"{air:.0%}", f"{near:.0%}", f"{np.mean(strikes):.0f}",
             f"{np.mean(downs):.0f}", f"{lean:.1f}", f"{halves:.2f}", f"{slide:.1f}"]  # fmt: skip
    return cells, good


def _knees(character: Character, posed: Array, low: Array, foot: int) -> tuple[float, float]:
    """Return the bend of a knee when its foot lands, and the greatest while it stands [degrees]."""
    ankle = find_feet(character.skeleton)[foot][0]
    knee = character.skeleton.parents[ankle]
    hip = character.skeleton.parents[knee]
    upper, lower = (
        posed[:, one, :3, 3] - posed[:, other, :3, 3] for one, other in ((knee, hip), (ankle, knee))
    )
    cosine = (upper * lower).sum(axis=1)
    cosine /= np.linalg.norm(upper, axis=1) * np.linalg.norm(lower, axis=1)
    bend = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    down = low < ON_GROUND_M
    landing = int(np.flatnonzero(down & ~np.roll(down, 1))[0])
    stay = (landing + np.arange(len(down) // 4)) % len(down)  # before the push
    return float(bend[landing]), float(bend[stay][down[stay]].max())


def film(character: Character, action: str, weight: float, seconds: float) -> tuple[Pose, Array]:
    """Return a whole character that stands, acts once, and stands again; and where."""
    animator = Animator(character, scale=1.0, place=RootDelta())
    frames = range(round((2 * SETTLED_S + seconds) * RATE_HZ))
    shown = []
    for number in frames:
        time = number / RATE_HZ
        acts = SETTLED_S <= time < SETTLED_S + seconds
        intent = ActionIntent(action, weight) if acts else None
        shown.append(animator.update(CharacterCommand(time, action=intent)))
    return (
        Pose.of_frames(posed.pose for posed in shown),
        np.stack([posed.table_from_character for posed in shown]),
    )


def action_row(
    character: Character, soles: Soles, name: str, action: str, weight: float
) -> tuple[list[str], bool]:
    """Return the measures of a clip of an action, and whether they meet the bars."""
    clip = character.clips[name]
    poses = sampled(clip)
    slide = float(soles.slides(poses).max())
    cells = [name, f"{slide:.1f}"]
    if action:
        slides = soles.slides(*film(character, action, weight, clip.duration))
        at = (np.arange(len(slides)) + 1) / RATE_HZ - SETTLED_S
        begins, ends = np.abs(at) < AROUND_S, np.abs(at - clip.duration) < AROUND_S
        acts = (at > AROUND_S) & (at < clip.duration - AROUND_S)
        cells += [f"{slides[part].max(initial=0.0):.1f}" for part in (begins, acts, ends)]
        slide = max(slide, float(slides.max()))
    else:
        cells += ["", "", ""]
    head = poses.globals(character.skeleton)[:, character.anatomy.joints["head"], :3, :3]
    rest = character.skeleton.rest.globals(character.skeleton)
    ahead = head @ rest[character.anatomy.joints["head"], :3, :3].T @ [0.0, 0.0, 1.0]
    turn = np.degrees(np.arctan2(ahead[:, 0], ahead[:, 2]))
    pitch = np.degrees(np.arcsin(np.clip(ahead[:, 1], -1.0, 1.0)))
    cells += [f"{np.ptp(turn):.0f}", f"{np.ptp(pitch):.0f}"]
    return cells, slide <= MAX_SLIDE_MM_S


def report(console: Console, character: Character) -> bool:
    """Print the tables of a character; return whether it meets the bars."""
    gaits = [name for name in (*WALK_CLIPS.values(), *RUN_CLIPS.values())
             if name in character.clips]  # fmt: skip
    soles, good = Soles(character), True
    if gaits:
        table = Table(
            *("clip", "bob cm", "air", "near", "strike °", "down °", "lean °", "halves °"),
            "slide mm/s", title=f"{character.name}: gaits",
        )  # fmt: skip
        for name in dict.fromkeys(gaits):
            cells, met = gait_row(character, soles, character.clips[name])
            table.add_row(*cells)
            good &= met
        console.print(table)
    table = Table(
        *("clip", "slide mm/s", "begins", "acts", "ends", "turn °", "pitch °"),
        title=f"{character.name}: other clips",
    )
    found = {
        clip: (action, weight)
        for action, names in clips_of_actions(character.clips, gaits).items()
        for weight, clip in names.items()
    }
    for name in character.clips:
        if name not in gaits:
            cells, met = action_row(character, soles, name, *found.get(name, ("", 0.0)))
            table.add_row(*cells)
            good &= met
    console.print(table)
    return good


def main(arguments: list[str]) -> int:
    """Print the tables and return an exit code."""
    console, good = Console(width=110), True
    for name in Character.bundled_names():
        which = str(Path(arguments[0]) / f"{name}.glb") if arguments else name
        good &= report(console, Character.load(which))
    return int(not good)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
