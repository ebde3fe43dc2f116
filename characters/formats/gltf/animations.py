"""Reading animations as clips at a uniform rate."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.formats.gltf.document import DamagedFileError, Json, error_context, label
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.formats.gltf.morphs import MorphTable
from cubeling.characters.formats.gltf.nodes import NodeTree, unique_names, unit_quaternions
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton

_COMMON_RATES_HZ = (24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0)
_FALLBACK_RATE_HZ = 120.0  # for keys at no common rate; animators use nothing finer
_MAX_FRAME_ANGLE = 0.2  # [rad]; linear interpolation then errs by 0.06 mm at a distance of 1 m
_MAX_LOOP_GAP = 0.1  # [rad] between the last and the first frame of a loop
_MAX_RATE_HZ = 1000.0
_MAX_CLIPS = 4096
_MAX_DURATION_S = 3600.0  # of valid files; longer ones would fill the memory
_COMPONENT_COUNTS = {"translation": 3, "rotation": 4, "scale": 3}


@dataclass(frozen=True)
class _KeyframeTrack:
    """Keyframes of one property of a joint, or of the morph weights of a mesh."""

    target: int | list[int]  # the joint, or the columns of the morphs in the pose
    path: str  # "translation", "rotation", "scale" or "weights"
    times: Array  # ascending, (keys,) [s]
    values: Array  # (keys, components); a cubic spline has in-tangent, value, out-tangent of each
    interpolation: str  # "LINEAR", "STEP" or "CUBICSPLINE"

    @property
    def max_angular_speed(self) -> float:
        """Highest mean speed between two keys [rad/s]; 0 for steps and other properties."""
        spans = np.diff(self.times)
        if self.interpolation == "STEP" or self.path != "rotation" or not (spans > 0).any():
            return 0.0
        quaternions = self.values[1::3] if self.interpolation == "CUBICSPLINE" else self.values
        cosines = np.abs((quaternions[1:] * quaternions[:-1]).sum(1)).clip(0.0, 1.0)
        return float((2 * np.arccos(cosines)[spans > 0] / spans[spans > 0]).max())


def read_clips(file: GltfFile, tree: NodeTree, morphs: MorphTable) -> dict[str, Clip]:
    """Return the animations that move the skeleton, by name."""
    animations = file.all("animations")
    if len(animations) > _MAX_CLIPS:
        raise DamagedFileError(
            f"has {len(animations)} animations, more than {_MAX_CLIPS}; remove some"
        )
    names = unique_names([each.get("name") or f"animation{n}" for n, each in enumerate(animations)])
    clips: dict[str, Clip] = {}
    for number, (name, animation) in enumerate(zip(names, animations, strict=True)):
        where = label("animation", number, animation)
        with error_context(where):
            tracks = _read_tracks(file, animation, tree, morphs, f"{file.path}: {where}")
            if tracks:
                clips[name] = _clip(file, name, animation, tracks, tree.skeleton, morphs)
    return clips


def _clip(
    file: GltfFile,
    name: str,
    animation: Json,
    tracks: list[_KeyframeTrack],
    skeleton: Skeleton,
    morphs: MorphTable,
) -> Clip:
    """Return a clip at a uniform rate; joints without a track keep their rest pose."""
    extras = animation.get("extras")
    extras = extras if isinstance(extras, dict) else {}
    keys = np.unique(np.concatenate([track.times for track in tracks]))
    start, length = keys[0], keys[-1] - keys[0]
    if length > _MAX_DURATION_S:
        raise DamagedFileError(f"lasts {length:.0f} s, longer than an hour")
    stated = extras.get("rate")
    if isinstance(stated, int | float) and 0 < stated <= _MAX_RATE_HZ:
        rate = float(stated)
    else:
        rate = _sufficient_rate(_common_rate(keys - start), tracks)
    frames = round(length * rate) + 1
    width = 10 * len(skeleton) + len(morphs.names) + 4 * len(tracks)
    file.budget.spend(frames * width, f"its {length:.0f} s")
    poses = _poses(tracks, start + np.arange(frames) / rate, skeleton, morphs)
    loop = extras.get("loop")
    return Clip(
        name=name,
        rate=rate,
        poses=poses,
        loop=loop if isinstance(loop, bool) else _is_loop(poses, skeleton),
        root_motion=skeleton.has_root_motion,
    )


def _poses(
    tracks: list[_KeyframeTrack], times: Array, skeleton: Skeleton, morphs: MorphTable
) -> Pose:
    rest = skeleton.rest
    weights = np.zeros(len(morphs.names)) if morphs.rest is None else morphs.rest
    values = {
        "translation": np.tile(rest.translations, (len(times), 1, 1)),
        "rotation": np.tile(rest.rotations, (len(times), 1, 1)),
        "scale": np.tile(rest.scales_or_ones, (len(times), 1, 1)),
        "weights": np.tile(weights, (len(times), 1)),
    }
    for track in tracks:
        values[track.path][:, track.target] = _sample(track, times)
    unscaled = rest.scales is None and np.allclose(values["scale"], 1.0, atol=1e-4)
    return Pose(
        values["translation"],
        rotations.continuous(rotations.normalize(values["rotation"])),
        None if unscaled else values["scale"],
        values["weights"] if values["weights"].any() else None,
    )


def _common_rate(keys: Array) -> float:
    """Return the lowest common rate, or that of the keys, with a frame at every key [Hz]."""
    mean = (len(keys) - 1) / keys[-1] if len(keys) > 1 else 0.0
    for rate in (*_COMMON_RATES_HZ, *((mean,) if 0 < mean < 2 * _FALLBACK_RATE_HZ else ())):
        if np.abs(keys * rate - np.round(keys * rate)).max() < 0.01:
            return float(rate)
    return _FALLBACK_RATE_HZ


def _sufficient_rate(rate: float, tracks: list[_KeyframeTrack]) -> float:
    """Return the rate times a power of two at which linear interpolation is exact enough."""
    fastest = max(track.max_angular_speed for track in tracks)
    while fastest / rate > _MAX_FRAME_ANGLE and rate <= _FALLBACK_RATE_HZ:
        rate *= 2
    return rate


def _is_loop(poses: Pose, skeleton: Skeleton) -> bool:
    """Whether the last frame equals the first, except for the position of joint 0."""
    ends = poses[np.array([0, -1])]
    difference = rotations.to_rotation_vector(
        rotations.multiply(rotations.conjugate(ends.rotations[0]), ends.rotations[1])
    )
    return bool(
        np.abs(difference[int(skeleton.has_root_motion) :]).max(initial=0.0) < _MAX_LOOP_GAP
    )


def _read_tracks(
    file: GltfFile, animation: Json, tree: NodeTree, morphs: MorphTable, where: str
) -> list[_KeyframeTrack]:
    """Return the tracks of an animation that move the skeleton; `where` is for warnings."""
    tracks: list[_KeyframeTrack] = []
    times_of: dict[int, Array] = {}  # shared by most channels
    for number, channel in enumerate(animation["channels"]):
        target = channel["target"]
        moved, width = _target(target["path"], target.get("node"), tree, morphs)
        if moved is None:
            continue
        with error_context(f"channel {number}"):
            if channel["sampler"] >= len(animation["samplers"]):
                raise DamagedFileError(f"sampler {channel['sampler']} does not exist")
            sampler = animation["samplers"][channel["sampler"]]
            if sampler["input"] not in times_of:
                times_of[sampler["input"]] = _key_times(file, sampler["input"])
            times = times_of[sampler["input"]]
            kind = sampler.get("interpolation", "LINEAR")
            values = _key_values(file, sampler, target["path"], width, len(times))
            if target["path"] == "rotation":
                keyed = slice(1, None, 3) if kind == "CUBICSPLINE" else slice(None)
                values[keyed] = unit_quaternions(values[keyed], where)
        tracks.append(_KeyframeTrack(moved, target["path"], times, values, kind))
    return tracks


def _target(
    path: str, node: int | None, tree: NodeTree, morphs: MorphTable
) -> tuple[int | list[int] | None, int]:
    """Return the joint or columns that a channel moves, or None, and its components."""
    if path == "weights":
        columns = list(morphs.columns.get(-1 if node is None else node, ()))
        return (columns or None), len(columns)
    joint = tree.joint_of_node.get(-1 if node is None else node)
    return (joint, _COMPONENT_COUNTS[path]) if path in _COMPONENT_COUNTS else (None, 0)


def _key_times(file: GltfFile, accessor: int) -> Array:
    times = file.floats(accessor, 1)
    if not len(times) or (np.diff(times) < 0).any():
        raise DamagedFileError(f"accessor {accessor} has no key times, or they do not ascend")
    return times


def _key_values(file: GltfFile, sampler: Json, path: str, width: int, keys: int) -> Array:
    """Return (keys, width); a cubic spline has three rows per key."""
    rows = {"LINEAR": keys, "STEP": keys, "CUBICSPLINE": 3 * keys}
    kind = sampler.get("interpolation", "LINEAR")
    if kind not in rows:
        raise DamagedFileError(f"has interpolation {kind!r:.20}")
    values = file.floats(sampler["output"], 1 if path == "weights" else width)
    needed = rows[kind] * width if path == "weights" else rows[kind]
    if len(values) != needed:
        raise DamagedFileError(f"has {len(values)} values instead of {needed}")
    return values.reshape(-1, width)


def _sample(track: _KeyframeTrack, times: Array) -> Array:
    """Return a track's values at some times, constant beyond its ends.

    Cubic splines as in the glTF 2.0 specification, appendix C.
    """
    keys, values = track.times, track.values
    if track.interpolation == "CUBICSPLINE":
        tangents_in, values, tangents_out = values[0::3], values[1::3], values[2::3]
    if len(keys) == 1:
        return np.repeat(values[:1], len(times), axis=0)
    if len(keys) == len(times) and (np.abs(keys - times) <= 1e-3 * (keys[1] - keys[0])).all():
        return values  # already at this rate, as most are
    before = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, len(keys) - 2)
    span = keys[before + 1] - keys[before]
    u = np.clip((times - keys[before]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    # Frame times and key times are rounded differently: a frame at a key has its exact value.
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
