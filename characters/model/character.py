"""A character: its skeleton, meshes and clips."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import Gaits
from cubeling.characters.model.arkit_wrinkles import with_generic_wrinkles
from cubeling.characters.model.bind_pose import upright_bind_pose
from cubeling.characters.model.constraints import JointConstraint
from cubeling.characters.model.facing import turn_ahead
from cubeling.characters.model.limb_ends import with_limb_ends
from cubeling.characters.model.look_at import LookAt
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.model.sidecar import Sidecar, read_sidecar
from cubeling.characters.model.speaking import gestures_beside
from cubeling.characters.model.springs import SpringBone
from cubeling.characters.model.standing import (
    StandingFactory,
    can_stand,
    recordings_beside,
    standing_factory,
)
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.motion import StandingMotion
from cubeling.characters.motion.trees.plan import Plan
from cubeling.characters.skeleton.anatomy import BODY_PARTS, Anatomy
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.files import first_bytes
from cubeling.registry import Registry

if TYPE_CHECKING:
    from cubeling.characters.ik.reaching.upper_body import UpperBody
    from cubeling.characters.ik.reaching.whole_body import WholeBody
    from cubeling.characters.synthesis.gestures.library import GestureLibrary
    from cubeling.characters.synthesis.idle.pauses import PauseLaw

CHARACTER_READERS: "Registry[Callable[[Path], Character]]" = Registry(
    {
        **dict.fromkeys(
            (".glb", ".gltf", ".vrm"), "cubeling.characters.formats.gltf.reading:load_character"
        ),
        ".fbx": "cubeling.characters.formats.fbx.reading:load_character",
    }
)
"""Readers of a character by the suffix of the file."""

CHARACTER_WRITERS: "Registry[Callable[[Character, Path], None]]" = Registry(
    {".glb": "cubeling.characters.formats.gltf.writing:save"}
)
"""Writers of a character by the suffix of the file."""

_MAGIC = {b"glTF": ".glb", b"Kaydara FBX Binary": ".fbx"}
"""How files of a format begin, with its suffix."""

LENDERS: Mapping[str, str] = {"humanoid": "human", "quadruped": "vleo"}
"""Bundled characters that lend their motions to those without, by the kind of body."""


@dataclass(frozen=True)
class Character:
    """A skinned character with its clips."""

    name: str
    """Its name: that of the file without the suffix."""

    skeleton: Skeleton
    """Joints and rest pose."""

    clips: Mapping[str, Clip]
    """Clips by name, in the order of the file."""

    meshes: tuple[Mesh, ...]
    """Skinned meshes in the frame of the character [m]."""

    morphs: tuple[str, ...] = ()
    """Names of the morphs, in the order of the weights in `Pose.morphs`."""

    semantics: Mapping[str, str] = field(default_factory=dict)
    """Body parts stated by the file: name in `Anatomy` to name of a joint."""

    plan: Plan | None = None
    """How its motions are combined, if its sidecar file says so."""

    body_layers: tuple[str, ...] = ()
    """What its sidecar file asks for besides the layers of all characters."""

    springs: tuple[SpringBone, ...] = ()
    """Joints that swing after the body: those of its file and of its sidecar file."""

    constraints: tuple[JointConstraint, ...] = ()
    """Joints that turn as others do."""

    look_at: LookAt | None = None
    """How its eyes follow a point; None for as far as people's eyes do."""

    standing: StandingFactory | None = None
    """Makes the motion that it stands with from a seed; None for its idle clip."""

    pauses: "PauseLaw | None" = None
    """How long it rests between balance shifts, whoever it stands as; None for as in the thesis."""

    gestures: "GestureLibrary | None" = None
    """With which its hands beat the rhythm of what it says; None for its head alone."""

    seed: int = 0
    """Characters with different seeds stand differently."""

    @staticmethod
    def load(name_or_path: "str | Path") -> "Character":
        """Load a bundled character by its name, or a .glb, .gltf, .vrm or .fbx file.

        A .toml file of the same name next to it may add to it: see `characters.model.sidecar`.

        Parameters
        ----------
        name_or_path
            The name of a bundled character, one of `bundled_names()`, or the path of a file.

        Raises
        ------
        CharacterError
            If there is no such character or file, or it is not a character.
        """
        path, bundled = Path(name_or_path), Character.bundled_names()
        reader = CHARACTER_READERS.get(format_suffix(path))
        if reader is not None and str(name_or_path) not in bundled:
            return _with_sidecar(reader(path), path)
        if path.suffix or len(path.parts) > 1:
            raise CharacterError(
                f"{name_or_path}: not a {_known_suffixes()} file; {conversion_advice(path)}, or "
                f"name a bundled character: {', '.join(bundled)}"
            )
        if str(name_or_path) not in bundled:
            raise CharacterError(
                f"no bundled character {str(name_or_path)!r}; there are "
                f"{', '.join(bundled)}, or give a {_known_suffixes()} file"
            )
        asset = resources.files("cubeling.characters") / "assets" / f"{name_or_path}.glb"
        with resources.as_file(asset) as file:
            return _with_sidecar(CHARACTER_READERS[".glb"](file), file)

    @staticmethod
    def bundled_names() -> tuple[str, ...]:
        """Return the names of the characters that come with the package."""
        assets = resources.files("cubeling.characters") / "assets"
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
        CHARACTER_WRITERS[".glb"](self, Path(path))

    def stand(self) -> StandingMotion | None:
        """Return a new motion for it to stand with; None if it stands with its idle clip."""
        return None if self.standing is None else self.standing(self.seed)

    @cached_property
    def gaits(self) -> Gaits:
        """How it walks and runs, by its clip "Walk" and the others like it.

        To find footfalls takes 0.1 to 0.2 s, so all that walk as this character share them.
        """
        idle = self.stand() or self.clips.get("idle", self.clips["Walk"])
        return Gaits(self.clips, self.skeleton, idle.sample(0.0))

    @cached_property
    def bounds(self) -> Array:
        """Lowest and highest corner of the rest pose, (2, 3) [m]."""
        rest = self.skeleton.rest.globals(self.skeleton)
        placed = [skin(mesh, rest) for mesh in self.meshes]
        points = np.concatenate([p for p in placed if len(p)] or [np.zeros((1, 3))])
        return np.stack([points.min(0), points.max(0)])

    @cached_property
    def anatomy(self) -> Anatomy:
        """Which joint is which body part: as the file states, else guessed.

        Files may rest in mid-stride, so the pose in which the skin was bound is looked at too.
        """
        upright = upright_bind_pose(self.skeleton, self.meshes)
        poses = [self.skeleton] if upright is self.skeleton else [upright, self.skeleton]
        try:
            guesses = [Anatomy.guess(pose, self.semantics) for pose in poses]
        except CharacterError as error:
            raise CharacterError(f"{self.name}: {error}") from None
        return min(guesses, key=lambda guess: (guess.kind == "other", len(guess.missing)))

    @property
    def with_stated_anatomy(self) -> "Character":
        """The same character, whose body parts stay what they are if its skeleton changes."""
        names = {part: self.skeleton.names[joint] for part, joint in self.anatomy.joints.items()}
        return replace(self, semantics={**dict.fromkeys(BODY_PARTS, ""), **names})

    @cached_property
    def lender(self) -> str | None:
        """Bundled character of its kind that lends it motions by default, if it has none to stand.

        See `can_stand` and `characters.retargeting.with_lent_motions`.
        """
        stated = self.standing is not None or self.plan is not None
        if stated or can_stand(self.clips, self.skeleton, self.anatomy):
            return None
        return LENDERS.get(self.anatomy.kind)

    @cached_property
    def upper_body(self) -> "UpperBody":
        """Its torso and arms, which put hands where they are to be."""
        from cubeling.characters.ik.reaching.upper_body import UpperBody

        return UpperBody.of(self.skeleton, self.anatomy)

    @cached_property
    def whole_body(self) -> "WholeBody | None":
        """All of it that puts hands where they are to be; None if only its upper body does."""
        from cubeling.characters.ik.reaching.whole_body import WholeBody

        return WholeBody.of(self.upper_body)

    @property
    def height(self) -> float:
        """Height of the rest pose above the ground [m]."""
        return float(self.bounds[1, 1] - min(self.bounds[0, 1], 0.0))

    @property
    def length(self) -> float:
        """Length of the rest pose from front to back [m]."""
        return float(self.bounds[1, 2] - self.bounds[0, 2])


