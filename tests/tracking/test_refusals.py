"""What looks like the cube and is not is refused, or reported correctly, over several frames.

All pictures are drawn here, without the tracker's own code.
"""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking.cube.faces import face_frame
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState
from tests.examples import some
from tests.tracking.showing import watch

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
Cells = NDArray[np.bool_]

CUBE = CubeModel.load("locomotion")
CAMERA = Intrinsics(
    np.array([[600.0, 0, 319.5], [0, 600.0, 239.5], [0, 0, 1]]), np.zeros(5), (640, 480)
)
BLACK = {face.name: marker_cells(CUBE.dictionary, face.marker_id) for face in CUBE.faces}
SUBSAMPLES_PER_PIXEL, FACE_TEXELS = 4, 160
"""Subsamples along a pixel, and samples along an edge of the cube's face."""


def paper(black: Cells) -> Picture:
    """One face of the cube from outside, (FACE_TEXELS, FACE_TEXELS)."""
    side = round(FACE_TEXELS * CUBE.marker_size / CUBE.edge)
    marker = cv2.resize(black.astype(np.uint8), (side, side), interpolation=cv2.INTER_NEAREST)
    edge = (FACE_TEXELS - side) // 2
    return np.asarray(225 - 200 * np.pad(marker, edge), np.uint8)


def lay(canvas: Picture, texture: Picture, corners: Array) -> None:
    """Lay a texture over three corners in space, top-left, top-right, bottom-left, (3, 3) [m]."""
    height, width = texture.shape
    first, right, down = corners[0], corners[1] - corners[0], corners[2] - corners[0]
    # Texel (0, 0) has its centre half a texel inside.
    plane = np.stack([right / width, down / height, first + (right / width + down / height) / 2])
    finer = np.array(
        [
            [SUBSAMPLES_PER_PIXEL, 0, (SUBSAMPLES_PER_PIXEL - 1) / 2],
            [0, SUBSAMPLES_PER_PIXEL, (SUBSAMPLES_PER_PIXEL - 1) / 2],
            [0, 0, 1.0],
        ]
    )
    outline = finer @ CAMERA.matrix @ np.vstack([corners, corners[1] + corners[2] - corners[0]]).T
    pixels = outline[:2] / outline[2]
    rows, columns = canvas.shape
    left, top = np.clip(pixels.min(axis=1).astype(int) - 2, 0, (columns, rows)).tolist()
    end, bottom = np.clip(pixels.max(axis=1).astype(int) + 3, 0, (columns, rows)).tolist()
    part = canvas[top:bottom, left:end]
    shifted = np.array([[1, 0, -left], [0, 1, -top], [0, 0, 1.0]])
    homography = shifted @ finer @ CAMERA.matrix @ plane.T
    size = (end - left, bottom - top)
    drawn = cv2.warpPerspective(texture, homography, size, flags=cv2.INTER_LINEAR)
    solid = np.full_like(texture, 255)
    inside = cv2.warpPerspective(solid, homography, size, flags=cv2.INTER_NEAREST) > 0
    part[inside] = drawn[inside]


def empty() -> Picture:
    return np.full((480 * SUBSAMPLES_PER_PIXEL, 640 * SUBSAMPLES_PER_PIXEL), 110, np.uint8)


def exposed(canvas: Picture, seed: int = 1) -> Picture:
    """Bring a canvas to the size of the picture, with the lens's blur and noise, (480, 640, 3)."""
    small = cv2.resize(canvas, (640, 480), interpolation=cv2.INTER_AREA).astype(np.float64)
    noise = np.random.default_rng(seed).normal(0, 1.5, small.shape)
    seen = cv2.GaussianBlur(small, (0, 0), 0.7) + noise
    grey = np.clip(np.rint(seen), 0, 255).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)


def turned(x: float, y: float, z: float, at: tuple[float, float, float]) -> Array:
    """Pose (4, 4): turns about the axes [rad], in the order y, x, z, and a place [m]."""
    turns = [se3.rotation(angle * axis) for angle, axis in zip((x, y, z), np.eye(3), strict=True)]
    return se3.pose(turns[2] @ turns[0] @ turns[1], np.array(at))


def tilted(
    x: float = 0.5, y: float = 0.6, z: float = 0.1, at: tuple[float, float, float] = (0, 0, 0.4)
) -> Array:
    """A cube of which the camera sees three faces."""
    return turned(x, y, z, at) @ np.diag([1.0, -1.0, -1.0, 1.0])


