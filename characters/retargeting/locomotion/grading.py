"""Whether a made gait is good: its figures, what a person should know, and what is no gait."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.retargeting.locomotion.gait_cycle import ArcPath, GaitCycle
from cubeling.characters.retargeting.measures import (
    bone_change,
    facing_error,
    knee_quantiles,
    sole_dip,
)
from cubeling.characters.retargeting.recording import Recording

YAW_RATE_PER_ANGULAR = 1.5
"""Yaw rate of the movement trees [°/s], for each degree of their parameter Angular."""

PERSON_LEG_M = 0.92
"""Length of a person's leg; lengths are judged as on a body of this size."""

MAX_SLIDE_CM_S, MAX_SEAM_CM, MAX_SINKING_CM = 1.0, 5.0, 1.0
"""Slide, seam and sinking that nobody sees, on a person."""

MAX_KNEE_EXCESS_DEG, MAX_FACING_ERROR_DEG = 8.0, 30.0
"""Bend of the knees beyond the recording, and angle beside the way, that nobody sees."""

MAX_BONE_CHANGE = 0.01
"""Change of the length of a bone that nobody sees, as a share."""

# What is no gait. People shuffle at 0.3 leg lengths a second; boxers move at 0.1.
_MIN_SPEED = 0.25  # [leg lengths/s]
_MAX_CLOSED_SEAM = 0.3  # [leg lengths]
_MAX_SLIDE = 0.2  # [leg lengths/s]; feet that hop, or that nothing holds
_MAX_LYING_DEG = 60.0  # of the body to the vertical; dinosaurs lean by less
_MAX_BACKWARD = math.radians(120.0)


@dataclass(frozen=True)
class GaitReport:
    """A gait found in a recording, or made for a movement tree."""

    name: str
    """Name of the file, or of the clip."""

    origin: str
    """The recording that it is made from, and how."""

    duration: float
    """Duration of one cycle [s]."""

    speed: float
    """Speed over the ground [m/s of the character]."""

    angular: float
    """Turn to the right, as the parameter Angular of the movement trees [degrees]."""

    seam: float
    """Distance of the joints where the cycle was closed, root mean square [m]."""

    slide: float
    """Mean speed of standing feet over the ground [m/s]."""

    sinking: float
    """Depth of the soles below the ground at the worst [m]."""

    knee_excess: float
    """By how much knees bend more than in the recording [rad]; 0 for quadrupeds."""

    bone_change: float
    """Greatest change of a limb bone's length, as a share of it at rest."""

    facing: float
    """Angle between the body's front and its way, to the left [rad]."""

    leg_length: float
    """Length of the character's legs [m]."""

    @classmethod
    def of(cls, name: str, gait: GaitCycle, meshes: Sequence[Mesh]) -> "GaitReport":
        """Measure a gait on the meshes of the character that walks."""
        poses = gait.clip.in_place
        return cls(
            name,
            gait.origin,
            gait.clip.duration,
            gait.path.speed,
            angular_of(gait.path),
            gait.seam,
            gait.mean_slide,
            sole_dip(poses, gait.rig, meshes),
            _knee_excess(gait),
            bone_change(poses, gait.rig),
            facing_error(poses, gait.rig),
            gait.rig.leg_length,
        )

    @property
    def warnings(self) -> dict[str, str]:
        """What a person would see of it, a line for each fault; lengths as on a person."""
        size = 100 * PERSON_LEG_M / self.leg_length
        knees, turn = math.degrees(self.knee_excess), abs(math.degrees(self.facing))
        found = [
            (
                "seam",
                self.seam * size > MAX_SEAM_CM,
                f"its ends are {self.seam * size:.0f} cm apart; "
                "a longer or more even recording repeats better",
            ),
            (
                "slide",
                self.slide * size > MAX_SLIDE_CM_S,
                f"its feet slide at {self.slide * size:.1f} cm/s; "
                "give a recording whose feet stand still",
            ),
            (
                "sinking",
                self.sinking * size > MAX_SINKING_CM,
                f"its feet sink {self.sinking * size:.1f} cm into the ground; "
                "look at its soles: cubeling character inspect -o FOLDER draws them",
            ),
            (
                "knees",
                knees > MAX_KNEE_EXCESS_DEG,
                f"its knees bend {knees:.0f}° more than the recording's; "
                "check its legs: cubeling character inspect -o FOLDER draws them",
            ),
            (
                "bones",
                self.bone_change > MAX_BONE_CHANGE,
                f"its bones change length by {self.bone_change:.0%}; "
                "export the clip without scales",
            ),
            (
                "facing",
                turn > MAX_FACING_ERROR_DEG,
                f"it looks {turn:.0f}° away from its way; give a recording that walks ahead",
            ),
        ]
        return {fault: text for fault, visible, text in found if visible}


def angular_of(path: ArcPath) -> float:
    """Return the parameter Angular of the movement trees for a path [degrees]."""
    return -math.degrees(path.yaw_rate) / YAW_RATE_PER_ANGULAR


def refuse_other_motion(gait: GaitCycle) -> None:
    """Refuse what is neither a walk nor a run: it hardly moves, does not repeat, or goes backwards.

    Raises
    ------
    CharacterError
        With the reason.
    """
    pace = gait.path.speed / gait.rig.leg_length
    seam = gait.seam / gait.rig.leg_length
    turn = facing_error(gait.clip.in_place, gait.rig)
    if pace < _MIN_SPEED:
        reason = f"no walk, at {pace * PERSON_LEG_M:.2f} m/s on a person"
    elif seam > _MAX_CLOSED_SEAM:
        reason = f"no step repeats; the most similar poses are {100 * seam * PERSON_LEG_M:.0f} cm "
        reason += "apart on a person"
    elif gait.mean_slide > _MAX_SLIDE * gait.rig.leg_length:
        slide = 100 * gait.mean_slide / gait.rig.leg_length * PERSON_LEG_M
        reason = f"no foot stands still; they slide at {slide:.0f} cm/s on a person"
    elif abs(turn) > _MAX_BACKWARD:
        reason = f"goes backwards: its body looks {abs(math.degrees(turn)):.0f}° away from its way"
    else:
        return
    raise CharacterError(f"{gait.origin}: {reason}; give a clip that walks ahead")


def refuse_lying(recording: Recording) -> None:
    """Refuse a person whose body lies in most frames: its vertical axis is another one.

    Raises
    ------
    CharacterError
        With the angle between the body and the vertical.
    """
    joints = recording.anatomy.joints
    ends = [joints[part] for part in ("leftFoot", "rightFoot") if part in joints]
    if recording.anatomy.kind != "humanoid" or not ends or "head" not in joints:
        return
    at = recording.clip.poses.globals(recording.skeleton)[..., :3, 3]
    body = (at[:, joints["head"]] + at[:, joints["hips"]]) / 2 - at[:, ends].mean(1)
    across = np.linalg.norm(body[:, [0, 2]], axis=-1)
    angle = math.degrees(float(np.median(np.arctan2(across, body[:, 1]))))
    if angle > _MAX_LYING_DEG:
        raise CharacterError(
            f"{recording.origin}: its body lies, {angle:.0f}° away from upright; say which axis is "
            "up with --up, or give a clip that walks"
        )


def _knee_excess(gait: GaitCycle) -> float:
    if gait.source_knees is None:
        return 0.0
    poses, rig = gait.clip.poses, gait.rig
    own = [knee_quantiles(poses, rig, leg) for leg in gait.legs]
    return max(float((np.array(own) - gait.source_knees).max()), 0.0)
