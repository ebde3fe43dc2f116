"""The bundled explorer's gaits.

Amplitudes and phases after the descriptions in Perry & Burnfield, "Gait Analysis" (2010), and
Williams, "The Animator's Survival Kit" (2001), freely exaggerated. Phase 0 is the left heel strike.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.human.acting import FRAME_RATE_HZ, GAZE_PITCH_DEG, pose_with_face
from tools.authoring.human.limbs import (
    FOOT,
    SIDES,
    curl_fingers,
    elbow_rotation,
    hang_arm,
    rotation_deg,
)
from tools.authoring.human.secondary_motion import GRAVITY_M_S2, add_secondary_motion
from tools.authoring.modelling.gait import Footfalls, FootMotion, GroundArc, foot_motion
from tools.authoring.modelling.rig import PosedRig
from tools.authoring.modelling.shapes import Array


@dataclass(frozen=True)
class GaitStyle:
    """Movement of the body in a gait; amplitudes in degrees where no unit is given."""

    bob: float
    """Amplitude of the rise and fall of the pelvis [m]; a run is ballistic instead."""

    lowest: float
    """Phase of its lowest point, in a step from 0 to 0.5."""

    sway: float
    """Sideways shift to the standing leg [m]."""

    pelvis_yaw: float
    """Yaw of the pelvis with the forward leg."""

    pelvis_list: float
    """Drop of the hip of the swinging leg."""

    lean: float
    """Lean of the trunk, forward."""

    chest_yaw: float
    """Yaw of the shoulders against the pelvis."""

    arm_swing: float
    """Amplitude of the swing of the upper arms."""

    arm_back: float
    """Centre of that swing, backward."""

    elbow: float
    """Bend of the elbows in the middle of the swing."""

    elbow_swing: float
    """Additional bend in front, and reduction behind."""

    reach: float
    """Greatest leg extension over the length of a straight leg."""

    head: float
    """Amplitude of the head's nod and tilt."""

    fist: float
    """Bend of the fingers."""

    habit: float
    """How far the two halves of the cycle differ, as a share of the movements."""

    mood: Mapping[str, float]
    """Weights of the face's morph targets by name."""


WALK = GaitStyle(
    0.026, 0.07, 0.024, 10, 4, 4, 15, 30, 4, 24, 16, 0.9965, 2.0, 18, 0.08, {"happy": 0.12}
)
RUN = GaitStyle(
    0.03, 0.12, 0.012, 12, 5, 17, 26, 48, 12, 88, 18, 0.985, 3.6, 58, 0.07, {"happy": 0.4}
)


@dataclass(frozen=True)
class HumanGait:
    """The parameters of one gait."""

    speed: float
    """[m/s]."""

    yaw_rate: float
    """To the left [degrees a second]."""

    frames: int
    """Frames of a cycle; even, so that half of it is a step."""

    steps: Footfalls
    """The feet."""

    style: GaitStyle
    """The rest of the body."""


def _walk(speed: float, yaw_rate: float, frames: int, width: float, ahead: float) -> HumanGait:
    cycle = frames / FRAME_RATE_HZ
    longest = 1.305  # the double step of a straight walk [m]
    part = speed * cycle / longest
    # Walking is an inverted pendulum: it rises with the square of the step (Alexander 1976).
    style = replace(WALK, bob=WALK.bob * part**2, pelvis_yaw=WALK.pelvis_yaw * part)
    strike, off = 0.42 * part, 0.35 + 0.55 * part
    steps = Footfalls(
        cycle, 0.6, width, ahead, strike, off, 0.08 - 0.045 * part,
        rise_from=0.44, retract=0.95, rise_fall=(1.8, 1.8),
    )  # fmt: skip
    return HumanGait(speed, yaw_rate, frames, steps, style)


def _run(speed: float, yaw_rate: float, frames: int, width: float, ahead: float) -> HumanGait:
    cycle = frames / FRAME_RATE_HZ
    steps = Footfalls(
        cycle, 0.27, width, ahead, 0.1, 1.05, 0.19,
        toe_out=0.06, rise_from=0.45, retract=0.6, rise_fall=(1.4, 1.4),
    )  # fmt: skip
    return HumanGait(speed, yaw_rate, frames, steps, RUN)


