"""What is the same in all synthetic pictures of a desk, drawn once for all tests of a process.

Desk, noise and printed cube take longer than twenty pictures. They are never changed. Neither is
where a tracker looks for edges and for paper on a cube, which takes it as long as four frames.
"""

import functools
import pickle
from collections.abc import Iterator

import numpy as np
import pytest

from cubeling.tracking.appearance import patches
from cubeling.tracking.cube.edges import EdgeModel
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.synthetic import desk, exposure, paper_cube, source
from cubeling.tracking.synthetic.camera_rays import CameraRays
from tests.bench import hand_scenes

AT_MOST = 6
"""Number of desks kept, of 35 MB each."""

WOOD_AT_MOST = 4
"""Number of desks kept from above, of 80 MB each, for cameras that see the same one."""

CUBES_AT_MOST = 64
"""Number of cubes whose edges and paper are kept."""

_still_parts, _face_textures = exposure.still_parts, paper_cube.face_textures
_desk_texture, _white_points, _edges_of = desk.desk_texture, patches.white_points, EdgeModel.of
_CameraKey = tuple[tuple[int, int], bytes, bytes, bytes]


@pytest.fixture(scope="module", autouse=True)
def desks_are_drawn_once() -> Iterator[None]:
    """Let all tests share cameras, desks and printed cubes, instead of drawing them each time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(exposure, "still_parts", still_parts)
        patch.setattr(exposure, "desk_texture", desk_texture)
        patch.setattr(paper_cube, "face_textures", face_textures)
        patch.setattr(patches, "white_points", white_points)
        patch.setattr(EdgeModel, "of", staticmethod(edges_of))
        for module in (source, hand_scenes):
            patch.setattr(module, "CameraRays", camera_rays)
        yield


def still_parts(camera: CameraRays, seed: int, clutter: bool) -> tuple[Floats, Floats, Floats]:
    """Return what `exposure.still_parts` does, the same arrays every time."""
    return _kept_still_parts(_key(camera.intrinsics, camera.camera_from_table), seed, clutter)


def face_textures(cube: CubeModel, seed: int) -> dict[str, list[Floats]]:
    """Return what `paper_cube.face_textures` does, the same arrays every time."""
    return _kept_face_textures(_KeptCube(cube), seed)


def desk_texture(random: np.random.Generator, clutter: bool) -> Floats:
    """Return what `exposure.desk_texture` does, the same array every time."""
    texture, state = _kept_desk_texture(pickle.dumps(random.bit_generator.state), clutter)
    random.bit_generator.state = pickle.loads(state)
    return texture


def edges_of(cube: CubeModel) -> EdgeModel:
    """Return what `EdgeModel.of` does, the same arrays every time."""
    return _kept_edges(_KeptCube(cube))


def white_points(cube: CubeModel, face: Face) -> tuple[Array, float]:
    """Return what `patches.white_points` does, the same array every time."""
    return _kept_white_points(_KeptCube(cube), face.name)


def camera_rays(intrinsics: Intrinsics, camera_from_table: Array | None = None) -> CameraRays:
    """Return a camera, the same every time."""
    pose = np.eye(4) if camera_from_table is None else camera_from_table
    return _kept_camera(_key(intrinsics, pose))


class _KeptCube:
    """A cube; two are equal if all that is printed on their paper is, and where."""

    def __init__(self, cube: CubeModel) -> None:
        self.cube = cube
        faces = tuple(
            (f.name, f.marker_id, f.roll_deg, f.icon, f.corners.tobytes()) for f in cube.faces
        )
        self._key = cube.dictionary, cube.edge, cube.marker_size, faces

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _KeptCube) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


def _key(intrinsics: Intrinsics, camera_from_table: Array) -> _CameraKey:
    arrays = intrinsics.matrix, intrinsics.distortion, camera_from_table
    matrix, distortion, pose = (np.asarray(array, float).tobytes() for array in arrays)
    return intrinsics.size, matrix, distortion, pose


@functools.lru_cache(AT_MOST)
def _kept_camera(key: _CameraKey) -> CameraRays:
    size, *arrays = key
    matrix, distortion, pose = (np.frombuffer(array) for array in arrays)
    return CameraRays(Intrinsics(matrix.reshape(3, 3), distortion, size), pose.reshape(4, 4))


@functools.lru_cache(AT_MOST)
def _kept_still_parts(key: _CameraKey, seed: int, clutter: bool) -> tuple[Floats, Floats, Floats]:
    parts = _still_parts(_kept_camera(key), seed, clutter)
    for part in parts:
        part.setflags(write=False)
    return parts


@functools.lru_cache(WOOD_AT_MOST)
def _kept_desk_texture(state: bytes, clutter: bool) -> tuple[Floats, bytes]:
    random = np.random.default_rng()
    random.bit_generator.state = pickle.loads(state)
    texture = _desk_texture(random, clutter)
    texture.setflags(write=False)
    return texture, pickle.dumps(random.bit_generator.state)


@functools.lru_cache(CUBES_AT_MOST)
def _kept_edges(cube: _KeptCube) -> EdgeModel:
    edges = _edges_of(cube.cube)
    for array in vars(edges).values():
        array.setflags(write=False)
    return edges


@functools.lru_cache(6 * CUBES_AT_MOST)
def _kept_white_points(cube: _KeptCube, name: str) -> tuple[Array, float]:
    (face,) = (face for face in cube.cube.faces if face.name == name)
    points, clearance = _white_points(cube.cube, face)
    points.setflags(write=False)
    return points, clearance


@functools.lru_cache(AT_MOST)
def _kept_face_textures(cube: _KeptCube, seed: int) -> dict[str, list[Floats]]:
    return _face_textures(cube.cube, seed)
