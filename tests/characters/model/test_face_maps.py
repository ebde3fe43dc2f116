"""The table [face] of a sidecar file: a folder of pictures for wrinkles and blood."""

import cv2
import numpy as np
import pytest

from cubeling.characters import Character, CharacterError
from cubeling.characters.model.face_maps import LAYER_NAMES, FaceTable, read_face_maps
from cubeling.characters.model.sidecar import read_sidecar


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "me_face"
    made.mkdir()
    grey = np.full((8, 16), 128, np.uint8)
    grey[2:4, 3:9] = 0
    cv2.imwrite(str(made / "au4.png"), grey)
    return made


@pytest.fixture
def sidecar(tmp_path, folder):
    def write(text):
        path = tmp_path / "me.toml"
        path.write_text(f"[face]\n{text}\n", encoding="utf-8")
        return read_sidecar(path, ())

    return write


def test_grey_is_flat_and_dark_is_a_groove(folder):
    maps = read_face_maps(folder, 0.002)
    groove = LAYER_NAMES.index("au4")
    assert maps.heights.shape == (12, 8, 16)
    assert maps.heights[groove, 2, 3] == pytest.approx(-128 / 127)
    assert not maps.heights[groove, 5:].any()
    assert not np.delete(maps.heights, groove, axis=0).any()
    assert not maps.blood.any()


def test_sixteen_bits_say_the_same(folder):
    picture = np.asarray(cv2.imread(str(folder / "au4.png"), cv2.IMREAD_GRAYSCALE))
    eight = read_face_maps(folder, 0.002)
    cv2.imwrite(str(folder / "au4.png"), picture.astype(np.uint16) * 257)
    assert np.array_equal(read_face_maps(folder, 0.002).heights, eight.heights)


def test_the_table_names_folder_depth_and_meshes(sidecar):
    face = sidecar('maps = "me_face"\ndepth_mm = 2.5\nmeshes = ["Head"]').face
    assert isinstance(face, FaceTable)
    assert face.maps.depth == pytest.approx(0.0025)
    assert face.meshes == ("Head",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("depth_mm = 2.0", "face.maps is missing; it must be a text"),
        ('maps = "me_face"\nheight = 1', "face.height"),
        (
            'maps = "me_face"\ndepth_mm = -1',
            "depth_mm must be a number from 0.001",
        ),
        ('maps = "me_face"\nmeshes = "Head"', "face.meshes must be a list"),
        ('maps = "me_face"\nscattering = -1', "must be a number of at least 0, not -1"),
        ('maps = "me_face"\nscattering = "much"', "must be a number of at least 0, not 'much'"),
        ('maps = "elsewhere"', "no picture of a face"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(sidecar, text, message):
    with pytest.raises(CharacterError, match=message) as refusal:
        sidecar(text)
    assert "\n" not in str(refusal.value)


def test_pictures_of_two_sizes_are_refused(folder):
    cv2.imwrite(str(folder / "blood.png"), np.zeros((8, 8), np.uint8))
    with pytest.raises(CharacterError, match="one size"):
        read_face_maps(folder, 0.002)


def test_a_file_that_is_no_picture_is_refused(folder):
    (folder / "blood.png").write_bytes(b"no picture")
    with pytest.raises(CharacterError, match="save it as PNG"):
        read_face_maps(folder, 0.002)


def test_a_mesh_without_texture_coordinates_is_refused(folder):
    table = FaceTable(read_face_maps(folder, 0.002), ("eyes",), 0.0)
    with pytest.raises(CharacterError, match="no mesh 'eyes' with texture coordinates"):
        table.on(Character.load("human").meshes, "me.toml")


def test_only_the_bundled_human_has_them():
    faces = {
        name: {mesh.name for mesh in Character.load(name).meshes if mesh.material.face is not None}
        for name in Character.bundled_names()
    }
    (skin,) = (mesh for mesh in Character.load("human").meshes if mesh.name == "explorer")
    assert skin.material.scattering == 1.0
    assert faces == {"human": {"explorer"}, "robot": set(), "vleo": set()}
