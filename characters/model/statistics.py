"""Statistics of a character and its clips."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from characters.model.character import Character
from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts, spans
from characters.motion.ground import find_ground, joint_trajectories
from characters.skeleton.feet import find_feet
from characters.skeleton.masks import subtree

_MIN_SPEED = 0.15  # body heights per second; slower bodies stand


@dataclass(frozen=True)
class CharacterStats:
    """The size of a character."""

    height: float
    """Height of the rest pose above the ground [m]."""

    joints: int
    meshes: int
    vertices: int
    triangles: int
    materials: int
    """Distinct materials."""

    textures: int
    """Distinct images of all kinds."""

    morphs: tuple[str, ...]
    """Their names."""

    @classmethod
    def of(cls, character: Character) -> "CharacterStats":
        """Measure a character."""
        materials = [mesh.material for mesh in character.meshes]
        textures = [image for each in materials for image in each.textures]
        return cls(
            height=character.height,
            joints=len(character.skeleton),
            meshes=len(character.meshes),
            vertices=sum(len(mesh.positions) for mesh in character.meshes),
            triangles=sum(len(mesh.triangles) for mesh in character.meshes),
            materials=len({id(material) for material in materials}),
            textures=len({id(image) for image in textures if image is not None}),
            morphs=character.morphs,
        )


@dataclass(frozen=True)
class FootContactStats:
    """The ground contact of one foot in a clip."""

    foot: str
    """Its part in `Anatomy`, or the name of its joint."""

    share: float
    """Part of the clip with contact, 0…1."""

    landings: int
    """Number of contacts, 0 for one without an end."""


@dataclass(frozen=True)
class ClipStats:
    """The movement of one clip."""

    clip: Clip
    """The clip."""

    speed: float
    """Mean speed over the ground [m/s]; in place, over a ground that moves backward under it as a
    treadmill."""

    in_place: bool
    """Whether the feet walk and the body stays."""

    loop_gap: float
    """Greatest distance of a joint between the first and the last frame [m]."""

    contacts: tuple[FootContactStats, ...]
    """Of each foot."""


def foot_joints(character: Character) -> dict[str, tuple[int, ...]]:
    """Return the joints of each foot, from the ankle on, by name."""
    skeleton, anatomy = character.skeleton, character.anatomy
    if not anatomy.feet:
        return {skeleton.names[foot[0]]: foot for foot in find_feet(skeleton)}
    return {anatomy.parts[ankle]: tuple(subtree(skeleton, ankle)) for ankle in anatomy.feet}


def clip_stats(character: Character, clip: Clip, feet: Mapping[str, Sequence[int]]) -> ClipStats:
    """Return the statistics of one clip; `feet` are the joints of each foot by name."""
    skeleton = character.skeleton
    ends = clip.in_place[np.array([0, len(clip) - 1])].globals(skeleton)[:, :, :3, 3]
    loop_gap = float(np.linalg.norm(ends[1] - ends[0], axis=-1).max())
    if len(clip) < 2:
        return ClipStats(clip, 0.0, False, loop_gap, ())
    contacts = find_contacts(clip, skeleton, list(feet.values()))
    stats = [
        FootContactStats(name, float(down.mean()), 0 if down.all() else len(spans(down, clip.loop)))
        for name, down in zip(feet, contacts.T, strict=True)
    ]
    speed, in_place = _ground_speed(
        character, clip, [joint for foot in feet.values() for joint in foot]
    )
    return ClipStats(clip, speed, in_place, loop_gap, tuple(stats))


def _ground_speed(character: Character, clip: Clip, feet: list[int]) -> tuple[float, bool]:
    """Return the speed over the ground [m/s], and whether the clip walks in place."""
    if clip.root_motion:
        speed = clip.cycle.length / clip.duration
    else:
        hips = character.anatomy.joint("hips") or 0
        ends = clip.poses[np.array([0, len(clip) - 1])].globals(character.skeleton)
        speed = float(np.linalg.norm(np.diff(ends[:, hips, [0, 2], 3], axis=0))) / clip.duration
    if speed > _MIN_SPEED * character.height or not feet:
        return speed, False
    tracked = joint_trajectories(clip, character.skeleton)
    ground = find_ground(clip, tracked, np.array(feet, np.intp))
    treadmill = float(np.hypot(*ground.velocity))
    return (treadmill, True) if treadmill > _MIN_SPEED * character.height else (speed, False)
