"""Parameters of each sequence of the benchmark."""

from dataclasses import dataclass, replace

from tests.bench.tracking.cameras import WEBCAM, WEBCAM_HALF, WIDE, Camera
from tests.bench.tracking.paper import SMALL_CUBE


@dataclass(frozen=True)
class SequencePlan:
    """How the cube is moved, held and lit."""

    speed: float = 0.0
    """Peak speed of the cube's centre [m/s]."""

    turning: float = 0.0
    """Peak angular speed [rad/s]."""

    exposure: float = 0.008
    """Exposure of a frame [s]."""

    depth: tuple[float, float] = (0.4, 0.6)
    """Bounds of where the cube starts along the optical axis [m]."""

    reach: tuple[float, float, float] = (1.0, 0.45, 0.35)
    """Shape of the motion: how far along each axis of the camera."""

    turns: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """Shape of the turning: how far about each axis of the camera."""

    pace: tuple[float, float] = (2.6, 4.2)
    """Bounds of the slowest wave's angular frequency [rad/s]."""

    facing: str = "any"
    """How the cube is held: "any" way, "frontal" with one face square on, "one" with one marker in
    view, "corner" with two or three faces.
    """

    fingers: str = ""
    """When fingers are laid on the cube: "" never, "later" within ten frames, "start"."""

    light: float = 1.0
    """Light in the room, 1 for a lit room; the camera's gain compensates for most of it."""

    shadows: bool = False
    """Whether edges of shadow fall across the cube."""

    foreign: int = 0
    """Markers on the table that belong to no cube."""

    independent: bool = False
    """Whether each frame shows another pose."""

    camera: Camera = WIDE
    """What takes the pictures."""

    height: float = 0.62
    """Height of the camera above the table [m]."""

    resting: bool = False
    """Whether the cube lies on the table in about half of the independent frames."""

    nominal: bool = False
    """Whether the trackers are told that the lens does not distort."""

    cube: str = "locomotion"
    """Name of a bundled cube, or path of a cube's file."""

    worn: bool = False
    """Whether paper bends, with tape beside the markers; each pose with its own paper and light."""

    smear: float = 0.0
    """Length of the motion blur in independent frames [px]."""

    covered: float = 0.0
    """Edge of the patch on a corner of every marker, as a share of the marker's edge."""

    count: int = 90
    """Default number of frames."""


INDOOR_EXPOSURE_S = 1 / 60
"""Exposure of a webcam in lamp light."""

WEBCAM_PLAN = SequencePlan(
    depth=(0.2, 0.6),
    shadows=True,
    independent=True,
    count=60,
    camera=WEBCAM,
    height=0.25,
    cube=SMALL_CUBE,
    worn=True,
)
"""A webcam of 640×480 looks at a cube of 30 mm."""

SEQUENCE_PLANS: dict[str, SequencePlan] = {
    "static": SequencePlan(count=60, facing="corner"),
    "static-one": SequencePlan(count=60, facing="frontal"),
    "far": SequencePlan(speed=0.15, turning=0.6, depth=(0.8, 1.4)),
    "twist": SequencePlan(turning=3.0, turns=(0.0, 0.7, 1.0)),
    "sweep-0.25": SequencePlan(speed=0.25, turning=1.0, exposure=INDOOR_EXPOSURE_S),
    "sweep-0.5": SequencePlan(speed=0.5, turning=2.0, exposure=INDOOR_EXPOSURE_S),
    "sweep-0.5-short": SequencePlan(speed=0.5, turning=2.0),
    "sweep-1.0": SequencePlan(speed=1.0, turning=3.0, exposure=INDOOR_EXPOSURE_S, pace=(4.0, 5.5)),
    "tumble": SequencePlan(speed=0.3, turning=7.0, exposure=INDOOR_EXPOSURE_S, pace=(2.0, 3.0)),
    "frontal": SequencePlan(speed=0.1, turning=0.3, depth=(0.35, 0.6), facing="frontal"),
    "fingers": SequencePlan(
        speed=0.25, turning=0.8, exposure=INDOOR_EXPOSURE_S, facing="corner", fingers="later"
    ),
    "fingers-start": SequencePlan(
        speed=0.25, turning=0.8, exposure=INDOOR_EXPOSURE_S, facing="corner", fingers="start"
    ),
    "darkness": SequencePlan(speed=0.15, turning=0.6, light=1 / 8),
    "shaded": SequencePlan(speed=0.15, turning=0.6, shadows=True),
    "cluttered": SequencePlan(speed=0.25, turning=1.0, foreign=10),
    "poses": SequencePlan(depth=(0.3, 0.7), independent=True, count=60),
    "webcam": replace(WEBCAM_PLAN, resting=True),
    "webcam-one": replace(WEBCAM_PLAN, facing="one"),
    "webcam-half": replace(WEBCAM_PLAN, resting=True, camera=WEBCAM_HALF),
    "webcam-blurred": replace(WEBCAM_PLAN, smear=10.0, exposure=INDOOR_EXPOSURE_S),
    "webcam-covered": replace(WEBCAM_PLAN, resting=True, covered=0.3),
    "webcam-fingers": replace(WEBCAM_PLAN, fingers="start"),
    "webcam-nominal": replace(WEBCAM_PLAN, resting=True, nominal=True),
    "webcam-held": replace(
        WEBCAM_PLAN,
        speed=0.25,
        turning=0.8,
        exposure=INDOOR_EXPOSURE_S,
        depth=(0.25, 0.45),
        facing="corner",
        fingers="start",
        independent=False,
        count=90,
    ),
}
"""Each sequence by its name."""
