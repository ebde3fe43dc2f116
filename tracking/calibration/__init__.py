"""Intrinsics of a camera from the printed cube itself, or from a ChArUco board."""

from cubeling.tracking.calibration.board import Board, write_board
from cubeling.tracking.calibration.camera_check import CameraCheck, check
from cubeling.tracking.calibration.collector import ViewCollector, ViewResult, calibrate_camera
from cubeling.tracking.calibration.coverage import ViewCoverage, ViewSample
from cubeling.tracking.calibration.solver import Calibration, calibrate, measured_cube
from cubeling.tracking.calibration.target_finders import BoardFinder, CubeFinder, TargetFinder
from cubeling.tracking.calibration.view import View

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
