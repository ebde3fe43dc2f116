"""Vleo idles, throws kisses and shouts; the last two with the head, the legs and the tail.

The three intensities of an action share every accent, so that they blend at equal phase.
"""

import numpy as np

from characters.authoring.loops import follow, keys, later, wave
from characters.authoring.vleo_clips import (
    MOUTH_SHUT,
    RATE,
    Flight,
    blink,
    breathe,
    clip,
    corners,
    fly,
    lids,
    tail,
)
from characters.authoring.vleo_rig import BURSTS, FEET, HEARTS, HIDDEN, Performance
from characters.clip import Clip
from characters.pose import Skeleton

IDLE_SECONDS, KISS_SECONDS, SHOUT_SECONDS = 7.0, 2.4, 2.0
LEVELS = ("head", "legs", "tail")
"""Intensity −1, 0 and 1."""
DEGREE = np.pi / 180


def clips(bound: Skeleton) -> dict[str, Clip]:
    """Return all clips by name."""
    made = [clip("idle", idle(), bound)]
    for level, name in enumerate(LEVELS):
        made.append(clip(f"kiss_{name}", kiss(level, bound), bound))
        made.append(clip(f"shout_{name}", shout(level, bound), bound))
    return {each.name: each for each in made}


def idle() -> Performance:
    """Look around, breathe, sway, blink, and wonder about something."""
    act = Performance(round(IDLE_SECONDS * RATE))
    n, seconds = act.frames, IDLE_SECONDS
    breathe(act, 3)
    shift = keys(n, (0.05, 1), (0.36, 1), (0.52, -1), (0.86, -1)) * 0.005
    act.move("hips", x=shift, y=-0.0015 + 0.0015 * wave(n, 6))
    act.turn("hips", up=1.5 * DEGREE * wave(n, 1, 0.1), tilt=-5 * shift, left=6 * shift)
    # Where it looks: the eyes first, the head after them, the neck last.
    look = keys(n, (0.02, 0), (0.10, 17), (0.26, 14), (0.33, -15), (0.50, -17), (0.56, 0)) * DEGREE
    wonder = keys(n, (0.54, 0), (0.62, 1), (0.82, 1), (0.90, 0))
    nod = keys(n, (0, 0), (0.10, 4), (0.30, -5), (0.46, 3), (0.62, 8), (0.82, 6)) * DEGREE
    neck = follow(look, seconds, 0.9, 0.7)
    for joint, share in (("neck1", 0.35), ("neck2", 0.35), ("neck3", 0.3)):
        act.turn(joint, up=0.3 * follow(nod, seconds, 1.0, 0.7), left=share * neck)
    act.turn("neck2", tilt=5 * DEGREE * wonder)
    act.turn("head", up=10 * DEGREE + nod, left=0.6 * follow(look, seconds, 1.5, 0.7))
    act.turn("head", tilt=17 * DEGREE * follow(wonder, seconds, 1.6, 0.45))
    for eye in ("LeftEye", "RightEye"):
        act.turn(eye, left=0.9 * (look - neck), up=4 * DEGREE * wonder)
    lids(act, blink(n, 0.085, 0.315, 0.56, 0.60, 0.90), 0.25 + 0.2 * wonder, 0.0)
    act.turn("jaw", up=keys(n, (0, 0.03), (0.2, 0.05), (0.4, 0.02), (0.62, 0.09), (0.84, -0.03)))
    tail(act, 3 * DEGREE * wave(n, 4, 0.1) + 4 * DEGREE, 6.5 * DEGREE * wave(n, 3), 1.5)
    return act


def kiss(level: int, bound: Skeleton) -> Performance:
    """Draw back, pucker, and throw a kiss that turns into hearts."""
    act = Performance(round(KISS_SECONDS * RATE))
    n = act.frames
    big = (1.0, 1.05, 1.15)[level]
    breathe(act, 1)
    throw = keys(
        n, (0.10, 0), (0.31, 22), (0.44, -28), (0.51, -20), (0.60, -19), (0.80, 2), (0.90, 0)
    )
    throw *= big * DEGREE
    act.turn("neck1", up=throw)
    act.turn("neck2", up=0.6 * later(throw, 0.012))
    act.turn("neck3", up=0.2 * later(throw, 0.024))
    chin = keys(n, (0.10, 10), (0.31, -14), (0.45, 52), (0.53, 43), (0.61, 40), (0.82, 8))
    act.turn("head", up=big * DEGREE * chin)
    lean = keys(n, (0.08, 0), (0.30, -9), (0.45, 18), (0.60, 15), (0.80, 0)) * DEGREE
    act.turn("head", tilt=lean)
    act.turn("neck2", tilt=0.4 * later(lean, 0.03))
    _pucker(act)
    if level >= 1:
        _kiss_legs(act, level)
    if level == 2:
        wag = 18 * DEGREE * wave(n, 5)
        tail(act, DEGREE * keys(n, (0.0, 14), (0.31, 4), (0.47, 20), (0.8, 15)), wag, 1.9, 0.8)
        wiggle = wave(n, 5, -0.03)  # the tail wags the dog
        act.turn("hips", left=7 * DEGREE * wiggle, tilt=3 * DEGREE * wiggle)
        act.turn("chest", left=-5 * DEGREE * wiggle, tilt=-3 * DEGREE * wiggle)
        act.move("hips", x=-0.005 * wiggle)
    else:
        bob = 0.12 * follow(throw, KISS_SECONDS, 2.0, 0.5) * (1 + level)
        tail(act, 4 * DEGREE - bob, (3 + 3 * level) * DEGREE * wave(n, 1), 1.4)
    size, spread = (0.62, 0.92, 1.25)[level], (0.6, 1.0, 1.45)[level]
    flights = [
        Flight(0.45, 0.44, (0.015, 0.115 * spread, 0.085 * spread), size, 0.012, 0.8),
        Flight(
            0.51, 0.42, (0.075 * spread, 0.085 * spread, 0.060 * spread), 0.8 * size, -0.010, -0.9
        ),
        Flight(
            0.57, 0.40, (-0.070 * spread, 0.100 * spread, 0.060 * spread), 0.9 * size, 0.010, 0.9
        ),
    ]
    fly(act, HEARTS, flights[: (2, 3, 3)[level]], bound)
    return act


