"""What a set of motions can do in play, and which clip comes nearest to what it lacks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.balance import FAR_BEYOND_HEIGHTS, hips_beyond_feet
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.behaviours import MIN_FRAMES, WINDOW_S, Travel
from cubeling.characters.synthesis.library import MotionLibrary

RUN_HEIGHTS_S = 1.1
"""Who is faster than this runs [body heights/s]."""

TURN_RAD_S = 0.4
"""Who turns faster than this while he walks or runs can be steered [rad/s]."""

BRISK_M_S2 = 0.4
"""Speed changes faster than this where someone starts or stops [m/s²]."""

FALLING_SHARE = 0.005
"""Share of a clip's frames with the hips far beyond the feet from which it is out of balance."""


@dataclass(frozen=True)
class Capability:
    """Something that motions may be able to do."""

    name: str
    """"stand", "walk", "run", "turn left", "turn right", "start" or "stop"."""

    there: bool
    """Whether they can, and hold it."""

    most: float
    """How fast, how sharply or how suddenly at most; the least speed to stand."""

    least: float
    """The same at least, of speeds that are held; else `most`."""

    unit: str

    clip: str
    """The clip that does it best, or comes nearest to it."""


def capabilities(library: MotionLibrary, kept: NDArray[np.bool_]) -> list[Capability]:
    """Return what the kept frames (frames,) of a library can do and what they lack.

    To walk and to run is to hold a speed ahead; to turn, a speed and a turn; to start and to stop,
    to do so within a clip. Where nothing kept does it, the nearest clip of all is named.
    """
    travel = Travel.of(library)
    run = RUN_HEIGHTS_S * float(np.ptp(library.skeleton.rest.globals(library.skeleton)[:, 1, 3]))
    held = travel.goes_ahead & travel.is_steady
    # Of the half second before and after, one is slow.
    change = travel.acceleration * WINDOW_S / 2
    still = travel.speed - np.abs(change) < 0.5 * travel.speed
    speed, turn = travel.speed, travel.yaw_rate
    every = (
        ("stand", -speed, travel.stands, "m/s"),
        ("walk", -np.abs(speed - 0.7 * run), held & (speed < run), "m/s"),
        ("run", speed, held & (speed >= run), "m/s"),
        ("turn left", turn, held & (turn > TURN_RAD_S), "rad/s"),
        ("turn right", -turn, held & (turn < -TURN_RAD_S), "rad/s"),
        ("start", travel.acceleration, still & (travel.acceleration > BRISK_M_S2), "m/s²"),
        ("stop", -travel.acceleration, still & (travel.acceleration < -BRISK_M_S2), "m/s²"),
    )
    shown = {"stand": speed, "walk": speed, "run": speed}
    return [
        _capability(library, name, best, able & kept, unit, np.abs(shown.get(name, best)))
        for name, best, able, unit in every
    ]


def _capability(
    library: MotionLibrary,
    name: str,
    best: Array,
    able: NDArray[np.bool_],
    unit: str,
    shown: Array,
) -> Capability:
    there = bool(able.sum() >= MIN_FRAMES)
    of = np.flatnonzero(able) if there else np.arange(len(library))
    nearest = int(of[best[of].argmax()])
    values = shown[of] if there else shown[[nearest]]
    clip = library.names[library.clip_of[nearest]]
    return Capability(name, there, float(values.max()), float(values.min()), unit, clip)


def falling(library: MotionLibrary) -> dict[str, float]:
    """Return the clips out of balance: the share of frames with the hips far beyond the feet."""
    height = float(np.ptp(library.skeleton.rest.globals(library.skeleton)[:, 1, 3]))
    away = hips_beyond_feet(library.positions, library.anatomy) > FAR_BEYOND_HEIGHTS * height
    shares = {name: float(away[library.clip(name)].mean()) for name in library.names}
    return {name: share for name, share in shares.items() if share > FALLING_SHARE}
