"""Spring bones: joints such as hair and ears, that swing after the body.

They are stated by VRM files, or by the table [springs] of the sidecar file of any character.
"""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.toml_file import TomlTable

Point = tuple[float, float, float]
"""A position or direction [m]."""

LEAF_LENGTH_M = 0.07
"""Length of a bone without children, as in VRM 0.x [m]."""

_LEAST_LENGTH_M = 1e-6  # of a bone; a shorter one has no direction

REFERENCE_HEIGHT_M = 1.7
"""Height of the characters for which the stiffness and gravity of sidecar files are meant [m]:
those of others are in proportion, so that the same numbers swing alike in any unit of length."""

SIDECAR_WIND = 0.3
"""What the characters of sidecar files feel of the wind that their own speed makes; 1 as in VRM."""


@dataclass(frozen=True)
class SpringCollider:
    """A sphere or capsule that the tails of spring bones do not enter."""

    joint: str
    """Name of the joint that carries it."""

    start: Point
    """Centre of the sphere, or one end of the capsule's axis, in the joint's frame [m]."""

    end: Point
    """The other end of the axis; that of a sphere is the same."""

    radius: float
    """Its radius [m]."""


@dataclass(frozen=True)
class SpringBone:
    """A joint that swings; its numbers are those of VRM's spring bones."""

    joint: str
    """Name of the joint that turns."""

    tail: Point
    """The end of its bone, whose movement is simulated, in the joint's frame [m]."""

    stiffness: float = 1.0
    """How fast the tail is pulled back to where the pose has it [m/s per 1/60 s]."""

    drag: float = 0.4
    """Part of its speed that the tail loses in 1/60 s, 0…1."""

    gravity: Point = (0.0, 0.0, 0.0)
    """A constant pull in the world, like the stiffness [m/s per 1/60 s]."""

    radius: float = 0.0
    """Radius of the sphere about the tail that hits colliders [m]."""

    colliders: tuple[SpringCollider, ...] = ()
    """What the tail does not enter."""

    center: str | None = None
    """Name of the joint relative to which it has inertia; None for the world."""

    wind: float = 1.0
    """Part of the character's speed over the table that drags at the tail, 0…1."""

    def with_names(self, names: Mapping[str, str]) -> "SpringBone":
        """Return it for joints with new names, given by their old ones."""
        return replace(
            self,
            joint=names.get(self.joint, self.joint),
            center=None if self.center is None else names.get(self.center, self.center),
            colliders=tuple(
                replace(each, joint=names.get(each.joint, each.joint)) for each in self.colliders
            ),
        )


@dataclass(frozen=True)
class SpringGroup:
    """Spring bones that a sidecar file states, by the names of joints."""

    place: str
    """Where it is written, for messages."""

    joints: tuple[str, ...]
    """Joints that swing, together with all that hangs on them."""

    stiffness: float
    """As in `SpringBone`, for `REFERENCE_HEIGHT_M`."""

    drag: float
    """As in `SpringBone`."""

    gravity: float
    """Strength of the pull downwards, likewise."""

    radius: float
    """As in `SpringBone` [m]."""

    wind: float
    """As in `SpringBone`."""

    colliders: tuple[tuple[str, Point, Point, float], ...]
    """Joint, start, end and radius of each collider, as in `SpringCollider`."""

    def bones(self, skeleton: Skeleton, meshes: Sequence[Mesh], height: float) -> list[SpringBone]:
        """Return its spring bones in a character of a height [m].

        Raises
        ------
        CharacterError
            If it names joints that the skeleton does not have.
        """
        swinging = {_joint(skeleton, name, self.place) for name in self.joints}
        for joint, parent in enumerate(skeleton.parents):
            if parent in swinging:
                swinging.add(joint)
        colliders = tuple(
            SpringCollider(skeleton.names[_joint(skeleton, name, self.place)], start, end, radius)
            for name, start, end, radius in self.colliders
        )
        size = height / REFERENCE_HEIGHT_M
        return [
            SpringBone(
                skeleton.names[joint],
                tail_of(skeleton, joint, meshes),
                self.stiffness * size,
                self.drag,
                (0.0, -self.gravity * size, 0.0),
                self.radius,
                colliders,
                wind=self.wind,
            )
            for joint in sorted(swinging)
        ]


