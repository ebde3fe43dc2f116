"""The keys of a glTF animation, and what lies between them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from characters.formats.gltf.document import DamagedFileError, Json, at
from characters.formats.gltf.file import GltfFile
from characters.formats.gltf.morphs import MorphTable
from characters.formats.gltf.nodes import NodeTree, unit_turns
from characters.skeleton import rotations

Array = NDArray[np.float64]

_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}


@dataclass(frozen=True)
class Track:
    """Keys of one property of one joint, or of the morphs of one mesh."""

    which: int | list[int]
    """The joint, or the columns of the morphs."""

    path: str
    """"translation", "rotation", "scale" or "weights"."""

    times: Array
    """Ascending, (keys,) [s]."""

    values: Array
    """(keys, components); of a cubic spline, tangent in, value and tangent out of each key."""

    interpolation: str
    """"LINEAR", "STEP" or "CUBICSPLINE"."""

    @property
    def speed(self) -> float:
        """How fast it turns at most between keys [rad/s]; 0 where it does not turn but jumps."""
        spans = np.diff(self.times)
        if self.interpolation == "STEP" or self.path != "rotation" or not (spans > 0).any():
            return 0.0
        turns = self.values[1::3] if self.interpolation == "CUBICSPLINE" else self.values
        cosines = np.abs((turns[1:] * turns[:-1]).sum(1)).clip(0.0, 1.0)
        return float((2 * np.arccos(cosines)[spans > 0] / spans[spans > 0]).max())


def read_tracks(
    file: GltfFile, animation: Json, tree: NodeTree, morphs: MorphTable, where: str
) -> list[Track]:
    """Return what an animation does to the skeleton and its morphs; `where` is for warnings."""
    tracks: list[Track] = []
    times_of: dict[int, Array] = {}  # which most channels share
    for number, channel in enumerate(animation["channels"]):
        target = channel["target"]
        which, width = _target(target["path"], target.get("node"), tree, morphs)
        if which is None:
            continue
        with at(f"channel {number}"):
            if channel["sampler"] >= len(animation["samplers"]):
                raise DamagedFileError(f"sampler {channel['sampler']} does not exist")
            sampler = animation["samplers"][channel["sampler"]]
            if sampler["input"] not in times_of:
                times_of[sampler["input"]] = _times(file, sampler["input"])
            times = times_of[sampler["input"]]
            kind = sampler.get("interpolation", "LINEAR")
            values = _values(file, sampler, target["path"], width, len(times))
            if target["path"] == "rotation":
                own = slice(1, None, 3) if kind == "CUBICSPLINE" else slice(None)
                values[own] = unit_turns(values[own], where)
        tracks.append(Track(which, target["path"], times, values, kind))
    return tracks


def _target(
    path: str, node: int | None, tree: NodeTree, morphs: MorphTable
) -> tuple[int | list[int] | None, int]:
    """Return what a channel moves and in how many components; None if nothing that is read."""
    if path == "weights":
        columns = list(morphs.columns.get(-1 if node is None else node, ()))
        return (columns or None), len(columns)
    joint = tree.joint_of_node.get(-1 if node is None else node)
    return (joint, _WIDTHS[path]) if path in _WIDTHS else (None, 0)


def _times(file: GltfFile, accessor: int) -> Array:
    times = file.floats(accessor, 1)
    if not len(times) or (np.diff(times) < 0).any():
        raise DamagedFileError(f"accessor {accessor} has key times that do not ascend, or none")
    return times


def _values(file: GltfFile, sampler: Json, path: str, width: int, keys: int) -> Array:
    """Return (keys, width), three times as many rows for a cubic spline."""
    rows = {"LINEAR": keys, "STEP": keys, "CUBICSPLINE": 3 * keys}
    kind = sampler.get("interpolation", "LINEAR")
    if kind not in rows:
        raise DamagedFileError(f"has interpolation {kind!r:.20}")
    values = file.floats(sampler["output"], 1 if path == "weights" else width)
    needed = rows[kind] * width if path == "weights" else rows[kind]
    if len(values) != needed:
        raise DamagedFileError(f"has {len(values)} values for {keys} keys, not {needed}")
    return values.reshape(-1, width)


def resampled(track: Track, times: Array) -> Array:
    """Return a track's values at the given times, held beyond its ends.

    Cubic splines as in the glTF 2.0 specification, appendix C.
    """
    keys, values = track.times, track.values
    if track.interpolation == "CUBICSPLINE":
        tangents_in, values, tangents_out = values[0::3], values[1::3], values[2::3]
    if len(keys) == 1:
        return np.repeat(values[:1], len(times), axis=0)
    if len(keys) == len(times) and (np.abs(keys - times) <= 1e-3 * (keys[1] - keys[0])).all():
        return values  # baked at this very rate, as most are
    before = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
    span = keys[before + 1] - keys[before]
    u = np.clip((times - keys[before]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    # Frame times and keys were rounded apart: a frame at a key shows exactly that key.
    u = np.where(np.abs(u - np.round(u)) < 1e-3, np.round(u), u)
    a, b = values[before], values[before + 1]
    if track.interpolation == "STEP":
        return np.where(u[:, None] < 1, a, b)
    if track.interpolation == "CUBICSPLINE":
        u, span = u[:, None], span[:, None]
        return (
            (2 * u**3 - 3 * u**2 + 1) * a
            + (u**3 - 2 * u**2 + u) * span * tangents_out[before]
            + (3 * u**2 - 2 * u**3) * b
            + (u**3 - u**2) * span * tangents_in[before + 1]
        )
    if track.path == "rotation":
        return rotations.slerp(a, b, u)
    mixed: Array = a + (b - a) * u[:, None]
    return mixed
