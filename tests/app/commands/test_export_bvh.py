"""The motion of a session's characters as .bvh: read again, it is what was drawn."""

import warnings
from pathlib import Path

import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.session import Recorder, SessionFile, frame_encoder
from cubeling.characters import Character, PosedCharacter, load_motion
from cubeling.characters.skeleton import rotations
from cubeling.tracking import Frame, Intrinsics

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # bvhio imports PyGLM by its old name
    import bvhio

PLACE_M, TURN_DEG = 1e-4, 0.01
SIZE = (64, 48)


def drawn(path: Path, topic: str, character: Character):
    """Return (frames, joints, 4, 4) on the table, and the same at rest without the table."""
    with SessionFile(path) as session:
        posed = [each for _, _, each in session.decode_messages({topic: PosedCharacter})]
    placed = np.stack(
        [each.table_from_character @ each.pose.globals(character.skeleton) for each in posed]
    )
    return placed, character.skeleton.rest.globals(character.skeleton)


def turns_of(matrices):
    return rotations.from_matrix(matrices / np.linalg.norm(matrices, axis=-2, keepdims=True))


def compare(file: Path, path: Path, topic: str, character: Character) -> None:
    placed, rest = drawn(path, topic, character)
    found = load_motion(file, scale=1.0, up="y")
    assert found.clip.rate == pytest.approx(30.0)
    assert len(found.clip) == len(placed)
    names = [name for name in found.skeleton.names if name in character.skeleton.names]
    assert len(names) > 10
    ours = [found.skeleton.index(name) for name in names]
    theirs = [character.skeleton.index(name) for name in names]
    read = found.clip.poses.globals(found.skeleton)[:, ours]
    assert np.abs(read[..., :3, 3] - placed[:, theirs][..., :3, 3]).max() < PLACE_M
    facing = rotations.multiply(
        turns_of(placed[:, theirs][..., :3, :3]),
        rotations.conjugate(turns_of(rest[theirs, :3, :3])),
    )
    apart = rotations.multiply(turns_of(read[..., :3, :3]), rotations.conjugate(facing))
    angle = 2.0 * np.arcsin(np.linalg.norm(apart[..., :3], axis=-1).clip(0.0, 1.0))
    assert np.degrees(angle).max() < TURN_DEG
    root = bvhio.readAsHierarchy(str(file))
    for frame in (0, len(placed) - 1):
        root.loadPose(frame, recursive=True)
        for joint, _, _ in root.layout():
            if joint.Name in names:
                truth = placed[frame, character.skeleton.index(joint.Name), :3, 3]
                assert np.abs(np.array(joint.PositionWorld) - truth).max() < PLACE_M


def test_the_motion_read_again_is_what_was_drawn(cubeling, short_session):
    code, out, err = cubeling("export", short_session, "-o", "out", "--bvh")
    assert (code, err) == (0, "")
    file = Path("out", "short-vleo.bvh")
    assert file.name in out
    compare(file, short_session, "/character/pose", Character.load("vleo"))
    code, _, err = cubeling("export", short_session, "-o", "out", "--bvh")
    assert (code, err.count("\n")) == (2, 1)
    assert "--overwrite" in err


def test_each_of_a_cast_has_a_file_and_a_gap_is_filled(cubeling):
    about = {"scenario": "companion", "character": "human", "others": "vleo"}
    cast = [Character.load(name) for name in ("human", "vleo")]
    playground = Playground("companion", Intrinsics.guess(SIZE), character=cast[0], others=cast[1:])
    encode = frame_encoder("jpeg", SIZE, 30.0)
    with Recorder(Path("two.mcap"), about) as recorder:
        for index in (*range(8), *range(11, 16)):
            frame = Frame(np.zeros((48, 64, 3), np.uint8), index / 30.0, index)
            recorder.write(playground.step(encode(frame)))
    playground.close()
    assert cubeling("export", "two.mcap", "-o", "out", "--bvh")[0] == 0
    for own, topic in (("human", "/character/pose"), ("vleo", "/cast/vleo/pose")):
        found = load_motion(Path("out", f"two-{own}.bvh"), scale=1.0, up="y")
        assert len(found.clip) == 16
        character = Character.load(own)
        placed, _ = drawn(Path("two.mcap"), topic, character)
        hips = found.skeleton.names[0]
        read = found.clip.poses.globals(found.skeleton)[[*range(8), *range(11, 16)], 0, :3, 3]
        truth = placed[:, character.skeleton.index(hips), :3, 3]
        assert np.abs(read - truth).max() < PLACE_M
