"""Show the tracker pictures of all sorts, and count the errors that it raises: none is right.

`python -m tests.campaigns.tracker [--frames 1e5] [--seed 1] [--processes 2]` prints a table; the
exit code is 1 if anything was raised. `--clip N` shows one clip alone, with its traceback. The
pictures are blurred, covered, cut by the border, tiny, near, dark, of other cubes, of sheets and of
nothing, in several sizes, and the tracker is told wrong lenses and wrong cubes.
"""

import argparse
import sys
import time
import traceback
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import cache
from multiprocessing import get_context

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.tracking import CubeModel, CubeTracker, Frame, Intrinsics
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.geometry import se3
from tests.tracking.drawn import Array, Picture, photograph, scene

FRAMES_PER_CLIP = 12
"""Frames that one tracker sees: enough to find a cube, to follow it, and to lose it again."""

SIZES = ((160, 120), (120, 160), (320, 240), (240, 320), (333, 217), (640, 480), (820, 616))
"""Sizes of the pictures [px]; the last is high enough to be searched at half its size."""

SIZE_SHARES = (0.1, 0.05, 0.35, 0.1, 0.15, 0.2, 0.05)
"""How often each is chosen."""


@dataclass(frozen=True)
class Clip:
    """The frames that one tracker sees, and what it is told."""

    cube: CubeModel
    """The cube that it is told to find."""

    lens: Intrinsics
    """The lens that it is told, right or wrong."""

    frames: tuple[Frame, ...]
    """The pictures."""


@cache
def cubes() -> tuple[CubeModel, ...]:
    """Cubes that are drawn or looked for: bundled, with one face, and glued wrongly."""
    locomotion, companion = CubeModel.load("locomotion"), CubeModel.load("companion")
    first, second, *rest = locomotion.faces
    swapped = (replace(first, corners=second.corners), replace(second, corners=first.corners))
    rolled = replace(first, corners=np.roll(first.corners, 1, axis=0))
    return (
        locomotion,
        companion,
        replace(locomotion, faces=locomotion.faces[:1]),
        replace(locomotion, faces=(*swapped, *rest)),
        replace(locomotion, faces=(rolled, second, *rest)),
    )


def clip(seed: int, number: int) -> Clip:
    """Draw a clip; it depends on nothing but its seed and number."""
    rng = np.random.default_rng((seed, number))
    size = SIZES[rng.choice(len(SIZES), p=SIZE_SHARES)]
    lens = _lens(rng, size)
    shown = cubes()[rng.integers(len(cubes()))]
    told = shown if rng.random() < 0.7 else cubes()[rng.integers(len(cubes()))]
    picture = _picture(rng, shown, lens)
    told_lens = lens if rng.random() < 0.6 else _wrong_lens(rng, lens)
    return Clip(told, told_lens, tuple(_frames(rng, picture)))


def _lens(rng: np.random.Generator, size: tuple[int, int]) -> Intrinsics:
    focal = rng.uniform(0.7, 1.4) * max(size)
    middle = (np.array(size) - 1) / 2
    matrix = np.array([[focal, 0, middle[0]], [0, focal, middle[1]], [0, 0, 1]])
    return Intrinsics(matrix, np.zeros(5), size)


def _wrong_lens(rng: np.random.Generator, lens: Intrinsics) -> Intrinsics:
    """Return another focal length, another middle, and a distortion, up to absurd ones."""
    matrix = lens.matrix.copy()
    matrix[:2, :2] *= np.exp(rng.uniform(-1, 1))
    matrix[:2, 2] *= rng.uniform(0.5, 1.5)
    return replace(lens, matrix=matrix, distortion=rng.normal(0, [0.3, 0.2, 0.01, 0.01, 0.05]))


def _picture(rng: np.random.Generator, cube: CubeModel, lens: Intrinsics) -> Picture:
    """Draw one or two cubes, a sheet, or none."""
    kind = rng.choice(["cube", "two cubes", "sheet", "shapes"], p=[0.6, 0.1, 0.2, 0.1])
    if kind == "shapes":
        return _shapes(rng, lens.size)
    if kind == "sheet":
        return _sheet(rng, cube, lens.size)
    shown = [(cube, _pose(rng, cube, lens))]
    if kind == "two cubes":
        other = cubes()[rng.integers(len(cubes()))]
        shown.append((other, _pose(rng, other, lens)))
    picture = photograph(scene(*shown, camera=lens), noise=0.0)
    return _shapes(rng, lens.size, picture) if rng.random() < 0.3 else picture


