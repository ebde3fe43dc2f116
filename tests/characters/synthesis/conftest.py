"""A small library: four clips of the bundled human, which walks, turns, runs and stands."""

import pytest

from cubeling.characters import Character, Clip, Pose
from cubeling.characters.synthesis.graphs.building import analyse
from cubeling.characters.synthesis.graphs.storage import StoredGraph
from cubeling.characters.synthesis.library import MotionLibrary
from tests.bundled_characters import bundled_character


@pytest.fixture(scope="session")
def human() -> Character:
    return bundled_character("human")


@pytest.fixture(scope="session")
def library(human: Character) -> MotionLibrary:
    clips = [human.clips[name] for name in ("Walk", "WalkLeftWide", "WalkLeftMedium", "Run")]
    idle = human.clips["idle"]
    poses = Pose(idle.poses.translations[:40], idle.poses.rotations[:40])
    clips.append(Clip("stand", idle.rate, poses, loop=False, root_motion=True))
    return MotionLibrary.of(clips, human.skeleton, human.anatomy)


@pytest.fixture(scope="session")
def stored(library: MotionLibrary) -> StoredGraph:
    return analyse(library)
