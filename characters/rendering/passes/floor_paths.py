"""Paths painted on the table: discs, a ring, and dashes between them."""

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.passes.render_pass import RegionPass
from characters.rendering.programs import ShaderPrograms, set_uniforms
from characters.rendering.projection import merge_rectangles
from characters.rendering.resources import FrameResources, Region
from characters.rendering.scene import FloorPath
from characters.skeleton.pose import Array

POINT_RADIUS_M, HIGHLIGHT_RADIUS_M = 0.005, 0.0075
"""Radii of a point, and of the highlighted one [m]."""

RING_RADII_M = (0.0105, 0.0125)
"""Inner and outer radius of the ring around the highlighted point [m]."""

DASH_M, GAP_M, DASH_WIDTH_M = 0.011, 0.008, 0.0028
"""Length of a dash, of the gap after it, and width of a dash [m]."""

CLEARANCE_M = 0.006
"""Distance between a disc and the first dash [m]."""


class FloorPathPass(RegionPass):
    """Paints the floor paths on the table."""

    def __init__(self, context: moderngl.Context, programs: ShaderPrograms) -> None:
        self._buffer = context.buffer(reserve=1 << 14, dynamic=True)
        content = [(self._buffer, "2f 2f 3f 3f", "position", "local", "shape", "color")]
        self._arrays = [
            context.vertex_array(programs.load("floor_paths", "floor_paths", *defines), content)
            for defines in ((), ("HIDDEN",))
        ]
        self._count = 0
        self.owned = (*self._arrays, self._buffer)

    def prepare(self, frame: FrameResources) -> None:
        """Upload the paths, and find the areas around them; what lies between is left out."""
        marks = [mark for path in frame.scene.floor for mark in _marks(path)]
        self._count = sum(len(mark) for mark in marks)
        self.areas = ()
        if self._count == 0:
            return
        vertices = np.concatenate(marks)
        if vertices.nbytes > self._buffer.size:
            self._buffer.orphan(2 * vertices.nbytes)
        self._buffer.write(vertices)
        areas = [
            frame.area_of(np.insert(mark[:, :2].astype(float), 1, 0.0, axis=1)) for mark in marks
        ]
        self.areas = merge_rectangles([area for area in areas if area is not None])

    def draw(self, frame: FrameResources, region: Region) -> None:
        """Paint the paths, except where real cubes or a hand hide them."""
        region.use()
        frame.context.enable_only(moderngl.BLEND)
        frame.context.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA
        array = self._arrays[region.hidden is not None]
        region.set_table_uniforms(array.program)
        set_uniforms(array.program, light=frame.light.white)
        array.render(moderngl.TRIANGLES, vertices=self._count)


def _marks(path: FloorPath) -> list[NDArray[np.float32]]:
    """Return the vertices of each point and of each dashed segment of a path.

    Each is (n, 10): position, position in the mark, shape, linear colour.
    """
    points = np.asarray(path.points, float).reshape(-1, 2)
    points = points[np.isfinite(points).all(axis=1)]
    highlighted = np.arange(len(points)) == (-1 if path.highlight is None else path.highlight)
    discs = np.zeros((len(points), 7))
    discs[:, 0:2], discs[:, 2] = points, 1.0
    discs[:, 5] = np.where(highlighted, HIGHLIGHT_RADIUS_M, POINT_RADIUS_M)
    rings = discs[highlighted]
    rings[:, 6], rings[:, 5] = RING_RADII_M
    segments = _dashes(points, path.closed, highlighted)
    color = np.asarray(path.color, float) ** 2.2
    marks = (*discs[:, None], rings, *segments)
    return [_quads(capsules, color) for capsules in marks if len(capsules)]


def _dashes(points: Array, closed: bool, highlighted: NDArray[np.bool_]) -> list[Array]:
    """Return the dashes of each segment as capsules, (n, 7).

    Centre and direction on the table, half length, radius, radius of the hole.
    """
    count = len(points)
    segments = [(i, (i + 1) % count) for i in range(count if closed and count > 2 else count - 1)]
    clearance = np.where(highlighted, RING_RADII_M[1], POINT_RADIUS_M) + CLEARANCE_M
    dashes = []
    for start, end in segments:
        step = points[end] - points[start]
        length = float(np.linalg.norm(step))
        free = length - clearance[start] - clearance[end]
        number = int((free + GAP_M) // (DASH_M + GAP_M))
        if number < 1:
            continue
        along = step / length
        # Half of the remainder is left free before the first dash, half after the last.
        remainder = free - number * DASH_M - (number - 1) * GAP_M
        first = clearance[start] + 0.5 * remainder + 0.5 * DASH_M
        centers = points[start] + along * (first + (DASH_M + GAP_M) * np.arange(number))[:, None]
        shape = np.tile(
            [*along, 0.5 * (DASH_M - DASH_WIDTH_M), 0.5 * DASH_WIDTH_M, 0.0], (number, 1)
        )
        dashes.append(np.hstack([centers, shape]))
    return dashes


def _quads(capsules: Array, color: Array) -> NDArray[np.float32]:
    """Return two triangles around each capsule, with a margin for its soft edge."""
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)], float)
    local = 1.3 * capsules[:, None, 5:6] * corner
    local[..., 0] += capsules[:, None, 4] * corner[:, 0]
    along = capsules[:, None, 2:4]
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    position = capsules[:, None, :2] + local[..., :1] * along + local[..., 1:] * across
    shape = np.broadcast_to(capsules[:, None, 4:7], (*position.shape[:2], 3))
    colors = np.broadcast_to(color, (*position.shape[:2], 3))
    vertices = np.concatenate([position, local, shape, colors], axis=-1)
    return vertices.reshape(-1, 10).astype(np.float32)
