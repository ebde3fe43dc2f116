import base64
import json

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Pose
from cubeling.characters.formats import load_motion
from cubeling.characters.model.character import skin
from cubeling.characters.skeleton import rotations
from tests.characters.formats.built_gltf import SAMPLES, build_arm, glb
from tests.examples import some


@pytest.fixture
def arm():
    return build_arm()


def load(tmp_path, data, name="thing.glb"):
    (tmp_path / name).write_bytes(data)
    return Character.load(tmp_path / name)


def test_ancestors_of_joints_are_honoured(tmp_path, arm):
    character = load(tmp_path, arm.bytes())
    assert character.skeleton.names == ("node0", "upper", "lower")
    globals_ = character.skeleton.rest.globals(character.skeleton)
    assert np.allclose(globals_[2, :3, 3], [0, 0.3, 0], atol=1e-6)
    placed = skin(character.meshes[0], globals_)
    assert np.allclose(placed, [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.6, 0.0]], atol=1e-5)
    assert character.height == pytest.approx(0.6)


def test_a_mesh_bound_at_rest_has_its_visible_positions(tmp_path, arm):
    mesh = load(tmp_path, arm.bytes()).meshes[0]
    assert np.allclose(
        mesh.positions, [[0.0, 0.0, 0.0], [0.01, 0.0, 0.0], [0.0, 0.6, 0.0]], atol=1e-5
    )


def test_byte_weights_are_normalised(tmp_path, arm):
    mesh = load(tmp_path, arm.bytes()).meshes[0]
    assert np.allclose(mesh.weights.sum(1), 1)


def test_a_matrix_equals_its_translation_rotation_and_scale(tmp_path, arm):
    plain = load(tmp_path, arm.bytes())
    node = arm.document["nodes"][0]
    matrix = np.eye(4)
    matrix[:3, :3] = rotations.to_matrix(node.pop("rotation")) * node.pop("scale")[0]
    node["matrix"] = matrix.T.ravel().tolist()
    assert np.allclose(load(tmp_path, arm.bytes()).bounds, plain.bounds, atol=1e-6)


def test_linear_keys_are_exact_with_constant_speed_between(tmp_path, arm):
    arm.animate("LINEAR", [0.5, 1.0], rotations.about("x", [0.0, 1.0]))
    clip = load(tmp_path, arm.bytes()).clips["a"]
    assert clip.duration == pytest.approx(0.5)
    assert np.allclose(clip.poses.rotations[-1, 2], rotations.about("x", 1.0), atol=1e-6)
    angles = rotations.to_rotation_vector(clip.poses.rotations[:, 2])[:, 0]
    assert np.allclose(np.diff(angles), angles[-1] / (len(clip) - 1), atol=1e-5)


def test_steps_hold_until_the_next_key(tmp_path, arm):
    arm.animate("STEP", [0.0, 0.5, 1.0], [[0, 0, 0], [1, 0, 0], [2, 0, 0]], "translation")
    clip = load(tmp_path, arm.bytes()).clips["a"]
    x = clip.poses.translations[:, 2, 0]
    assert sorted(set(x.tolist())) == [0.0, 1.0, 2.0]
    assert x[round(0.5 * clip.rate) - 1] == 0
    assert x[round(0.5 * clip.rate)] == 1


def test_cubic_splines_follow_their_tangents(tmp_path, arm):
    # x = t³ on 0…2: values and slopes at the ends give back the cubic itself.
    keys = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [12, 0, 0], [8, 0, 0], [12, 0, 0]]
    arm.animate("CUBICSPLINE", [0.0, 2.0], keys, "translation")
    clip = load(tmp_path, arm.bytes()).clips["a"]
    times = np.arange(len(clip)) / clip.rate
    assert np.allclose(clip.poses.translations[:, 2, 0], times**3, atol=1e-5)


def test_keys_at_irregular_times_are_reached_closely(tmp_path, arm):
    times = [0.0, 0.1234, 0.7071, 1.0]
    arm.animate("LINEAR", times, [[0, 0, 0], [1, 0, 0], [0, 0, 0], [1, 0, 0]], "translation")
    clip = load(tmp_path, arm.bytes()).clips["a"]
    x = [clip.poses.translations[round(t * clip.rate), 2, 0] for t in times]
    assert np.allclose(x, [0, 1, 0, 1], atol=0.05)


