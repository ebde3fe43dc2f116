"""Camera intrinsics, and the file that holds them."""

import contextlib
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Self

import cv2
import numpy as np
from numpy.typing import ArrayLike

from cubeling.files import FileKind, write_whole
from cubeling.tracking.errors import TrackingError
from cubeling.tracking.geometry.arrays import Array

GUESSED_FIELD_OF_VIEW, GUESSED_FOCAL_DEVIATION = math.radians(60), 0.35
"""Field of view of a common camera along the longer side of its picture [rad], and the standard
deviation of its focal length as a share of it: phones and webcams have 50° to 100°."""

GUESSED_CENTRE, MAX_CALIBRATED_DEVIATION = 0.008, 0.005
"""How far the principal point of such a camera is from the middle, one standard deviation as a
share of the longer side, and the focal deviation above which a lens was not calibrated: `cubeling
calibrate` accepts none above."""

CAMERA_FILE = FileKind(
    "camera file",
    (".yaml", ".yml"),
    TrackingError,
    65_536,
    "cubeling.tracking.geometry.intrinsics:Intrinsics.load",
)
"""A `camera_info` file as ROS writes it."""

DISTORTION_MODELS = {4: "plumb_bob", 5: "plumb_bob", 8: "rational_polynomial"}
"""Name in ROS for each number of OpenCV's coefficients, k1 k2 p1 p2 [k3 [k4 k5 k6]]."""


DEVIATION_KEY = "focal_deviation"
"""The key of `Intrinsics.focal_deviation` in the file; ROS ignores it."""


