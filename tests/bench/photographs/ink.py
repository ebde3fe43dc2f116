"""How light printed ink is in photographs: `python -m tests.bench.photographs.ink`.

Light of the ink beside that of the paper around it, in every marker that OpenCV finds. It says from
which share on a picture is hazy (`cubeling.tracking.appearance.picture_quality.INK_SHARE`).
"""

import cv2
import numpy as np
from rich.console import Console

from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from tests.bench.photographs.dodecahedron import DICTIONARY, paths, photograph
from tests.bench.photographs.marker_corners import Array, Picture, opencv_detector

SIDE_PX = 80
"""Side of a marker as it is looked at."""

INK_QUANTILE, PAPER_QUANTILE = 0.1, 0.97
"""Quantiles of a marker's light that are its ink and its paper."""


def ink_share(picture: Picture, corners: Array) -> float:
    """Return the light of a marker's ink beside that of its paper; corners are (4, 2) [px]."""
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], np.float32) * SIDE_PX
    straight = cv2.getPerspectiveTransform(np.asarray(corners, np.float32), square)
    seen = cv2.warpPerspective(picture, straight, (SIDE_PX, SIDE_PX))
    ink, paper = np.quantile(LINEAR_FROM_SRGB[seen].mean(axis=-1), (INK_QUANTILE, PAPER_QUANTILE))
    return float(ink / paper)


def main() -> None:
    """Print the quantiles."""
    detector = opencv_detector(DICTIONARY)
    shares = []
    for number in range(len(paths())):
        picture = photograph(number)
        found, _, _ = detector.detectMarkers(picture)
        shares += [ink_share(picture, corners[0]) for corners in found]
    low, middle, high = np.quantile(shares, (0.1, 0.5, 0.9))
    Console().print(
        f"{len(shares)} markers: ink {middle:.3f} of the light of paper in the median, "
        f"{low:.3f} to {high:.3f} in four of five"
    )


if __name__ == "__main__":
    main()