def _pose(rng: np.random.Generator, cube: CubeModel, lens: Intrinsics) -> Array:
    """Return a pose of a cube that is from 8 px to more than the picture wide, all around."""
    focal = float(lens.matrix[0, 0])
    width = np.exp(rng.uniform(np.log(14), np.log(0.9 * max(lens.size))))
    depth = max(focal * cube.edge / width, 1.2 * cube.edge)
    share = rng.uniform(-0.5, 0.5, 2) * (np.array(lens.size) / focal)
    place = np.array([*(share * depth), depth])
    turn = rng.normal(size=3)
    turn *= rng.uniform(0, np.pi) / np.linalg.norm(turn)
    return se3.pose(se3.rotation(turn), place)


def _sheet(rng: np.random.Generator, cube: CubeModel, size: tuple[int, int]) -> Picture:
    """Lay the faces of a cube beside each other on flat paper, and look at it from some side."""
    cells = [np.pad(marker_cells(cube.dictionary, each.marker_id), 1) for each in cube.faces]
    turned = [np.rot90(each, int(rng.integers(4))) for each in cells]
    blank = np.zeros_like(turned[0])
    places = rng.permutation([*turned, *[blank] * (12 - len(turned))])
    rows = [np.concatenate(list(places[row : row + 4]), axis=1) for row in (0, 4, 8)]
    paper = np.where(np.concatenate(rows), 30, 220)
    texture = np.kron(paper, np.ones((8, 8))).astype(np.uint8)
    height, width = texture.shape
    corners = np.array([(0, 0), (width, 0), (width, height), (0, height)], np.float32)
    spread = rng.uniform(0.3, 1.2) * min(size) / height
    seen = (corners - (width / 2, height / 2)) * spread
    angle = rng.uniform(0, 2 * np.pi)
    seen = seen @ np.array([(np.cos(angle), np.sin(angle)), (-np.sin(angle), np.cos(angle))])
    seen += np.array(size) / 2 + rng.normal(0, 0.08 * min(size), (4, 2))
    plane = cv2.getPerspectiveTransform(corners, seen.astype(np.float32))
    grey = cv2.warpPerspective(texture, plane, size, flags=cv2.INTER_AREA, borderValue=(120,))
    return np.repeat(np.asarray(grey, np.uint8)[..., None], 3, axis=2)


def _shapes(
    rng: np.random.Generator, size: tuple[int, int], picture: Picture | None = None
) -> Picture:
    """Draw random shapes, on noise or over a picture."""
    if picture is None:
        picture = rng.integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)
        picture = np.asarray(cv2.blur(picture, (1 + 2 * int(rng.integers(8)),) * 2), np.uint8)
    drawn = picture.copy()
    for _ in range(rng.integers(1, 9)):
        middle, reach = rng.uniform(0, 1, 2) * size, rng.uniform(0.03, 0.4) * min(size)
        points = middle + rng.uniform(-reach, reach, (rng.integers(3, 7), 2))
        colour = rng.integers(0, 256, 3).tolist()
        cv2.fillPoly(drawn, [np.rint(points).astype(np.int32)], colour)
    return drawn


def _frames(rng: np.random.Generator, picture: Picture) -> Iterator[Frame]:
    """Move, blur, cover, darken and compress a picture, more from frame to frame or at once."""
    height, width = picture.shape[:2]
    motion = np.eye(3)
    speed = rng.choice([0.0, 0.003, 0.02, 0.06]) * width
    drift = rng.normal(0, 1, 4) * (speed, speed, 0.01, 0.01)
    cover, softness = rng.random() < 0.3, rng.choice([0.0, 0.7, 1.5, 4.0], p=[0.4, 0.25, 0.25, 0.1])
    contrast = rng.choice([0.9, 0.6, 0.1, 0.02], p=[0.6, 0.3, 0.07, 0.03])
    noise = rng.choice([0.0, 2.0, 12.0], p=[0.4, 0.5, 0.1])
    now = 0.0
    for index in range(FRAMES_PER_CLIP):
        if rng.random() < 0.06:  # a leap
            drift[:2] += rng.normal(0, 0.2 * width, 2)
        shown = cv2.warpPerspective(picture, motion, (width, height), borderValue=(90, 90, 90))
        if rng.random() < 0.5 and softness:
            shown = _soften(rng, np.asarray(shown, np.uint8), softness)
        if cover:
            shown = _shapes(rng, (width, height), np.asarray(shown, np.uint8))
        level = contrast * shown.astype(np.float32) + 20 + rng.normal(0, noise + 1e-6, shown.shape)
        seen = np.clip(np.rint(level), 0, 255).astype(np.uint8)
        if rng.random() < 0.2:
            stored = cv2.imencode(".jpg", seen, [cv2.IMWRITE_JPEG_QUALITY, 30])[1]
            seen = np.asarray(cv2.imdecode(stored, cv2.IMREAD_COLOR), np.uint8)
        yield Frame(seen, now, index)
        # Frames that follow at once, late, or with the same time.
        now += float(rng.choice([1 / 30, 1 / 30, 1 / 30, 0.0, 0.15, 2.0]))
        turn, grow = drift[2], 1 + drift[3]
        step = np.array([[grow, -turn, drift[0]], [turn, grow, drift[1]], [0, 0, 1.0]])
        motion = step @ motion


