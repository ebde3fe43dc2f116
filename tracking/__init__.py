"""Camera frames in; where the cube is, and what the hand does with it, out."""

from cubeling.tracking.calibration import Calibration, calibrate_camera
from cubeling.tracking.cube.file import write_cube
from cubeling.tracking.cube.icons import icon_mask, icon_paths
from cubeling.tracking.cube.model import CubeModel, Face
from cubeling.tracking.cube.model import bundled as bundled_cubes
from cubeling.tracking.cube.printing.sheet import write_sheet
from cubeling.tracking.detection.recognition import CubeRecognizer
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeControls, CubeState
from cubeling.tracking.gestures.gestures import CubeGestures
from cubeling.tracking.refinement.lens_estimate import LensEstimate
from cubeling.tracking.sources import FrameSource, Health, LiveFrames, StoredFrames, open_source
from cubeling.tracking.tracker.several import CubesTracker
from cubeling.tracking.tracker.tracker import CubeTracker

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
