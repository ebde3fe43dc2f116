"""Camera frames in; where the cube is, and what the hand does with it, out."""

from tracking.calibration import Calibration, calibrate_camera
from tracking.cube import CubeModel, Face
from tracking.cube_file import write_cube
from tracking.errors import TrackingError
from tracking.frame import Frame
from tracking.gestures import CubeGestures
from tracking.icons import icon_mask, icon_paths
from tracking.intrinsics import Intrinsics
from tracking.several import CubesTracker
from tracking.sheet import write_sheet
from tracking.sources import FrameSource, Health, LiveFrames, open_source
from tracking.state import CubeControls, CubeState
from tracking.tracker import CubeTracker

__all__ = [
    "Calibration",
    "CubeControls",
    "CubeGestures",
    "CubeModel",
    "CubeState",
    "CubeTracker",
    "CubesTracker",
    "Face",
    "Frame",
    "FrameSource",
    "Health",
    "Intrinsics",
    "LiveFrames",
    "TrackingError",
    "calibrate_camera",
    "icon_mask",
    "icon_paths",
    "open_source",
    "write_cube",
    "write_sheet",
]