def _soften(rng: np.random.Generator, picture: Picture, reach: float) -> Picture:
    """Blur as a lens out of focus, or as motion along a line."""
    if rng.random() < 0.5:
        return np.asarray(cv2.GaussianBlur(picture, (0, 0), reach), np.uint8)
    count = 2 * int(2 * reach) + 1
    line, middle = np.zeros((count, count), np.uint8), count // 2
    dx, dy = (middle * np.array(_direction(rng))).round().astype(int).tolist()
    cv2.line(line, (middle - dx, middle - dy), (middle + dx, middle + dy), (1,))
    return np.asarray(cv2.filter2D(picture, -1, line / max(int(line.sum()), 1)), np.uint8)


def _direction(rng: np.random.Generator) -> tuple[float, float]:
    angle = rng.uniform(0, np.pi)
    return float(np.cos(angle)), float(np.sin(angle))


def show(seed: int, number: int) -> tuple[Counter[str], str]:
    """Show one clip to a tracker; return the verdicts, and the traceback of what was raised."""
    drawn, verdicts = clip(seed, number), Counter[str]()
    try:
        tracker = CubeTracker(drawn.cube, drawn.lens)
        for frame in drawn.frames:
            state = tracker.update(frame)
            verdicts[state.verdict] += 1
            if state.visible and not np.isfinite(state.covariance).all():
                raise AssertionError("a pose is trusted without a covariance")
            tracker.predict(frame.timestamp + 0.05)
    except Exception:
        return verdicts, traceback.format_exc()
    return verdicts, ""


def run(clips: range, seed: int, processes: int = 1) -> tuple[Counter[str], dict[int, str]]:
    """Show clips; return the number of frames by their verdict, and the tracebacks by clip."""
    with ExitStack() as stack:
        shown: Iterator[tuple[Counter[str], str]] = map(show, [seed] * len(clips), clips)
        if processes > 1:
            pool = stack.enter_context(
                ProcessPoolExecutor(processes, get_context("spawn"), initializer=_use_one_thread)
            )
            shown = pool.map(show, [seed] * len(clips), clips, chunksize=8)
        else:
            _use_one_thread()
        counts, raised = Counter[str](), dict[int, str]()
        for number, (verdicts, text) in zip(clips, shown, strict=True):
            counts += verdicts
            if text:
                raised[number] = text
        return counts, raised


def _use_one_thread() -> None:
    cv2.setNumThreads(1)


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description="Show the tracker pictures of all sorts.")
    parser.add_argument("--frames", type=float, default=1e5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--clip", type=int, help="show this one alone")
    wanted = parser.parse_args()
    began = time.perf_counter()
    clips = range(-(-round(wanted.frames) // FRAMES_PER_CLIP))
    if wanted.clip is not None:
        clips = range(wanted.clip, wanted.clip + 1)
    counts, raised = run(clips, wanted.seed, wanted.processes if len(clips) > 1 else 1)
    table = Table("verdict", "frames", title="pictures of all sorts")
    for verdict, number in counts.most_common():
        table.add_row(verdict, f"{number:,}")
    table.add_row("errors", f"{len(raised):,}")
    table.add_row("seconds", f"{time.perf_counter() - began:.0f}")
    console = Console()
    console.print(table)
    for number, text in list(raised.items())[:20]:
        told = text if wanted.clip is not None else text.rstrip().splitlines()[-1]
        console.print(f"--seed {wanted.seed} --clip {number}: {told}", markup=False)
    return 1 if raised else 0


if __name__ == "__main__":
    sys.exit(main())
