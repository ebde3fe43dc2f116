"""Which views a calibration still needs, and which of them to ask for next.

A focal length hides behind the distance as long as the target is met squarely: tilt brings it to
light (20 views tilted by 12° leave it uncertain by 2.8 %, by 35° by 0.4 %). The lens bends the
corners of the picture most, so the target must go there; near views say more than far ones.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TILTED = np.deg2rad(18)
"""A plate is tilted up, down, to the left or the right from this angle on [rad]."""

TOWARDS = np.deg2rad(55)
"""It is tilted in a direction if it is by no more than this from it [rad]."""

NEAR, FAR = 0.20, 0.15
"""A marker's side is this share of the picture's height, at least or at most; a board's twice."""

OUTER = 0.38
"""A target is in a corner of the picture if it is in so much of its width and height."""

Tilt = tuple[str, Array]
TILTS: tuple[Tilt, ...] = tuple(
    (name, np.array(way, float))
    for name, way in (
        ("tilt up", (0, -1)),
        ("tilt down", (0, 1)),
        ("tilt left", (-1, 0)),
        ("tilt right", (1, 0)),
    )
)
"""The ways that a plate can look, in the picture: x right, y down."""

CORNERS = ("top left", "top right", "bottom left", "bottom right")

NEEDED = {
    **{name: 3 for name, _ in TILTS},
    **dict.fromkeys(CORNERS, 2),
    "middle": 2,
    "near": 4,
    "far": 2,
}
"""How many views of each kind are wanted."""

EACH_PLATE = 3
"""How many views of each plate, beside another one, are wanted."""

FIRST = ("tilt up", "tilt left", "tilt down", "tilt right", "near", *CORNERS, "middle", "far")
"""What is asked for first where several kinds are missing alike."""


@dataclass(frozen=True)
class Look:
    """How the target is seen in one picture."""

    centre: tuple[float, float]
    """Its middle in the picture, each 0…1, from the top left."""

    size: float
    """Mean side of the largest plate as a share of the picture's height."""

    tilt: tuple[float, float]
    """Where the plate that is met most squarely looks, beside the camera: angle to the right and
    downwards in the picture [rad]."""

    plates: tuple[int, ...]
    """Numbers of the plates seen."""


def kinds(look: Look, plates: Sequence[str]) -> set[str]:
    """Say which wishes a view fulfils."""
    x, y = look.centre
    found = {
        name
        for name, way in TILTS
        if np.linalg.norm(look.tilt) >= TILTED
        and np.dot(look.tilt, way) >= np.cos(TOWARDS) * np.linalg.norm(look.tilt)
    }
    across = "left" if x < OUTER else "right" if x > 1 - OUTER else ""
    down = "top" if y < OUTER else "bottom" if y > 1 - OUTER else ""
    if across and down:
        found.add(f"{down} {across}")
    if not across and not down:
        found.add("middle")
    large = 2.0 if len(plates) == 1 else 1.0
    found |= {"near"} if look.size >= NEAR * large else set()
    found |= {"far"} if look.size <= FAR * large else set()
    if len(look.plates) > 1:
        found |= {f"side {plates[number]}" for number in look.plates}
    return found


class Coach:
    """Keeps account of the views and says what to ask for.

    Parameters
    ----------
    plates
        Names of the target's plates; with one plate no sides are asked for.
    """

    def __init__(self, plates: Sequence[str]) -> None:
        self._plates = tuple(plates)
        self.needed = dict(NEEDED)
        if len(plates) > 1:
            self.needed |= {f"side {name}": EACH_PLATE for name in plates}
        self.counts: Counter[str] = Counter()
        """How many views of each kind there are."""

    def add(self, look: Look) -> None:
        """Count a view."""
        self.counts.update(kinds(look, self._plates))

    def offered(self, look: Look) -> set[str]:
        """Say which wishes a look would fulfil."""
        return kinds(look, self._plates)

    def share(self, kind: str) -> float:
        """How far a wish is fulfilled, 0…1."""
        return min(1.0, self.counts[kind] / self.needed[kind])

    @property
    def progress(self) -> float:
        """How far all wishes are fulfilled, 0…1."""
        return float(np.mean([self.share(kind) for kind in self.needed]))

    @property
    def content(self) -> bool:
        """Whether all wishes are fulfilled."""
        return not any(True for _ in self.missing())

    def missing(self) -> Iterable[str]:
        """Wishes that are not fulfilled yet."""
        return (kind for kind in self.needed if self.share(kind) < 1)

    def next(self) -> str:
        """Return the wish to ask for now; "" where all are fulfilled.

        It stays the same until it is fulfilled, so that nobody is sent about.
        """
        order = [*FIRST, *self.needed]
        return min(self.missing(), key=order.index, default="")

    def ask_more(self) -> None:
        """Ask for two more of each tilt, and near: the views did not determine the camera."""
        for kind in (*(name for name, _ in TILTS), "near"):
            self.needed[kind] = max(self.needed[kind], self.counts[kind]) + 2
