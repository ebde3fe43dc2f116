"""Paths painted on the table: discs, a ring, and dashes between them."""

from collections.abc import Sequence

import moderngl
import numpy as np
from numpy.typing import NDArray

from characters.rendering.passes.cubes import Outlines
from characters.rendering.programs import Programs, assign
from characters.rendering.scene import FloorPath

Array = NDArray[np.float64]

DISC, LARGE_DISC = 0.005, 0.0075
"""Radii of a point, and of the highlighted one [m]."""

RING = (0.0105, 0.0125)
"""Inner and outer radius of the ring around the highlighted point [m]."""

DASH, GAP, WIDTH = 0.011, 0.008, 0.0028
"""Length of a dash, of the gap after it, and its width [m]."""

CLEAR = 0.006
"""Between a disc and the first dash [m]."""


class FloorMarks:
    """Draws floor paths.

    Parameters
    ----------
    context, programs
        Where to draw.
    """

    def __init__(self, context: moderngl.Context, programs: Programs) -> None:
        self._program = programs.marks
        self._buffer = context.buffer(reserve=1 << 14, dynamic=True)
        self._array = context.vertex_array(
            programs.marks, [(self._buffer, "2f 2f 3f 3f", "position", "local", "shape", "color")]
        )
        self._count = 0

    def lay(self, paths: Sequence[FloorPath]) -> list[Array]:
        """Take the paths of this picture.

        Returns
        -------
        list of NDArray
            For each run of marks the points around it in the table frame, (n, 3): what lies between
            runs need not be drawn.
        """
        runs = [run for path in paths for run in _runs(path)]
        self._count = sum(len(run) for run in runs)
        if self._count == 0:
            return []
        vertices = np.concatenate(runs)
        if vertices.nbytes > self._buffer.size:
            self._buffer.orphan(2 * vertices.nbytes)
        self._buffer.write(vertices)
        return [np.insert(run[:, :2].astype(float), 1, 0.0, axis=1) for run in runs]

    def draw(self, clip_from_table: Array, white: Array, outlines: Outlines) -> None:
        """Paint the marks into the framebuffer in use, but where `outlines` of cubes hide them."""
        if self._count:
            assign(self._program, clip_from_table=clip_from_table, light=white)
            assign(self._program, cubes=outlines.count, longest=outlines.longest)
            assign(self._program, outlines=outlines.sides)
            self._array.render(moderngl.TRIANGLES, vertices=self._count)

    def release(self) -> None:
        """Give the card's memory back; a second call does nothing."""
        self._array.release()
        self._buffer.release()


def _runs(path: FloorPath) -> list[NDArray[np.float32]]:
    """Return the vertices of each point and of each leg of a path.

    Each is (n, 10): position, place in the mark, shape, linear colour.
    """
    points = np.asarray(path.points, float).reshape(-1, 2)
    points = points[np.isfinite(points).all(axis=1)]
    chosen = np.arange(len(points)) == (-1 if path.highlight is None else path.highlight)
    discs = np.zeros((len(points), 7))
    discs[:, 0:2], discs[:, 2], discs[:, 5] = points, 1.0, np.where(chosen, LARGE_DISC, DISC)
    rings = discs[chosen]
    rings[:, 6], rings[:, 5] = RING
    legs = _dashes(points, path.closed, chosen)
    color = np.asarray(path.color, float) ** 2.2
    return [
        _quads(capsules, color) for capsules in (*discs[:, None], rings, *legs) if len(capsules)
    ]


def _dashes(points: Array, closed: bool, chosen: NDArray[np.bool_]) -> list[Array]:
    """Return the dashes of each leg as capsules, (n, 7).

    Centre and direction on the table, half length, radius, radius of the hole.
    """
    count = len(points)
    legs = [(i, (i + 1) % count) for i in range(count if closed and count > 2 else count - 1)]
    clear = np.where(chosen, RING[1], DISC) + CLEAR
    dashes = []
    for start, end in legs:
        step = points[end] - points[start]
        length = float(np.linalg.norm(step))
        room = length - clear[start] - clear[end]
        number = int((room + GAP) // (DASH + GAP))
        if number < 1:
            continue
        along = step / length
        # What is left over stands half before the first dash and half after the last.
        first = clear[start] + 0.5 * (room - number * DASH - (number - 1) * GAP) + 0.5 * DASH
        middles = points[start] + along * (first + (DASH + GAP) * np.arange(number))[:, None]
        shape = np.tile([*along, 0.5 * (DASH - WIDTH), 0.5 * WIDTH, 0.0], (number, 1))
        dashes.append(np.hstack([middles, shape]))
    return dashes


def _quads(capsules: Array, color: Array) -> NDArray[np.float32]:
    """Return two triangles around each capsule, with a rim for its soft edge."""
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, -1), (1, 1), (-1, 1)], float)
    reach = 1.3 * capsules[:, None, 5:6] * corner
    reach[..., 0] += capsules[:, None, 4] * corner[:, 0]
    along = capsules[:, None, 2:4]
    across = np.stack([-along[..., 1], along[..., 0]], axis=-1)
    position = capsules[:, None, :2] + reach[..., :1] * along + reach[..., 1:] * across
    shape = np.broadcast_to(capsules[:, None, 4:7], (*position.shape[:2], 3))
    paint = np.broadcast_to(color, (*position.shape[:2], 3))
    vertices = np.concatenate([position, reach, shape, paint], axis=-1)
    return vertices.reshape(-1, 10).astype(np.float32)
