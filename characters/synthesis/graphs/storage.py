"""One file for a motion library and what was found in it.

A .graph file is a NumPy archive (.npz) without pickled objects: arrays, and one JSON text that
holds the version, the names and the skeleton with its identity.
"""

import hashlib
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from characters.errors import CharacterError
from characters.skeleton import rotations
from characters.skeleton.anatomy import Anatomy
from characters.skeleton.pose import Pose, Skeleton
from characters.synthesis.graphs.candidates import Candidates
from characters.synthesis.library import MotionLibrary

FILE_VERSION = 1
"""Version of the file; it changes when older files can no longer be played."""


WHOLE_BODY = "BP123456"
"""The name of the whole body among the parts."""

_FORMAT = "cubeling motion graph"


@dataclass(frozen=True)
class StoredGraph:
    """What a .graph file holds."""

    library: MotionLibrary
    """The frames."""

    distance: str
    """Name of the distance by which they were compared."""

    profile: str
    """Split profile of its part graphs."""

    thresholds: Mapping[str, float]
    """Threshold of the whole body and of each part, by name."""

    candidates: Mapping[str, Candidates]
    """Look-alikes of the whole body, `WHOLE_BODY`, and of each part of the profile, by name."""


def skeleton_identity(skeleton: Skeleton) -> str:
    """Return a short text that changes with the joints, their order and their rest pose."""
    rest = np.round(
        np.concatenate([skeleton.rest.translations, skeleton.rest.rotations], axis=1), 5
    )
    content = json.dumps([skeleton.names, skeleton.parents]).encode() + (rest + 0.0).tobytes()
    return hashlib.sha256(content).hexdigest()[:16]


def save_graph(stored: StoredGraph, path: Path) -> None:
    """Write a .graph file."""
    library = stored.library
    skeleton, poses = library.skeleton, library.poses
    moving = np.flatnonzero(np.ptp(poses.translations, axis=0).max(1) > 1e-6)
    content: dict[str, Any] = {
        "format": _FORMAT,
        "version": FILE_VERSION,
        "rate": library.rate,
        "clips": library.names,
        "joints": skeleton.names,
        "skeleton": skeleton_identity(skeleton),
        "anatomy": dict(library.anatomy.joints),
        "kind": library.anatomy.kind,
        "distance": stored.distance,
        "profile": stored.profile,
        "thresholds": dict(stored.thresholds),
        "candidates": list(stored.candidates),
    }
    arrays: dict[str, Any] = {
        "content": np.array(json.dumps(content)),
        "parents": np.array(skeleton.parents, np.int32),
        "rest_translations": skeleton.rest.translations,
        "rest_rotations": skeleton.rest.rotations,
        "starts": library.starts.astype(np.int32),
        "loops": library.loops,
        "rotations": poses.rotations.astype(np.float32),
        "fixed_translations": poses.translations[0].astype(np.float32),
        "moving": moving.astype(np.int32),
        "translations": poses.translations[:, moving].astype(np.float32),
        "steps": library.steps.astype(np.float32),
        "contacts": library.contacts,
    }
    for number, candidates in enumerate(stored.candidates.values()):
        pairs = np.stack([candidates.rows, candidates.columns])
        arrays[f"pairs_{number}"] = pairs[:, pairs[0] < pairs[1]].astype(np.int32)
        arrays[f"distances_{number}"] = candidates.distances[pairs[0] < pairs[1]]
        arrays[f"barred_{number}"] = candidates.barred
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


def load_graph(path: Path) -> StoredGraph:
    """Read a .graph file.

    Raises
    ------
    CharacterError
        If it is missing, damaged, of another version, or no graph at all.
    """
    try:
        with path.open("rb") as file:
            if file.read(2) != b"PK":  # every archive begins so
                raise ValueError("it is no archive")
            file.seek(0)
            with np.load(file, allow_pickle=False) as archive:
                content = json.loads(str(archive["content"]))
                if content["format"] != _FORMAT:
                    raise ValueError("it holds something else")
                if content["version"] == FILE_VERSION:
                    return _stored(content, {name: archive[name] for name in archive.files})
    except OSError as error:
        raise CharacterError(f"{path}: {error.strerror or 'not a motion graph'}") from None
    except (
        *(CharacterError, zipfile.BadZipFile, zlib.error),
        *(EOFError, IndexError, KeyError, TypeError, ValueError),
    ) as error:
        reason = " ".join(str(error).split())[:80]
        raise CharacterError(
            f"{path}: not a motion graph ({reason}); build one with: cubeling motions build"
        ) from None
    raise CharacterError(
        f"{path}: written as version {content['version']}, this program reads {FILE_VERSION}; "
        "build it again with: cubeling motions build"
    )


def _stored(content: Mapping[str, Any], arrays: Mapping[str, Any]) -> StoredGraph:
    rest = Pose(arrays["rest_translations"], arrays["rest_rotations"])
    parents = tuple(int(parent) for parent in arrays["parents"])
    skeleton = Skeleton(tuple(content["joints"]), parents, rest)
    if skeleton_identity(skeleton) != content["skeleton"]:
        raise ValueError("its skeleton is damaged")
    frames, joints = arrays["rotations"].shape[:2]
    translations = np.tile(arrays["fixed_translations"].astype(float), (frames, 1, 1))
    translations[:, arrays["moving"]] = arrays["translations"]
    turns = rotations.normalize(arrays["rotations"].astype(float))
    starts = arrays["starts"].astype(np.intp)
    shapes = (joints, arrays["steps"].shape, len(arrays["contacts"]), len(starts), starts[-1])
    if shapes != (len(skeleton), (frames, 3), frames, len(content["clips"]) + 1, frames):
        raise ValueError("its arrays do not belong together")
    if starts[0] != 0 or (np.diff(starts) < 1).any() or not np.isfinite(turns).all():
        raise ValueError("its frames are damaged")
    library = MotionLibrary(
        skeleton,
        Anatomy(content["kind"], {str(k): int(v) for k, v in content["anatomy"].items()}),
        float(content["rate"]),
        tuple(content["clips"]),
        starts,
        arrays["loops"],
        Pose(translations, turns),
        arrays["steps"].astype(float),
        arrays["contacts"],
    )
    candidates = {}
    for number, name in enumerate(content["candidates"]):
        pairs = arrays[f"pairs_{number}"].astype(np.intp)
        distances = arrays[f"distances_{number}"].astype(float)
        if pairs.shape != (2, len(distances)) or (pairs.size and pairs.max() >= frames):
            raise ValueError("its edges are damaged")
        both = np.concatenate([pairs, pairs[::-1]], axis=1)
        twice = np.concatenate([distances, distances])
        candidates[name] = Candidates(both[0], both[1], twice, arrays[f"barred_{number}"])
    return StoredGraph(
        library,
        content["distance"],
        content["profile"],
        {str(name): float(value) for name, value in content["thresholds"].items()},
        candidates,
    )
