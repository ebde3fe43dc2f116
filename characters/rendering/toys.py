"""Small things that stand on the table: a flower, a balloon and a flag, each on a thin stick.

A stick is what a hand can hold without stooping: the grip is as high as a hand that hangs down.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cubeling.characters.control.command import PosedCharacter
from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Material, Mesh
from cubeling.characters.rendering.scene import SceneCharacter
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

GRIP_M = 0.072
"""Height at which a hand holds a toy that stands on the table [m]."""

_SIDES = 18  # of everything round

_GREEN, _CLAY, _YELLOW = (0.06, 0.30, 0.05), (0.50, 0.15, 0.06), (0.95, 0.60, 0.04)  # linear RGB
_PINK, _RED, _BLUE = (0.86, 0.16, 0.36), (0.78, 0.03, 0.04), (0.03, 0.17, 0.62)
_WOOD, _WHITE = (0.42, 0.24, 0.10), (0.86, 0.84, 0.78)

_ONE_JOINT = Skeleton(("root",), (-1,), Pose(np.zeros((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]])))


@dataclass(frozen=True)
class Toy:
    """A small thing that does not bend; it is drawn as a character of one joint is."""

    name: str
    """One of `TOYS`."""

    meshes: tuple[Mesh, ...]
    """Its surface [m]; it stands at the origin."""

    skeleton: Skeleton = _ONE_JOINT
    """A single joint, which carries the whole toy."""

    morphs: tuple[str, ...] = ()
    """A toy has no morph targets."""

    def place(self, table_from_toy: Array, timestamp: float) -> SceneCharacter:
        """Return it as it is to be drawn at a place, (4, 4) [m]."""
        pose = self.skeleton.rest
        posed = PosedCharacter(pose, table_from_toy, True, "still", 0.0, 0.0, 0.0, timestamp)
        return SceneCharacter(self, posed)


@dataclass(frozen=True)
class _ToyPart:
    """Some vertices of a toy."""

    positions: Array  # (n, 3) [m]
    normals: Array  # (n, 3)
    triangles: NDArray[np.int64]  # (m, 3), counter-clockwise from outside
    color: tuple[float, float, float]  # linear RGB

    def transform(self, turn: Array, origin: ArrayLike) -> "_ToyPart":
        """Return it after a linear map (3, 3), moved to an origin."""
        normals = self.normals @ np.linalg.inv(turn)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return _ToyPart(
            self.positions @ turn.T + np.asarray(origin), normals, self.triangles, self.color
        )


@cache
def toy(name: str) -> Toy:
    """Return a toy by its name, one of `TOYS`; the same object every time.

    Raises
    ------
    CharacterError
        There is no such toy.
    """
    if name not in TOYS:
        raise CharacterError(f"no toy is called '{name}': choose one of {', '.join(TOYS)}")
    return Toy(name, (_mesh(name, TOYS[name]()),))


def _flower() -> list[_ToyPart]:
    """Return a flower in a pot, which looks up and to the player."""
    pot = [*_round(_CLAY, (0.0, 0.0), (0.0075, 0.0), (0.0095, 0.013)), *_rim(0.0095, 0.013, _CLAY)]
    facing = _about_x(np.deg2rad(55))
    head = np.array([0.0, 0.088, 0.002])
    petals = []
    for angle in np.arange(6) * np.pi / 3:
        turn = facing @ _about_y(angle)
        petal = _ball(_PINK).transform(turn @ np.diag([0.0055, 0.0018, 0.0075]), (0.0, 0.0, 0.0))
        petals.append(petal.transform(np.eye(3), head + turn @ [0.0, 0.0, 0.0085]))
    middle = _ball(_YELLOW).transform(facing @ np.diag([0.0052, 0.0036, 0.0052]), head)
    leaves = [
        _ball(_GREEN).transform(
            _about_z(side * 0.6) @ np.diag([0.0085, 0.0012, 0.0035]), (side * 0.008, height, 0.0)
        )
        for side, height in ((1, 0.030), (-1, 0.036))
    ]
    return [*pot, *_stick(_GREEN, 0.088, 0.0013), *petals, middle, *leaves]


def _balloon() -> list[_ToyPart]:
    """Return a balloon on a stick with a foot."""
    body = _ball(_RED).transform(np.diag([0.0155, 0.0185, 0.0155]), (0.0, 0.105, 0.0))
    knot = _round(_RED, (0.0, 0.0835), (0.0032, 0.0835), (0.0008, 0.0875))
    return [*_foot(_BLUE), *_stick(_WHITE, 0.086, 0.0008), body, *knot]


def _flag() -> list[_ToyPart]:
    """Return a pennant with a stripe on a pole."""
    knob = _ball(_YELLOW).transform(0.0026 * np.eye(3), (0.0, 0.110, 0.0))
    cloth = [
        _pennant(0.110, 0.084, 0.0, 0.030, _BLUE),
        _pennant(0.101, 0.093, 0.0004, 0.0301, _YELLOW),
    ]
    return [*_foot(_WOOD), *_stick(_WOOD, 0.110, 0.0012), knob, *cloth]


TOYS: dict[str, Callable[[], list[_ToyPart]]] = {
    "flower": _flower,
    "balloon": _balloon,
    "flag": _flag,
}
"""What makes the parts of each toy."""


def _foot(color: tuple[float, float, float]) -> list[_ToyPart]:
    return _round(color, (0.0, 0.0), (0.0095, 0.0), (0.0095, 0.002), (0.0012, 0.006))


def _stick(color: tuple[float, float, float], top: float, radius: float) -> list[_ToyPart]:
    return _round(color, (radius, 0.002), (radius, top), (0.0, top))


def _rim(radius: float, height: float, color: tuple[float, float, float]) -> list[_ToyPart]:
    """Return the earth in a pot and the edge around it."""
    wide, dark = radius * 1.12, (0.05, 0.03, 0.02)
    edge = _round(color, (radius, height - 0.003), (wide, height - 0.003), (wide, height))
    return [*edge, *_round(color, (wide, height), (0.8 * radius, height)),
            *_round(dark, (0.8 * radius, height), (0.0, height))]  # fmt: skip


def _round(color: tuple[float, float, float], *profile: tuple[float, float]) -> list[_ToyPart]:
    """Return surfaces of revolution about +y through (radius, height) [m], with sharp edges."""
    return [_revolve(np.array(pair), color) for pair in itertools.pairwise(profile)]


def _ball(color: tuple[float, float, float]) -> _ToyPart:
    """Return a sphere of radius 1."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 13)
    radius = np.cos(angles)
    radius[[0, -1]] = 0.0  # not 1e-16: each pole is one point
    return _revolve(np.stack([radius, np.sin(angles)], axis=1), color, sphere=True)


