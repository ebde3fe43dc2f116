"""Full-body clips in place of the bundled explorer, from a few acting curves.

The animator sets curves for weight, gaze and arms. The counterbalance of the trunk and the
follow-through of head, hands and backpack are derived from them, alike in every clip.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton
from tools.authoring.human.face import EXPRESSIONS
from tools.authoring.human.limbs import (
    FOOT,
    SIDES,
    HandTarget,
    curl_fingers,
    elbow_rotation,
    hang_arm,
    reach_target,
    rotation_deg,
)
from tools.authoring.human.secondary_motion import add_secondary_motion
from tools.authoring.modelling.curves import smoothstep, soft_limited, spring_follow
from tools.authoring.modelling.rig import PosedRig
from tools.authoring.modelling.shapes import Array

FRAME_RATE_HZ = 60.0
TOE_OUT_RAD = 0.14
GAZE_PITCH_DEG = -9.0
"""Pitch of the level gaze [degrees]: the viewer looks from above the table."""

MAX_REACH = 0.995
"""Greatest leg extension over the length of a straight leg."""

TOE_RELAX_M = 0.04
"""Height above the ground at which the toes hang loose [m]."""

FOOT_OFFSET_M = 0.118
"""Distance of a foot from the middle [m]."""

Curve = Array | float


@dataclass(frozen=True)
class ActingCurves:
    """The acting of a clip: curves over its frames, or constant numbers."""

    weight: Curve = 0.0
    """Weight shift, −1 on the right leg … 1 on the left."""

    crouch: Curve = 0.0
    """Lowering of the pelvis [m]."""

    air: Curve = 0.0
    """Height of the feet above the ground [m]."""

    heels: Curve = 0.0
    """Lift of both heels over the balls of the feet [degrees]."""

    lean: Curve = 0.0
    """Lean of the trunk, forward [degrees]."""

    twist: Curve = 0.0
    """Twist of the shoulders, to the left [degrees]."""

    side: Curve = 0.0
    """Side bend of the trunk, to the right [degrees]."""

    look: tuple[Curve, Curve] = (0.0, 0.0)
    """Gaze to the left and down [degrees]; the eyes lead, the head follows."""

    head: tuple[Curve, Curve] = (0.0, 0.0)
    """Turn of the head to the left and down, which the eyes compensate [degrees]."""

    tilt: Curve = 0.0
    """Tilt of the head, to the right [degrees]."""

    breath: Curve = 0.0
    """Breathing of chest and shoulders, −1…1."""

    shrug: Curve = 0.0
    """Raise of both shoulders [degrees]."""

    swing: tuple[Curve, Curve] = (3.0, 3.0)
    """Swing of the left and the right upper arm, forward [degrees]."""

    spread: tuple[Curve, Curve] = (0.0, 0.0)
    """Spread of the arms, away from the body [degrees]."""

    bend: tuple[Curve, Curve] = (19.0, 19.0)
    """Bend of the elbows [degrees]."""

    fist: tuple[Curve, Curve] = (18.0, 18.0)
    """Bend of the fingers [degrees]."""

    hands: Mapping[str, HandTarget] = field(default_factory=dict)
    """Targets of hands that do not hang, by "Left" or "Right"."""

    mood: Mapping[str, Curve] = field(default_factory=dict)
    """Weights of the face's morph targets by name."""


def clip_from_acting(
    name: str,
    skeleton: Skeleton,
    seconds: float,
    score: ActingCurves,
    loop: bool,
    rate: float = FRAME_RATE_HZ,
) -> Clip:
    """Return the clip of acting curves, (frames + 1,) each, whose ends are equal."""
    frames = round(seconds * rate)
    rig = PosedRig(skeleton, frames + 1)
    still = np.zeros(frames + 1)
    _stand(rig, score, still)
    _hold_trunk(rig, score, still, seconds)
    _hold_arms(rig, score, still, seconds)
    add_secondary_motion(rig, seconds)
    return Clip(name, rate, pose_with_face(rig, score.mood), loop=loop, root_motion=True)


def pose_with_face(rig: PosedRig, mood: Mapping[str, Curve]) -> Pose:
    """Return the poses of a rig with the weights of its face."""
    pose = rig.pose
    morphs = np.zeros((len(pose.rotations), len(EXPRESSIONS)))
    for name, curve in mood.items():
        morphs[:, list(EXPRESSIONS).index(name)] = np.clip(curve, 0.0, 1.0)
    return Pose(pose.translations, pose.rotations, None, morphs)


def _stand(rig: PosedRig, score: ActingCurves, still: Array) -> None:
    """Place the pelvis over the standing leg with the other hip dropped, and both feet."""
    weight, air, pitch = score.weight + still, score.air + still, np.radians(score.heels + still)
    drop = -0.016 + 0.006 * np.abs(weight) + 0.002 * score.breath - score.crouch + air
    ahead = -0.008 - 0.12 * np.maximum(score.crouch + still, 0.0)
    rig.shift("hips", np.stack([0.042 * weight, drop, ahead], axis=-1))
    pitched = 90 * np.maximum(score.crouch + still, 0.0) + 0.35 * (score.lean + still)
    rig.turn("hips", rotation_deg(1 + pitched, -4 * weight, 3.6 * weight))
    relaxed = 1.0 - 0.5 * smoothstep(air / TOE_RELAX_M)
    places = {}
    for name, sign in SIDES:
        facing = rotations.about("y", sign * TOE_OUT_RAD + still)
        heel = FOOT.ankle - FOOT.ball[0], -FOOT.ball[1]
        up = FOOT.ball[0] + np.cos(pitch) * heel[0] - np.sin(pitch) * heel[1]
        back = FOOT.ball[1] + np.sin(pitch) * heel[0] + np.cos(pitch) * heel[1]
        ankle = np.stack(
            [sign * FOOT_OFFSET_M + still, up + air, -0.012 + 0.014 * sign + still], axis=-1
        )
        ankle += rotations.rotate(facing, back[:, None] * [0.0, 0.0, 1.0])
        places[name] = ankle, rotations.multiply(facing, rotations.about("x", pitch))
    _stay_in_reach(rig, {name: ankle for name, (ankle, _) in places.items()})
    for name, (ankle, foot) in places.items():
        rig.place_foot(name, ankle, foot, relaxed * pitch)


