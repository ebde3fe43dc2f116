"""Camera frames in; where the cube is, and what the hand does with it, out."""

from tracking.calibration import Calibration, calibrate_camera
from tracking.cube.file import write_cube
from tracking.cube.icons import icon_mask, icon_paths
from tracking.cube.model import CubeModel, Face
from tracking.cube.model import bundled as bundled_cubes
from tracking.cube.printing.sheet import write_sheet
from tracking.detection.recognition import CubeRecognizer
from tracking.errors import TrackingError
from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.state import CubeControls, CubeState
from tracking.gestures.gestures import CubeGestures
from tracking.refinement.lens_estimate import LensEstimate
from tracking.sources import FrameSource, Health, LiveFrames, StoredFrames, open_source
from tracking.tracker.several import CubesTracker
from tracking.tracker.tracker import CubeTracker

__all__ = [
    "Calibration",
    "CubeControls",
    "CubeGestures",
    "CubeModel",
    "CubeRecognizer",
    "CubeState",
    "CubeTracker",
    "CubesTracker",
    "Face",
    "Frame",
    "FrameSource",
    "Health",
    "Intrinsics",
    "LensEstimate",
    "LiveFrames",
    "StoredFrames",
    "TrackingError",
    "bundled_cubes",
    "calibrate_camera",
    "icon_mask",
    "icon_paths",
    "open_source",
    "write_cube",
    "write_sheet",
]