def add_cube(
    canvas: Picture, pose: Array, cube: CubeModel = CUBE, cells: dict[str, Cells] | None = None
) -> Picture:
    """Draw a cube; `cells` may give faces another marker."""
    cells = cells or {}
    for face in cube.faces:
        grown = face.corners.mean(axis=0)
        grown = grown + (face.corners - grown) * cube.edge / cube.marker_size
        corners = grown @ pose[:3, :3].T + pose[:3, 3]
        if (pose[:3, :3] @ face.normal) @ corners.mean(axis=0) < 0:
            black = cells.get(face.name, marker_cells(cube.dictionary, face.marker_id))
            lay(canvas, paper(black), corners[[0, 1, 3]])
    return canvas


def add_sheet(canvas: Picture, pose: Array, cells: dict[tuple[int, int], Cells]) -> Picture:
    """Draw faces side by side in a plane, at (column, row), the origin in their middle."""
    columns, rows = (max(place[axis] for place in cells) + 1 for axis in (0, 1))
    sheet = np.full((rows * FACE_TEXELS, columns * FACE_TEXELS), 225, np.uint8)
    for (column, row), black in cells.items():
        sheet[
            row * FACE_TEXELS : (row + 1) * FACE_TEXELS,
            column * FACE_TEXELS : (column + 1) * FACE_TEXELS,
        ] = paper(black)
    x, y = columns * CUBE.edge / 2, rows * CUBE.edge / 2
    corners = np.array([(-x, -y, 0), (x, -y, 0), (-x, y, 0)])
    lay(canvas, sheet, corners @ pose[:3, :3].T + pose[:3, 3])
    return canvas


def watched(picture: Picture, cube: CubeModel = CUBE) -> list[CubeState]:
    return watch(picture, cube, CAMERA)


def off(state: CubeState, *truths: Array) -> float:
    """Distance to the nearest of several cubes [m]; 1 m for a turn of more than 10°."""
    assert state.camera_from_cube is not None
    steps = [se3.delta(state.camera_from_cube, truth) for truth in truths]
    return min(
        float(np.linalg.norm(step[:3])) if np.linalg.norm(step[3:]) < np.deg2rad(10) else 1.0
        for step in steps
    )


VIEWS = [(0.5, 0.6, 0.1), (0.8, -0.5, 0.4), (0.4, 2.2, -0.3), (-0.6, 0.7, 1.0)]


@pytest.mark.parametrize("view", some([(view,) for view in VIEWS]))
def test_the_cube_itself_is_seen_in_these_drawings(view: tuple[float, float, float]) -> None:
    """Or the refusals below would prove nothing."""
    pose = tilted(*view)
    states = watched(exposed(add_cube(empty(), pose)))
    assert all(state.visible for state in states)
    assert max(off(state, pose) for state in states) < 0.0005


@pytest.mark.parametrize("view", some([(view,) for view in VIEWS]))
def test_another_cube_is_not_seen(view: tuple[float, float, float]) -> None:
    other = CubeModel.load("companion")
    picture = exposed(add_cube(empty(), tilted(*view), other))
    assert all(state.visible for state in watched(picture, other))
    assert not any(state.visible for state in watched(picture))


@pytest.mark.parametrize("view", some([(view,) for view in VIEWS]))
def test_a_cube_in_a_mirror_is_not_seen(view: tuple[float, float, float]) -> None:
    picture = exposed(add_cube(empty(), tilted(*view)))
    for axis in (0, 1):
        mirrored = np.ascontiguousarray(np.flip(picture, axis))
        assert not any(state.visible for state in watched(mirrored))


SWAPPED = {"front": "top", "top": "front", "left": "bottom", "bottom": "left"}
SWAPPED |= {"right": "back", "back": "right"}


@pytest.mark.parametrize("view", some([(view,) for view in VIEWS]))
def test_of_a_cube_with_its_markers_on_other_faces_no_two_are_mixed(
    view: tuple[float, float, float],
) -> None:
    """What is reported lies where one of its markers says, never between two that disagree."""
    pose = tilted(*view)
    cells = {name: BLACK[marker] for name, marker in SWAPPED.items()}
    cubes = [
        pose @ face_frame(CUBE.face(name)) @ se3.inverse(face_frame(CUBE.face(marker)))
        for name, marker in SWAPPED.items()
    ]
    for state in watched(exposed(add_cube(empty(), pose, cells=cells))):
        assert not state.visible or off(state, *cubes) < 0.005