def _stay_in_reach(rig: PosedRig, ankles: Mapping[str, Array]) -> None:
    """Lower the pelvis where a leg would be longer than `MAX_REACH`: its foot would slide."""
    lower = 0.0
    for side, ankle in ankles.items():
        hip = rig.places(f"{side}UpLeg")
        longest = MAX_REACH * np.linalg.norm(hip - ankle, axis=1) / rig.leg_extension(side, ankle)
        apart = np.sum((hip - ankle)[:, [0, 2]] ** 2, axis=1)
        lower = np.maximum(lower, hip[:, 1] - ankle[:, 1] - np.sqrt(longest**2 - apart))
    rig.shift("hips", np.stack([0 * lower, -lower, 0 * lower], axis=-1))


def _hold_trunk(rig: PosedRig, score: ActingCurves, still: Array, seconds: float) -> None:
    """Balance the trunk over the pelvis; the head follows the eyes, and the chest the head."""
    weight, breath = score.weight + still, score.breath + still
    look, nod = (_spring_loop(curve + still, seconds, 2.2, 0.75) for curve in score.look)
    follows = _spring_loop(look, seconds, 1.3, 0.8)
    lean, side = 0.65 * (score.lean + still), score.side + still
    twist = score.twist + still
    rig.turn(
        "spine1",
        rotation_deg(0.3 * lean - 0.6 * breath, 1.5 * weight + 0.05 * follows + 0.3 * twist,
               0.35 * side - 2.4 * weight),
    )  # fmt: skip
    rig.turn(
        "spine2",
        rotation_deg(1.0 + 0.35 * lean - 0.9 * breath, 1.5 * weight + 0.07 * follows + 0.35 * twist,
               0.35 * side - 2.4 * weight),
    )  # fmt: skip
    rig.turn(
        "chest",
        rotation_deg(1.5 + 0.35 * lean - 1.3 * breath, 0.08 * follows + 0.35 * twist,
               0.3 * side - 0.8 * weight),
    )  # fmt: skip
    tilt = _spring_loop(score.tilt + still, seconds, 2.0, 0.6) + 2.2 * weight - 0.10 * look
    own = [curve + still for curve in score.head]
    gaze = rotation_deg(GAZE_PITCH_DEG + nod + own[1] + 0.5 * breath, look + own[0], tilt)
    above = rotations.multiply(rotations.conjugate(rig.facing("chest")), gaze)
    rig.turn("neck", rotations.slerp(rotations.IDENTITY, above, 0.4))
    rig.face("head", gaze)
    across = soft_limited(score.look[0] - look - 0.8 * own[0], 17)
    down = soft_limited(score.look[1] - nod - 0.8 * own[1], 13)
    for side_name, _ in SIDES:
        rig.turn(f"{side_name}Eye", rotation_deg(down, across))


def _hold_arms(rig: PosedRig, score: ActingCurves, still: Array, seconds: float) -> None:
    """Let the arms hang and sway after the trunk, and bring hands to their targets."""
    late = _spring_loop(score.weight + still, seconds, 0.9, 0.6)
    lift = _spring_loop(score.breath + still, seconds, 1.2, 0.9)
    for number, (side, sign) in enumerate(SIDES):
        spread, bend = (curve[number] + still for curve in (score.spread, score.bend))
        swing = score.swing[number] + still
        raised = score.shrug + 1.6 * score.breath + 1.0
        rig.turn(f"{side}Shoulder", rotation_deg(0 * still, 0, sign * raised))
        lower = 24 - spread + 2.2 * sign * late - 1.2 * lift
        hang_arm(rig, side, sign, swing - 2 * lift, lower)
        bend = bend + 2.5 * lift
        rig.turn(f"{side}ForeArm", elbow_rotation(rig, side, sign, bend, 12 + 0.3 * (bend - 19)))
        flop = _spring_loop(swing, seconds, 2.0, 0.5) - swing  # the hand follows the arm
        rig.turn(f"{side}Hand", rotation_deg(-4 - 0.5 * flop, 0, -sign * (3 + 1.5 * lift)))
        if side in score.hands:
            reach_target(rig, side, sign, score.hands[side])
        curl_fingers(rig, side, score.fist[number] + still, 0.45 * (score.fist[number] + still))


def _spring_loop(curve: Array, seconds: float, hertz: float, damping: float) -> Array:
    """Return how a spring follows a loop whose last value equals its first."""
    eased = spring_follow(curve[:-1], seconds, hertz, damping)
    return np.append(eased, eased[0])