def tail_of(
    skeleton: Skeleton, joint: int, meshes: Sequence[Mesh] = (), leaf_length: float | None = None
) -> Point:
    """Return the end of a joint's bone in its frame: the origin of its first child.

    Without a child it is the middle of the vertices that the joint moves in `meshes`; without any,
    it goes on from its parent by `leaf_length`, or by as much as it is away from it.
    """
    children = [child for child, parent in enumerate(skeleton.parents) if parent == joint]
    ends = [skeleton.rest.translations[child] for child in children]
    if not children:
        ends = _middle_of_vertices(joint, meshes)
    for end in ends:
        if np.linalg.norm(end) > _LEAST_LENGTH_M:
            return _point(end)
    along = skeleton.rest.translations[joint]
    length = float(np.linalg.norm(along))
    if length <= _LEAST_LENGTH_M:
        along, length = np.array([0.0, LEAF_LENGTH_M, 0.0]), LEAF_LENGTH_M
    return _point(along if leaf_length is None else along * leaf_length / length)


def _middle_of_vertices(joint: int, meshes: Sequence[Mesh]) -> list[Array]:
    """Return the weighted mean of the vertices that a joint moves, in its frame, if there is any.

    The bind pose tells where they are in it.
    """
    total, weight = np.zeros(3), 0.0
    for mesh in meshes:
        weights = np.where(mesh.joints == joint, mesh.weights, 0.0).sum(axis=1)
        placed = (
            mesh.positions @ mesh.inverse_bind[joint, :3, :3].T + mesh.inverse_bind[joint, :3, 3]
        )
        total += weights @ placed
        weight += float(weights.sum())
    return [total / weight] if weight > 0 else []


def read_spring_groups(file: TomlTable) -> tuple[SpringGroup, ...]:
    """Return the groups in the table [springs] of a sidecar file.

    Raises
    ------
    CharacterError
        If a part of it is invalid.
    """
    return tuple(_group(table) for table in file.tables("springs").values())


_NUMBERS = {
    "stiffness": (0.0, 1000.0, 1.0),
    "drag": (0.0, 1.0, 0.4),
    "gravity": (-1000.0, 1000.0, 0.0),
    "radius": (0.0, 1000.0, 0.0),
    "wind": (0.0, 1.0, SIDECAR_WIND),
}
"""Least, greatest and default value of the numbers of a group."""


def _group(table: TomlTable) -> SpringGroup:
    table.only("joints", "colliders", *_NUMBERS)
    joints = table.texts("joints")
    if not joints:
        raise table.unlike("joints", 'a list ["name of a joint", …]')
    return SpringGroup(
        f"{table.source}: {table.place}",
        joints,
        **{name: table.number(name, *limits) for name, limits in _NUMBERS.items()},
        colliders=tuple(_collider(row) for row in table.rows("colliders")),
    )


def _collider(table: TomlTable) -> tuple[str, Point, Point, float]:
    table.only("joint", "offset", "tail", "radius")
    joint = table.text("joint")
    start = table.numbers("offset", 3, -1000.0, 1000.0, (0.0, 0.0, 0.0))
    end = table.numbers("tail", 3, -1000.0, 1000.0, start)
    return joint, _point(start), _point(end), table.number("radius", 0.0, 1000.0)


def _joint(skeleton: Skeleton, name: str, place: str) -> int:
    if name in skeleton.names:
        return skeleton.names.index(name)
    near = difflib.get_close_matches(name, skeleton.names, 1)
    hint = f"; did you mean {near[0]!r}?" if near else f"; there are {', '.join(skeleton.names)}"
    raise CharacterError(f"{place}: no joint {name!r}{hint}")


def _point(vector: Array | Sequence[float]) -> Point:
    x, y, z = (float(value) for value in vector)
    return x, y, z