def format_suffix(path: Path) -> str:
    """Return the suffix of a file's format, in lower case: by its content if the name has none."""
    suffix = path.suffix.lower()
    if suffix in CHARACTER_READERS:
        return suffix
    begin = first_bytes(path, max(map(len, _MAGIC)))
    return next((known for magic, known in _MAGIC.items() if begin.startswith(magic)), suffix)


def conversion_advice(path: Path) -> str:
    """Return what turns a file of another kind into one that can be read."""
    if path.suffix.lower() in (".blend", ".dae"):
        return "open it in Blender and export it as .glb"
    return "convert it"


def _known_suffixes() -> str:
    *others, last = CHARACTER_READERS
    return f"{', '.join(others)} or {last}"


def _with_sidecar(character: Character, path: Path) -> Character:
    """Return a character with what files of the same name add: a .toml, .idle, .gestures file."""
    sidecar_path = path.with_suffix(".toml")
    sidecar = read_sidecar(sidecar_path, character.clips)
    for part, joint in sidecar.joints.items():
        if joint and joint not in character.skeleton.names:
            raise CharacterError(
                f"{sidecar_path}: joints.{part}: no joint {joint!r}; there are "
                f"{', '.join(character.skeleton.names)}"
            )
    face = sidecar.face
    found = replace(
        character,
        meshes=(
            with_generic_wrinkles(character.meshes)
            if face is None
            else face.on(character.meshes, str(sidecar_path))
        ),
        semantics={**character.semantics, **sidecar.joints},
        plan=sidecar.plan,
        body_layers=sidecar.body_layers,
        springs=_springs(character, sidecar),
    )
    skeleton, meshes, clips = with_limb_ends(
        found.skeleton, found.anatomy, found.meshes, found.clips
    )
    found = replace(found, skeleton=skeleton, meshes=meshes, clips=clips)
    skeleton, clips = turn_ahead(found.skeleton, found.anatomy, found.clips)
    found = replace(found, skeleton=skeleton, clips=clips, gestures=gestures_beside(path, skeleton))
    found = replace(found, pauses=sidecar.pauses)
    recordings = recordings_beside(path, found.skeleton)
    if not recordings:
        return found
    parts = found.skeleton, found.anatomy, found.clips
    standing = standing_factory(*parts, recordings, pauses=sidecar.pauses)
    return replace(found, standing=standing)


