"""What there is to know of a character, and what is wrong with it, in plain sentences."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.model.character import Character
from characters.model.facts import ClipFacts, Sizes, facts_of, joints_of_feet
from characters.model.mesh import Mesh

MANY_JOINTS, MANY_TRIANGLES, LARGE_TEXTURE = 256, 100_000, 4096
"""What takes long without a graphics card: joints, triangles, pixels along a texture."""

LIKELY_HEIGHT = 0.05, 30.0
"""Between these a height is taken to be meant [m]: there are mice, and there were dinosaurs."""

_CLOSED = 0.03  # heights: a loop whose ends are so near to each other closes
_CYCLE = re.compile(r"(?i)walk|run|jog|trot|gallop|stroll|idle|loop|cycle")
_GAIT = re.compile(r"(?i)walk|run|jog|trot|gallop|stroll")


@dataclass(frozen=True)
class Inspection:
    """What was found."""

    character: Character
    """Who."""

    sizes: Sizes
    """How large."""

    clips: tuple[ClipFacts, ...]
    """What it knows."""

    problems: tuple[str, ...]
    """Sentences for a person, the ones that matter most first; none if all is well."""


def inspect(character: Character, notes: Sequence[str] = (), body: bool = True) -> Inspection:
    """Look at a character.

    Parameters
    ----------
    character
        Who.
    notes
        What was repaired or guessed while it was read; these come first among the problems.
    body
        Whether its meshes are its own: those of a stick figure have no problems.
    """
    feet = joints_of_feet(character)
    clips = tuple(facts_of(character, clip, feet) for clip in character.clips.values())
    sizes = Sizes.of(character)
    problems = [
        *notes,
        *(_problems_of_body(character, sizes) if body else ()),
        *_problems_of_joints(character, feet),
        *_problems_of_clips(character, clips),
    ]
    return Inspection(character, sizes, clips, tuple(problems))


def _problems_of_body(character: Character, sizes: Sizes) -> Iterator[str]:
    low = float(character.bounds[0, 1])
    if not LIKELY_HEIGHT[0] <= sizes.height <= LIKELY_HEIGHT[1]:
        yield (
            f"It is {sizes.height:.3g} m tall at rest: files are in metres, so this one was "
            "exported at another scale. On the table it is scaled to fit."
        )
    if sizes.height and abs(low) > 0.05 * sizes.height:
        where = "above" if low > 0 else "below"
        yield f"At rest it is {abs(low):.2g} m {where} the ground: move it to y = 0 in its file."
    lowest, highest = character.bounds[:, [0, 2]]
    beside = float(np.hypot(*np.maximum(np.maximum(lowest, -highest), 0.0)))
    if beside > 0.05 * sizes.height:
        yield f"At rest it is {beside:.2g} m beside x = z = 0, where it is put down: move it there."
    off = max((_unevenness(mesh) for mesh in character.meshes), default=0.0)
    if off > 1e-3:
        yield f"Skin weights do not sum to one: they are off by {off:.2g}; normalise them."
    if sizes.triangles > MANY_TRIANGLES:
        yield (
            f"{sizes.triangles:,} triangles take long to draw without a graphics card; "
            f"{MANY_TRIANGLES:,} are plenty on a table."
        )
    largest = max((_side(mesh) for mesh in character.meshes), default=0)
    if largest > LARGE_TEXTURE:
        yield f"A texture has {largest} pixels along a side: {LARGE_TEXTURE} are plenty."
    if sizes.joints > MANY_JOINTS:
        yield f"{sizes.joints} joints take long to pose: {MANY_JOINTS} are plenty."


def _unevenness(mesh: Mesh) -> float:
    sums = mesh.weights.sum(axis=1)
    return float(np.abs(sums - 1.0).max()) if len(sums) else 0.0


def _side(mesh: Mesh) -> int:
    maps: list[NDArray[np.uint8] | None] = [
        mesh.material.texture, mesh.material.surface, mesh.material.bumps
    ]  # fmt: skip
    return max((max(image.shape[:2]) for image in maps if image is not None), default=0)


def _problems_of_joints(character: Character, feet: dict[str, tuple[int, ...]]) -> Iterator[str]:
    anatomy = character.anatomy
    remedy = f"say which joints they are under [joints] in {character.name}.toml beside it"
    if anatomy.kind == "other":
        yield (
            "Its joints were not recognised as those of a person or an animal: for looking "
            f"around, steps and retargeting, {remedy}."
        )
    elif anatomy.missing:
        parts = ", ".join(anatomy.missing)
        yield f"Not found in its {anatomy.kind} skeleton: {parts}; if they are there, {remedy}."
    if not feet:
        yield f"No feet were found: they will not hold the ground; {remedy}."
    head, foot = anatomy.joint("head"), next(iter(anatomy.feet), None)
    if head is not None and foot is not None:
        heights = character.skeleton.rest.globals(character.skeleton)[:, 1, 3]
        if heights[head] < heights[foot]:
            yield "At rest its head is below its feet: turn it so that +y is up in its file."


def _problems_of_clips(character: Character, clips: Sequence[ClipFacts]) -> Iterator[str]:
    if not clips:
        yield "It has no clips: it can be posed and retargeted to, but does nothing by itself."
    still = [facts.clip.name for facts in clips if facts.clip.duration == 0.0]
    if still:
        yield f"{_named(still)} of one frame: nothing moves in it."
    height = max(character.height, 1e-9)
    open_ = [
        f"{facts.clip.name!r} ({100 * facts.opening / height:.0f} % of its height)"
        for facts in clips
        if _CYCLE.search(facts.clip.name) and facts.opening > _CLOSED * height
    ]
    if open_:
        yield (
            f"{'This clip does' if len(open_) == 1 else 'These clips do'} not loop, for the last "
            f"frame is not the first again: {', '.join(open_)}."
        )
    afloat = [
        facts.clip.name
        for facts in clips
        if _GAIT.search(facts.clip.name) and not any(foot.times for foot in facts.footing)
    ]
    if afloat:
        yield f"{_named(afloat)} called a gait, but no foot was found to step in it."
    treadmill = [
        facts.clip.name for facts in clips if facts.in_place and _GAIT.search(facts.clip.name)
    ]
    if treadmill:
        yield (
            f"{_named(treadmill)} in place: `cubeling character locomotion` makes a walk over the "
            "ground of it."
        )


def _named(names: Sequence[str]) -> str:
    """Return the subject of a sentence about some clips, and its verb.

    >>> _named(["Walk"]), _named(["Walk", "Run"])
    ("The clip 'Walk' is", "The clips 'Walk', 'Run' are")
    """
    listed = ", ".join(repr(name) for name in names)
    return f"The clip {listed} is" if len(names) == 1 else f"The clips {listed} are"