def _pucker(act: Performance) -> None:
    """Shut the eyes and mouth, push the lips out, and open up into a smile."""
    n = act.frames
    shut = keys(n, (0.29, 0), (0.37, 1), (0.60, 1), (0.68, 0))
    glad = keys(n, (0.0, 0.5), (0.30, 0.5), (0.62, 1), (0.85, 0.6))
    lids(act, shut, glad, 0.0)
    jaw = keys(n, (0.08, 0.02), (0.22, 1), (0.49, 1), (0.56, -0.7), (0.70, -0.5), (0.90, 0.0))
    act.turn("jaw", up=MOUTH_SHUT * jaw)
    corners(act, 0.5 + 0.5 * glad, keys(n, (0.10, 0), (0.27, 1), (0.48, 1), (0.56, 0), (0.97, 0)))
    lips = keys(n, (0.14, 0), (0.27, 0.85), (0.36, 0.9), (0.44, 1.25), (0.50, 0.9), (0.56, 0))
    act.scales["lips"] = np.maximum(lips, HIDDEN)
    act.move("lips", z=keys(n, (0.14, -0.012), (0.30, 0.010), (0.44, 0.016), (0.56, -0.012)))


def _kiss_legs(act: Performance, level: int) -> None:
    """Crouch, rise on the forelegs with one paw up; at full intensity jump for joy."""
    n, hop = act.frames, level == 2
    act.move("hips", z=keys(n, (0.10, 0), (0.31, -0.014), (0.45, 0.010), (0.60, 0.006), (0.84, 0)))
    pitch = keys(n, (0.12, 0), (0.31, -8), (0.45, 9 + 7 * hop), (0.58, 6), (0.82, 0)) * DEGREE
    act.turn("hips", up=pitch)
    act.turn("spine2", up=0.4 * later(pitch, 0.015))
    act.turn("chest", up=0.3 * later(pitch, 0.03))
    if not hop:
        rise = [(0.12, 0), (0.31, -13), (0.44, 7), (0.52, 3), (0.60, -4), (0.68, 2), (0.80, 0)]
        act.move("hips", y=keys(n, *rise) / 1000)
        act.move("hips", x=keys(n, (0.25, 0), (0.45, -0.006), (0.62, -0.005), (0.78, 0)))
        paw = keys(n, (0.33, 0), (0.45, 1), (0.60, 0.9), (0.71, 0), (0.97, 0))
        act.step("LeftFrontFoot", y=0.036 * paw, z=0.020 * paw, toes=-30 * DEGREE * paw)
        return
    jump = [(0.10, 0), (0.31, -20), (0.37, -4), (0.46, 42), (0.55, -8), (0.59, -14), (0.66, -4)]
    again = [(0.74, 16), (0.82, -9), (0.90, 2)]
    act.move("hips", y=keys(n, *jump, *again) / 1000)
    for foot in FEET:
        front = "Front" in foot
        up = keys(n, (0.37, 0), (0.46, 0.058 if front else 0.026), (0.55, 0), (0.68, 0),
                  (0.745, 0.014), (0.81, 0), (0.99, 0))  # fmt: skip
        act.step(foot, y=up, z=(0.4 if front else -0.3) * up, toes=(-12 if front else -9) * up)


