"""The body as the graphs see it: joint weights, kinematic chains and split profiles, from a file.

Source: Fernández-Baena, PhD thesis, La Salle – URL, 2015, chapter 3.3 (M2.1 and M2.2).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.anatomy import BODY_PARTS, Anatomy
from cubeling.characters.skeleton.pose import Skeleton
from cubeling.toml_file import TomlTable, read, toml_kind

BODY_PLAN_FILE = toml_kind(
    "body plan", CharacterError, "cubeling.characters.synthesis.body:read_body_plan"
)
"""A file of weights, chains and profiles."""

LOWER_CHAINS = ("HC5", "HC6")
"""The chains of the legs: they are always in one part, whose timing the others follow."""


@dataclass(frozen=True)
class BodyPart:
    """A part of the body that has a graph of its own."""

    name: str
    """"BP" and the digits of its chains."""

    joints: tuple[int, ...]
    """Its joints: those of its chains and what hangs on them."""

    weights: Mapping[int, float]
    """Weight of each joint that counts in its distance."""

    prior: bool
    """Whether it is the part of the legs: it decides when the others move, and moves the root."""

    @property
    def weight(self) -> float:
        """The sum of its weights."""
        return sum(self.weights.values())


@dataclass(frozen=True)
class BodyPlan:
    """Weights, chains and split profiles of a body."""

    weights: Mapping[str, float]
    """Weight of a body part's joint in the distance, by the name of the part in VRM 1.0."""

    chains: Mapping[str, tuple[str, ...]]
    """Body parts of each chain, HC1 … HC6."""

    profiles: Mapping[str, tuple[str, ...]]
    """Parts of each split profile; a part is written as the digits of its chains."""

    def joint_weights(self, anatomy: Anatomy) -> dict[int, float]:
        """Return the weight of each joint of a skeleton that counts."""
        found = {anatomy.joint(part): weight for part, weight in self.weights.items()}
        return {joint: weight for joint, weight in found.items() if joint is not None and weight}

    def split(self, profile: str, skeleton: Skeleton, anatomy: Anatomy) -> tuple[BodyPart, ...]:
        """Return the parts of a profile, the prior part first.

        Raises
        ------
        CharacterError
            If there is no such profile, or the skeleton has no legs to put into it.
        """
        if profile not in self.profiles:
            known = ", ".join(self.profiles)
            raise CharacterError(f"no split profile {profile!r}; there are {known}")
        weights = self.joint_weights(anatomy)
        owners = self._chain_of_joints(skeleton, anatomy)
        parts = []
        for digits in self.profiles[profile]:
            chains = {f"HC{digit}" for digit in digits}
            joints = tuple(joint for joint, chain in enumerate(owners) if chain in chains)
            own = {joint: weight for joint, weight in weights.items() if joint in joints}
            parts.append(BodyPart(f"BP{digits}", joints, own, chains >= set(LOWER_CHAINS)))
        parts.sort(key=lambda part: not part.prior)
        if not all(part.weights for part in parts):
            empty = next(part.name for part in parts if not part.weights)
            raise CharacterError(
                f"split profile {profile}: the skeleton has no joint of {empty}; "
                f"missing are {', '.join(anatomy.missing) or 'some joints'}"
            )
        return tuple(parts)

    def _chain_of_joints(self, skeleton: Skeleton, anatomy: Anatomy) -> list[str]:
        """Return the chain of each joint: its own, or that of its nearest ancestor."""
        chain_of = {
            joint: chain
            for chain, parts in self.chains.items()
            for part in parts
            if (joint := anatomy.joint(part)) is not None
        }
        owners: list[str] = []
        for joint, parent in enumerate(skeleton.parents):
            inherited = owners[parent] if parent >= 0 else LOWER_CHAINS[0]
            owners.append(chain_of.get(joint, inherited))
        return owners


@cache
def default_body_plan() -> BodyPlan:
    """Return the weights, chains and profiles of the thesis."""
    return read_body_plan(Path(str(files("cubeling.characters.synthesis") / "profiles.toml")))


def read_body_plan(path: Path) -> BodyPlan:
    """Read a body plan from a .toml file like the bundled `profiles.toml`.

    Raises
    ------
    CharacterError
        If the file cannot be read, names unknown body parts, or splits the body wrongly.
    """
    file = TomlTable(read(path, BODY_PLAN_FILE), str(path), error=CharacterError)
    file.only("weights", "chains", "profiles")
    weights, chains, profiles = (file.table(key) for key in ("weights", "chains", "profiles"))
    plan = BodyPlan(
        {part: weights.number(part, 0.0) for part in weights},
        {name: chains.texts(name) for name in chains},
        {name: profiles.texts(name) for name in profiles},
    )
    chained = (part for parts in plan.chains.values() for part in parts)
    unknown = {*plan.weights, *chained} - {*BODY_PARTS}
    if unknown:
        raise CharacterError(f"{path}: no body part is named {sorted(unknown)[0]!r}")
    every = sorted(name.removeprefix("HC") for name in chains)
    for name, parts in plan.profiles.items():
        if sorted("".join(parts)) != every or not any("5" in p and "6" in p for p in parts):
            raise CharacterError(
                f"{path}: profile {name} must have each of the chains {', '.join(every)} once, "
                "with 5 and 6 in one part"
            )
    return plan
