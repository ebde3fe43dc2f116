from cubeling.tracking.calibration.board import Board as Board, write_board as write_board
from cubeling.tracking.calibration.camera_check import (
    CameraCheck as CameraCheck,
    check_camera as check_camera,
)
from cubeling.tracking.calibration.collector import (
    ViewCollector as ViewCollector,
    ViewResult as ViewResult,
    calibrate_camera as calibrate_camera,
)
from cubeling.tracking.calibration.coverage import (
    ViewCoverage as ViewCoverage,
    ViewSample as ViewSample,
)
from cubeling.tracking.calibration.solver import (
    Calibration as Calibration,
    calibrate as calibrate,
    measured_cube as measured_cube,
)
from cubeling.tracking.calibration.target_finders import (
    BoardFinder as BoardFinder,
    CubeFinder as CubeFinder,
    TargetFinder as TargetFinder,
)
from cubeling.tracking.calibration.view import View as View
