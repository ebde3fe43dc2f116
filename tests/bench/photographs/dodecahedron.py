"""The photographs of a hand-held dodecahedron: its shape and its poses by bundle adjustment.

The reference rests on lines along the markers' sides in all pictures together. It shares nothing
with the tracker but the pictures, and the algebra of `se3`.
"""

from dataclasses import dataclass
from functools import cache
from itertools import combinations
from pathlib import Path

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.cube.sides import Side
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from tests.bench.photographs.marker_corners import (
    Array,
    Picture,
    cell_edges,
    line_corners,
    opencv_corners,
    opencv_detector,
)

PHOTOGRAPHS = Path(__file__).parents[4] / "shared" / "data" / "photographs"
FOLDER = PHOTOGRAPHS / "dodecahedron"
DICTIONARY = "DICT_6X6_250"
MARKERS = (0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 11)
"""The twelfth holds the pen, and is never seen."""
SIDE = 0.020
"""Side of a marker's black square, which sets the scale [m]."""

ADJUSTMENT_STEPS, CORNER_ERROR_PX = 18, 0.2
"""Steps of the bundle adjustment, and the error of a corner from which on it loses weight [px]."""

NEAR = (0.005, np.deg2rad(10))
"""Two poses of one thing, each with the errors of a single small marker, are as near [m, rad]."""


@dataclass(frozen=True, eq=False)
class Reference:
    """What the corners of all pictures together say."""

    body_from_marker: Array
    """Where each of `MARKERS` lies, (11, 4, 4)."""

    camera_from_body: dict[int, Array]
    """Pose of the body in each picture that shows at least two markers, (4, 4)."""

    bloom: float
    """How far white grows over black at each side, by `measured_bloom` [px]."""

    error: float
    """Median distance of a corner from where it should be [px]."""


@cache
def paths() -> tuple[Path, ...]:
    """The photographs, in order."""
    return tuple(sorted(FOLDER.glob("*.jpg"), key=lambda path: int(path.stem.split("_")[1])))


@cache
def camera() -> Intrinsics:
    """The lens as its authors calibrated it."""
    return Intrinsics.load(FOLDER / "camera.yaml")


def photograph(number: int) -> Picture:
    """Picture `number` of `paths`, (H, W, 3) BGR."""
    return np.asarray(cv2.imread(str(paths()[number])), np.uint8)


@cache
def grey_photograph(number: int) -> Picture:
    """The same in grey, (H, W)."""
    return np.asarray(cv2.cvtColor(photograph(number), cv2.COLOR_BGR2GRAY), np.uint8)


@cache
def all_corners() -> tuple[dict[int, Array], ...]:
    """`line_corners` of every marker that OpenCV detects, in every photograph."""
    detector, found = opencv_detector(DICTIONARY, fine=True), []
    for number in range(len(paths())):
        grey = grey_photograph(number)
        squares = opencv_corners(detector, grey).items()
        lines = {each: line_corners(grey, square) for each, square in squares if each in MARKERS}
        found.append({each: square for each, square in lines.items() if square is not None})
    return tuple(found)


def square_points(side: float) -> Array:
    """Corners of a marker in its own frame, x right and y up, (4, 3) [m]."""
    return np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)]) * side / 2


def marker_poses(corners: Array, lens: Intrinsics, side: float = SIDE) -> list[Array]:
    """Both camera_from_marker by OpenCV's method for squares, the better one first, (4, 4)."""
    method = cv2.SOLVEPNP_IPPE_SQUARE
    points = square_points(side)
    found = cv2.solvePnPGeneric(points, corners, lens.matrix, lens.distortion, flags=method)
    pairs = zip(found[1], found[2], strict=True)
    return [se3.pose(se3.rotation(np.ravel(turn)), np.ravel(shift)) for turn, shift in pairs]


@cache
def measured_bloom() -> float:
    """How far white grows over black, by the edges of the cells inside all markers [px].

    The sizes of whole markers cannot tell it from their distance. Inside, black cells shrink and
    white cells grow.
    """
    table = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARY))
    edges = []
    for number, corners in enumerate(all_corners()):
        for marker, square in corners.items():
            bits = table.getBitsFromByteList(table.bytesList[marker : marker + 1], table.markerSize)
            edges += cell_edges(grey_photograph(number), square, np.pad(bits, 1).astype(np.float64))
    places, signs, shifts = np.array(edges).T
    # The corners are those of a marker of another size, perhaps to one side.
    columns = np.stack([signs, places, np.ones_like(places)], axis=1)
    weights = np.ones_like(places)
    for _ in range(ADJUSTMENT_STEPS):
        weighted = columns.T * weights
        solved = np.linalg.solve(weighted @ columns, weighted @ shifts)
        weights = 1 / (1 + ((shifts - columns @ solved) / CORNER_ERROR_PX) ** 2)
    return -float(solved[0])


