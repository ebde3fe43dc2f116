"""A body, its skeleton and what it knows how to do."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import resources
from pathlib import Path

import numpy as np

from characters.errors import CharacterError
from characters.model.mesh import Mesh
from characters.model.sidecar import read_sidecar
from characters.motion.clip import Clip
from characters.motion.trees.plan import Plan
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Array, Skeleton

READERS: "dict[str, Callable[[Path], Character]]" = {}
"""What reads a character from a file, by its suffix; `characters.formats` registers its own."""

WRITERS: "dict[str, Callable[[Character, Path], None]]" = {}
"""What writes a character to a file, by its suffix."""


@dataclass(frozen=True)
class Character:
    """A skinned character with its clips."""

    name: str
    """Its name; that of the file without the suffix."""

    skeleton: Skeleton
    """Joints and rest pose."""

    clips: dict[str, Clip]
    """What it knows, by name."""

    meshes: tuple[Mesh, ...]
    """What is drawn."""

    morphs: tuple[str, ...] = ()
    """Names of the morphs that `Pose.morphs` turns on, in its order."""

    semantics: Mapping[str, str] = field(default_factory=dict)
    """What joints are, where the file says so: name in `Anatomy` to name in the skeleton."""

    plan: Plan | None = None
    """How its motions are put together, where the file beside it says so."""

    @staticmethod
    def load(name_or_path: "str | Path") -> "Character":
        """Load a bundled character by its name, or a .glb, .gltf or .vrm file.

        What its file does not say may stand in a .toml of the same name beside it: see
        `characters.model.sidecar`.

        Raises
        ------
        CharacterError
            If there is no such character or file, or it is not a skinned glTF.
        """
        path = Path(name_or_path)
        reader = READERS.get(path.suffix.lower())
        if reader is not None:
            return _with_sidecar(reader(path), path)
        if path.suffix or len(path.parts) > 1:
            raise CharacterError(
                f"{name_or_path}: not a .glb, .gltf or .vrm file; convert it, or name a bundled "
                f"character: {', '.join(Character.bundled())}"
            )
        if str(name_or_path) not in Character.bundled():
            raise CharacterError(
                f"no bundled character {str(name_or_path)!r}; there are "
                f"{', '.join(Character.bundled())}, or give a .glb, .gltf or .vrm file"
            )
        asset = resources.files("characters") / "assets" / f"{name_or_path}.glb"
        with resources.as_file(asset) as bundled:
            return _with_sidecar(READERS[".glb"](bundled), bundled)

    @staticmethod
    def bundled() -> tuple[str, ...]:
        """Return the names of the characters that come with the package."""
        assets = resources.files("characters") / "assets"
        if not assets.is_dir():
            return ()
        return tuple(sorted(a.name[:-4] for a in assets.iterdir() if a.name.endswith(".glb")))

    def save(self, path: "str | Path") -> None:
        """Write a .glb; the same character gives the same bytes.

        Raises
        ------
        CharacterError
            If its arrays do not fit together or the file cannot be written.
        """
        WRITERS[".glb"](self, Path(path))

    @cached_property
    def bounds(self) -> Array:
        """Lowest and highest corner of the rest pose, (2, 3) [m]."""
        placed = [skin(mesh, self.skeleton.rest.globals(self.skeleton)) for mesh in self.meshes]
        points = np.concatenate([p for p in placed if len(p)] or [np.zeros((1, 3))])
        return np.stack([points.min(0), points.max(0)])

    @cached_property
    def anatomy(self) -> Anatomy:
        """Which joint is which part of a body: said by the file, else guessed."""
        try:
            return Anatomy.guess(self.skeleton, self.semantics)
        except CharacterError as error:
            raise CharacterError(f"{self.name}: {error}") from None

    @property
    def height(self) -> float:
        """Height of the rest pose above the ground [m]."""
        return float(self.bounds[1, 1] - min(self.bounds[0, 1], 0.0))


def _with_sidecar(character: Character, path: Path) -> Character:
    """Return a character with what the file beside its own says."""
    beside = path.with_suffix(".toml")
    said = read_sidecar(beside, character.clips)
    for part, joint in said.semantics.items():
        if joint and joint not in character.skeleton.names:
            raise CharacterError(
                f"{beside}: joints.{part}: no joint {joint!r}; there are "
                f"{', '.join(character.skeleton.names)}"
            )
    semantics = {**character.semantics, **said.semantics}
    return replace(character, semantics=semantics, plan=said.plan)


def skin(mesh: Mesh, globals_: Array, morphs: Mapping[str, float] | None = None) -> Array:
    """Return the vertices of a mesh, (vertices, 3), under `character_from_joint` (joints, 4, 4).

    Linear blend skinning on the processor, for measuring; the renderer does it on the card.
    `morphs` says by name how far each is on.
    """
    matrices = globals_ @ mesh.inverse_bind
    positions = mesh.positions.astype(float)
    for morph in mesh.morphs:
        positions[morph.vertices] += (morphs or {}).get(morph.name, 0.0) * morph.shifts
    points = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
    moved = np.zeros((len(points), 3))
    for corner in range(mesh.joints.shape[1]):
        each = matrices[mesh.joints[:, corner], :3]
        moved += mesh.weights[:, corner, None] * (each @ points[:, :, None])[..., 0]
    return moved
