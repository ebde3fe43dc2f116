"""From the animations of a glTF file to clips at a uniform rate."""

import numpy as np
from numpy.typing import NDArray

from characters.formats.gltf.document import DamagedFileError, Json, at, called
from characters.formats.gltf.file import GltfFile
from characters.formats.gltf.morphs import MorphTable
from characters.formats.gltf.nodes import NodeTree, unique
from characters.formats.gltf.tracks import Track, read_tracks, resampled
from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.pose import Pose, Skeleton

Array = NDArray[np.float64]

_RATES = (24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0)
_FALLBACK_RATE = 120.0  # keys at no common rate: finer than any that people animate at
_STRAIGHT = 0.2  # [rad] from frame to frame; going straight there is 0.06 mm off, a metre away
_FASTEST = 1000.0  # [Hz] that a file may state
_MOST_CLIPS = 4096
_LONGEST = 3600.0  # [s]; a longer one is a damaged file that would eat the memory


def read_clips(file: GltfFile, tree: NodeTree, morphs: MorphTable) -> dict[str, Clip]:
    """Return the animations that move the skeleton, by name."""
    animations = file.all("animations")
    if len(animations) > _MOST_CLIPS:
        raise DamagedFileError(
            f"has {len(animations)} animations, of which {_MOST_CLIPS} are read; take some out"
        )
    names = unique([each.get("name") or f"animation{n}" for n, each in enumerate(animations)])
    clips: dict[str, Clip] = {}
    for number, (name, animation) in enumerate(zip(names, animations, strict=True)):
        where = called("animation", number, animation)
        with at(where):
            tracks = read_tracks(file, animation, tree, morphs, f"{file.path}: {where}")
            if tracks:
                clips[name] = _clip(file, name, animation, tracks, tree.skeleton, morphs)
    return clips


def _clip(
    file: GltfFile,
    name: str,
    animation: Json,
    tracks: list[Track],
    skeleton: Skeleton,
    morphs: MorphTable,
) -> Clip:
    """Return tracks resampled to one rate; joints without a track keep their rest pose."""
    extras = animation.get("extras")
    extras = extras if isinstance(extras, dict) else {}
    keys = np.unique(np.concatenate([track.times for track in tracks]))
    start, length = keys[0], keys[-1] - keys[0]
    if length > _LONGEST:
        raise DamagedFileError(f"lasts {length:.0f} s, longer than the hour that is read")
    stated = extras.get("rate")
    if isinstance(stated, int | float) and 0 < stated <= _FASTEST:
        rate = float(stated)
    else:
        rate = _fine_enough(_rate(keys - start), tracks)
    frames = round(length * rate) + 1
    width = 10 * len(skeleton) + len(morphs.names) + 4 * len(tracks)
    file.budget.spend(frames * width, f"its {length:.0f} s")
    poses = _poses(tracks, start + np.arange(frames) / rate, skeleton, morphs)
    loop = extras.get("loop")
    return Clip(
        name=name,
        rate=rate,
        poses=poses,
        loop=loop if isinstance(loop, bool) else _closes(poses, skeleton),
        root_motion=skeleton.has_root_motion,
    )


def _poses(tracks: list[Track], times: Array, skeleton: Skeleton, morphs: MorphTable) -> Pose:
    rest = skeleton.rest
    still = np.ones((len(skeleton), 3)) if rest.scales is None else rest.scales
    weights = np.zeros(len(morphs.names)) if morphs.rest is None else morphs.rest
    values = {
        "translation": np.tile(rest.translations, (len(times), 1, 1)),
        "rotation": np.tile(rest.rotations, (len(times), 1, 1)),
        "scale": np.tile(still, (len(times), 1, 1)),
        "weights": np.tile(weights, (len(times), 1)),
    }
    for track in tracks:
        values[track.path][:, track.which] = resampled(track, times)
    unscaled = rest.scales is None and np.allclose(values["scale"], 1.0, atol=1e-4)
    return Pose(
        values["translation"],
        rotations.continuous(rotations.normalize(values["rotation"])),
        None if unscaled else values["scale"],
        values["weights"] if values["weights"].any() else None,
    )


def _rate(keys: Array) -> float:
    """Return the lowest usual rate [Hz], or that of the keys, which has a frame at every key."""
    mean = (len(keys) - 1) / keys[-1] if len(keys) > 1 else 0.0
    for rate in (*_RATES, *((mean,) if 0 < mean < 2 * _FALLBACK_RATE else ())):
        if np.abs(keys * rate - np.round(keys * rate)).max() < 0.01:
            return float(rate)
    return _FALLBACK_RATE


def _fine_enough(rate: float, tracks: list[Track]) -> float:
    """Return the rate times a power of two at which clips, straight between frames, err little."""
    fastest = max(track.speed for track in tracks)
    while fastest / rate > _STRAIGHT and rate <= _FALLBACK_RATE:
        rate *= 2
    return rate


def _closes(poses: Pose, skeleton: Skeleton) -> bool:
    """Whether the last frame is like the first, apart from where joint 0 is."""
    ends = poses[np.array([0, -1])]
    turn = rotations.to_rotation_vector(
        rotations.multiply(rotations.conjugate(ends.rotations[0]), ends.rotations[1])
    )
    return bool(np.abs(turn[int(skeleton.has_root_motion) :]).max(initial=0.0) < 0.1)
