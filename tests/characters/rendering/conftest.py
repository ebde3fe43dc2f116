"""A graphics context, a table under a camera, and a pawn to put on it."""

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.rendering import Box, CameraView, SceneCharacter, Stage, create_context
from cubeling.characters.skeleton.pose import Pose, Skeleton

Array = NDArray[np.float64]
SIZE = (320, 180)


@pytest.fixture(scope="session")
def _context() -> Iterator[moderngl.Context]:
    context = create_context()
    yield context
    context.release()


@pytest.fixture
def ctx(_context: moderngl.Context) -> Iterator[moderngl.Context]:
    """Yield the one context of all tests; a test that leaves a pending GL error behind fails.

    It is made current, as tests elsewhere create contexts of their own in the same process.
    """
    with _context:
        yield _context
        assert _context.error == "GL_NO_ERROR"


@pytest.fixture
def stage(ctx: moderngl.Context) -> Iterator[Stage]:
    stage = Stage(ctx, SIZE)
    yield stage
    stage.release()


@dataclass(frozen=True)
class Pawn:
    """A turned chess piece one metre high, with a joint in its foot and one in its neck."""

    meshes: tuple[Mesh, ...]
    skeleton: Skeleton
    morphs: tuple[str, ...] = ()

    def posed(
        self, bend: float = 0.0, at: tuple[float, float] = (0.0, 0.0), height: float = 0.12
    ) -> SceneCharacter:
        half = 0.5 * bend
        rotations = np.array([[0, 0, 0, 1], [0, 0, np.sin(half), np.cos(half)]], float)
        place = np.diag([height, height, height, 1.0])
        place[[0, 2], 3] = at
        pose = replace(self.skeleton.rest, rotations=rotations)
        return SceneCharacter(self, PosedCharacter(pose, place, True, "idle", 0.0, 0.0, 0.0, 0.0))


@pytest.fixture(scope="session")
def pawn() -> Pawn:
    radii = np.array([0.0, 0.26, 0.28, 0.2, 0.13, 0.1, 0.2, 0.11, 0.19, 0.21, 0.15, 0.0])
    heights = np.array([0.0, 0.0, 0.08, 0.16, 0.35, 0.6, 0.63, 0.66, 0.74, 0.83, 0.94, 1.0])
    around = np.linspace(0.0, 2.0 * np.pi, 33)
    ring = np.stack([np.cos(around), np.sin(around)], axis=-1)
    rows, columns = len(radii), len(around)
    positions = np.empty((rows, columns, 3))
    positions[..., [0, 2]] = radii[:, None, None] * ring
    positions[..., 1] = heights[:, None]
    rise, run = np.gradient(heights), np.gradient(radii)
    normals = np.empty_like(positions)
    normals[..., [0, 2]] = rise[:, None, None] * ring
    normals[..., 1] = -run[:, None]
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    quads = np.stack([corner, corner + columns, corner + columns + 1, corner + 1], axis=-1)
    upper = np.clip((heights - 0.45) / 0.25, 0.0, 1.0).repeat(columns)
    weights = np.zeros((rows * columns, 4))
    weights[:, 0], weights[:, 1] = 1.0 - upper, upper
    joints = np.zeros((rows * columns, 4), np.uint16)
    joints[:, 1] = 1
    bind = np.stack([np.eye(4), np.eye(4)])
    bind[1, 1, 3] = -0.55
    mesh = Mesh(
        name="pawn",
        positions=positions.reshape(-1, 3).astype(np.float32),
        normals=normals.reshape(-1, 3).astype(np.float32),
        triangles=np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint32),
        joints=joints,
        weights=weights.astype(np.float32),
        inverse_bind=bind,
        material=Material(base_color=(0.62, 0.11, 0.08, 1.0), roughness=0.45),
    )
    rest = Pose(np.array([[0, 0, 0], [0, 0.55, 0]], float), np.array([[0, 0, 0, 1]] * 2, float))
    return Pawn((mesh,), Skeleton(("foot", "neck"), (-1, 0), rest))


@pytest.fixture(scope="session")
def view() -> CameraView:
    """Return a grey table seen from above its front edge, without a cube."""
    return _table(SIZE)


@pytest.fixture(scope="session")
def hd_view() -> CameraView:
    return _table((1280, 720))


@pytest.fixture(scope="session")
def cube(view: CameraView) -> Box:
    """Return a cube of 6 cm that stands before the pawn's place, to its left."""
    assert view.camera_from_table is not None
    table_from_box = np.eye(4)
    table_from_box[:3, 3] = -0.055, 0.03, 0.07
    return Box(view.camera_from_table @ table_from_box, 0.06)


@pytest.fixture
def regenerate() -> bool:
    """Return whether golden pictures are to be written anew: `CUBELING_GOLDEN=write pytest …`."""
    return os.environ.get("CUBELING_GOLDEN") == "write"


def _table(size: tuple[int, int]) -> CameraView:
    width, height = size
    matrix = np.array(
        [[0.95 * width, 0, width / 2 - 0.5], [0, 0.95 * width, height / 2 - 0.5], [0, 0, 1]]
    )
    pitch = np.deg2rad(32.0)
    camera_from_table = np.eye(4)
    camera_from_table[:3, :3] = [
        [1, 0, 0],
        [0, -np.cos(pitch), np.sin(pitch)],
        [0, -np.sin(pitch), -np.cos(pitch)],
    ]
    camera_from_table[:3, 3] = 0.0, 0.05, 0.45
    image = np.full((height, width, 3), 150, np.uint8)
    image += (np.arange(width)[None, :, None] // 8 % 2 * 6).astype(np.uint8)
    return CameraView(image, matrix, np.zeros(5), camera_from_table)
