"""One file for a motion library and what was found in it; see `characters.synthesis.archive`."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.synthesis.archive import (
    ArchiveFormat,
    Arrays,
    Content,
    read_skeleton,
    skeleton_content,
)
from cubeling.characters.synthesis.graphs.candidates import Candidates
from cubeling.characters.synthesis.graphs.graph import EdgeRule
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.files import FileKind

GRAPH_FORMAT = ArchiveFormat(
    "cubeling motion graph",
    1,
    FileKind(
        "motion graph",
        (".graph",),
        CharacterError,
        1 << 30,
        "cubeling.characters.synthesis.graphs.storage:load_graph",
    ),
    "cubeling motions build",
)
"""The format of `.graph` files: `cubeling motions build` writes them."""

WHOLE_BODY = "BP123456"
"""The name of the whole body among the parts."""


@dataclass(frozen=True)
class StoredGraph:
    """What a .graph file holds."""

    library: MotionLibrary

    distance: str
    """Name of the distance by which they were compared."""

    profile: str
    """Split profile of its part graphs."""

    thresholds: Mapping[str, float]
    """Threshold of the whole body and of each part, by name."""

    candidates: Mapping[str, Candidates]
    """Look-alikes of the whole body, `WHOLE_BODY`, and of each part of the profile, by name."""

    rule: EdgeRule = "successor"
    """Which frames a jump joins; "same" as printed."""


def save_graph(stored: StoredGraph, path: Path) -> None:
    """Write a .graph file."""
    library, poses = stored.library, stored.library.poses
    moving = np.flatnonzero(np.ptp(poses.translations, axis=0).max(1) > 1e-6)
    body, body_arrays = skeleton_content(library.skeleton, library.anatomy)
    content: dict[str, Any] = {
        **body,
        "rate": library.rate,
        "clips": library.names,
        "distance": stored.distance,
        "profile": stored.profile,
        "thresholds": dict(stored.thresholds),
        "candidates": list(stored.candidates),
        "rule": stored.rule,
    }
    arrays: dict[str, Any] = {
        **body_arrays,
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
    GRAPH_FORMAT.save(path, content, arrays)


def load_graph(path: Path) -> StoredGraph:
    """Read a .graph file.

    Raises
    ------
    CharacterError
        If it is missing, damaged, of another version, or no graph at all.
    """
    return GRAPH_FORMAT.load(path, _read_stored)


def _read_stored(content: Content, arrays: Arrays) -> StoredGraph:
    skeleton, anatomy = read_skeleton(content, arrays)
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
        anatomy,
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
        "same" if content.get("rule") == "same" else "successor",  # files before have none
    )