def test_buffers_in_files_and_data_uris_are_read(tmp_path, arm):
    whole = load(tmp_path, arm.bytes())
    for uri in ("body.bin", "data:application/octet-stream;base64,"):
        if uri.startswith("data"):
            uri += base64.b64encode(arm.blob).decode()
        else:
            (tmp_path / uri).write_bytes(arm.blob)
        arm.document["buffers"] = [{"byteLength": len(arm.blob), "uri": uri}]
        split = load(tmp_path, json.dumps(arm.document).encode(), "thing.gltf")
        assert np.array_equal(split.meshes[0].positions, whole.meshes[0].positions)


def test_a_missing_buffer_file_is_named(tmp_path, arm):
    arm.document["buffers"] = [{"byteLength": len(arm.blob), "uri": "lost.bin"}]
    with pytest.raises(CharacterError, match=r"needs 'lost\.bin'"):
        load(tmp_path, json.dumps(arm.document).encode(), "thing.gltf")


def test_a_character_survives_saving_and_loading(tmp_path, walker):
    walker.save(tmp_path / "walker.glb")
    again = Character.load(tmp_path / "walker.glb")
    assert again.skeleton.names == walker.skeleton.names
    assert again.skeleton.parents == walker.skeleton.parents
    assert list(again.clips) == list(walker.clips)
    for name, clip in walker.clips.items():
        loaded = again.clips[name]
        assert (loaded.rate, loaded.loop, loaded.root_motion) == (clip.rate, True, True)
        assert np.allclose(loaded.poses.translations, clip.poses.translations, atol=1e-6)
        same = rotations.align(loaded.poses.rotations, clip.poses.rotations)
        assert np.allclose(same, clip.poses.rotations, atol=1e-6)
    before, after = walker.meshes[0], again.meshes[0]
    assert before.colors is not None
    assert after.colors is not None
    assert np.array_equal(before.positions, after.positions)
    assert np.array_equal(before.triangles, after.triangles)
    assert np.allclose(before.colors, after.colors, atol=1e-5)
    assert np.allclose(before.inverse_bind, after.inverse_bind, atol=1e-6)
    assert np.allclose(before.weights, after.weights, atol=1e-5)
    assert np.allclose(after.weights.sum(1), 1, atol=1e-6)


def test_saving_twice_gives_the_same_bytes_and_leaves_nothing_else(tmp_path, walker):
    walker.save(tmp_path / "a.glb")
    walker.save(tmp_path / "b.glb")
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.glb", "b.glb"]


def test_a_texture_survives_saving_and_loading(tmp_path, walker):
    picture = np.arange(4 * 4 * 4, dtype=np.uint8).reshape(4, 4, 4)
    mesh = walker.meshes[0]
    fields = {**vars(mesh), "uvs": np.zeros((8, 2), np.float32)}
    fields["material"] = type(mesh.material)(base_color_texture=picture, roughness=0.25)
    textured = Character("t", walker.skeleton, {}, (type(mesh)(**fields),))
    textured.save(tmp_path / "t.glb")
    material = Character.load(tmp_path / "t.glb").meshes[0].material
    assert material.base_color_texture is not None
    assert np.array_equal(material.base_color_texture, picture)
    assert material.roughness == 0.25


def test_arrays_that_do_not_fit_are_not_written(tmp_path, walker):
    mesh = walker.meshes[0]
    broken = type(mesh)(**{**vars(mesh), "weights": mesh.weights * 2})
    character = Character("broken", walker.skeleton, {}, (broken,))
    with pytest.raises(CharacterError, match="'box': its skin weights do not sum to one"):
        character.save(tmp_path / "broken.glb")
    assert not list(tmp_path.iterdir())


def test_saving_into_a_missing_folder_is_refused(tmp_path, walker):
    with pytest.raises(CharacterError, match="cannot write"):
        walker.save(tmp_path / "nowhere" / "w.glb")


def complaint(path):
    try:
        Character.load(path)
    except CharacterError as error:
        return str(error)
    return ""