def test_of_two_cubes_with_the_same_markers_one_is_seen_whole() -> None:
    here, there = tilted(at=(-0.09, 0, 0.4)), tilted(0.4, 2.2, -0.3, at=(0.09, 0, 0.4))
    picture = exposed(add_cube(add_cube(empty(), here), there))
    for state in watched(picture):
        assert not state.visible or off(state, here, there) < 0.001


def test_a_marker_with_one_wrong_bit_is_not_the_cubes() -> None:
    """A sheet with it alone: some dictionary may hold it."""
    for row, column in ((1, 1), (2, 3), (4, 4)):
        cells = BLACK["front"].copy()
        cells[row, column] ^= True
        for lean in (0.0, -0.5):
            pose = turned(lean, 0.3, 0.1, (0, 0, 0.3))
            picture = exposed(add_sheet(empty(), pose, {(0, 0): cells}))
            assert not any(state.visible for state in watched(picture))


def test_one_wrong_bit_on_one_face_leaves_the_cube_where_it_is() -> None:
    for name in BLACK:
        cells = BLACK[name].copy()
        cells[2, 2] ^= True
        pose = tilted()
        for state in watched(exposed(add_cube(empty(), pose, cells={name: cells}))):
            assert not state.visible or off(state, pose) < 0.001


LEANS = [(lean, second) for lean in (-0.3, 0.0, -0.8, -1.1) for second in ("right", "back")]
"""How far a sheet leans [rad], and the second of its markers."""


@pytest.mark.parametrize(("lean", "second"), some(LEANS, 2))
def test_two_markers_in_one_plane_are_not_a_cube(lean: float, second: str) -> None:
    pose = turned(lean, 0.2, 0.1, (0, 0, 0.4))
    picture = add_sheet(empty(), pose, {(0, 0): BLACK["front"], (1, 0): BLACK[second]})
    assert not any(state.visible for state in watched(exposed(picture)))


NET = {(1, 0): "top", (0, 1): "left", (1, 1): "front", (2, 1): "right", (3, 1): "back"}
NET |= {(1, 2): "bottom"}

FLAT = (-0.9, 0.2, 0.4), (0, 0, 0), (-0.5, 0, 0), (0.3, 0.6, 0.8), (-1.1, 0, 0)
"""Turns of the sheet."""


@pytest.mark.parametrize(
    "view",
    some([((x, y, z),) for x, y, z in FLAT]),
)
def test_the_flat_sheet_is_not_a_cube(view: tuple[float, float, float]) -> None:
    """At most one of its six markers is taken for the only visible one of a cube."""
    pose = turned(*view, (0, 0, 0.5))
    sheet = {place: BLACK[name] for place, name in NET.items()}
    cubes = []
    for (column, row), name in NET.items():
        shift = np.array([(column - 1.5) * CUBE.edge, (row - 1.0) * CUBE.edge, 0.0])
        there = pose @ se3.pose(np.eye(3), shift)
        cubes.append(there @ se3.inverse(face_frame(CUBE.face(name))))
    for state in watched(exposed(add_sheet(empty(), pose, sheet))):
        assert len(state.faces) <= 1
        assert not state.visible or off(state, *cubes) < 0.005


def on_a_screen(picture: Picture, pose: Array, width: float = 0.14) -> Picture:
    """Show a picture on a screen of some width [m] that lies at `pose`, and take its picture."""
    x, y = width / 2, width / 2 * picture.shape[0] / picture.shape[1]
    corners = np.array([(-x, -y, 0), (x, -y, 0), (-x, y, 0)])
    canvas = empty()
    screen = np.asarray(cv2.resize(picture[..., 0], None, fx=2, fy=2), np.uint8)
    lay(canvas, screen, corners @ pose[:3, :3].T + pose[:3, 3])
    return exposed(canvas)


TURNS = [(0, 0.5, 0), (0.5, 0.3, 0.2), (0, -0.8, 0)]
SCREENS = [(VIEWS[i % 4], TURNS[i % 3]) for i in range(12)]
"""Every cube on a screen that is turned in every way; the first runs in every change."""


@pytest.mark.parametrize(("view", "turn"), some(SCREENS))
def test_a_cube_on_a_screen_seen_from_the_side_is_refused(
    view: tuple[float, float, float], turn: tuple[float, float, float]
) -> None:
    shown = exposed(add_cube(empty(), tilted(*view, at=(0, 0, 0.25))))
    picture = on_a_screen(shown, turned(*turn, (0, 0, 0.17)))
    assert not any(state.visible for state in watched(picture))
