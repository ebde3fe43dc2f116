"""Intrinsics of a camera from the printed cube itself, or from a ChArUco board."""

from tracking.calibration.board import Board, write_board
from tracking.calibration.camera_check import CameraCheck, check
from tracking.calibration.collector import ViewCollector, ViewResult, calibrate_camera
from tracking.calibration.coverage import ViewCoverage, ViewSample
from tracking.calibration.solver import Calibration, calibrate, measured_cube
from tracking.calibration.target_finders import BoardFinder, CubeFinder, TargetFinder
from tracking.calibration.view import View

__all__ = [
    "Board",
    "BoardFinder",
    "Calibration",
    "CameraCheck",
    "CubeFinder",
    "TargetFinder",
    "View",
    "ViewCollector",
    "ViewCoverage",
    "ViewResult",
    "ViewSample",
    "calibrate",
    "calibrate_camera",
    "check",
    "measured_cube",
    "write_board",
]
