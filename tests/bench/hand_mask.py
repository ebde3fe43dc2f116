"""How well the hand is found: `python -m tests.bench.hand_mask [-o FOLDER]`."""

import argparse
import sys
import time
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from tests.bench.hand_scenes import GLOVES, SKINS, HandScene, HandView
from tracking.appearance.hand import HandFinder, HandMask
from tracking.cube.model import CubeModel
from tracking.geometry.arrays import Floats
from tracking.tracker.tracker import CubeTracker

AZIMUTHS = (0.0, -60.0, -120.0, -190.0)


def iou(mask: HandMask | None, truth: Floats, window: tuple[slice, slice]) -> float:
    """Soft intersection over union in a window of the image."""
    found = np.zeros_like(truth)
    if mask is not None:
        height, width = mask.cover.shape
        found[mask.y : mask.y + height, mask.x : mask.x + width] = mask.cover / 255.0
    a, b = found[window], truth[window]
    return float(np.minimum(a, b).sum() / max(float(np.maximum(a, b).sum()), 1e-6))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--scenes", type=int, default=len(AZIMUTHS))
    arguments = parser.parse_args()
    cube = CubeModel.load("locomotion")
    table = Table("hand", "IoU", "lowest scene", "lowest frame", "seen", "ms", "false cover")
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    for name, skin in (SKINS | GLOVES).items():
        if arguments.only not in name:
            continue
        scenes, times, frames, aruco, seen, false = [], [], [], [], [], 0.0
        for number, azimuth in enumerate(AZIMUTHS[: arguments.scenes]):
            scene = HandScene(HandView(skin, azimuth, seed=number + 1), cube)
            tracker, finder = CubeTracker(cube, scene.intrinsics), None
            finder = HandFinder(cube, scene.intrinsics)
            shares = []
            for index in range(scene.count):
                frame, truth = scene.frame(index)
                state = tracker.update(frame)
                start = time.perf_counter()
                mask = finder.update(frame.image, state)
                times.append(1000 * (time.perf_counter() - start))
                start = time.perf_counter()
                detector.detectMarkers(cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY))
                aruco.append(1000 * (time.perf_counter() - start))
                window = finder.region(state.camera_from_cube)
                if window is None or not state.visible:
                    continue
                if truth[window].max() == 0:
                    false = max(false, float(mask.cover.max()) if mask else 0.0)
                if scene.state(index).grip > 0.99:
                    shares.append(iou(mask, truth, window))
                    seen.append(mask is not None)
                    if arguments.output and index % 12 == 0:
                        write(
                            arguments.output / f"{name} {number} {index}.png",
                            frame.image,
                            mask,
                            truth,
                            window,
                        )
            scenes.append(np.mean(shares[3:]))
            frames += shares[3:]
        table.add_row(
            name,
            f"{np.mean(scenes):.3f}",
            " ".join(f"{s:.2f}" for s in scenes),
            f"{min(frames):.2f}",
            f"{np.mean(seen):.2f}",
            f"{np.median(times):.2f} ({np.median(times) / np.median(aruco):.2f}×)",
            f"{false:.0f}",
        )
    Console(width=120).print(table)
    sys.exit(0)


def write(path, image, mask, truth, window):
    path.parent.mkdir(parents=True, exist_ok=True)
    shown = image.copy()
    found = np.zeros(truth.shape, np.float32)
    if mask is not None:
        height, width = mask.cover.shape
        found[mask.y : mask.y + height, mask.x : mask.x + width] = mask.cover / 255.0
    green = np.array([0, 255, 0], np.float32)
    cut = shown * (1 - 0.7 * found[..., None]) + 0.7 * found[..., None] * green
    wrong = np.stack([truth * 255, truth * 0, found * 255], axis=-1)
    cv2.imwrite(
        str(path),
        np.hstack([image[window], cut[window].astype(np.uint8), wrong[window].astype(np.uint8)]),
    )


if __name__ == "__main__":
    main()
