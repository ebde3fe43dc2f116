"""MPEG-4 facial animation parameters (FAPs): faces to and from .fap files.

Sources: ISO/IEC 14496-2, annex C, for the 68 parameters; Ostermann, "Animation of synthetic faces
in MPEG-4", 1998. What a part of the face is in parameters stands in `faps.toml`. The two parameters
of whole visemes and expressions, 1 and 2, are neither written nor read.

A text file begins with the version, a name, the frame rate and the number of frames. Each frame has
a line of 68 flags, which say what is given, and a line with its number and the given values.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.face.lids import numbers_by_name
from cubeling.characters.face.visemes.mouth_morphs import arkit_parts
from cubeling.characters.skeleton.pose import Array
from cubeling.files import FileKind, write_whole
from cubeling.toml_file import bundled

FAP_COUNT = 68
"""How many parameters there are."""

FAP_FILE = FileKind(
    "FAP file",
    (".fap",),
    CharacterError,
    50_000_000,
    "cubeling.characters.face.fap:read_faps",
)
"""A .fap file of at most two hours at 25 Hz."""

_VERSION = "2.1"
_MIRRORED = ((6, 7), (8, 9), (10, 11), (12, 13), (19, 20), (21, 22), (31, 32), (33, 34), (35, 36),
             (37, 38), (41, 42), (53, 54), (55, 56), (57, 58), (59, 60))  # fmt: skip
_OTHER_NAMES = {"blink": ("eyeBlinkLeft", "eyeBlinkRight")}
_FITTING_STEPS = 400


@dataclass(frozen=True, eq=False)
class FapTrack:
    """The parameters of a face over time."""

    rate: float
    """Frames a second, as the file's header says."""

    values: NDArray[np.int64]
    """(frames, 68), in the units of the standard; 0 is a face at rest."""


class FaceParameters:
    """What the morphs of one character are in parameters.

    It knows ARKit's parts of the face, the visemes made of them, blinks and brows; the other morphs
    of a character have no parameters.
    """

    def __init__(self, morphs: Sequence[str]) -> None:
        limits, parts = _table()
        self._limits = limits
        self._of_morph = np.zeros((len(morphs), FAP_COUNT))
        names = numbers_by_name(morphs)
        for name, mix in _known_morphs(parts):
            if name in names:
                self._of_morph[names[name]] = sum(
                    weight * parts[part] for part, weight in mix.items()
                )

    def to_faps(self, weights: Array) -> NDArray[np.int64]:
        """Return the parameters, (…, 68), of morph weights (…, morphs), within their limits."""
        exact = np.asarray(weights) @ self._of_morph
        return np.asarray(np.clip(exact, *self._limits.T).round().astype(np.int64))

    def from_faps(self, values: NDArray[np.int64]) -> Array:
        """Return the morph weights, (frames, morphs), 0…1, that come closest to (frames, 68).

        Least squares by projected gradients (Lin, "Projected gradient methods for nonnegative
        matrix factorization", 2007), with Nesterov's acceleration.
        """
        square = self._of_morph @ self._of_morph.T
        towards = np.asarray(values, float) @ self._of_morph.T
        step = 1.0 / max(float(np.linalg.norm(square, 2)), 1e-9)
        weights = ahead = np.zeros(towards.shape)
        for number in range(_FITTING_STEPS):
            moved = np.clip(ahead - step * (ahead @ square - towards), 0.0, 1.0)
            ahead = moved + number / (number + 3.0) * (moved - weights)
            weights = moved
        return weights


def write_faps(path: Path, track: FapTrack) -> None:
    """Write a .fap file."""
    lines = [f"{_VERSION} {path.stem.replace(' ', '_')} {track.rate:g} {len(track.values)}"]
    for number, row in enumerate(track.values.tolist()):
        lines.append(" ".join("1" if value else "0" for value in row))
        lines.append(" ".join(map(str, (number, *(value for value in row if value)))))
    write_whole(path, "\n".join(lines) + "\n", CharacterError)


def read_faps(path: Path) -> FapTrack:
    """Read a .fap file.

    Raises
    ------
    CharacterError
        It cannot be read, is too large, or is no such file.
    """
    lines = FAP_FILE.read(path).decode("utf-8", "replace").splitlines()
    filled = [(number, line.split()) for number, line in enumerate(lines, 1) if line.strip()]
    rate, count = _header(path, filled[0][1] if filled else [])
    if len(filled) != 1 + 2 * count:
        raise CharacterError(
            f"{path} has {(len(filled) - 1) // 2} of {count} frames: it is cut off"
        )
    values = np.zeros((count, FAP_COUNT), np.int64)
    for frame in range(count):
        (at, mask), (_, given) = filled[1 + 2 * frame : 3 + 2 * frame]
        try:
            shown = np.array([{"0": False, "1": True}[flag] for flag in mask])
            values[frame, shown] = [round(float(value)) for value in given[1:]]
        except (KeyError, ValueError, IndexError, OverflowError):
            raise CharacterError(
                f"{path}, line {at}: no frame of {FAP_COUNT} flags and a value for each that is set"
            ) from None
    values[:, :2] = 0
    return FapTrack(rate, values)


def _header(path: Path, words: Sequence[str]) -> tuple[float, int]:
    """Return the frame rate and the number of frames of the first line."""
    try:
        rate, count = float(words[-2]), int(words[-1])
    except (ValueError, IndexError):
        rate, count = 0.0, -1
    if len(words) < 4 or not words[0].startswith("2.") or not 0.0 < rate <= 1000.0 or count < 0:
        raise CharacterError(
            f"{path} is no .fap file: it begins with a version 2, a name, the rate and the frames"
        )
    return rate, count


def _known_morphs(parts: Mapping[str, Array]) -> Iterator[tuple[str, Mapping[str, float]]]:
    """Yield the normalised name of every morph that has parameters, and its mix of parts."""
    for part in parts:
        yield part.lower(), {part: 1.0}
        stem = part.removesuffix("Left")
        if stem != part:  # one morph for both sides
            yield stem.lower(), {part: 1.0, f"{stem}Right": 1.0}
    for name, both in _OTHER_NAMES.items():
        yield name, dict.fromkeys(both, 1.0)
        for part, side in zip(both, ("left", "right"), strict=True):
            yield name + side, {part: 1.0}
    for shape, mix in arkit_parts().items():
        yield (
            f"viseme{shape.lower()}",
            {
                side: weight
                for stem, weight in mix.items()
                for side in (stem, f"{stem}Left", f"{stem}Right")
                if side in parts
            },
        )


@cache
def _table() -> tuple[Array, dict[str, Array]]:
    """Return the limits of the parameters, (68, 2), and the parameters of parts, (68,) each."""
    data = bundled(Path(__file__).with_name("faps.toml"))
    limits = np.zeros((FAP_COUNT, 2))
    for number, (least, greatest) in data["limits"].items():
        limits[int(number) - 1] = least, greatest
    other = dict(_MIRRORED)
    parts = {}
    for name, mix in data["parts"].items():
        sides = [(name, {int(number): value for number, value in mix.items()})]
        if name.endswith("Left"):
            right = {other.get(number, number): value for number, value in sides[0][1].items()}
            sides.append((f"{name.removesuffix('Left')}Right", right))
        for side, values in sides:
            parts[side] = np.zeros(FAP_COUNT)
            for number, value in values.items():
                parts[side][number - 1] = value
    return limits, parts
