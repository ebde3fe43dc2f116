"""Writing a motion as a Biovision hierarchy (.bvh), for other programs."""

from pathlib import Path

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.files import write_whole

ROTATION_ORDER = "ZXY"
"""Axes of a joint's rotations in the file, the last one applied first."""

_END_M = 0.05  # length of a joint that nothing follows
_STILL_M = 1e-6  # a joint that moves less has no positions


def save_bvh(
    clip: Clip,
    skeleton: Skeleton,
    anatomy: Anatomy,
    path: Path,
    table_from_character: Array | None = None,
) -> None:
    """Write a clip as a .bvh file: the hips and all joints below them.

    Joints of the file are not rotated at rest. Lengths are in metres. Joints that move in the frame
    of their parent have positions too. Scales and morphs are left out.

    Parameters
    ----------
    clip, skeleton, anatomy
        The motion, and the body that makes it.
    path
        The file.
    table_from_character
        Where the body stands in each frame, (frames, 4, 4), scaled; None for where the clip has it.

    Raises
    ------
    CharacterError
        If the body has no hips, or the file cannot be written.
    """
    hips = anatomy.joint("hips")
    if hips is None:
        raise CharacterError(f"clip {clip.name!r}: a .bvh file begins at the hips")
    joints = subtree(skeleton, hips)
    rest = skeleton.rest.globals(skeleton)
    placed = clip.poses.globals(skeleton)[:, joints]
    size = 1.0
    if table_from_character is not None:
        placed = table_from_character[:, None] @ placed
        size = float(np.linalg.norm(table_from_character[0, :3, 0]))
    turns = rotations.from_matrix(_unscaled(placed[..., :3, :3]))
    still = rotations.from_matrix(_unscaled(rest[joints, :3, :3]))
    facing = rotations.multiply(turns, rotations.conjugate(still))
    row = {joint: number for number, joint in enumerate(joints)}
    above = [row.get(skeleton.parents[joint], -1) for joint in joints]
    local = facing.copy()
    local[:, 1:] = rotations.multiply(rotations.conjugate(facing[:, above[1:]]), facing[:, 1:])
    places = placed[..., :3, 3].copy()
    places[:, 1:] = rotations.rotate(
        rotations.conjugate(facing[:, above[1:]]), places[:, 1:] - places[:, above[1:]]
    )
    offsets = size * (rest[joints, :3, 3] - rest[[skeleton.parents[j] for j in joints], :3, 3])
    moving = np.abs(places - offsets).max((0, 2)) > _STILL_M
    moving[0], offsets[0] = True, 0.0
    angles = np.degrees(_zxy(rotations.to_matrix(local)))
    columns = [
        values[:, joint]
        for joint in _depth_first(above)
        for values in ((places, angles) if moving[joint] else (angles,))
    ]
    values = np.concatenate(columns, axis=1)
    names = [skeleton.names[joint] for joint in joints]
    lines = ["HIERARCHY", *_joint(0, names, above, offsets, moving.tolist()), "MOTION"]
    lines += [f"Frames: {len(values)}", f"Frame Time: {1.0 / clip.rate:.8f}"]
    lines += [" ".join(f"{value:.7g}" for value in frame) for frame in values.tolist()]
    write_whole(path, "\n".join(lines) + "\n", CharacterError)


def _unscaled(matrices: Array) -> Array:
    """Return the rotations (…, 3, 3) in matrices that scale before they rotate."""
    unscaled: Array = matrices / np.linalg.norm(matrices, axis=-2, keepdims=True)
    return unscaled


def _depth_first(above: list[int]) -> list[int]:
    """Return the joints in the order in which the hierarchy names them."""
    order, waiting = [], [0]
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting += [child for child in reversed(range(len(above))) if above[child] == joint]
    return order


def _joint(
    joint: int,
    names: list[str],
    above: list[int],
    offsets: Array,
    moving: list[bool],
    space: str = "",
) -> list[str]:
    """Return the lines of a joint and those below it."""
    rotated = " ".join(f"{axis}rotation" for axis in ROTATION_ORDER)
    channels = f"6 Xposition Yposition Zposition {rotated}" if moving[joint] else f"3 {rotated}"
    offset = " ".join(f"{value:.6f}" for value in offsets[joint])
    kind = "JOINT" if joint else "ROOT"
    lines = [f"{space}{kind} {names[joint]}", f"{space}{{", f"{space}  OFFSET {offset}"]
    lines.append(f"{space}  CHANNELS {channels}")
    children = [child for child, parent in enumerate(above) if parent == joint and child]
    for child in children:
        lines += _joint(child, names, above, offsets, moving, space + "  ")
    if not children:
        end = offsets[joint] / max(float(np.linalg.norm(offsets[joint])), 1e-9) * _END_M
        ends = " ".join(f"{value:.6f}" for value in end)
        lines += [f"{space}  End Site", f"{space}  {{", f"{space}    OFFSET {ends}", f"{space}  }}"]
    return [*lines, f"{space}}}"]


def _zxy(matrices: Array) -> Array:
    """Return the angles (…, 3) [rad] of rotations about z, then the new x, then the new y."""
    about_x = np.arcsin(np.clip(matrices[..., 2, 1], -1.0, 1.0))
    about_z = np.arctan2(-matrices[..., 0, 1], matrices[..., 1, 1])
    about_y = np.arctan2(-matrices[..., 2, 0], matrices[..., 2, 2])
    angles: Array = np.stack([about_z, about_x, about_y], axis=-1)
    return angles
