"""Body animation parameters of MPEG-4 (.bap): motions of an H-ANIM body as integers.

Angles are in units of 1e-5 rad, offsets of the body in millimetres. A text file begins with the
version, a name, the frame rate and the number of frames. Each frame has a line of 296 flags, which
say what is given, and a line with its number and the given values.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.formats.loading import MotionOptions, RecordedMotion
from cubeling.characters.formats.mocap.hanim import (
    BAP_COUNT,
    FINGERS,
    hanim_skeleton,
    parameters,
)
from cubeling.characters.formats.mocap.text import CUT_OFF, EXPORT_AGAIN, TextFile
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.files import write_whole

UNIT_RAD = 1e-5
"""What 1 stands for in a parameter of an angle [rad]."""

UNIT_M = 1e-3
"""What 1 stands for in a parameter of an offset [m]."""

MAX_RATE_HZ = 1000.0
"""Files with a higher frame rate are refused [Hz]."""

_VERSION = "2.1"
_STRAIGHT_RAD = 1e-3  # an elbow or a knee that is bent by less has no plane

# Limbs whose middle joint is a hinge: flexed forwards (−1) or backwards (1) about x.
_HINGES = tuple(
    (f"{side}_{upper}", f"{side}_{middle}", f"{side}_{end}", sign)
    for side in "lr"
    for upper, middle, end, sign in (
        ("shoulder", "elbow", "wrist", -1),
        ("hip", "knee", "ankle", 1),
    )
)


@dataclass(frozen=True, eq=False)
class BapTrack:
    """The parameters of a body over time."""

    rate: float
    """Frames a second, as the file's header says."""

    values: NDArray[np.int64]
    """(frames, 296); 0 is a body at rest."""

    def motion(self, name: str) -> Clip:
        """Return the motion of `hanim_skeleton`."""
        skeleton = hanim_skeleton()
        count = len(self.values)
        angles = np.zeros((count, len(skeleton), 3))
        offsets = np.tile(skeleton.rest.translations, (count, 1, 1))
        for number, (joint, axis) in enumerate(parameters()):
            column, row = self.values[:, number], skeleton.index(joint)
            if axis.isupper():
                offsets[:, row, "XYZ".index(axis)] += column * UNIT_M
            else:
                angles[:, row, "zyx".index(axis)] = column * UNIT_RAD
        turns = rotations.from_euler("zyx", angles)
        return Clip(name, self.rate, Pose(offsets, turns), loop=False)


def track_of(clip: Clip) -> BapTrack:
    """Return the parameters of a motion of `hanim_skeleton`.

    Elbows and knees become hinges: what else they turn by is left to the joints above and below,
    so that hands and feet stay where they are. The outer joints of fingers keep their flexion.
    """
    skeleton = hanim_skeleton()
    turns = _reduce(rotations.normalize(clip.poses.rotations))
    angles = _joint_angles(turns)
    moved = clip.poses.translations - skeleton.rest.translations
    values = np.zeros((len(clip), BAP_COUNT), np.int64)
    for number, (joint, axis) in enumerate(parameters()):
        row = skeleton.index(joint)
        exact = (
            moved[:, row, "XYZ".index(axis)] / UNIT_M
            if axis.isupper()
            else angles[:, row, "zyx".index(axis)] / UNIT_RAD
        )
        values[:, number] = np.round(exact)
    return BapTrack(clip.rate, values)


def write_baps(path: Path, track: BapTrack) -> None:
    """Write a .bap file.

    Raises
    ------
    CharacterError
        The file cannot be written.
    """
    lines = [f"{_VERSION} {path.stem.replace(' ', '_')} {track.rate:g} {len(track.values)}"]
    for number, row in enumerate(track.values.tolist()):
        lines.append(" ".join("1" if value else "0" for value in row))
        lines.append(" ".join(map(str, (number, *(value for value in row if value)))))
    write_whole(path, "\n".join(lines) + "\n", CharacterError)


def read_baps(path: Path) -> BapTrack:
    """Read a .bap file.

    Raises
    ------
    CharacterError
        It cannot be read, or is no such file; the message names the line.
    """
    file = TextFile.read(path)
    lines = [(number, line.split()) for number, line in enumerate(file.text.split("\n"), 1)]
    filled = [(number, words) for number, words in lines if words]
    rate, count = _header(file, filled[0][1] if filled else [])
    if len(filled) != 1 + 2 * count:
        raise file.error(filled[-1][0], f"{(len(filled) - 1) // 2} of {count} frames", CUT_OFF)
    file.check_size(BAP_COUNT, count)
    values = np.zeros((count, BAP_COUNT), np.int64)
    for frame in range(count):
        (at, mask), (line, given) = filled[1 + 2 * frame : 3 + 2 * frame]
        shown = np.array([flag == "1" for flag in mask])
        if len(mask) != BAP_COUNT or not set(mask) <= {"0", "1"}:
            raise file.error(at, f"not {BAP_COUNT} flags of 0 or 1", EXPORT_AGAIN)
        if len(given) != 1 + int(shown.sum()):
            raise file.error(line, "not one value for each flag of 1", EXPORT_AGAIN)
        values[frame, shown] = [round(file.number(line, word)) for word in given[1:]]
    return BapTrack(rate, values)


def load_motion(path: Path, options: MotionOptions) -> RecordedMotion:
    """Read a .bap file as the motion of a person of 1.75 m."""
    return RecordedMotion(hanim_skeleton(), read_baps(path).motion(path.stem))


