"""Key frames of the whole body from the keys of its parts (Huang 2013, section 8.5).

Every key of any part is a key frame of all. What a part lacks there is filled in.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cubeling.characters.skeleton.pose import Array

Fill = Literal["complex", "lazy"]
"""All parts at every key frame, or only those that have a key there and the important ones."""

LazyFill = Literal["previous", "between"]
"""A lazy fill repeats the previous key, as the thesis draws it, or interpolates, as it says."""


@dataclass(frozen=True, eq=False)
class PartKeys:
    """The keys of one part of the body."""

    times: Array
    """Ascending, (keys,)."""

    values: Array
    """(keys, n)."""

    def between(self, time: float) -> Array:
        """Return the linear interpolation at a time, held beyond the ends, (n,)."""
        after = int(np.searchsorted(self.times, time))
        if after == 0 or after == len(self.times):
            held: Array = self.values[min(after, len(self.times) - 1)]
            return held
        low, high = self.times[after - 1], self.times[after]
        share = (time - low) / (high - low)
        value: Array = self.values[after - 1] + share * (
            self.values[after] - self.values[after - 1]
        )
        return value

    def previous(self, time: float) -> Array:
        """Return the last key not after a time, or the first one, (n,)."""
        value: Array = self.values[max(int(np.searchsorted(self.times, time, "right")) - 1, 0)]
        return value

    def at(self, time: float) -> Array | None:
        """Return the key at exactly a time, (n,), or None."""
        number = int(np.searchsorted(self.times, time))
        there = number < len(self.times) and self.times[number] == time
        return self.values[number] if there else None


@dataclass(frozen=True, eq=False)
class KeyFrame:
    """The parts of a body at one time."""

    time: float
    """That of at least one part's key."""

    parts: Mapping[str, Array]
    """Value of each part, (n,); a lazy fill leaves parts out."""

    filled: tuple[str, ...] = ()
    """Parts whose value was filled in."""


def gather(
    parts: Mapping[str, PartKeys],
    fill: Fill = "complex",
    important: Collection[str] = (),
    lazy_fill: LazyFill = "previous",
) -> list[KeyFrame]:
    """Return the key frames of all parts, in the order of time.

    Parameters
    ----------
    parts
        The keys of each part.
    fill
        Whether all parts are filled in, or the `important` ones.
    important
        Parts that a lazy fill does not leave out.
    lazy_fill
        How it fills them.
    """
    times = sorted({float(time) for keys in parts.values() for time in keys.times})
    frames = []
    for time in times:
        values: dict[str, Array] = {}
        filled = []
        for name, keys in parts.items():
            own = keys.at(time)
            if own is None and (fill == "complex" or name in important):
                between = fill == "complex" or lazy_fill == "between"
                own = keys.between(time) if between else keys.previous(time)
                filled.append(name)
            if own is not None:
                values[name] = own
        frames.append(KeyFrame(time, values, tuple(filled)))
    return frames
