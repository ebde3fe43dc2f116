"""Which joints of a skeleton stand and look: pelvis, legs and neck."""

from dataclasses import dataclass
from typing import Self

from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.joint_chains import chains_to_root
from cubeling.characters.skeleton.pose import Skeleton

_LEG = ("UpperLeg", "LowerLeg", "Foot")


@dataclass(frozen=True)
class StandingLegs:
    """The joints below and above the trunk of a body on two legs; none of another body."""

    pelvis: int = -1
    """What carries trunk and legs; −1 if that is not known."""

    legs: tuple[tuple[int, ...], ...] = ()
    """Hip, knee and ankle of both legs; none if the pelvis is not known."""

    toes: tuple[int, ...] = ()
    """The toes of both, where the foot bends; −1 of a foot without."""

    neck: tuple[int, ...] = ()
    """From the neck to the head."""

    @property
    def joints(self) -> list[int]:
        """The joints of legs and neck, and the pelvis if there are legs to stand on."""
        legs = [joint for leg in self.legs for joint in leg]
        legs += [joint for joint in self.toes if joint >= 0]
        return [*legs, *self.neck, *([self.pelvis] if self.legs else [])]

    @classmethod
    def of(cls, skeleton: Skeleton, anatomy: Anatomy) -> Self:
        """Return the stance of a skeleton."""
        if anatomy.kind == "quadruped":
            return cls()
        chains, parts = chains_to_root(skeleton.parents), anatomy.joints
        head = parts.get("head", -1)
        line = chains[head] if head >= 0 else []
        neck = parts.get("neck", head)
        above = tuple(line[line.index(neck) :]) if neck in line else ()
        legs = tuple(tuple(parts.get(side + part, -1) for part in _LEG) for side in SIDES)
        spine = parts.get("spine", -1)
        if spine < 0 or any(min(leg) < 0 or leg[0] not in chains[leg[1]] for leg in legs):
            return cls(neck=above)
        lines = [chains[joint][:-1] for joint in (spine, *(leg[0] for leg in legs))]
        common = [joint for joint in lines[0] if all(joint in each for each in lines)]
        # A foot hangs at its shin or, in rigs for animators, where nothing here moves it.
        if not common or any(
            knee not in chains[ankle] and common[-1] in chains[ankle] for _, knee, ankle in legs
        ):
            return cls(neck=above)
        toes = (parts.get(side + "Toes", -1) for side in SIDES)
        bending = tuple(
            toe if ankle in chains[toe] else -1 for toe, (*_, ankle) in zip(toes, legs, strict=True)
        )
        return cls(common[-1], legs, bending, above)