def refused(path):
    message = complaint(path)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_files_without_a_character_are_refused_in_one_line(tmp_path, arm):
    path = tmp_path / "x.glb"
    assert "cannot read" in refused(path)
    path.write_bytes(b"not a picture of a cat")
    assert "not a glTF file" in refused(path)
    path.write_bytes(b"")
    assert "not a glTF file" in refused(path)
    path.write_bytes(glb({"asset": {"version": "1.0"}}))
    assert "export it as glTF 2.0" in refused(path)
    path.write_bytes(glb({"asset": {"version": "2.0"}, "nodes": [{"name": "lamp"}]}))
    assert "has no skin and no animation" in refused(path)
    assert "cannot read the FBX" in refused(tmp_path / "x.fbx")
    with pytest.raises(CharacterError, match="no bundled character 'unicorn'"):
        Character.load("unicorn")


def test_a_file_cut_anywhere_is_refused_in_one_line(tmp_path, arm):
    whole = arm.bytes()
    path = tmp_path / "cut.glb"
    for length in range(0, len(whole), 37):
        path.write_bytes(whole[:length])
        refused(path)


@pytest.mark.filterwarnings("ignore::cubeling.characters.errors.CharacterWarning")
def test_a_file_with_any_number_changed_loads_or_is_refused(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    rng = np.random.default_rng(5)
    text = json.dumps({**arm.document, "buffers": [{"byteLength": len(arm.blob)}]})
    digits = [at for at, letter in enumerate(text) if letter.isdigit()]
    path = tmp_path / "odd.glb"
    for at in rng.choice(digits, 60):
        changed = text[:at] + str(rng.integers(10)) + text[at + 1 :]
        path.write_bytes(glb(changed, arm.blob))
        assert "\n" not in complaint(path)


def test_a_node_that_is_its_own_ancestor_is_refused(tmp_path, arm):
    arm.document["nodes"][2]["children"] = [0]
    with pytest.raises(CharacterError, match="ancestor"):
        load(tmp_path, arm.bytes())


@pytest.mark.parametrize("path", some(SAMPLES, 3), ids=lambda path: path.stem)
def test_characters_made_elsewhere_load_and_play(path):
    character = Character.load(path)
    assert character.height > 0
    for clip in list(character.clips.values())[:3]:
        pose = clip.sample(clip.duration / 3)
        globals_ = pose.globals(character.skeleton)
        for mesh in character.meshes[:3]:
            moved = skin(mesh, globals_)
            assert np.isfinite(moved).all()
            assert np.ptp(moved, axis=0).max() < 3 * np.ptp(character.bounds, axis=0).max()


@pytest.mark.parametrize("name", Character.bundled_names())
def test_bundled_characters_load(name):
    character = Character.load(name)
    assert character.name == name
    assert "idle" in character.clips
    assert character.skeleton.has_root_motion
    for mesh in character.meshes:
        assert np.allclose(mesh.weights.sum(1), 1, atol=1e-5)
    rest = character.skeleton.rest
    assert isinstance(rest, Pose)


def test_one_clip_is_loaded_by_its_name_or_alone(tmp_path, arm, walker):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    (tmp_path / "arm.glb").write_bytes(arm.bytes())
    assert load_motion(tmp_path / "arm.glb").clip.name == "a"
    walker.save(tmp_path / "walker.glb")
    assert load_motion(tmp_path / "walker.glb", "Run").clip.duration == pytest.approx(0.7)
    with pytest.raises(CharacterError, match=r"has idle, Walk, Run.*say which one"):
        load_motion(tmp_path / "walker.glb")
    with pytest.raises(CharacterError, match="not a motion file"):
        load_motion(tmp_path / "walk.xyz")


def test_motions_without_a_model_are_read(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]))
    for key in ("meshes", "skins"):
        del arm.document[key]
    arm.document["nodes"][3] = {"name": "lamp"}
    (tmp_path / "arm.glb").write_bytes(arm.bytes())
    performance = load_motion(tmp_path / "arm.glb")
    assert performance.skeleton.names == ("node0", "upper", "lower")
    assert performance.clip.duration == 1.0
    assert "moves no mesh" in refused(tmp_path / "arm.glb")


def test_rigid_parts_that_are_animated_make_a_character(tmp_path, arm):
    arm.animate("LINEAR", [0.0, 1.0], rotations.about("x", [0.0, 1.0]), node=2)
    del arm.document["skins"]
    arm.document["nodes"][2]["children"] = [3]
    arm.document["nodes"][3] = {"name": "hand", "mesh": 0, "translation": [0, 0, 100]}
    character = load(tmp_path, arm.bytes())
    assert character.skeleton.names == ("node0", "upper", "lower", "hand")
    assert np.allclose(character.meshes[0].positions[0], [0, 0.4, 0], atol=1e-6)
