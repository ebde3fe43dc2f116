"""Statistics and problems of a character, as sentences for a person."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.contacts import find_contacts, spans
from cubeling.characters.motion.ground import find_ground, joint_trajectories
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.masks import subtree

MANY_JOINTS, MANY_TRIANGLES, LARGE_TEXTURE_PX = 256, 100_000, 4096
"""More of these is slow without a GPU."""

PLAUSIBLE_HEIGHT_M = 0.05, 30.0
"""Heights of characters, from mice to dinosaurs."""

_HEAD_PARTS = {"neck", "head", "jaw", "leftEye", "rightEye"}
_MAX_LOOP_GAP = 0.03  # body heights
_MIN_SPEED = 0.15  # body heights per second; slower bodies stand
_GAIT_NAME = re.compile("walk|run|jog|trot|gallop|stroll", re.IGNORECASE)
_LOOP_NAME = re.compile(f"{_GAIT_NAME.pattern}|idle|loop|cycle", re.IGNORECASE)


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
    """Number of materials that differ."""

    textures: int
    """Distinct images of all kinds."""

    morphs: tuple[str, ...]
    """Names of the morph targets, each once."""

    @classmethod
    def of(cls, character: Character) -> "CharacterStats":
        """Measure a character in its bind pose."""
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

    speed: float
    """Mean speed over the ground [m/s]; in place, over a ground that moves backward under it as a
    treadmill."""

    in_place: bool
    """Whether the feet walk and the body stays."""

    loop_gap: float
    """Greatest distance of a joint between the first and the last frame [m]."""

    contacts: tuple[FootContactStats, ...]
    """One for each foot that was found."""


@dataclass(frozen=True)
class Inspection:
    """The result of an inspection."""

    character: Character

    stats: CharacterStats
    """Numbers of joints, meshes, triangles and the like."""

    clips: tuple[ClipStats, ...]
    """One for each clip of the character."""

    problems: tuple[str, ...]
    """Sentences for a person, the most important ones first."""


def inspect(character: Character, notes: Sequence[str] = (), body: bool = True) -> Inspection:
    """Return statistics and problems of a character.

    Parameters
    ----------
    character
        The character.
    notes
        Repairs and guesses while it was read; they come first among the problems.
    body
        Whether its meshes are its own; those of a stick figure have no problems.
    """
    feet = _foot_joints(character)
    clips = tuple(_clip_stats(character, clip, feet) for clip in character.clips.values())
    stats = CharacterStats.of(character)
    problems = [
        *notes,
        *(_problems_of_meshes(character, stats) if body else ()),
        *(_problems_of_joints(character, feet) if not _is_head(character) else ()),
        *_problems_of_clips(character, clips),
    ]
    return Inspection(character, stats, clips, tuple(problems))


def _problems_of_meshes(character: Character, stats: CharacterStats) -> Iterator[str]:
    low = float(character.bounds[0, 1])
    if not PLAUSIBLE_HEIGHT_M[0] <= stats.height <= PLAUSIBLE_HEIGHT_M[1]:
        yield (
            f"It is {stats.height:.3g} m tall at rest: files are in metres, so this one was "
            "exported at another scale. On the table it is scaled to fit."
        )
    if stats.height and abs(low) > 0.05 * stats.height:
        where = "above" if low > 0 else "below"
        yield f"At rest it is {abs(low):.2g} m {where} the ground: move it to y = 0 in its file."
    lowest, highest = character.bounds[:, [0, 2]]
    distance = float(np.hypot(*np.maximum(np.maximum(lowest, -highest), 0.0)))
    if distance > 0.05 * stats.height:
        yield (
            f"At rest it is {distance:.2g} m away from x = z = 0, its reference point: "
            "move it there."
        )
    sums = [mesh.weights.sum(axis=1) for mesh in character.meshes]
    error = float(np.abs(np.concatenate([*sums, [1.0]]) - 1.0).max())
    if error > 1e-3:
        yield f"Skin weights do not sum to one: the error is {error:.2g}; normalise them."
    if stats.triangles > MANY_TRIANGLES:
        yield (
            f"{stats.triangles:,} triangles are slow to draw without a graphics card; "
            f"{MANY_TRIANGLES:,} are enough."
        )
    textures = [image for mesh in character.meshes for image in mesh.material.textures]
    largest = max((max(image.shape[:2]) for image in textures if image is not None), default=0)
    if largest > LARGE_TEXTURE_PX:
        yield f"A texture has {largest} pixels along a side: {LARGE_TEXTURE_PX} are enough."
    if stats.joints > MANY_JOINTS:
        yield f"{stats.joints} joints are slow to pose: {MANY_JOINTS} are enough."


def _problems_of_joints(character: Character, feet: dict[str, tuple[int, ...]]) -> Iterator[str]:
    anatomy = character.anatomy
    remedy = f"say which joints they are under [joints] in {character.name}.toml next to it"
    if anatomy.kind == "other":
        yield (
            "Its joints were not recognised as those of a person or an animal: for looking "
            f"around, steps and retargeting, {remedy}."
        )
    elif anatomy.missing:
        parts = ", ".join(anatomy.missing)
        yield f"Not found in its {anatomy.kind} skeleton: {parts}; if it has them, {remedy}."
    if not feet:
        yield f"No feet were found, so they may slide; {remedy}."
    head, foot = anatomy.joint("head"), next(iter(anatomy.feet), None)
    if head is not None and foot is not None:
        heights = character.skeleton.rest.globals(character.skeleton)[:, 1, 3]
        if heights[head] < heights[foot]:
            yield "At rest its head is below its feet: rotate it in its file so that +y is up."


def _is_head(character: Character) -> bool:
    """Return whether a character is a head alone: no limb is found, and its face has morphs."""
    parts = set(character.anatomy.joints)
    return bool(parts) and parts <= _HEAD_PARTS and bool(character.morphs)


def _problems_of_clips(character: Character, clips: Sequence[ClipStats]) -> Iterator[str]:
    if character.lender is not None:
        lent = f"those of the bundled {character.lender}, retargeted"
        if clips:
            yield (
                "None of its motions is one of standing still, in which it could rest: beside them "
                f"it plays {lent}. A clip of its own with the name Idle, or --own-motions-only of "
                "cubeling play, leaves them out."
            )
        else:
            yield (
                f"It has no motions of its own: it plays {lent}; --own-motions-only of cubeling "
                "play leaves them out."
            )
    elif not clips and _is_head(character):
        yield "It is a head: it speaks, looks around and shows moods, and does not walk."
    elif not clips:
        yield "It has no clips: it can be posed and retargeted to, but plays nothing by itself."
    static = [stats.clip.name for stats in clips if stats.clip.duration == 0.0]
    if static:
        yield f"{_subject_and_verb(static)} only one frame long and does not move."
    height = max(character.height, 1e-9)
    unclosed = [
        f"{stats.clip.name!r} ({100 * stats.loop_gap / height:.0f} % of its height)"
        for stats in clips
        if _LOOP_NAME.search(stats.clip.name) and stats.loop_gap > _MAX_LOOP_GAP * height
    ]
    if unclosed:
        yield (
            f"{'This clip does' if len(unclosed) == 1 else 'These clips do'} not loop: the last "
            f"frame differs from the first: {', '.join(unclosed)}."
        )
    without_contacts = [
        stats.clip.name
        for stats in clips
        if _GAIT_NAME.search(stats.clip.name) and not any(foot.landings for foot in stats.contacts)
    ]
    if without_contacts:
        yield f"{_subject_and_verb(without_contacts)} named as a gait, but no foot steps in it."
    treadmill = [
        stats.clip.name for stats in clips if stats.in_place and _GAIT_NAME.search(stats.clip.name)
    ]
    if treadmill:
        yield (
            f"{_subject_and_verb(treadmill)} in place: `cubeling character locomotion` turns it "
            "into a walk over the ground."
        )


def _subject_and_verb(names: Sequence[str]) -> str:
    """Return the subject of a sentence about some clips, and its verb.

    >>> _subject_and_verb(["Walk"]), _subject_and_verb(["Walk", "Run"])
    ("The clip 'Walk' is", "The clips 'Walk', 'Run' are")
    """
    listed = ", ".join(repr(name) for name in names)
    return f"The clip {listed} is" if len(names) == 1 else f"The clips {listed} are"


def _foot_joints(character: Character) -> dict[str, tuple[int, ...]]:
    """Return the joints of each foot, from the ankle on, by name."""
    skeleton, anatomy = character.skeleton, character.anatomy
    if not anatomy.feet:
        return {skeleton.names[foot[0]]: foot for foot in find_feet(skeleton)}
    return {anatomy.parts[ankle]: tuple(subtree(skeleton, ankle)) for ankle in anatomy.feet}


def _clip_stats(character: Character, clip: Clip, feet: Mapping[str, Sequence[int]]) -> ClipStats:
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
    joints = [joint for foot in feet.values() for joint in foot]
    speed, in_place = _ground_speed(character, clip, joints)
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