@cache
def reference() -> Reference:
    """Adjust the body and all pictures together to the corners, robustly."""
    seen = {number: each for number, each in enumerate(all_corners()) if len(each) > 1}
    body = _first_body(seen)
    cameras = np.stack([_first_pose(corners, body) for corners in seen.values()])
    return _adjusted(seen, body, cameras)


def _first_body(seen: dict[int, dict[int, Array]]) -> Array:
    """Chain the markers by the most common relative poses of pairs, (11, 4, 4)."""
    relative: dict[tuple[int, int], list[Array]] = {}
    for corners in seen.values():
        poses = {marker: marker_poses(square, camera())[0] for marker, square in corners.items()}
        for one, other in combinations(poses, 2):
            pair = se3.inverse(poses[one]) @ poses[other]
            relative.setdefault((one, other), []).append(pair)
            relative.setdefault((other, one), []).append(se3.inverse(pair))
    found = {pair: medoid(each) for pair, each in relative.items()}
    body = {0: np.eye(4)}
    while len(body) < len(MARKERS):
        known = [pair for pair in found if pair[0] in body and pair[1] not in body]
        one, other = max(known, key=lambda pair: found[pair][1])
        body[other] = body[one] @ found[one, other][0]
    return np.stack([body[marker] for marker in MARKERS])


def medoid(poses: list[Array]) -> tuple[Array, int]:
    """The pose that most others are `NEAR` to, and how many."""
    counts = []
    for one in poses:
        deltas = np.array([se3.delta(one, other) for other in poses])
        shift, turn = np.linalg.norm(deltas[:, :3], axis=1), np.linalg.norm(deltas[:, 3:], axis=1)
        near = (shift < NEAR[0]) & (turn < NEAR[1])
        counts.append(np.count_nonzero(near) - float(shift[near].mean()) / NEAR[0])
    return poses[int(np.argmax(counts))], round(max(counts))


def _first_pose(corners: dict[int, Array], body: Array) -> Array:
    """The pose of the body that explains most corners of one picture, (4, 4)."""
    places = {marker: body[MARKERS.index(marker)] for marker in corners}
    poses = [
        pose @ se3.inverse(places[marker])
        for marker, square in corners.items()
        for pose in marker_poses(square, camera())
    ]

    def error(pose: Array) -> float:
        found = projected(pose @ np.stack(list(places.values())), camera())
        away = np.linalg.norm(found - np.stack(list(corners.values())), axis=2)
        return float(np.minimum(away, 10).mean())

    return min(poses, key=error)


def projected(camera_from_marker: Array, lens: Intrinsics, bloom: float = 0.0) -> Array:
    """Corners of markers in the image, (N, 4, 4) → (N, 4, 2) [px], with white grown over black."""
    rotations, origins = camera_from_marker[:, :3, :3], camera_from_marker[:, None, :3, 3]
    points = square_points(SIDE) @ np.swapaxes(rotations, 1, 2) + origins
    flat, none = points.reshape(-1, 3), np.zeros(3)
    pixels = cv2.projectPoints(flat, none, none, lens.matrix, lens.distortion)[0].reshape(-1, 4, 2)
    inward = np.zeros_like(pixels)
    for step in (-1, 1):
        side = np.roll(pixels, step, axis=1) - pixels
        inward += side / np.linalg.norm(side, axis=2, keepdims=True)
    return np.asarray(pixels + bloom * inward, np.float64)


