"""Wrinkles of heads with ARKit's shapes and no sidecar file: where they are, and where none are."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.characters.model.arkit_wrinkles import (
    MAP_SIDE_PX,
    generic_face_maps,
    with_generic_wrinkles,
)
from cubeling.characters.model.face_maps import LAYER_NAMES
from cubeling.characters.model.mesh import Mesh, Morph

EYES_M = 0.064
"""Distance of the eyes of the head below [m]; its radius is as large as a head's."""

PLACES = {
    "eyeBlink": (0.0, 0.0),
    "browOuterUp": (0.1, 0.35),
    "mouthSmile": (-0.12, -1.05),
    "noseSneer": (-0.25, -0.6),
}
"""Where each shape moves the skin on the left: outwards of the eye, and above it [EYES_M]."""


def head(names=str, mirrored=False, fine=96) -> Mesh:
    """Return half a cylinder with ARKit's shapes; u runs around it, v down."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, fine), np.linspace(0.0, 1.0, fine))
    turn, y = (u - 0.5) * np.pi, 1.7 + (0.5 - v) * 4.0 * EYES_M
    radius = 1.25 * EYES_M
    outward = np.stack([np.sin(turn), 0.0 * turn, np.cos(turn)], axis=-1)
    points = radius * outward + np.stack([0.0 * y, y, 0.0 * y], axis=-1)
    first = (np.arange(fine - 1)[:, None] * fine + np.arange(fine - 1)).ravel()
    quads = np.stack([first, first + fine, first + fine + 1, first + 1], axis=-1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    around = radius * turn / EYES_M
    morphs = []
    for name, (outwards, above) in PLACES.items():
        for side, sign in (("Left", 1.0), ("Right", -1.0)):
            off = np.hypot(sign * around - 0.5 - outwards, (y - 1.7) / EYES_M - above)
            moved = np.flatnonzero(off < 0.15)
            push = np.outer(np.exp(-((off.ravel()[moved] / 0.1) ** 2)), [0.0, 0.004, 0.0])
            morphs.append(Morph(names(name + side), moved.astype(np.uint32), push.astype("f4")))
    if mirrored:
        u = np.abs(2.0 * u - 1.0)
    count = fine * fine
    return Mesh(
        name="head",
        positions=points.reshape(-1, 3).astype(np.float32),
        normals=outward.reshape(-1, 3).astype(np.float32),
        triangles=triangles.astype(np.uint32),
        joints=np.zeros((count, 4), np.uint16),
        weights=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)).astype(np.float32),
        inverse_bind=np.eye(4)[None],
        uvs=np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32),
        morphs=tuple(morphs),
    )


@pytest.fixture(scope="module")
def maps():
    found = generic_face_maps(head())
    assert found is not None
    return found


def middle_of(layer):
    """Return where a layer is painted: to the left of the middle, and above the eyes [EYES_M]."""
    rows, columns = np.nonzero(np.abs(layer) > 0.1)
    turn = (columns.mean() / MAP_SIDE_PX - 0.5) * np.pi
    return 1.25 * turn, (0.5 - rows.mean() / MAP_SIDE_PX) * 4.0


def test_each_unit_wrinkles_its_own_part_of_a_face(maps):
    places = {name: middle_of(layer) for name, layer in zip(LAYER_NAMES, maps.heights, strict=True)}
    assert abs(places["au1"][0]) < 0.1
    assert places["au1"][1] > PLACES["browOuterUp"][1] + 0.2
    assert abs(places["au4"][0]) < 0.1
    assert abs(places["au4"][1] - PLACES["browOuterUp"][1]) < 0.3
    assert places["au6_left"][0] > 0.5 + 0.3
    assert abs(places["au6_left"][1]) < 0.2
    for unit in ("au10", "au12", "au20"):
        across, above = places[f"{unit}_left"]
        assert 0.2 < across < 0.8
        assert -1.4 < above < PLACES["noseSneer"][1] + 0.1
    for unit in ("au2", "au6", "au10", "au12", "au20"):
        left, right = places[f"{unit}_left"], places[f"{unit}_right"]
        assert left == pytest.approx((-right[0], right[1]), abs=0.05)


def test_no_smile_is_as_deep_as_a_frown(maps):
    deepest = dict(zip(LAYER_NAMES, -maps.heights.min(axis=(1, 2)), strict=True))
    assert max(deepest["au6_left"], deepest["au12_left"]) < 0.75 * deepest["au4"]
    assert maps.depth < 0.04 * EYES_M


@pytest.mark.parametrize("names", [str.lower, lambda name: name[:-4] + "_L"])
def test_names_of_shapes_may_be_written_in_other_ways(names):
    written = head(lambda name: name.replace("Right", "_R") if names("xLeft") != "xleft" and
                   name.endswith("Right") else names(name))  # fmt: skip
    assert generic_face_maps(written) is not None


def test_a_face_whose_halves_share_a_texture_has_none():
    assert generic_face_maps(head(mirrored=True)) is None


def test_without_arkit_shapes_meshes_stay_as_they_are():
    plain = replace(head(), morphs=())
    assert with_generic_wrinkles([plain]) == (plain,)
    assert with_generic_wrinkles([head(), plain])[0].material.face is not None
