"""Intrinsics of a camera from the printed cube itself, or from a ChArUco board."""

from tracking.calibration.board import Board, write_board
from tracking.calibration.camera import calibrate_camera
from tracking.calibration.checking import Check, check
from tracking.calibration.coach import Coach, Look
from tracking.calibration.collecting import Collector, Glance
from tracking.calibration.finders import BoardFinder, CubeFinder, Finder
from tracking.calibration.solving import Calibration, calibrate, measured_cube
from tracking.calibration.view import View

__all__ = [
    "Board",
    "BoardFinder",
    "Calibration",
    "Check",
    "Coach",
    "Collector",
    "CubeFinder",
    "Finder",
    "Glance",
    "Look",
    "View",
    "calibrate",
    "calibrate_camera",
    "check",
    "measured_cube",
    "write_board",
]
