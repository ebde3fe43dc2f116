"""What the frames of a library do over the ground, and which of them meet a request."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.balance import FAR_BEYOND_HEIGHTS, hips_beyond_feet
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.library import Frames, MotionLibrary

WINDOW_S = 0.5
"""Speed and yaw rate of a frame are means over so long before and after it [s]."""

SPEED_CELL_M_S, YAW_CELL_RAD_S = 0.25, 0.6
"""Frames whose speeds and yaw rates fall into one cell of this size behave alike."""

SPEED_ERROR_M_S = 0.5
"""A speed that is off by this is as bad as a yaw rate that is off by `YAW_CELL_RAD_S`."""

STANDING_M_S = 0.2
"""A slower body stands [m/s]."""

LEAVING_ERRORS = 0.3
"""A behaviour is left for one that is nearer by so many of these errors."""

TOO_FAST_FACTOR = 2.0
"""How much worse it is to be too fast than too slow: a fast body orbits its target."""

MIN_FRAMES = 12
"""Cells with fewer frames are no behaviour of their own."""

GAP_S, HOLD_S = 0.5, 0.4
"""A clip that leaves a behaviour for less than the first time goes on with it; one that has it for
less than the second does not hold it [s]."""

MAX_DRIFT_RAD = math.radians(30)
"""Who moves in a direction farther from where he faces neither walks nor runs ahead [rad]."""

MAX_SPEED_CHANGE = 0.2
"""Who changes his speed by a larger share in `WINDOW_S` does not hold it."""


@dataclass(frozen=True)
class Travel:
    """How the body moves over the ground around each frame of a library."""

    speed: Array
    """Mean speed, (frames,) [m/s]."""

    yaw_rate: Array
    """Mean yaw rate, to the left, (frames,) [rad/s]."""

    drift: Array
    """Direction of its way from where it faces halfway, to the left, (frames,) [rad]."""

    acceleration: Array
    """Change of its speed ahead, (frames,) [m/s²]."""

    on_all_feet: NDArray[np.bool_]
    """Whether all feet are on the ground, (frames,)."""

    @staticmethod
    def of(library: MotionLibrary) -> "Travel":
        """Return what is seen in `WINDOW_S` before and after each frame.

        A clip that ends goes on as in its last frame, and began as in its first.
        """
        reach = round(WINDOW_S * library.rate)
        first = np.arange(len(library))
        for _ in range(reach):
            first = np.where(library.predecessors[first] < 0, first, library.predecessors[first])
        place, yaw = np.zeros((len(library), 2)), np.zeros(len(library))
        ahead = np.zeros((2, len(library)))
        for number in range(2 * reach):
            x, z, turn = library.steps[first].T
            sine, cosine = np.sin(yaw), np.cos(yaw)
            place += np.stack([cosine * x + sine * z, cosine * z - sine * x], axis=-1)
            ahead[number // reach] += z
            yaw += turn
            first = library.onward(first, 1)
        seconds = 2 * reach / library.rate
        # Along an arc, the chord is shorter than the way.
        half = np.clip(np.abs(yaw) / 2, 1e-6, math.pi - 0.5)
        way = np.hypot(*place.T) * half / np.sin(half)
        drift = np.arctan2(*place.T) - yaw / 2
        return Travel(
            way / seconds,
            yaw / seconds,
            np.arctan2(np.sin(drift), np.cos(drift)),
            (ahead[1] - ahead[0]) / (seconds / 2) ** 2,
            np.asarray(library.contacts.all(1)),
        )

    @property
    def stands(self) -> NDArray[np.bool_]:
        """Where it stands, (frames,): who kicks or steps on the spot does not."""
        return (self.speed < STANDING_M_S) & self.on_all_feet

    @property
    def goes_ahead(self) -> NDArray[np.bool_]:
        """Where it moves to where it faces, (frames,)."""
        return (self.speed >= STANDING_M_S) & (np.abs(self.drift) < MAX_DRIFT_RAD)

    @property
    def is_steady(self) -> NDArray[np.bool_]:
        """Where it holds its speed, (frames,)."""
        held: NDArray[np.bool_] = (
            np.abs(self.acceleration) * WINDOW_S < MAX_SPEED_CHANGE * self.speed
        )
        return held


@dataclass(frozen=True)
class Behaviours:
    """The behaviours that the kept frames of a graph have: cells of speed and yaw rate."""

    means: Array
    """Mean speed [m/s] and yaw rate [rad/s] of each behaviour, (behaviours, 2)."""

    members: Frames
    """Behaviour of each frame, −1 for none, (frames,)."""

    @staticmethod
    def of(library: MotionLibrary, kept: NDArray[np.bool_]) -> "Behaviours":
        """Return the behaviours of the kept frames (frames,) of a library.

        To stand, or to hold a speed and a turn ahead: who speeds up, brakes or steps aside is on
        the way to a behaviour, but has none, and neither has who falls. Only where nothing is left
        does every motion count.
        """
        travel = Travel.of(library)
        rates = np.stack([travel.speed, travel.yaw_rate], axis=-1)
        original, kept = kept, kept & _fit_for_play(library, travel, kept)
        cells = np.round(rates / [SPEED_CELL_M_S, YAW_CELL_RAD_S]).astype(np.intp)
        cells[rates[:, 0] < STANDING_M_S] = -1, 0  # whichever way it turns
        _, owner, counts = np.unique(cells[kept], axis=0, return_inverse=True, return_counts=True)
        usual = counts >= min(MIN_FRAMES, counts.max())
        numbers = np.where(usual, np.cumsum(usual) - 1, -1)
        members = np.full(len(library), -1, np.intp)
        members[kept] = numbers[owner.ravel()]
        members = held_behaviours(library, members, original)
        numbers = np.unique(members[members >= 0])
        members = np.where(members < 0, -1, np.searchsorted(numbers, members))
        means = [rates[members == number].mean(0) for number in range(len(numbers))]
        return Behaviours(np.array(means), members)

    def nearest(self, speed: float, yaw_rate: float, present: int = -1) -> int:
        """Return the behaviour that is nearest to a speed [m/s] and yaw rate [rad/s].

        The `present` one is left only for one that is clearly nearer.
        """
        away = (self.means - [speed, yaw_rate]) / [SPEED_ERROR_M_S, YAW_CELL_RAD_S]
        away[:, 0] *= np.where(away[:, 0] > 0.0, TOO_FAST_FACTOR, 1.0)
        if speed < STANDING_M_S:
            away[:, 1] = 0.0  # to stand is more than to keep the heading
        errors = np.sqrt(np.square(away).sum(1))
        if present >= 0:
            errors[present] -= LEAVING_ERRORS
        return int(errors.argmin())

    def goals(self, behaviour: int) -> NDArray[np.bool_]:
        """Return which frames have a behaviour, (frames,)."""
        found: NDArray[np.bool_] = self.members == behaviour
        return found


def held_behaviours(library: MotionLibrary, members: Frames, kept: NDArray[np.bool_]) -> Frames:
    """Return the behaviour of each frame of a clip that holds it, with short gaps filled, or −1.

    `members` are the behaviours of single frames, (frames,). Only `kept` frames fill a gap. Where
    nothing is held, they are returned as they are.
    """
    found = np.full(len(members), -1, np.intp)
    gap, hold = GAP_S * library.rate, HOLD_S * library.rate
    for number, name in enumerate(library.names):
        frames, loop = library.clip(name), bool(library.loops[number])
        for behaviour in np.unique(members[frames][members[frames] >= 0]):
            own = members[frames] == behaviour
            free = kept[frames] & (members[frames] < 0)
            for run in _runs(~own, loop):
                ends = not loop and (run[0] == 0 or run[-1] == len(own) - 1)
                if len(run) <= gap and not ends and free[run].all():
                    own[run] = True
            for run in _runs(own, loop):
                if len(run) >= hold or (loop and own.all()):
                    found[frames[run]] = behaviour
    return found if (found >= 0).any() else members


def _runs(flags: NDArray[np.bool_], loop: bool) -> list[Frames]:
    """Return the runs of set flags in a clip, as frames; in a loop one may pass its end."""
    order = np.roll(np.arange(len(flags)), -int(np.argmin(flags)) if loop else 0)
    changes = np.flatnonzero(np.diff(flags[order], prepend=False, append=False))
    return [order[a:b] for a, b in zip(changes[::2], changes[1::2], strict=True)]


def _fit_for_play(
    library: MotionLibrary, travel: Travel, kept: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Return which frames stand, or hold a speed ahead over their feet; else all, (frames,)."""
    height = float(np.ptp(library.skeleton.rest.globals(library.skeleton)[:, 1, 3]))
    away = hips_beyond_feet(library.positions, library.anatomy) / height
    for going in (
        travel.goes_ahead & travel.is_steady & (away < FAR_BEYOND_HEIGHTS),
        travel.goes_ahead,
    ):
        if (going & kept).sum() >= MIN_FRAMES:
            return going | travel.stands
    return np.ones(len(library), bool)
