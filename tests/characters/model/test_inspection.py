"""What an inspection finds, and that it finds nothing wrong with the bundled characters."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Animator, Character, CharacterCommand, Clip, Skeleton
from cubeling.characters.model.inspection import inspect
from tests.characters.formats.built_gltf import Builder


@pytest.fixture(scope="module")
def sound(walker, gait):
    """Return a character of which only the joints are too few to be a person's."""
    clips = {name: walker.clips[name] for name in ("idle", "Walk", "Run")}
    return replace(walker, clips=clips)


def problems(character, **changes):
    return "\n".join(inspect(replace(character, **changes)).problems)


DATA = Path(__file__).parents[4] / "shared" / "data"


@pytest.mark.skipif(not DATA.is_dir(), reason="the real data is not here")
def test_inspection_reports_an_odd_scale_and_walks_in_place():
    found = inspect(Character.load(DATA / "gltf" / "Fox.glb"))
    assert found.character.anatomy.kind == "quadruped"
    assert [stats.in_place for stats in found.clips] == [False, True, True]
    assert "79 m tall" in found.problems[0]
    assert "'Walk', 'Run' are in place" in found.problems[1]
    assert len(found.problems) == 2


@pytest.mark.parametrize("name", Character.bundled_names())
def test_inspection_finds_no_problems_in_bundled_characters(name):
    found = inspect(Character.load(name))
    assert found.problems == ()
    assert found.stats.triangles > 1000
    assert len(found.clips) == len(found.character.clips)


def test_speed_loop_gap_and_contacts_of_a_walk(sound):
    stats = {found.clip.name: found for found in inspect(sound).clips}
    assert stats["Walk"].speed == pytest.approx(1.35, abs=0.01)
    assert stats["Walk"].loop_gap == pytest.approx(0.0, abs=1e-6)
    assert [foot.foot for foot in stats["Walk"].contacts] == ["leftFoot", "rightFoot"]
    for foot in stats["Walk"].contacts:
        assert foot.landings == 1
        assert foot.share == pytest.approx(0.6, abs=0.12)
    assert [foot.share for foot in stats["idle"].contacts] == [1.0, 1.0]


def test_a_walk_in_place_is_recognised_by_its_feet(sound):
    walk = sound.clips["Walk"]
    in_place = Clip("Walk", walk.rate, walk.in_place, loop=True, root_motion=False)
    found = inspect(replace(sound, clips={"Walk": in_place}))
    assert found.clips[0].in_place
    assert found.clips[0].speed == pytest.approx(1.35, rel=0.15)
    assert any("in place" in problem for problem in found.problems)


def test_notes_of_the_reader_come_first(sound):
    assert inspect(sound, ["The weights were repaired."]).problems[0] == (
        "The weights were repaired."
    )


def test_inspection_reports_an_odd_size_or_position(sound):
    mesh = sound.meshes[0]

    def moved(scale, rise, aside=0.0):
        positions = (scale * mesh.positions + [aside, rise, 0.0]).astype(np.float32)
        return problems(sound, meshes=(replace(mesh, positions=positions),))

    assert "tall" not in moved(1.0, 0.0)
    assert "170 m tall" in moved(100.0, 0.0)
    assert "0.5 m above the ground" in moved(1.0, 0.5)
    assert "0.5 m below the ground" in moved(1.0, -0.5)
    assert "away from x" not in moved(1.0, 0.0, 0.1)
    assert "1.8 m away from x = z = 0" in moved(1.0, 0.0, 2.0)
    assert "1.8 m away from x = z = 0" in moved(1.0, 0.0, -2.0)


def test_inspection_reports_weights_textures_and_triangles(sound):
    mesh = sound.meshes[0]
    heavy = replace(mesh, weights=1.2 * mesh.weights)
    assert "the error is 0.2" in problems(sound, meshes=(heavy,))
    crowd = replace(mesh, triangles=np.tile(mesh.triangles, (30_000, 1)))
    assert "120,000 triangles" in problems(sound, meshes=(crowd,))
    large = replace(mesh.material, normal_texture=np.zeros((2, 5000, 3), np.uint8))
    assert "5000 pixels" in problems(sound, meshes=(replace(mesh, material=large),))


def test_inspection_reports_unrecognised_joints(sound):
    skeleton = sound.skeleton
    names = tuple("abcde")
    strange = Skeleton(names, skeleton.parents, skeleton.rest)
    found = problems(sound, skeleton=strange, clips={})
    assert "not recognised" in found
    assert "No feet were found" in found
    assert "no clips" in found


def test_a_head_without_a_skin_is_a_head(tmp_path):
    build = Builder()
    triangle = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.2, 0.1]])
    shape = {"POSITION": build.floats(triangle, "VEC3")}
    opened = [{"POSITION": build.floats(0.1 * triangle, "VEC3")}]
    face = {"primitives": [{"attributes": shape, "targets": opened}]}
    build.document["meshes"] = [face, {"primitives": [{"attributes": shape}]}]
    build.document["nodes"] = [
        {"name": "group", "children": [1, 2]},
        {"name": "skull_mesh", "mesh": 0},
        {"name": "eye_L", "mesh": 1, "translation": [0.03, 0.1, 0.1]},
    ]
    (tmp_path / "someone.glb").write_bytes(build.bytes())
    character = Character.load(tmp_path / "someone.glb")
    head = character.anatomy.joint("head")
    assert head is not None
    assert character.skeleton.names[head] == "group"
    assert [mesh.name for mesh in character.meshes] == ["skull_mesh", "eye_L"]
    (problem,) = inspect(character).problems
    assert problem.startswith("It is a head")
    Animator(character).update(CharacterCommand(0.0))


def test_inspection_reports_a_gait_that_does_not_loop(sound):
    walk = sound.clips["Walk"]
    half = Clip("Walk", walk.rate, walk.poses[: len(walk) // 2], loop=False, root_motion=True)
    found = problems(sound, clips={"Walk": half})
    assert "does not loop" in found
    once = Clip("wave", walk.rate, half.poses, loop=False, root_motion=True)
    assert "loop" not in problems(sound, clips={"wave": once})


def test_inspection_reports_clips_of_one_frame(sound):
    walk = sound.clips["Walk"]
    assert "one frame" in problems(sound, clips={"pose": Clip("pose", 30.0, walk.poses[:1])})
