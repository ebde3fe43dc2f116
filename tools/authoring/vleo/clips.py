"""Movements that Vleo's clips share: face, tail, breathing and flying effects."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.curves import Array, loop_phases, smoothstep, soft_limited
from tools.authoring.modelling.quadruped import AnimationTracks, loop_clip, solve_poses, swing_tail
from tools.authoring.vleo.expressions import EXPRESSIONS, JAW_HINGE_M
from tools.authoring.vleo.rig import FEET, HIDDEN_SCALE, TAIL


def clip(name: str, anim: AnimationTracks, bound: Skeleton) -> Clip:
    """Return the looping clip of the tracks: its last frame equals its first."""
    return loop_clip(name, anim, bound, FEET, tuple(EXPRESSIONS))


def tail(
    anim: AnimationTracks, up: Array, left: Array, tip: float = 1.6, drag: float = 1.0
) -> None:
    """Swing the tail; see `swing_tail`."""
    swing_tail(anim, TAIL, up, left, tip, 4.2, drag, (0.55, 0.55))


def breathe(anim: AnimationTracks, cycles: int, depth: float = 0.035) -> None:
    """Breathe: expand the belly and raise the chest a little."""
    breath = 0.5 - 0.5 * np.cos(2 * np.pi * cycles * loop_phases(anim.frames))
    anim.scales["belly"] = 1 + depth * breath[:, None] * np.array([1.0, 1.0, 0.5])
    anim.turn("chest", up=0.25 * depth * breath)
    anim.turn("neck1", up=-0.3 * depth * breath)


CARRIED_AGE = 0.15
"""Share of a flight for which the mouth takes an effect along."""


@dataclass(frozen=True)
class EffectFlight:
    """The flight of one heart or one burst."""

    start: float
    """Phase at which it leaves the mouth."""

    life: float
    """Share of the loop for which it is visible."""

    way: tuple[float, float, float]
    """Its destination, from the mouth [m]."""

    size: float
    """Its full scale; 0 for an invisible one that keeps blends consistent."""

    swirl: float = 0.0
    """Amplitude of its sideways swing [m]."""

    facing: float = 0.0
    """Yaw at mid-flight, to the left [rad]."""

    spin: float = 0.0
    """Rotation about the vertical axis over the flight [rad]."""


def animate_effects(
    anim: AnimationTracks, joints: Sequence[str], flights: Sequence[EffectFlight], bound: Skeleton
) -> None:
    """Let effects fly from the middle of the mouth at their start.

    They leave straight ahead while they grow, and spread only then, so that they come out of the
    mouth and not from beside it. None of them stops before it is gone.
    """
    mouth = _open_mouth(anim, bound)
    home = bound.rest.translations
    for joint, flight in zip(joints, flights, strict=True):
        age = ((loop_phases(anim.frames) - flight.start) % 1.0) / flight.life
        alive = age < 1
        age = np.minimum(age, 1.0)
        # The mouth carries it while it is small.
        carried = flight.start + flight.life * soft_limited(age, CARRIED_AGE)
        leaves = mouth[np.round(carried * anim.frames).astype(int) % anim.frames]
        out = 0.7 * (1 - (1 - age) ** 3) + 0.3 * age
        spread = 0.5 * smoothstep(age / 0.7) + 0.5 * age**1.5
        sideways = flight.swirl * np.sin(2 * np.pi * age)
        rise = np.stack([spread, age**1.3, out], axis=1) * np.array(flight.way)
        offset = leaves - home[bound.index(joint)] + rise + sideways[:, None] * np.array([1, 0, 0])
        anim.moves[joint] = np.where(alive[:, None], offset, leaves - home[bound.index(joint)])
        anim.scales[joint] = np.where(
            alive, np.maximum(flight.size * _pop(age), HIDDEN_SCALE), HIDDEN_SCALE
        )
        anim.turn(
            joint,
            left=(flight.facing + flight.spin * (age - 0.5)) * alive,
            tilt=0.3 * np.sin(6 * age) * alive,
        )


def _open_mouth(anim: AnimationTracks, bound: Skeleton) -> Array:
    """Return the middle of the opening between the lips, (frames, 3) [m]."""
    globals_ = solve_poses(anim, bound, FEET).globals(bound)
    rest = bound.rest.globals(bound)[:, :3, 3]
    head, lips = bound.index("head"), bound.index("lips")
    opening = sum(
        (EXPRESSIONS[name].jaw * on for name, on in anim.morphs.items()),
        start=np.zeros(anim.frames),
    )
    turned = rotations.rotate(rotations.about("x", 0.5 * opening), rest[lips] - JAW_HINGE_M)
    at = turned + JAW_HINGE_M - rest[head]
    return np.asarray(
        np.einsum("fij,fj->fi", globals_[:, head, :3, :3], at) + globals_[:, head, :3, 3]
    )


def _pop(age: Array) -> Array:
    """Return the scale over a flight: fast growth with overshoot, full size, then zero."""
    grown = 1.18 * np.sin(np.pi / 2 * np.clip(age / 0.22, 0, 1))
    settle = 0.18 * np.clip((age - 0.22) / 0.2, 0, 1)
    return np.asarray((grown - settle) * np.clip((1 - age) / 0.25, 0, 1) ** 0.5)
