"""What the characters of a session did, as motion capture (.bvh)."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import distinct_names
from cubeling.app.running.asked_scenario import load_cast, scenario_of
from cubeling.app.session import SessionFile
from cubeling.characters import Character, Clip, Pose, PosedCharacter, save_bvh
from cubeling.characters.motion import Array, rotations

MIN_FRAME_S = 1e-3
"""Frames that are nearer together give no rate [s]."""


def write_motions(path: Path, folder: Path, name: str) -> dict[str, int]:
    """Write a .bvh file for each character of a session that has every channel.

    They are called NAME-CHARACTER.bvh. Frames are at the median rate of the session's, and between
    those where the camera was not in time; places are in metres on the table.

    Returns
    -------
    frames
        How many each file has, by its name.

    Raises
    ------
    AppError, CharacterError
        The session has too few poses or other joints than its character has today, or a file cannot
        be written.
    """
    written = {}
    with SessionFile(path) as session:
        for topic, (own, character) in cast_of(session):
            found = [each for _, _, each in session.decode_messages({topic: PosedCharacter})]
            file = f"{name}-{own}.bvh"
            clip, placed = _clip(f"{name}: {own}", character, found)
            save_bvh(clip, character.skeleton, character.anatomy, folder / file, placed)
            written[file] = len(clip)
    return written


def cast_of(session: SessionFile) -> Iterator[tuple[str, tuple[str, Character]]]:
    """Yield the channel of the poses, the name and the body of each character."""
    options = session.info.options
    cast = load_cast(options, scenario_of(options, options.scenario))
    for number, name in enumerate(distinct_names(each.name for each in cast)):
        topic = f"/cast/{name}/pose" if number else "/character/pose"
        yield topic, (name, cast[number])


def _clip(name: str, character: Character, posed: Sequence[PosedCharacter]) -> tuple[Clip, Array]:
    """Return poses at a uniform rate, and table_from_character (frames, 4, 4) of each."""
    times = np.array([each.timestamp for each in posed])
    if len(times) < 2 or not (interval := float(np.median(np.diff(times)))) > MIN_FRAME_S:
        raise AppError(f"{name} has too few frames for a motion")
    if any(len(each.pose.rotations) != len(character.skeleton) for each in posed):
        raise AppError(
            f"{name} had other joints when it was recorded: record a replay of the session first"
        )
    rate = 1.0 / interval
    at = times[0] + np.arange(round((times[-1] - times[0]) * rate) + 1) * interval
    after = np.clip(np.searchsorted(times, at), 1, len(times) - 1)
    before = after - 1
    share = np.clip((at - times[before]) / np.maximum(times[after] - times[before], 1e-9), 0.0, 1.0)

    def between(values: Array, weights: Array) -> Array:
        mixed: Array = values[before] + (values[after] - values[before]) * weights
        return mixed

    def turned(values: Array, weights: Array) -> Array:
        return rotations.nlerp(values[before], values[after], weights)

    joints = share[:, None, None]
    poses = Pose(
        between(np.stack([each.pose.translations for each in posed]), joints),
        turned(np.stack([each.pose.rotations for each in posed]), joints[..., 0]),
        between(np.stack([each.pose.scales_or_ones for each in posed]), joints),
    )
    places = np.stack([each.table_from_character for each in posed])
    sizes = np.linalg.norm(places[:, :3, 0], axis=-1)
    placed = np.tile(np.eye(4), (len(at), 1, 1))
    turns = turned(rotations.from_matrix(places[:, :3, :3] / sizes[:, None, None]), share)
    placed[:, :3, :3] = rotations.to_matrix(turns) * between(sizes, share)[:, None, None]
    placed[:, :3, 3] = between(places[:, :3, 3], share[:, None])
    return Clip(name, rate, poses, loop=False), placed
