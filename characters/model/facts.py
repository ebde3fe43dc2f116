"""What can be measured of a character and its clips."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from characters.model.character import Character
from characters.motion.clip import Clip
from characters.motion.contacts import find_contacts, spans
from characters.motion.ground import find_ground, joint_trajectories
from characters.skeleton.feet import find_feet

_GOES = 0.15  # heights a second: what is slower stands


@dataclass(frozen=True)
class Sizes:
    """How large a character is."""

    height: float
    """Of the rest pose above the ground [m]."""

    joints: int
    meshes: int
    vertices: int
    triangles: int
    materials: int
    """Different ones."""

    textures: int
    """Different pictures, of all kinds."""

    morphs: tuple[str, ...]
    """Their names."""

    @classmethod
    def of(cls, character: Character) -> "Sizes":
        """Measure a character."""
        materials = [mesh.material for mesh in character.meshes]
        maps = [image for each in materials for image in (each.texture, each.surface, each.bumps)]
        return cls(
            height=character.height,
            joints=len(character.skeleton),
            meshes=len(character.meshes),
            vertices=sum(len(mesh.positions) for mesh in character.meshes),
            triangles=sum(len(mesh.triangles) for mesh in character.meshes),
            materials=len({id(material) for material in materials}),
            textures=len({id(image) for image in maps if image is not None}),
            morphs=character.morphs,
        )


@dataclass(frozen=True)
class Footing:
    """How one foot stands in a clip."""

    foot: str
    """The part of `Anatomy` that it is, or the name of its joint."""

    share: float
    """Of the clip during which it stands, 0…1."""

    times: int
    """How often it is put down."""


@dataclass(frozen=True)
class ClipFacts:
    """What there is to know of one clip."""

    clip: Clip
    """The clip itself."""

    speed: float
    """How fast the body goes over the ground, on average [m/s]; in place, over a ground that is
    taken to run backward under it."""

    in_place: bool
    """Whether it goes nowhere, though its feet do."""

    opening: float
    """Furthest that a joint is, in the last frame, from where it was in the first [m]."""

    footing: tuple[Footing, ...]
    """Of each foot."""


def joints_of_feet(character: Character) -> dict[str, tuple[int, ...]]:
    """Return the joints of each foot, from the ankle on, by its name."""
    skeleton, anatomy = character.skeleton, character.anatomy
    if not anatomy.feet:
        return {skeleton.names[foot[0]]: foot for foot in find_feet(skeleton)}
    feet = {}
    for ankle in anatomy.feet:
        joints = [ankle]
        for joint in range(ankle + 1, len(skeleton)):
            if skeleton.parents[joint] in joints:
                joints.append(joint)
        feet[anatomy.parts[ankle]] = tuple(joints)
    return feet


def facts_of(character: Character, clip: Clip, feet: Mapping[str, Sequence[int]]) -> ClipFacts:
    """Return what there is to know of one clip; `feet` are the joints of each foot by its name."""
    skeleton = character.skeleton
    ends = clip.in_place[np.array([0, len(clip) - 1])].globals(skeleton)[:, :, :3, 3]
    opening = float(np.linalg.norm(ends[1] - ends[0], axis=-1).max())
    if len(clip) < 2:
        return ClipFacts(clip, 0.0, False, opening, ())
    contacts = find_contacts(clip, skeleton, list(feet.values()))
    footing = [
        Footing(name, float(stands.mean()), 0 if stands.all() else len(spans(stands, clip.loop)))
        for name, stands in zip(feet, contacts.T, strict=True)
    ]
    speed, in_place = _speed(character, clip, [joint for foot in feet.values() for joint in foot])
    return ClipFacts(clip, speed, in_place, opening, tuple(footing))


def _speed(character: Character, clip: Clip, feet: list[int]) -> tuple[float, bool]:
    """Return how fast a body goes in a clip [m/s], and whether only its feet do."""
    if clip.root_motion:
        speed = clip.cycle.length / clip.duration
    else:
        hips = character.anatomy.joint("hips") or 0
        ends = clip.poses[np.array([0, len(clip) - 1])].globals(character.skeleton)
        speed = float(np.linalg.norm(np.diff(ends[:, hips, [0, 2], 3], axis=0))) / clip.duration
    if speed > _GOES * character.height or not feet:
        return speed, False
    tracked = joint_trajectories(clip, character.skeleton)
    ground = find_ground(clip, tracked, np.array(feet, np.intp))
    under = float(np.hypot(*ground.velocity))
    return (under, True) if under > _GOES * character.height else (speed, False)