@dataclass(frozen=True)
class Intrinsics:
    """Pinhole and lens distortion of a camera, in OpenCV's model."""

    matrix: Array
    """Focal lengths and principal point, (3, 3) [px]; pixel centres at whole numbers."""

    distortion: Array
    """Distortion coefficients, (4,), (5,) or (8,): k1 k2 p1 p2 [k3 [k4 k5 k6]]."""

    size: tuple[int, int]
    """Width and height of the images that it holds for [px]."""

    focal_deviation: float | None = None
    """Standard deviation of the focal lengths, as a share of them; None where it is not stated, as
    in a calibration by another program."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "matrix", np.array(self.matrix, np.float64))
        object.__setattr__(self, "distortion", np.array(self.distortion, np.float64).ravel())
        object.__setattr__(self, "size", (int(self.size[0]), int(self.size[1])))
        problem = self._problem()
        if problem:
            raise TrackingError(f"these camera intrinsics cannot be: {problem}")

    def _problem(self) -> str:
        if self.matrix.shape != (3, 3) or not np.isfinite(self.matrix).all():
            return "the camera matrix must be 3 by 3 finite numbers"
        if self.matrix[0, 0] <= 0 or self.matrix[1, 1] <= 0:
            return "both focal lengths must be positive"
        if not np.array_equal(self.matrix[2], (0, 0, 1)) or self.matrix[1, 0] != 0:
            return "the camera matrix must be upper triangular with last row 0 0 1"
        if len(self.distortion) not in DISTORTION_MODELS or not np.isfinite(self.distortion).all():
            return f"the distortion must be 4, 5 or 8 finite numbers, not {len(self.distortion)}"
        if min(self.size) < 1:
            return "width and height must be at least one pixel"
        if self.focal_deviation is not None and not 0 < self.focal_deviation <= 1:
            return "the deviation of the focal length must be a share from 0 to 1"
        return ""

    @classmethod
    def guess(cls, size: tuple[int, int]) -> Self:
        """Assume a lens without distortion and with 60° along the longer side of the picture.

        >>> Intrinsics.guess((1280, 720)).matrix.round(1).tolist()
        [[1108.5, 0.0, 639.5], [0.0, 1108.5, 359.5], [0.0, 0.0, 1.0]]
        """
        width, height = size
        focal = max(size) / 2 / math.tan(GUESSED_FIELD_OF_VIEW / 2)
        matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
        return cls(matrix, np.zeros(5), size, GUESSED_FOCAL_DEVIATION)

    @property
    def centre_deviation(self) -> float:
        """Standard deviation of the principal point along each axis [px]; 0 where calibrated.

        >>> Intrinsics.guess((1000, 500)).centre_deviation
        8.0
        """
        stated = self.focal_deviation or 0.0
        return max(self.size) * GUESSED_CENTRE if stated > MAX_CALIBRATED_DEVIATION else 0.0

    def undistort(self, points: ArrayLike) -> Array:
        """Move pixels to where the same camera without lens distortion would see them.

        Parameters
        ----------
        points
            Pixels of the distorted image, (…, 2) [px].

        Returns
        -------
        Pixels of a pinhole with the same matrix, (…, 2) [px].
        """
        pixels = np.asarray(points, np.float64)
        flat = pixels.reshape(-1, 1, 2)
        if not len(flat):
            return pixels.copy()
        # OpenCV's default stops after 5 iterations: too few at the border of a wide lens.
        precise = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 50, 1e-12)
        moved = cv2.undistortImagePoints(flat, self.matrix, self.distortion, None, precise)
        return moved.reshape(pixels.shape).astype(np.float64)

    def scale(self, size: tuple[int, int]) -> Self:
        """Return the same camera with images of another size, still of its whole sensor.

        Parameters
        ----------
        size
            Width and height of the new images [px].
        """
        horizontal, vertical = size[0] / self.size[0], size[1] / self.size[1]
        scale = np.array([[horizontal, 0, 0], [0, vertical, 0], [0, 0, 1]])
        matrix = scale @ self.matrix
        matrix[0, 2] += (horizontal - 1) / 2  # pixel centres are at integers
        matrix[1, 2] += (vertical - 1) / 2
        return replace(self, matrix=matrix, size=size)

    def lengthen(self, scale: float, focal_deviation: float | None) -> Self:
        """Return a camera with focal lengths `scale` times as long, and how sure they are.

        >>> Intrinsics.guess((640, 480)).lengthen(2.0, 0.1).matrix.round(1)[0].tolist()
        [1108.5, 0.0, 319.5]
        """
        matrix = self.matrix * [[scale, scale, 1], [1, scale, 1], [1, 1, 1]]
        return replace(self, matrix=matrix, focal_deviation=focal_deviation)

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a `camera_info` YAML file as ROS writes it.

        Raises
        ------
        TrackingError
            The file is missing, is not YAML, or its camera cannot be used.
        """
        import yaml  # takes 15 ms to load, and most cameras have no file

        text = CAMERA_FILE.read_text(path)
        try:
            if any(isinstance(token, yaml.AliasToken) for token in yaml.scan(text)):
                # A few lines of aliases of aliases stand for more numbers than fit in memory.
                raise ValueError("it has aliases (*name): write the values out")
            document = yaml.safe_load(text)
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            reason = " ".join(str(error).split())
            raise TrackingError(f"the camera file '{path}' is not YAML: {reason}") from error
        try:
            return cls._from_document(document)
        except TrackingError as error:
            raise TrackingError(f"the camera file '{path}' cannot be used: {error}") from error

    @classmethod
    def _from_document(cls, document: object) -> Self:
        if not isinstance(document, dict):
            raise TrackingError("it holds no 'camera_matrix'; write a ROS camera_info file")
        model = document.get("distortion_model", "plumb_bob")
        if model not in DISTORTION_MODELS.values():
            known = " and ".join(sorted(set(DISTORTION_MODELS.values())))
            raise TrackingError(f"its distortion_model is {model!r}; only {known} can be used")
        width, height = (_integer(document, key) for key in ("image_width", "image_height"))
        matrix = _numbers(document, "camera_matrix")
        if len(matrix) != 9:
            raise TrackingError(f"'camera_matrix' must hold 9 numbers, not {len(matrix)}")
        distortion = _numbers(document, "distortion_coefficients")
        deviation = document.get(DEVIATION_KEY)
        if deviation is not None and not isinstance(deviation, float):
            raise TrackingError(
                f"'{DEVIATION_KEY}' must be a share such as 0.01, not {deviation!r}"
            )
        return cls(matrix.reshape(3, 3), distortion, (width, height), deviation)

    def save(self, path: str | Path, name: str = "camera") -> None:
        """Write a ROS `camera_info` YAML file, completely or not at all; `load` reads it back.

        Parameters
        ----------
        path
            The file.
        name
            Name of the camera in the file.

        Raises
        ------
        TrackingError
            The file cannot be written.
        """
        document = {
            "image_width": self.size[0],
            "image_height": self.size[1],
            "camera_name": name,
            "camera_matrix": _table(self.matrix),
            "distortion_model": DISTORTION_MODELS[len(self.distortion)],
            "distortion_coefficients": _table(self.distortion[None]),
            "rectification_matrix": _table(np.eye(3)),
            "projection_matrix": _table(np.hstack([self.matrix, np.zeros((3, 1))])),
        }
        if self.focal_deviation is not None:
            document[DEVIATION_KEY] = self.focal_deviation
        import yaml

        text = yaml.safe_dump(document, sort_keys=False, default_flow_style=None)
        write_whole(path, text, TrackingError)


def _integer(document: dict[Any, Any], key: str) -> int:
    value = document.get(key)
    if not isinstance(value, int) or isinstance(value, bool):
        raise TrackingError(f"'{key}' must be a whole number, not {value!r}")
    return value


def _numbers(document: dict[Any, Any], key: str) -> Array:
    table = document.get(key)
    data = table.get("data") if isinstance(table, dict) else None
    if isinstance(data, list):
        # YAML 1.1 reads 1e-05, which C++ writes, as a string: `float` takes both.
        with contextlib.suppress(TypeError, ValueError):
            return np.array([float(value) for value in data], np.float64)
    raise TrackingError(f"'{key}' needs a list of numbers called 'data'")


def _table(values: Array) -> dict[str, Any]:
    rows, columns = values.shape
    return {"rows": rows, "cols": columns, "data": [float(value) for value in values.ravel()]}