GAITS = {
    "Walk": _walk(1.35, 0.0, 58, 0.082, -0.04),
    "WalkTurnWide": _walk(1.3, 45.0, 58, 0.084, -0.04),
    "WalkTurnMedium": _walk(1.12, 90.0, 56, 0.09, -0.035),
    "WalkTurnShort": _walk(0.9, 135.0, 52, 0.1, -0.025),
    "Run": _run(3.4, 0.0, 46, 0.06, -0.105),
    "RunTurnWide": _run(3.2, 67.5, 46, 0.07, -0.1),
    "RunTurnMedium": _run(2.8, 135.0, 44, 0.085, -0.085),
}
"""Gaits by name. In tighter turns the speed is lower and the feet are wider apart."""


def gait_clip(skeleton: Skeleton, name: str, gait: HumanGait) -> Clip:
    """Return one cycle of a gait along an arc, as a loop with root motion."""
    path = GroundArc(gait.speed, float(np.radians(gait.yaw_rate)))
    steps, style = gait.steps, gait.style
    phase = np.arange(gait.frames + 1) / gait.frames
    feet = {s: foot_motion(path, steps, FOOT, sign, phase) for s, sign in SIDES}
    rig = PosedRig(skeleton, gait.frames + 1)
    bank = np.arctan(path.speed * path.yaw_rate / 9.81)
    _carry_pelvis(rig, gait, phase, bank)
    _fit_height(rig, feet, style.reach)
    _carry_trunk(rig, style, phase, path.yaw_rate)
    _swing_arms(rig, style, phase)
    for side, foot in feet.items():
        rig.place_foot(side, foot.ankle, foot.facing, foot.toe)
    where, yaw = path.at(phase * steps.cycle)
    add_secondary_motion(rig, steps.cycle, path.speed * path.yaw_rate)
    rig.shift("root", np.stack([where[:, 0], 0 * yaw, where[:, 1]], axis=-1))
    rig.turn("root", rotations.about("y", yaw))
    return Clip(name, FRAME_RATE_HZ, pose_with_face(rig, style.mood), loop=True, root_motion=True)


def _wave(phase: Array, peak: float, times: int = 1) -> Array:
    """Return a cosine that is 1 at phase `peak`, `times` times a cycle."""
    return np.asarray(np.cos(2 * np.pi * times * (phase - peak)))


def _carry_pelvis(rig: PosedRig, gait: HumanGait, phase: Array, bank: float) -> None:
    style, height = gait.style, float(rig.rest("hips")[1])
    sway = style.sway * _wave(phase, 0.28) + 0.55 * height * np.tan(0.5 * bank)
    bob = -style.bob * _wave(phase, style.lowest, 2)
    if gait.steps.stance < 0.5:
        bob = _bounce(gait.steps, phase)
    bob -= style.habit * style.bob * _wave(phase, style.lowest)  # deeper onto the left foot
    surge = 0.3 * style.bob * _wave(phase, style.lowest + 0.3, 2)
    rig.shift("hips", np.stack([sway, bob, surge], axis=-1))
    pitch = 0.45 * style.lean + 1.2 * _wave(phase, 0.1, 2)
    roll = style.pelvis_list * _wave(phase, 0.2) - np.degrees(0.3 * bank)
    rig.turn("hips", rotation_deg(pitch, -style.pelvis_yaw * _wave(phase, 0.02), roll))


def _bounce(steps: Footfalls, phase: Array) -> Array:
    """Return the height of a body that falls freely in flight and is sprung in stance [m]."""
    stance = steps.stance * steps.cycle
    flight = steps.cycle / 2 - stance
    since = phase * steps.cycle % (steps.cycle / 2)  # time since a landing
    depth = GRAVITY_M_S2 * flight * stance / (2 * np.pi)  # at the speed of the landing
    sprung = -depth * np.sin(np.pi * np.minimum(since / stance, 1.0))
    falling = np.maximum(since - stance, 0.0)
    return np.asarray(sprung + GRAVITY_M_S2 / 2 * falling * (flight - falling))


