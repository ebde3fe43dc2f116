from cubeling.tracking.calibration.collector import calibrate_camera as calibrate_camera
from cubeling.tracking.calibration.solver import Calibration as Calibration
from cubeling.tracking.cube.file import write_cube as write_cube
from cubeling.tracking.cube.icons import (
    ICON_COLOURS as ICON_COLOURS,
    OTHER_ACTION as OTHER_ACTION,
    has_icon as has_icon,
    icon_mask as icon_mask,
    icon_paths as icon_paths,
)
from cubeling.tracking.cube.marker import marker_cells as marker_cells
from cubeling.tracking.cube.model import (
    SECOND as SECOND,
    CubeModel as CubeModel,
    Face as Face,
    bundled_cubes as bundled_cubes,
    face_corners as face_corners,
    side_of as side_of,
)
from cubeling.tracking.cube.printing.sheet import write_sheet as write_sheet
from cubeling.tracking.detection.markers import MarkerDetector as MarkerDetector
from cubeling.tracking.detection.recognition import CubeRecognizer as CubeRecognizer
from cubeling.tracking.errors import (
    NoCameraError as NoCameraError,
    TrackingError as TrackingError,
)
from cubeling.tracking.geometry import se3 as se3
from cubeling.tracking.geometry.frame import Frame as Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics as Intrinsics
from cubeling.tracking.geometry.state import CubeControls as CubeControls, CubeState as CubeState
from cubeling.tracking.gestures.gestures import CubeGestures as CubeGestures
from cubeling.tracking.gestures.table import SIDE_NORMALS as SIDE_NORMALS
from cubeling.tracking.pose_table import PoseTable as PoseTable, track_video as track_video
from cubeling.tracking.refinement.lens_estimate import LensEstimate as LensEstimate
from cubeling.tracking.sources import open_source as open_source
from cubeling.tracking.sources.base import (
    BufferedFrames as BufferedFrames,
    FrameSource as FrameSource,
    LiveFrames as LiveFrames,
    StoredFrames as StoredFrames,
    Timeline as Timeline,
    nanoseconds_of as nanoseconds_of,
)
from cubeling.tracking.sources.device import Health as Health
from cubeling.tracking.sources.mcap_camera import (
    FOCAL_DEVIATION as FOCAL_DEVIATION,
    LENS_RECORD as LENS_RECORD,
)
from cubeling.tracking.sources.streams.pushed import (
    ImageFeed as ImageFeed,
    PushedSource as PushedSource,
)
from cubeling.tracking.synthetic.plain_room import PlainRoom as PlainRoom
from cubeling.tracking.tracker.frame_markers import FrameMarkers as FrameMarkers
from cubeling.tracking.tracker.learned_camera import LearnedCamera as LearnedCamera
from cubeling.tracking.tracker.print_check import (
    PrintCheck as PrintCheck,
    PrintFault as PrintFault,
    cube_with as cube_with,
)
from cubeling.tracking.tracker.several import CubesTracker as CubesTracker
from cubeling.tracking.tracker.tracker import CubeTracker as CubeTracker