def _revolve(
    profile: Array, color: tuple[float, float, float], *, sphere: bool = False
) -> _ToyPart:
    """Return a surface of revolution through (rings, 2), from below to above on its outside."""
    radius, height = profile.T
    along = profile[-1] - profile[0]
    across = profile if sphere else np.broadcast_to([along[1], -along[0]], profile.shape)
    across = across / np.linalg.norm(across, axis=1, keepdims=True)
    angles = np.arange(_SIDES) * 2 * np.pi / _SIDES
    spokes = np.stack([np.sin(angles), np.cos(angles)], axis=1)

    def around(out: Array, up: Array) -> Array:
        x, z = (out[:, None] * spokes[:, axis] for axis in (0, 1))
        return np.stack([x, np.repeat(up[:, None], _SIDES, 1), z], axis=2).reshape(-1, 3)

    ring, side = (each.ravel() for each in np.mgrid[: len(profile) - 1, :_SIDES])
    here, there = ring * _SIDES + side, ring * _SIDES + (side + 1) % _SIDES
    up, across_up = here + _SIDES, there + _SIDES
    lower, upper = np.stack([here, there, across_up], 1), np.stack([here, across_up, up], 1)
    triangles = np.concatenate([lower[radius[ring] > 0], upper[radius[ring + 1] > 0]])
    return _ToyPart(around(radius, height), around(*across.T), triangles, color)


def _pennant(
    top: float, bottom: float, inset: float, length: float, color: tuple[float, float, float]
) -> _ToyPart:
    """Return a waving triangle of cloth from two heights on a pole to its tip, both sides."""
    shares = np.linspace(0.0, 1.0, 13)
    middle, half = (top + bottom) / 2, (top - bottom) / 2 * (1 - shares)
    x, z = length * shares, 0.0035 * np.sin(7.0 * shares) * shares
    slope = np.gradient(z, x)
    normal = np.stack([-slope, np.zeros_like(x), np.ones_like(x)], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    rows = [np.stack([x, middle + sign * half, z], axis=1) for sign in (1, -1)]
    front = np.concatenate(rows) + (inset + 0.0002) * np.tile(normal, (2, 1))
    back = np.concatenate(rows) - (inset + 0.0002) * np.tile(normal, (2, 1))
    first = np.arange(len(shares) - 1)
    low = first + len(shares)
    faces = np.concatenate([np.stack([first, low, low + 1], 1),
                            np.stack([first, low + 1, first + 1], 1)])  # fmt: skip
    normals = np.concatenate([np.tile(normal, (2, 1)), -np.tile(normal, (2, 1))])
    triangles = np.concatenate([faces, faces[:, ::-1] + len(front)])
    return _ToyPart(np.concatenate([front, back]), normals, triangles, color)


def _mesh(name: str, parts: Sequence[_ToyPart]) -> Mesh:
    """Return all parts as one mesh that the one joint moves."""
    counts = [len(part.positions) for part in parts]
    starts = np.cumsum([0, *counts[:-1]])
    total = sum(counts)
    colors = np.repeat([(*part.color, 1.0) for part in parts], counts, axis=0)
    return Mesh(
        name=name,
        positions=np.concatenate([part.positions for part in parts]).astype(np.float32),
        normals=np.concatenate([part.normals for part in parts]).astype(np.float32),
        triangles=np.concatenate(
            [part.triangles + start for part, start in zip(parts, starts, strict=True)]
        ).astype(np.uint32),
        joints=np.zeros((total, 4), np.uint16),
        weights=np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (total, 1)),
        inverse_bind=np.eye(4)[None],
        colors=colors.astype(np.float32),
        material=Material(roughness=0.45),
    )


def _about_x(angle: float) -> Array:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])


def _about_y(angle: float) -> Array:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])


def _about_z(angle: float) -> Array:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
