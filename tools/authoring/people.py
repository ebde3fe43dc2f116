"""The .idle files of the bundled characters: how each stands, "recorded" in nine moods."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from cubeling.affect.regions import region_of
from cubeling.characters.model.character import Character
from cubeling.characters.motion.clip import Clip
from cubeling.characters.synthesis.idle.recordings import StandingRecording, read_standing
from cubeling.characters.synthesis.idle.storage import save_person
from tools.authoring.human import standing as human
from tools.authoring.modelling.quadruped import AnimationTracks, loop_clip
from tools.authoring.modelling.quadruped_standing import standing_tracks
from tools.authoring.modelling.shapes import Array
from tools.authoring.modelling.standing import MOODS
from tools.authoring.robot import motion as robot_motion, rig as robot
from tools.authoring.vleo import clips as vleo_clips, rig as vleo

KEPT_RATE_HZ = 15.0
"""Frames a second that are kept [Hz]."""


def save_standing(character: Character, path: Path) -> None:
    """Write how a bundled character stands, as its .idle file."""
    recordings = tuple(
        recording_of(character, mood, clip) for mood, clip in STANDING[character.name](character)
    )
    save_person((character.skeleton, character.anatomy, recordings), path)


def recording_of(character: Character, mood: str, clip: Clip) -> StandingRecording:
    """Return a clip of a mood as a recording of how a character stands."""
    fewer = replace(clip, rate=KEPT_RATE_HZ, poses=clip.poses[:: round(clip.rate / KEPT_RATE_HZ)])
    body = character.skeleton, character.anatomy
    return read_standing(fewer, *body, region_of(mood), alignment="none")


def _vleo(character: Character) -> Iterable[tuple[str, Clip]]:
    def tail(anim: AnimationTracks, up: Array, left: Array) -> None:
        vleo_clips.tail(anim, up, left, 1.5)

    for mood in MOODS:
        tracks = standing_tracks("vleo", mood, vleo.NECK, tail, *_size(character))
        yield mood, loop_clip(mood, tracks, character.skeleton, vleo.FEET)


def _robot(character: Character) -> Iterable[tuple[str, Clip]]:
    for mood in MOODS:
        tracks = standing_tracks(
            "robot", mood, robot.NECK, robot_motion.tail, *_size(character), 0.009
        )
        yield mood, loop_clip(mood, tracks, character.skeleton, robot.FEET)


def _size(character: Character) -> tuple[float, float]:
    """Return the distance of the hind feet, and that of hips and chest along the body [m]."""
    placed = character.skeleton.rest.globals(character.skeleton)[:, :3, 3]
    left, right, hips, chest = (
        placed[character.anatomy.joints[part]]
        for part in ("leftFoot", "rightFoot", "hips", "chest")
    )
    return float(abs(left[0] - right[0])), float(abs(chest[2] - hips[2]))


STANDING: dict[str, Callable[[Character], Iterable[tuple[str, Clip]]]] = {
    "human": lambda character: human.standing(character.skeleton),
    "vleo": _vleo,
    "robot": _robot,
}
"""What makes the recordings of a character, by its name."""