def _springs(character: Character, sidecar: Sidecar) -> tuple[SpringBone, ...]:
    """Return the spring bones of a character; those of its sidecar file replace its own."""
    bones = {bone.joint: bone for bone in character.springs}
    for group in sidecar.springs:
        for bone in group.bones(character.skeleton, character.meshes, character.height):
            bones[bone.joint] = bone
    return tuple(bones.values())


def skin(
    mesh: Mesh, character_from_joint: Array, morphs: Mapping[str, float] | None = None
) -> Array:
    """Return the vertices of a mesh, (…, vertices, 3), for joint placements (…, joints, 4, 4).

    Linear blend skinning on the CPU, for measurements; the renderer does it on the GPU.
    `morphs` are weights by name.
    """
    matrices = character_from_joint @ mesh.inverse_bind
    positions = mesh.positions.astype(float)
    for morph in mesh.morphs:
        positions[morph.vertices] += (morphs or {}).get(morph.name, 0.0) * morph.displacements
    points = np.concatenate([positions, np.ones((len(positions), 1))], axis=1)
    skinned = np.zeros((*matrices.shape[:-3], len(points), 3))
    for influence in range(mesh.joints.shape[1]):
        each = matrices[..., mesh.joints[:, influence], :3, :]
        skinned += mesh.weights[:, influence, None] * (each @ points[:, :, None])[..., 0]
    return skinned