def _adjusted(seen: dict[int, dict[int, Array]], body: Array, cameras: Array) -> Reference:
    """Adjust all poses by Gauss and Newton's method with Cauchy's weights."""
    squares = np.concatenate([list(corners.values()) for corners in seen.values()])
    pairs = [(place, m) for place, corners in enumerate(seen.values()) for m in corners]
    places, markers = np.array([(place, MARKERS.index(marker)) for place, marker in pairs]).T
    rows, count, step = np.arange(len(squares)), len(body) + len(cameras), 1e-6
    bloom = measured_bloom()

    def residual(body: Array, cameras: Array) -> Array:
        found = projected(cameras[places] @ body[markers], camera(), bloom)
        return np.asarray((found - squares).reshape(-1, 8), np.float64)

    for _ in range(ADJUSTMENT_STEPS):
        now = residual(body, cameras)
        # A corner depends on one marker and one picture: all others may move at once.
        jacobian = np.zeros((len(squares), 8, 6 * count))
        for axis, small in enumerate(step * np.eye(6)):
            by_body = residual(_moved(body, small), cameras)
            by_camera = residual(body, _moved(cameras, small))
            jacobian[rows, :, 6 * markers + axis] = (by_body - now) / step
            jacobian[rows, :, 6 * (len(body) + places) + axis] = (by_camera - now) / step
        away = np.linalg.norm(now.reshape(-1, 2), axis=1)
        weights = np.repeat(1 / (1 + (away / CORNER_ERROR_PX) ** 2), 2)
        # The first marker stays where it is.
        columns = jacobian.reshape(-1, 6 * count)[:, 6:]
        normal = (columns.T * weights) @ columns
        solved = -np.linalg.solve(normal, (columns.T * weights) @ now.ravel())
        deltas = solved.reshape(-1, 6)
        body[1:] = _moved(body[1:], deltas[: len(body) - 1])
        cameras = _moved(cameras, deltas[len(body) - 1 :])
    found = dict(zip(seen, cameras, strict=True))
    return Reference(body, found, bloom, float(np.median(away)))


def _moved(poses: Array, deltas: Array) -> Array:
    """`se3.moved` of each pose, (N, 4, 4), by its own delta, (N, 6), or by the same, (6,)."""
    each = np.broadcast_to(deltas, (len(poses), 6))
    return np.stack([se3.apply_delta(*both) for both in zip(poses, each, strict=True)])


def one_marker(number: int, side: float = SIDE) -> CubeModel:
    """A cube of which only the front has a marker, with a side [m]."""
    document = {
        "dictionary": DICTIONARY,
        "edge_mm": 1500 * side,
        "marker_mm": 1000 * side,
        "face": [{"name": "front", "marker_id": number}],
    }
    return CubeModel.from_document(document, "photograph", f"marker {number}")


@cache
def body_model() -> tuple[CubeModel, Array]:
    """The dodecahedron as a body that the tracker can follow, and `body_from_cube`, (4, 4)."""
    found = reference().body_from_marker
    normals, centres = found[:, :3, 2], found[:, :3, 3]
    # Every plane is equally far from the middle.
    rows = np.c_[normals, np.ones(len(found))]
    middle = np.linalg.lstsq(rows, (normals * centres).sum(axis=1), rcond=None)[0]
    frames = found.copy()
    frames[:, :3, 3] -= middle[:3]
    sides = _sides(frames, float(middle[3]))
    faces = tuple(
        Face(side.name, marker, square_points(SIDE) @ pose[:3, :3].T + pose[:3, 3], at=at)
        for marker, pose, (side, at) in zip(MARKERS, frames, sides, strict=False)
    )
    body = tuple(side for side, _ in sides)
    model = CubeModel("dodecahedron", DICTIONARY, 2 * float(middle[3]), SIDE, faces, body=body)
    return model, se3.pose(np.eye(3), middle[:3])


def _sides(frames: Array, height: float) -> list[tuple[Side, tuple[float, float]]]:
    """The twelve sides with the middles of their markers, by the frames of eleven markers.

    The twelfth side is opposite to the one to which no other is parallel.
    """
    normals = frames[:, :3, 2]
    alone = int(np.argmax((normals @ normals.T).min(axis=1)))
    pen = frames[alone].copy()
    pen[:3, 1:] *= -1
    frames = np.concatenate([frames, pen[None]])
    heights = np.einsum("ij,ij->i", frames[:, :3, 2], frames[:, :3, 3])
    sides = []
    for number, frame in enumerate(frames):
        outline = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * height
        others = [other for other in range(len(frames)) if other != number]
        for other in others:
            outline = _cut(outline, frame, frames[other, :3, 2], heights[other])
        x, y = outline.mean(axis=0)
        centred = frame.copy()
        centred[:3, 3] += frame[:3, :2] @ (x, y)
        name = f"face {(*MARKERS, 'of the pen')[number]}"
        sides.append((Side(name, centred, outline - (x, y)), (-float(x), -float(y))))
    return sides


def _cut(outline: Array, frame: Array, normal: Array, height: float) -> Array:
    """The part of an outline in the plane of a frame that is below another plane, (N, 2)."""
    points = outline @ frame[:3, :2].T + frame[:3, 3]
    above = points @ normal - height
    kept = []
    for number, here in enumerate(above):
        there, after = above[number - 1], outline[number]
        if (here > 0) != (there > 0):
            share = there / (there - here)
            kept.append(outline[number - 1] + share * (after - outline[number - 1]))
        if here <= 0:
            kept.append(after)
    return np.array(kept)
