"""Files of motions: NumPy archives (.npz) without pickled objects.

An archive holds arrays, and one JSON text, "content", with its format, its version, names, and the
skeleton with its identity.
"""

import hashlib
import json
import os
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Pose, Skeleton
from cubeling.files import FileKind, whole_file

MAX_UNPACKED_BYTES = 1 << 30
"""Most bytes of the arrays of a file: an hour of a body takes a tenth of it."""

MOST_COMPRESSION = 100
"""How many times as large as the file its arrays may be; ours are at most ten times as large."""

Content = Mapping[str, Any]
"""What the JSON text says."""

Arrays = Mapping[str, Any]
"""The arrays by name."""

_T = TypeVar("_T")


@dataclass(frozen=True)
class ArchiveFormat:
    """A kind of file."""

    name: str
    """What the file says that it is."""

    version: int
    """It changes when older files can no longer be read."""

    kind: FileKind
    """Its files: their suffix, and how large they may be."""

    made_by: str
    """The command that makes one."""

    def save(self, path: Path, content: Content, arrays: Arrays) -> None:
        """Write content and arrays to a file of this format."""
        text = json.dumps({"format": self.name, "version": self.version, **content})
        with whole_file(path, CharacterError) as partial, partial.open("wb") as file:
            np.savez_compressed(file, content=np.array(text), **arrays)

    def load(self, path: Path, read: Callable[[Content, Arrays], _T]) -> _T:
        """Return what `read` makes of a file; it raises ValueError if something is wrong.

        Raises
        ------
        CharacterError
            If the file is missing, damaged, of another version, or something else.
        """
        with self.kind.open(path) as file:
            try:
                _check_archive(file)
                with np.load(file, allow_pickle=False) as archive:
                    content = json.loads(str(archive["content"]))
                    if content["format"] != self.name:
                        raise ValueError("it holds something else")
                    if content["version"] == self.version:
                        return read(content, {name: archive[name] for name in archive.files})
            except (
                *(CharacterError, zipfile.BadZipFile, zlib.error),
                *(AttributeError, EOFError, IndexError, KeyError, OSError, TypeError, ValueError),
                *(OverflowError, RecursionError, struct.error),
                *(NotImplementedError, tokenize.TokenError),  # of zipfile, and of numpy's headers
            ) as error:
                reason = " ".join(str(error).split())[:80]
                raise CharacterError(
                    f"{path}: not {self._one} ({reason}); make one with: {self.made_by}"
                ) from None
        raise CharacterError(
            f"{path}: written as version {content['version']}, this program reads {self.version}; "
            f"make it again with: {self.made_by}"
        )

    def load_once(self, path: Path, read: Callable[[Content, Arrays], _T]) -> _T:
        """Return what `load` does; a file that has not changed is read once."""
        try:
            changed = path.stat().st_mtime_ns
        except (OSError, ValueError):
            changed = 0  # the reader says what is wrong
        loaded: _T = _load(self, path, changed, read)
        return loaded

    @property
    def _one(self) -> str:
        return f"{'an' if self.kind.name[0] in 'aeiou' else 'a'} {self.kind.name}"


def _check_archive(file: BinaryIO) -> None:
    """Refuse what is no archive, or one whose arrays are far larger than it; back to its start."""
    if file.read(2) != b"PK":  # every archive begins so
        raise ValueError("it is no archive")
    size = file.seek(0, os.SEEK_END)
    with zipfile.ZipFile(file) as archive:
        unpacked = sum(member.file_size for member in archive.infolist())
    if unpacked > min(MAX_UNPACKED_BYTES, 100_000 + MOST_COMPRESSION * size):
        raise ValueError(f"its {size} bytes stand for {unpacked}")
    file.seek(0)


@lru_cache(maxsize=16)
def _load(
    kind: ArchiveFormat, path: Path, changed: int, read: Callable[[Content, Arrays], Any]
) -> Any:
    return kind.load(path, read)


def skeleton_identity(skeleton: Skeleton) -> str:
    """Return a short text that changes with the joints, their order and their rest pose."""
    rest = np.round(
        np.concatenate([skeleton.rest.translations, skeleton.rest.rotations], axis=1), 5
    )
    content = json.dumps([skeleton.names, skeleton.parents]).encode() + (rest + 0.0).tobytes()
    return hashlib.sha256(content).hexdigest()[:16]


def skeleton_content(skeleton: Skeleton, anatomy: Anatomy) -> tuple[Content, Arrays]:
    """Return the part of a file that holds a skeleton."""
    content = {
        "joints": skeleton.names,
        "skeleton": skeleton_identity(skeleton),
        "anatomy": dict(anatomy.joints),
        "kind": anatomy.kind,
    }
    arrays = {
        "parents": np.array(skeleton.parents, np.int32),
        "rest_translations": skeleton.rest.translations,
        "rest_rotations": skeleton.rest.rotations,
    }
    return content, arrays


def read_skeleton(content: Content, arrays: Arrays) -> tuple[Skeleton, Anatomy]:
    """Return the skeleton that a file holds, and its anatomy."""
    rest = Pose(arrays["rest_translations"], arrays["rest_rotations"])
    parents = tuple(int(parent) for parent in arrays["parents"])
    skeleton = Skeleton(tuple(content["joints"]), parents, rest)
    if skeleton_identity(skeleton) != content["skeleton"]:
        raise ValueError("its skeleton is damaged")
    parts = {str(part): int(joint) for part, joint in content["anatomy"].items()}
    return skeleton, Anatomy(content["kind"], parts)