def shout(level: int, bound: Skeleton) -> Performance:
    """Glower, draw back, and thrust the head out with the mouth wide open."""
    act = Performance(round(SHOUT_SECONDS * RATE))
    n = act.frames
    breath = keys(n, (0.0, 0), (0.22, 1), (0.34, 0.1), (0.66, 0)) * 0.07
    act.scales["belly"] = np.repeat(1 + breath[:, None], 3, axis=1)
    thrust = keys(n, (0.0, -10), (0.20, 22), (0.30, -40), (0.37, -31), (0.62, -33), (0.76, -6))
    thrust *= (1.0, 0.85, 0.75)[level] * DEGREE
    act.turn("neck1", up=thrust)
    act.turn("neck2", up=0.5 * later(thrust, 0.01))
    act.turn("neck3", up=0.1 * later(thrust, 0.02))
    chin = keys(n, (0.0, 12), (0.20, -22), (0.31, 78), (0.38, 66), (0.62, 70), (0.78, 6))
    act.turn("head", up=DEGREE * chin)
    raging = keys(n, (0.27, 0), (0.34, 1), (0.58, 1), (0.68, 0), (0.97, 0))
    shake = raging * wave(n, 8, 0.30)
    act.turn("head", left=10 * DEGREE * shake, tilt=6 * DEGREE * raging * wave(n, 8, 0.33))
    act.turn("neck2", left=-5 * DEGREE * later(shake, 0.01))
    jaw = keys(
        n, (0.0, -0.10), (0.21, 0.12), (0.30, -0.80), (0.37, -0.68), (0.60, -0.74), (0.72, -0.06)
    )
    act.turn("jaw", up=jaw + 0.05 * raging * wave(n, 16))
    corners(act, keys(n, (0.0, -1), (0.22, -1), (0.30, -0.3), (0.60, -0.3), (0.72, -1)), 0.0)
    lids(act, 0.0, 0.35, keys(n, (0.0, 0.9), (0.22, 1.1), (0.34, 1.0), (0.80, 0.9)))
    if level >= 1:
        _shout_legs(act, level)
    _shout_tail(act, level)
    size, spread = (0.80, 1.15, 1.6)[level], (0.75, 1.0, 1.4)[level]
    flights = [
        Flight(0.30, 0.24, (0.010, 0.065 * spread, 0.075 * spread), size, 0.0, 1.2),
        Flight(0.38, 0.24, (0.070 * spread, 0.075 * spread, 0.050 * spread), 0.8 * size, 0.0, -1.2),
        Flight(0.46, 0.24, (-0.070 * spread, 0.085 * spread, 0.050 * spread), 0.9 * size, 0.0, 1.2),
    ]
    fly(act, BURSTS, flights[: (2, 3, 3)[level]], bound)
    return act


def _shout_legs(act: Performance, level: int) -> None:
    """Brace, lunge and stomp: right, left, right; at full intensity rear up first."""
    n, rear = act.frames, level == 2
    lunge = [(0.0, -5), (0.20, 2 + 4 * rear), (0.30, -13), (0.36, -7)]
    jolts = [(0.44, -4), (0.485, -12), (0.54, -5), (0.585, -4), (0.625, -11), (0.72, -6)]
    act.move("hips", y=keys(n, *lunge, *jolts) / 1000)
    back = -0.016 - 0.006 * rear
    act.move("hips", z=keys(n, (0.0, 0), (0.20, back), (0.31, 0.016), (0.60, 0.014), (0.80, 0)))
    pitch = keys(
        n, (0.0, -3), (0.20, 7 + 10 * rear), (0.30, -7), (0.40, -4), (0.62, -5), (0.80, -3)
    )
    act.turn("hips", up=DEGREE * pitch)
    act.turn("chest", up=0.3 * DEGREE * later(pitch, 0.01))
    sway = raised = np.zeros(n)
    stomps = {"RightFrontFoot": [(0.06, 0.19, 0.30), (0.53, 0.58, 0.625)]}
    stomps["LeftFrontFoot"] = [(0.38, 0.435, 0.485)]
    if rear:
        stomps["LeftFrontFoot"].insert(0, (0.06, 0.19, 0.30))
    for foot, times in stomps.items():
        side = 1.0 if foot.startswith("Left") else -1.0
        raised = np.zeros(n)
        for start, top, down in times:
            high = 1.0 if start < 0.1 else 0.75
            raised = raised + high * keys(
                n, (start, 0), (top, 1), (0.5 * (top + down) + 0.01, 0.9), (down, 0), (0.99, 0)
            )
        act.step(foot, y=(0.034 + 0.016 * rear) * raised, z=0.016 * raised, toes=0.2 * raised)
        sway = sway - side * raised
    act.move("hips", x=0.005 * sway)
    act.turn("hips", tilt=-2.5 * DEGREE * sway)


def _shout_tail(act: Performance, level: int) -> None:
    """Hold the tail stiff; at full intensity slam it down twice and whip it about."""
    n = act.frames
    if level < 2:
        stiff = keys(n, (0.0, 2), (0.22, 5 + 4 * level), (0.33, -3 - 2 * level), (0.6, 1)) * DEGREE
        tail(act, stiff, (1 + 2 * level) * DEGREE * wave(n, 2), 1.2)
        return
    slam = keys(
        n, (0.0, 9), (0.21, 32), (0.31, -13), (0.40, 24), (0.53, 22), (0.625, -12), (0.72, 14)
    )
    whip = keys(
        n,
        (0.0, 0),
        (0.10, -7),
        (0.21, 4),
        (0.31, 0),
        (0.40, 21),
        (0.49, -23),
        (0.59, 14),
        (0.72, -10),
        (0.86, 8),
    )
    tail(act, DEGREE * slam, DEGREE * whip, 1.1, 0.55)
