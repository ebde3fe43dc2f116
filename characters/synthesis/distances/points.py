"""The distance of Kovar et al.: clouds of points, aligned on the ground."""

import numpy as np

from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.distances.distance import Block
from cubeling.characters.synthesis.library import Frames, MotionLibrary

WINDOW_S = 1 / 3
"""Length of motion that a frame stands for [s]; it makes velocities count."""

WINDOW_FRAMES = 5
"""Frames of the window whose points are compared."""


class PointClouds:
    """min over θ, x₀, z₀ of Σ w_i |p_i − T p'_i|², in m²; a `FrameDistance`.

    Kovar, Gleicher and Pighin, "Motion graphs", SIGGRAPH 2002 (S26, T 2.24 to 2.27). The points are
    the joints in a window that starts at the frame. About their centres, the best turn of the
    points x + iz maximises |Σ w x̄ x'|, so all distances are two real matrix products. The weights
    are equal and sum to one.
    """

    def __init__(self, library: MotionLibrary, joints: tuple[int, ...] | None = None) -> None:
        chosen = list(range(len(library.skeleton))) if joints is None else list(joints)
        points = windows(library, chosen)
        self._points = points
        self._centres = points[..., [0, 2]].mean(1)
        ground = points[..., [0, 2]] - self._centres[:, None]
        self._ground = (ground[..., 0] + 1j * ground[..., 1]) / np.sqrt(points.shape[1])
        self._heights = points[..., 1] / np.sqrt(points.shape[1])
        self._norms = np.square(np.abs(self._ground)).sum(1) + np.square(self._heights).sum(1)
        self._ground_blocks = self._ground.astype(np.complex64)
        self._height_blocks = self._heights.astype(np.float32)

    def __len__(self) -> int:
        return len(self._norms)

    def block(self, rows: Frames, columns: Frames) -> Block:
        """Return the distances of frames to frames."""
        turned: Block = np.abs(self._ground_blocks[rows].conj() @ self._ground_blocks[columns].T)
        turned += self._height_blocks[rows] @ self._height_blocks[columns].T
        turned *= -2.0
        turned += self._norms[rows, None].astype(np.float32)
        turned += self._norms[columns].astype(np.float32)
        np.maximum(turned, 0.0, out=turned)
        return turned

    def pairs(self, a: Frames, b: Frames) -> Array:
        """Return the distances of frames to frames, one to one."""
        product = np.einsum("ij,ij->i", self._ground[a].conj(), self._ground[b])
        turn = np.where(np.abs(product) > 0, product / np.maximum(np.abs(product), 1e-300), 1.0)
        ground = self._ground[a] * turn[:, None] - self._ground[b]
        rises = self._heights[a] - self._heights[b]
        total: Array = np.square(np.abs(ground)).sum(1) + np.square(rises).sum(1)
        return total

    def alignment(self, a: int, b: int) -> RootDelta:
        """Return where frame b's root is best placed in the frame of a's root (T 2.25 to 2.27)."""
        product = complex(np.vdot(self._ground[b], self._ground[a]))
        # x + iz turns the other way than yaw, which leads from z to x.
        yaw = -float(np.angle(product))
        x, z = self._centres[b].tolist()
        turned = RootDelta(yaw=yaw).then(RootDelta(x, z))
        centre_x, centre_z = self._centres[a].tolist()
        return RootDelta(centre_x - turned.x, centre_z - turned.z, yaw)


def windows(library: MotionLibrary, joints: list[int]) -> Array:
    """Return the points of each frame's window, (frames, points, 3) [m], in the frame's own axes.

    At the end of a clip the last frame stands still.
    """
    stride = max(round(WINDOW_S * library.rate / (WINDOW_FRAMES - 1)), 1)
    frames = np.arange(len(library))
    x, z, yaw = np.zeros((3, len(library)))
    clouds = []
    for offset in range(stride * (WINDOW_FRAMES - 1) + 1):
        if offset % stride == 0:
            own = library.positions[frames][:, joints]
            sine, cosine = np.sin(yaw)[:, None], np.cos(yaw)[:, None]
            across = cosine * own[..., 0] + sine * own[..., 2] + x[:, None]
            ahead = cosine * own[..., 2] - sine * own[..., 0] + z[:, None]
            clouds.append(np.stack([across, own[..., 1], ahead], axis=-1))
        step = np.where((library.successors[frames] < 0)[:, None], 0.0, library.steps[frames])
        sine, cosine = np.sin(yaw), np.cos(yaw)
        x = x + cosine * step[:, 0] + sine * step[:, 1]
        z = z - sine * step[:, 0] + cosine * step[:, 1]
        yaw = yaw + step[:, 2]
        frames = library.onward(frames, 1)
    return np.concatenate(clouds, axis=1)
