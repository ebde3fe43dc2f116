"""Scenes of the benchmark: procedural ones of metres, and bundled characters on a table."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from cubeling.characters.model.character import Character
from cubeling.characters.rendering.geometry.morph_mixer import MorphMixer
from cubeling.characters.rendering.geometry.vertices import CharacterVertices
from cubeling.characters.skeleton.pose import Pose
from tools.ray_tracing import Triangles
from tools.ray_tracing.mesh import Array

ROOM_RADIUS_M = 0.7
"""Radius of the occlusion in scenes of metres: spec S9, 0.5 to 1 m."""

TABLE_RADIUS_M = 0.08
"""Radius where characters of 0.2 m stand: the same share of their height."""

CHARACTER_HEIGHT_M = 0.2
FOCAL_SHARE = 0.95
"""Focal length as a share of the picture's width, as of a webcam."""

SPHERE_STEPS, TERRAIN_STEPS = 40, 158
"""Subdivisions; the terrain has 50,000 triangles, the spheres and blobs 50,000 together."""


@dataclass(frozen=True)
class Scene:
    """A mesh before a camera."""

    name: str
    """For tables."""

    mesh: Triangles
    """In the camera frame (x right, y down, z forward) [m]."""

    radius_m: float
    """Radius of the occlusion that suits its size [m]."""

    @staticmethod
    def matrix(size: tuple[int, int]) -> Array:
        """Return the pinhole matrix of a picture, (3, 3) [px]."""
        width, height = size
        focal = FOCAL_SHARE * width
        return np.array([[focal, 0.0, width / 2], [0.0, focal, height / 2], [0.0, 0.0, 1.0]])


def grid(columns: int, rows: int) -> Array:
    """Return the corners of the triangles between (rows + 1) × (columns + 1) vertices."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = first + columns + 1
    quads = np.stack([first, below, below + 1, first + 1], axis=-1)
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def sphere(center: Sequence[float], radius: float) -> Triangles:
    """Return a sphere."""
    u, v = np.meshgrid(
        np.linspace(0.0, 2.0 * np.pi, SPHERE_STEPS + 1), np.linspace(0.0, np.pi, SPHERE_STEPS + 1)
    )
    normals = np.stack([np.sin(v) * np.cos(u), np.cos(v), np.sin(v) * np.sin(u)], axis=-1)
    normals = normals.reshape(-1, 3)
    return Triangles.of(radius * normals + center, normals, grid(SPHERE_STEPS, SPHERE_STEPS))


def rectangle(
    corner: Sequence[float], first: Sequence[float], second: Sequence[float]
) -> Triangles:
    """Return a flat rectangle from a corner and two sides."""
    a, b, c = (np.asarray(each, float) for each in (corner, first, second))
    normal = np.cross(b, c)
    positions = np.stack([a, a + b, a + c, a + b + c])
    return Triangles.of(positions, np.tile(normal / np.linalg.norm(normal), (4, 1)), grid(1, 1))


def box(center: Sequence[float], half: Sequence[float], yaw: float = 0.0) -> Triangles:
    """Return a box that is turned about the vertical by `yaw` [rad]."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            u, v = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3]
            corner = side * np.eye(3)[axis] - u - v
            faces.append((corner * half, 2 * u * half, 2 * v * half, side * np.eye(3)[axis]))
    turn = np.array(
        [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]], float
    )
    parts = []
    for corner, first, second, normal in faces:
        positions = np.stack([corner, corner + first, corner + second, corner + first + second])
        parts.append(
            Triangles.of(positions @ turn.T + center, np.tile(normal @ turn.T, (4, 1)), grid(1, 1))
        )
    joined = Triangles.joined(parts)
    return Triangles.of(joined.positions, joined.normals, joined.corners)


def floor(side: float, height: float = 0.0) -> Triangles:
    """Return a square of the floor around the origin."""
    return rectangle((-side / 2, height, -side / 2), (0, 0, side), (side, 0, 0))


def corner() -> Triangles:
    """Return a floor and two walls."""
    return Triangles.joined(
        [
            rectangle((-2.0, 0, -1.2), (0, 0, 4.2), (4.0, 0, 0)),
            rectangle((-2.0, 0, -1.2), (4.0, 0, 0), (0, 2.5, 0)),
            rectangle((-1.3, 0, -1.2), (0, 2.5, 0), (0, 0, 4.2)),
        ]
    )


def spheres(seed: int) -> Triangles:
    """Return spheres on a floor, some of them afloat or sunk in."""
    rng = np.random.default_rng(seed)
    parts = [floor(12.0)]
    for _ in range(15):
        radius = rng.uniform(0.12, 0.45)
        x, z = rng.uniform(-1.4, 1.4), rng.uniform(-1.4, 1.2)
        parts.append(sphere((x, radius * rng.uniform(0.5, 1.6), z), radius))
    return Triangles.joined(parts)


def boxes(seed: int) -> Triangles:
    """Return turned boxes on a floor, some of them on others."""
    rng = np.random.default_rng(seed)
    parts = [floor(12.0)]
    for _ in range(18):
        half = rng.uniform(0.08, 0.35, 3).tolist()
        x, z = rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.2)
        parts.append(box((x, half[1] * rng.uniform(0.6, 1.0), z), half, rng.uniform(0, np.pi)))
    return Triangles.joined(parts)


