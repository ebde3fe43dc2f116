"""From the animations of a glTF file to clips at a uniform rate."""

from dataclasses import dataclass

import numpy as np
import pygltflib
from numpy.typing import NDArray

from characters import rotations
from characters.clip import Clip
from characters.formats.gltf_file import DamagedFileError, GltfFile
from characters.formats.gltf_morphs import MorphTable
from characters.formats.gltf_nodes import NodeTree
from characters.pose import Pose, Skeleton

Array = NDArray[np.float64]

_RATES = (24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0)
_FALLBACK_RATE = 120.0  # keys at no common rate: finer than any that people animate at
_LONGEST = 3600.0  # [s]; a longer one is a damaged file that would eat the memory
_PATHS = {"translation": 3, "rotation": 4, "scale": 3}


@dataclass(frozen=True)
class _Track:
    """Keys of one property of one joint, or of the morphs of one mesh."""

    which: int | tuple[int, ...]
    """The joint, or the columns of the morphs."""

    path: str
    times: Array
    values: Array
    interpolation: str


def read_clips(file: GltfFile, tree: NodeTree, morphs: MorphTable) -> dict[str, Clip]:
    """Return the animations that move the skeleton, by name."""
    clips: dict[str, Clip] = {}
    for number, animation in enumerate(file.document.animations):
        name = animation.name or f"animation{number}"
        while name in clips:
            name += "'"
        tracks = _tracks(file, animation, tree, morphs)
        if tracks:
            clips[name] = _clip(name, animation.extras or {}, tracks, tree.skeleton, morphs)
    return clips


def _tracks(
    file: GltfFile, animation: pygltflib.Animation, tree: NodeTree, morphs: MorphTable
) -> list[_Track]:
    tracks: list[_Track] = []
    for channel in animation.channels:
        path, node = channel.target.path, channel.target.node
        known = morphs.columns if path == "weights" else tree.joint_of_node
        which = known.get(node)
        width = len(morphs.columns.get(node, ())) if path == "weights" else _PATHS.get(path, 0)
        if which is None or not width:
            continue
        sampler = animation.samplers[channel.sampler]
        times = file.accessor(sampler.input).astype(float)
        values = file.accessor(sampler.output).astype(float)
        interpolation = sampler.interpolation or "LINEAR"
        keys = 3 * len(times) if interpolation == "CUBICSPLINE" else len(times)
        if path == "weights" and values.shape == (keys * width,):
            values = values.reshape(keys, width)
        if not len(times) or values.shape != (keys, width) or (np.diff(times) < 0).any():
            raise DamagedFileError(f"animation {animation.name!r} has keys that do not fit")
        tracks.append(_Track(which, path, times, values, interpolation))
    return tracks


def _clip(
    name: str,
    extras: dict[str, object],
    tracks: list[_Track],
    skeleton: Skeleton,
    morphs: MorphTable,
) -> Clip:
    """Return tracks resampled to one rate; joints without a track keep their rest pose."""
    keys = np.unique(np.concatenate([track.times for track in tracks]))
    start, length = keys[0], keys[-1] - keys[0]
    if not 0 <= length <= _LONGEST:
        raise DamagedFileError(f"animation {name!r} lasts {length:.0f} s")
    stated = extras.get("rate")
    rate = float(stated) if isinstance(stated, int | float) and stated > 0 else _rate(keys - start)
    times = start + np.arange(round(length * rate) + 1) / rate
    rest = skeleton.rest
    still = np.ones((len(skeleton), 3)) if rest.scales is None else rest.scales
    values = {
        "translation": np.tile(rest.translations, (len(times), 1, 1)),
        "rotation": np.tile(rest.rotations, (len(times), 1, 1)),
        "scale": np.tile(still, (len(times), 1, 1)),
        "weights": np.tile(
            np.zeros(len(morphs.names)) if morphs.rest is None else morphs.rest, (len(times), 1)
        ),
    }
    for track in tracks:
        values[track.path][:, track.which] = _resampled(track, times)
    unscaled = rest.scales is None and np.allclose(values["scale"], 1.0, atol=1e-4)
    turns = rotations.continuous(rotations.normalize(values["rotation"]))
    poses = Pose(
        values["translation"],
        turns,
        None if unscaled else values["scale"],
        values["weights"] if values["weights"].any() else None,
    )
    loop = extras.get("loop")
    return Clip(
        name=name,
        rate=rate,
        poses=poses,
        loop=loop if isinstance(loop, bool) else _closes(poses, skeleton),
        root_motion=skeleton.has_root_motion,
    )


def _rate(keys: Array) -> float:
    """Return the lowest usual rate [Hz] that has a frame at every key."""
    gaps = np.diff(keys)
    own = (1.0 / gaps.min(),) if len(gaps) and gaps.min() > 1 / 240 else ()
    for rate in (*_RATES, *own):
        if np.abs(keys * rate - np.round(keys * rate)).max() < 0.01:
            return float(rate)
    return _FALLBACK_RATE


def _resampled(track: _Track, times: Array) -> Array:
    """Return a track's values at the given times, held beyond its ends.

    Cubic splines as in the glTF 2.0 specification, appendix C.
    """
    keys, values = track.times, track.values
    if track.interpolation == "CUBICSPLINE":
        tangents_in, values, tangents_out = values[0::3], values[1::3], values[2::3]
    if len(keys) == 1:
        return np.repeat(values[:1], len(times), axis=0)
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
        return rotations.slerp(rotations.normalize(a), rotations.normalize(b), u)
    mixed: Array = a + (b - a) * u[:, None]
    return mixed


def _closes(poses: Pose, skeleton: Skeleton) -> bool:
    """Whether the last frame is like the first, apart from where joint 0 is."""
    ends = poses[np.array([0, -1])]
    turn = rotations.to_rotation_vector(
        rotations.multiply(rotations.conjugate(ends.rotations[0]), ends.rotations[1])
    )
    return bool(np.abs(turn[int(skeleton.has_root_motion) :]).max(initial=0.0) < 0.1)
