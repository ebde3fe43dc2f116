"""A skeleton seen as a body: facing the same way as any other, standing on the same ground."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from characters.errors import CharacterError
from characters.skeleton import rotations
from characters.skeleton.anatomy import SIDES, Anatomy
from characters.skeleton.pose import Array, Skeleton

_STANDS = (-0.02, 0.12)  # heights of the lowest joint, in body sizes, of one who stands at rest
_SPREAD = 0.2  # [rad]: legs farther apart at rest do not stand; their soles are square to them


@dataclass(frozen=True)
class Leg:
    """The joints of a leg; its ankle is a point of the shin, wherever the foot hangs."""

    upper: int
    """Joint of the thigh."""

    lower: int
    """Joint of the shin."""

    foot: int
    """Joint of the foot."""

    toes: int | None
    """Joint of the toes, the ball of the foot, if there is one."""

    attached: bool
    """Whether the foot is below the shin in the tree; rigs for inverse kinematics have it apart."""

    @property
    def end(self) -> int:
        """The joint that is nearest to the ground."""
        return self.foot if self.toes is None else self.toes


@dataclass(frozen=True)
class Body:
    """A skeleton with its anatomy; all its measures are in the common axes, +y up and +z ahead."""

    skeleton: Skeleton
    """Its joints."""

    anatomy: Anatomy
    """Which joint is which part."""

    def part(self, name: str) -> int | None:
        """Return the joint of a part, or None."""
        return self.anatomy.joint(name)

    @cached_property
    def upright(self) -> Array:
        """The rotation (4,) from the skeleton's axes to the common ones, in quarter turns.

        A file may look along any axis at rest; which one, hips, limbs and head tell.
        """
        places = self.skeleton.rest.globals(self.skeleton)[:, :3, 3]
        left, right = self._side(places, "left"), self._side(places, "right")
        legs = [places[leg.end] for leg in self.legs]
        trunk = [places[j] for j in (self.part("hips"), self.part("head")) if j is not None]
        if not legs or left is None or right is None:
            return rotations.IDENTITY
        up = _nearest_axis(np.mean(trunk, axis=0) - np.mean(legs, axis=0))
        across = left - right
        across = _nearest_axis(across - up * float(across @ up))
        return rotations.from_matrix(np.stack([across, up, np.cross(across, up)]))

    def _side(self, places: Array, side: str) -> Array | None:
        joints = [j for part, j in self.anatomy.joints.items() if part.startswith(side)]
        return places[joints].mean(0) if joints else None

    @cached_property
    def rest_turns(self) -> Array:
        """How each joint is turned at rest, (joints, 4)."""
        return rotations.multiply(self.upright, turns_of(self.skeleton.rest.globals(self.skeleton)))

    @cached_property
    def rest_places(self) -> Array:
        """Where each joint is at rest, (joints, 3) [m]."""
        return rotations.rotate(self.upright, self.skeleton.rest.globals(self.skeleton)[:, :3, 3])

    @cached_property
    def legs(self) -> tuple[Leg, ...]:
        """Its legs, left before right, hind before front."""
        return tuple(
            leg
            for front in ("", "Front")
            for side in SIDES
            if (leg := self._leg(side + front)) is not None
        )

    def _leg(self, side: str) -> Leg | None:
        upper, lower, foot = (self.part(side + p) for p in ("UpperLeg", "LowerLeg", "Foot"))
        if upper is None or lower is None or foot is None:
            return None
        if upper not in self.line(lower):
            return None
        return Leg(upper, lower, foot, self.part(side + "Toes"), lower in self.line(foot))

    def line(self, joint: int) -> list[int]:
        """Return a joint and its ancestors, from the root down."""
        line = [joint]
        while self.skeleton.parents[line[-1]] >= 0:
            line.append(self.skeleton.parents[line[-1]])
        return line[::-1]

    def direction(self, start: str, end: str) -> Array | None:
        """Return where one part points to another at rest, (3,) of length one, or None."""
        a, b = self.part(start), self.part(end)
        if a is None or b is None:
            return None
        bone = self.rest_places[b] - self.rest_places[a]
        length = float(np.linalg.norm(bone))
        return bone / length if length > 1e-9 else None

    @cached_property
    def leg_length(self) -> float:
        """How long its legs are, mean [m]: a person's along the bones, from hip to ankle.

        Beasts stand on legs that are bent, on toes or on soles: what counts is how high they
        carry the body.
        """
        if self.anatomy.kind == "quadruped":
            lengths = [
                float(self.rest_places[leg.upper, 1] - self.rest_places[leg.end, 1])
                for leg in self.legs
            ]
        else:
            lengths = [sum(self.bones(leg)) for leg in self.legs]
        if not lengths or not min(lengths) > 0:
            raise CharacterError(
                "retargeting needs legs, but of thigh, shin and foot "
                f"{', '.join(self.anatomy.missing) or 'some'} are missing; "
                "say which joints they are in a [joints] table"
            )
        return float(np.mean(lengths))

    def bones(self, leg: Leg) -> tuple[float, float]:
        """Return how long thigh and shin of a leg are [m]."""
        hip, knee, ankle = self.rest_places[[leg.upper, leg.lower, leg.foot]]
        return float(np.linalg.norm(knee - hip)), float(np.linalg.norm(ankle - knee))

    @cached_property
    def stands(self) -> bool:
        """Whether its feet are on the ground at rest, as those of models are."""
        size = float(np.ptp(self.rest_places, axis=0).max()) or 1.0
        lowest = min(float(self.rest_places[leg.end, 1]) for leg in self.legs) / size
        return _STANDS[0] < lowest < _STANDS[1]

    def sole(self, leg: Leg) -> Array:
        """Return how a foot stands flat, as the rotation (4,) of +z ahead and +y up to it at rest.

        Models stand with flat feet; the soles of a recorded skeleton, whose legs are spread in
        its zero pose, are square to the shin.
        """
        shin = self.rest_places[leg.upper] - self.rest_places[leg.foot]
        up = np.array([0.0, 1.0, 0.0])
        if self._spread > _SPREAD:
            up = np.array([shin[0], shin[1], 0.0]) / float(np.hypot(shin[0], shin[1]))
        ahead = np.array([0.0, 0.0, 1.0])
        if leg.toes is not None:
            ahead = self.rest_places[leg.toes] - self.rest_places[leg.foot]
        ahead = ahead - up * float(ahead @ up)
        ahead = ahead / max(float(np.linalg.norm(ahead)), 1e-9)
        return rotations.from_matrix(np.stack([np.cross(up, ahead), up, ahead], axis=-1))

    @cached_property
    def _spread(self) -> float:
        """Greatest angle between a leg and the vertical, seen from the front [rad]."""
        bones = [self.rest_places[leg.upper] - self.rest_places[leg.foot] for leg in self.legs]
        return max(abs(float(np.arctan2(bone[0], bone[1]))) for bone in bones)


def turns_of(globals_: Array) -> Array:
    """Return the rotations (…, 4) of placements (…, 4, 4), whatever their scale."""
    matrices = globals_[..., :3, :3]
    lengths = np.linalg.norm(matrices, axis=-2, keepdims=True)
    return rotations.from_matrix(matrices / np.where(lengths > 0, lengths, 1.0))


def _nearest_axis(direction: Sequence[float] | Array) -> Array:
    """Return the one of ±x, ±y, ±z that is nearest to a direction."""
    axis = np.zeros(3)
    number = int(np.abs(direction).argmax())
    axis[number] = np.sign(direction[number]) or 1.0
    return axis