def terrain(seed: int) -> Triangles:
    """Return hills: a sum of waves of random directions."""
    rng = np.random.default_rng(seed)
    x, z = np.meshgrid(
        np.linspace(-2.5, 2.5, TERRAIN_STEPS + 1), np.linspace(-2.5, 2.5, TERRAIN_STEPS + 1)
    )
    y, slope_x, slope_z = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    for octave in np.repeat(np.arange(4), 3):
        frequency, strength = 1.7 * 1.9**octave, 0.19 * 0.6**octave
        angle, phase = rng.uniform(0.0, 2.0 * np.pi, 2)
        a, b = frequency * np.cos(angle), frequency * np.sin(angle)
        wave = a * x + b * z + phase
        y += strength * np.sin(wave)
        slope_x += strength * a * np.cos(wave)
        slope_z += strength * b * np.cos(wave)
    normals = np.stack([-slope_x, np.ones_like(x), -slope_z], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    return Triangles.of(positions, normals, grid(TERRAIN_STEPS, TERRAIN_STEPS))


def room() -> Triangles:
    """Return a room with two boxes, after the Cornell box, seen through its open front."""
    return Triangles.joined(
        [
            rectangle((-1, 0, -1), (0, 0, 2), (2, 0, 0)),
            rectangle((-1, 2, -1), (2, 0, 0), (0, 0, 2)),
            rectangle((-1, 0, -1), (2, 0, 0), (0, 2, 0)),
            rectangle((-1, 0, -1), (0, 2, 0), (0, 0, 2)),
            rectangle((1, 0, -1), (0, 0, 2), (0, 2, 0)),
            box((-0.35, 0.6, -0.35), (0.3, 0.6, 0.3), 0.3),
            box((0.4, 0.3, 0.25), (0.3, 0.3, 0.3), -0.35),
        ]
    )


def posed(body: Character, pose: Pose, table_from_character: Array) -> Triangles:
    """Return the morphed and skinned mesh of a character in the table frame."""
    vertices = CharacterVertices.of(body.meshes)
    shape = vertices.shape_records
    mixed = MorphMixer(shape, vertices.morphs, body.morphs).mix(pose.morphs)
    shape = shape if mixed is None else mixed
    palette = vertices.palette(table_from_character @ pose.globals(body.skeleton))
    turns = palette.copy()
    turns[:, :3, 3] = 0.0
    normals = vertices.skin(turns, slice(None), shape[:, 3:])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    positions = vertices.skin(palette, slice(None), shape[:, :3])
    return Triangles.of(positions, normals, vertices.indices.reshape(-1, 3))


def character(name: str, clip: str, time: float) -> Triangles:
    """Return a bundled character in a moment of one of its clips [s], on a table."""
    body = Character.load(name)
    mesh = posed(body, body.clips[clip].sample(time), np.eye(4))
    low, high = mesh.positions.min(axis=0), mesh.positions.max(axis=0)
    scale = CHARACTER_HEIGHT_M / (high[1] - low[1])
    place = np.diag([scale, scale, scale, 1.0])
    place[:3, 3] = -scale * np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    return Triangles.joined([floor(3.0), mesh.transformed(place)])


def seen_from(mesh: Triangles, eye: Sequence[float], target: Sequence[float]) -> Triangles:
    """Return a mesh in the frame of a camera at `eye` that looks at `target`; +y was up."""
    forward = np.subtract(target, eye)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 1.0, 0.0))
    right /= np.linalg.norm(right)
    camera_from_world = np.eye(4)
    camera_from_world[:3, :3] = right, np.cross(forward, right), forward
    camera_from_world[:3, 3] = -camera_from_world[:3, :3] @ eye
    return mesh.transformed(camera_from_world)


Builder = Callable[[], Triangles]
_ROOM_EYE, _ROOM_TARGET = (0.6, 1.5, 3.4), (0.0, 0.3, -0.1)
_TABLE_EYE, _TABLE_TARGET = (0.12, 0.24, 0.37), (0.0, 0.09, 0.0)

_BUILDERS: dict[str, tuple[Builder, float, Sequence[float], Sequence[float]]] = {
    "spheres": (partial(spheres, 1), ROOM_RADIUS_M, _ROOM_EYE, _ROOM_TARGET),
    "terrain": (partial(terrain, 2), ROOM_RADIUS_M, (0.0, 1.9, 3.0), (0.0, 0.0, 0.0)),
    "pile": (partial(boxes, 8), ROOM_RADIUS_M, _ROOM_EYE, _ROOM_TARGET),
    "robot": (partial(character, "robot", "idle", 0.5), TABLE_RADIUS_M, _TABLE_EYE, _TABLE_TARGET),
    "corner": (corner, ROOM_RADIUS_M, (1.3, 1.4, 2.9), (-0.3, 0.5, -0.4)),
    "boxes": (partial(boxes, 5), ROOM_RADIUS_M, _ROOM_EYE, _ROOM_TARGET),
    "balls": (partial(spheres, 6), ROOM_RADIUS_M, _ROOM_EYE, _ROOM_TARGET),
    "hills": (partial(terrain, 7), ROOM_RADIUS_M, (0.3, 1.6, 3.2), (0.0, 0.0, 0.0)),
    "room": (room, ROOM_RADIUS_M, (0.13, 1.1, 3.2), (0.05, 0.95, 0.0)),
    "human": (partial(character, "human", "idle", 0.5), TABLE_RADIUS_M, _TABLE_EYE, _TABLE_TARGET),
    "vleo": (partial(character, "vleo", "idle", 0.5), TABLE_RADIUS_M, _TABLE_EYE, _TABLE_TARGET),
}

TUNED = ("spheres", "terrain", "pile", "robot")
"""Scenes on which the constants of the estimators were chosen."""

HELD_OUT = ("corner", "boxes", "balls", "hills", "room", "human", "vleo")
"""Scenes that only the figures are from."""


CHARACTERS = ("robot", "human", "vleo")
"""Scenes with a character; it is the second object."""


def load(name: str) -> Scene:
    """Return a scene by its name."""
    build, radius, eye, target = _BUILDERS[name]
    return Scene(name, seen_from(build(), eye, target), radius)