def _fit_height(rig: PosedRig, feet: dict[str, FootMotion], reach: float) -> None:
    """Raise the pelvis as high as the greatest leg extension allows, by bisection."""
    low, high = -0.3, 0.1
    for _ in range(30):
        middle = (low + high) / 2
        rig.shift("hips", [0.0, middle, 0.0])
        longest = max(rig.leg_extension(s, foot.ankle).max() for s, foot in feet.items())
        rig.shift("hips", [0.0, -middle, 0.0])
        low, high = (middle, high) if longest < reach else (low, middle)
    rig.shift("hips", [0.0, low, 0.0])


def _carry_trunk(rig: PosedRig, style: GaitStyle, phase: Array, yaw_rate: float) -> None:
    """Turn the shoulders against the pelvis and keep the head level, facing the path."""
    into = np.degrees(yaw_rate)
    for number, name in enumerate(("spine1", "spine2", "chest")):
        lag = 0.02 * (number + 1)  # overlapping action: each joint follows the one below
        yaw = (style.pelvis_yaw + style.chest_yaw) / 3 * _wave(phase, 0.02 + lag) + 0.03 * into
        roll = -style.pelvis_list * 0.55 * _wave(phase, 0.2 + lag)
        pitch = 0.22 * style.lean + 0.8 * _wave(phase, 0.12 + lag, 2)
        rig.turn(name, rotation_deg(pitch, yaw, roll))
    # The head dips after each landing, and tilts and turns with a delay.
    dip, tilt = style.head * _wave(phase, 0.17, 2), 0.7 * style.head * _wave(phase, 0.32)
    tilt += 10.0 * style.habit
    gaze = rotation_deg(
        GAZE_PITCH_DEG + dip, 0.12 * into + 2 * _wave(phase, 0.12), tilt - 0.04 * into
    )
    above = rotations.multiply(rotations.conjugate(rig.facing("chest")), gaze)
    rig.turn("neck", rotations.slerp(rotations.IDENTITY, above, 0.45))
    rig.face("head", gaze)


def _swing_arms(rig: PosedRig, style: GaitStyle, phase: Array) -> None:
    """Swing the arms against the legs; elbows and hands follow through."""
    for side, sign in SIDES:
        front = 0.52 if sign > 0 else 0.02  # phase at which this arm is in front
        wide = 1.0 + sign * style.habit
        swing = wide * style.arm_swing * _wave(phase, front) - style.arm_back
        rig.turn(
            f"{side}Shoulder",
            rotation_deg(
                0, -sign * 5 * _wave(phase, front - 0.03), sign * 1.5 * _wave(phase, 0.2, 2)
            ),
        )
        hang_arm(rig, side, sign, swing, 20 - 3 * _wave(phase, front))
        bend = style.elbow / wide + style.elbow_swing * _wave(phase, front + 0.07)
        inward = 0.06 * bend + 3 * _wave(phase, front)
        rig.turn(f"{side}ForeArm", elbow_rotation(rig, side, sign, bend, inward))
        late = _wave(phase, front + 0.17)
        rig.turn(f"{side}Hand", rotation_deg(14 * late - 6, 0, sign * -4))
        curl_fingers(rig, side, style.fist, 0.4 * style.fist)


def locomotion(skeleton: Skeleton) -> dict[str, Clip]:
    """Return the twelve gaits, straight and in turns of both sides, by name."""
    clips = []
    for name, gait in GAITS.items():
        if gait.yaw_rate == 0:
            clips.append(gait_clip(skeleton, name, gait))
            continue
        for side, sign in SIDES:
            turn = replace(gait, yaw_rate=sign * gait.yaw_rate)
            clips.append(gait_clip(skeleton, name.replace("Turn", side), turn))
    return {clip.name: clip for clip in clips}
