"""The bundled explorer's gaits.

Amplitudes and phases after the descriptions in Perry & Burnfield, "Gait Analysis" (2010), and
Williams, "The Animator's Survival Kit" (2001), freely exaggerated. Phase 0 is the left heel strike.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from characters.motion.clip import Clip
from characters.skeleton import rotations
from characters.skeleton.pose import Pose, Skeleton
from tools.authoring.human.acting import GAZE_PITCH_DEG, pose_with_face
from tools.authoring.human.limbs import (
    FOOT,
    SIDES,
    curl_fingers,
    elbow_rotation,
    hang_arm,
    rotation_deg,
)
from tools.authoring.human.secondary_motion import add_secondary_motion
from tools.authoring.modelling.gait import Footfalls, FootMotion, GroundArc, foot_motion
from tools.authoring.modelling.rig import PosedRig, mirrored
from tools.authoring.modelling.shapes import Array

FRAME_RATE_HZ = 60.0


@dataclass(frozen=True)
class GaitStyle:
    """Movement of the body in a gait; amplitudes in degrees where no unit is given."""

    bob: float
    """Amplitude of the rise and fall of the pelvis [m]."""

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

    mood: Mapping[str, float]
    """Weights of the face's morph targets by name."""


WALK = GaitStyle(0.028, 0.06, 0.024, 9, 5, 4, 15, 30, 4, 24, 16, 0.994, 2.0, 18, {"happy": 0.12})
RUN = GaitStyle(0.032, 0.15, 0.012, 12, 5, 13, 26, 44, 12, 86, 18, 0.985, 3.6, 58, {"happy": 0.4})


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
    longest = 1.395  # the double step of a straight walk [m]
    part = speed * cycle / longest
    # Walking is an inverted pendulum: it rises with the square of the step (Alexander 1976).
    style = replace(WALK, bob=WALK.bob * part**2, pelvis_yaw=WALK.pelvis_yaw * part)
    strike, off = 0.36 * part, 0.35 + 0.7 * part
    steps = Footfalls(cycle, 0.6, width, ahead, strike, off, 0.035, rise_from=0.45)
    return HumanGait(speed, yaw_rate, frames, steps, style)


def _run(speed: float, yaw_rate: float, frames: int, ahead: float) -> HumanGait:
    steps = Footfalls(frames / FRAME_RATE_HZ, 0.29, 0.06, ahead, 0.1, 0.85, 0.17, 0.06, 0.35, 0.55)
    return HumanGait(speed, yaw_rate, frames, steps, RUN)


GAITS = {
    "Walk": _walk(1.35, 0.0, 62, 0.082, -0.07),
    "WalkTurnWide": _walk(1.3, 45.0, 62, 0.084, -0.065),
    "WalkTurnMedium": _walk(1.12, 90.0, 58, 0.09, -0.045),
    "WalkTurnShort": _walk(0.9, 135.0, 52, 0.1, -0.03),
    "Run": _run(3.4, 0.0, 42, -0.11),
    "RunTurnWide": _run(3.2, 67.5, 42, -0.1),
    "RunTurnMedium": _run(2.8, 135.0, 40, -0.09),
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
    _carry_pelvis(rig, style, phase, bank)
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


def _carry_pelvis(rig: PosedRig, style: GaitStyle, phase: Array, bank: float) -> None:
    height = float(rig.rest("hips")[1])
    sway = style.sway * _wave(phase, 0.28) + 0.55 * height * np.tan(0.5 * bank)
    bob = -style.bob * _wave(phase, style.lowest, 2)
    surge = 0.3 * style.bob * _wave(phase, style.lowest + 0.3, 2)
    rig.shift("hips", np.stack([sway, bob, surge], axis=-1))
    pitch = 0.45 * style.lean + 1.2 * _wave(phase, 0.1, 2)
    roll = style.pelvis_list * _wave(phase, 0.2) - np.degrees(0.3 * bank)
    rig.turn("hips", rotation_deg(pitch, -style.pelvis_yaw * _wave(phase, 0.02), roll))


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
        swing = style.arm_swing * _wave(phase, front) - style.arm_back
        rig.turn(
            f"{side}Shoulder",
            rotation_deg(
                0, -sign * 5 * _wave(phase, front - 0.03), sign * 1.5 * _wave(phase, 0.2, 2)
            ),
        )
        hang_arm(rig, side, sign, swing, 20 - 3 * _wave(phase, front))
        bend = style.elbow + style.elbow_swing * _wave(phase, front + 0.07)
        inward = 0.06 * bend + 3 * _wave(phase, front)
        rig.turn(f"{side}ForeArm", elbow_rotation(rig, side, sign, bend, inward))
        late = _wave(phase, front + 0.17)
        rig.turn(f"{side}Hand", rotation_deg(14 * late - 6, 0, sign * -4))
        curl_fingers(rig, side, style.fist, 0.4 * style.fist)


def mirrored_half_cycle(clip: Clip, skeleton: Skeleton, name: str) -> Clip:
    """Return the mirror image of a gait, shifted by half a cycle to start with the left foot."""
    image = mirrored(clip.in_place, skeleton)
    half = (len(clip) - 1) // 2
    order = (np.arange(len(clip)) + half) % (len(clip) - 1)
    pose, morphs = Pose(image.translations[order], image.rotations[order]), clip.poses.morphs
    x, z, yaw = (clip.track * [-1.0, 1.0, -1.0]).T  # an even arc looks the same from any frame
    translations, turns = pose.translations.copy(), pose.rotations.copy()
    translations[:, 0] += np.stack([x, 0 * x, z], axis=-1)
    turns[:, 0] = rotations.multiply(rotations.about("y", yaw), turns[:, 0])
    return Clip(
        name, clip.rate, Pose(translations, turns, None, morphs), clip.loop, clip.root_motion
    )


def locomotion(skeleton: Skeleton) -> dict[str, Clip]:
    """Return the twelve gaits, straight and in turns of both sides, by name."""
    clips = {}
    for name, gait in GAITS.items():
        straight = gait.yaw_rate == 0
        clip = gait_clip(skeleton, name if straight else name.replace("Turn", "Left"), gait)
        clips[clip.name] = clip
        if not straight:
            right = mirrored_half_cycle(clip, skeleton, name.replace("Turn", "Right"))
            clips[right.name] = right
    return clips