def _header(file: TextFile, words: list[str]) -> tuple[float, int]:
    """Return the frame rate and the number of frames of the first line."""
    try:
        rate, count = float(words[-2]), int(words[-1])
    except (ValueError, IndexError):
        rate, count = math.nan, -1
    if len(words) < 4 or not 0.0 < rate <= MAX_RATE_HZ or count < 1:
        raise file.error(1, "not a version, a name, a rate and a number of frames", EXPORT_AGAIN)
    return rate, count


def _reduce(turns: Array) -> Array:
    """Return local rotations (frames, joints, 4) that the parameters can express."""
    index = hanim_skeleton().index
    turns = turns.copy()

    def hand_down(joint: str, child: str, kept: Array) -> None:
        """Let a joint keep a rotation, and its child turn by what is left."""
        left = rotations.multiply(rotations.conjugate(kept), turns[:, index(joint)])
        turns[:, index(joint)] = kept
        turns[:, index(child)] = rotations.multiply(left, turns[:, index(child)])

    for side in "lr":
        collarbone = f"{side}_sternoclavicular"
        z_y = _zyx(turns[:, index(collarbone)])
        z_y[:, 2] = 0.0
        hand_down(collarbone, f"{side}_shoulder", rotations.from_euler("zyx", z_y))
    for upper, middle, end, sign in _HINGES:
        above, flexion = _hinge(turns[:, index(middle)], sign)
        spin = rotations.about("y", above)
        turns[:, index(upper)] = rotations.multiply(turns[:, index(upper)], spin)
        bent = rotations.multiply(rotations.conjugate(spin), turns[:, index(middle)])
        turns[:, index(middle)] = bent
        hand_down(middle, end, rotations.about("x", flexion))
    for side in "lr":
        ankle = turns[:, index(f"{side}_ankle")]
        y_x = np.stack([np.zeros(len(ankle)), *_yxz(ankle)[:, :2].T], axis=-1)
        hand_down(f"{side}_ankle", f"{side}_subtalar", rotations.from_euler("zyx", y_x))
        outer = [(f"{finger}{number}", "z") for finger in FINGERS for number in (2, 3)]
        outer += [("thumb2", "x"), ("thumb3", "x"), ("metatarsal", "x")]
        for joint, axis in outer:
            turns[:, index(f"{side}_{joint}")] = _twist(turns[:, index(f"{side}_{joint}")], axis)
    return turns


def _hinge(turns: Array, sign: int) -> tuple[Array, Array]:
    """Return the angles t, f (frames,) [rad] of rotations Ry(t) Rx(f) Ry(u); f has the sign.

    A straight limb has no plane: it keeps that of the frame before.
    """
    matrices = rotations.to_matrix(turns)
    flexion = np.arccos(np.clip(matrices[:, 1, 1], -1.0, 1.0))
    above = np.arctan2(sign * matrices[:, 0, 1], sign * matrices[:, 2, 1])
    bent = flexion > _STRAIGHT_RAD
    last = np.maximum.accumulate(np.where(bent, np.arange(len(bent)), -1))
    first = int(np.argmax(bent))
    held = np.where(last >= 0, last, first)
    above = np.where(bent.any(), above[held], 0.0)
    return above, np.where(bent, sign * flexion, 0.0)


def _twist(turns: Array, axis: str) -> Array:
    """Return the part of rotations (frames, 4) about an axis."""
    kept = np.zeros(turns.shape)
    kept[:, 3] = turns[:, 3]
    kept[:, "xyz".index(axis)] = turns[:, "xyz".index(axis)]
    kept[np.linalg.norm(kept, axis=1) < 1e-9] = rotations.IDENTITY
    return rotations.normalize(kept)


def _joint_angles(turns: Array) -> Array:
    """Return the angles (frames, joints, 3) [rad] about z, y and x of local rotations.

    Joints without a parameter for z turn about y by up to half a turn.
    """
    skeleton, angles = hanim_skeleton(), _zyx(turns)
    with_z = {joint for joint, axis in parameters() if axis == "z"}
    flat = [number for number, joint in enumerate(skeleton.names) if joint not in with_z]
    m = rotations.to_matrix(turns[:, flat])
    angles[:, flat, 0] = 0.0
    angles[:, flat, 1] = np.arctan2(-m[..., 2, 0], m[..., 0, 0])
    angles[:, flat, 2] = np.arctan2(-m[..., 1, 2], m[..., 1, 1])
    return angles


def _zyx(turns: Array) -> Array:
    """Return the angles (…, 3) [rad] about z, y and x of rotations Rz Ry Rx."""
    m = rotations.to_matrix(turns)
    angles: Array = np.stack(
        [
            np.arctan2(m[..., 1, 0], m[..., 0, 0]),
            np.arcsin(np.clip(-m[..., 2, 0], -1.0, 1.0)),
            np.arctan2(m[..., 2, 1], m[..., 2, 2]),
        ],
        axis=-1,
    )
    return angles


def _yxz(turns: Array) -> Array:
    """Return the angles (…, 3) [rad] about y, x and z of rotations Ry Rx Rz."""
    m = rotations.to_matrix(turns)
    angles: Array = np.stack(
        [
            np.arctan2(m[..., 0, 2], m[..., 2, 2]),
            np.arcsin(np.clip(-m[..., 1, 2], -1.0, 1.0)),
            np.arctan2(m[..., 1, 0], m[..., 1, 1]),
        ],
        axis=-1,
    )
    return angles
