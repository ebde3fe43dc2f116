"""How well a hand is found on photographs: `python -m tests.bench.photographs.hands [-o FILE]`.

The photographs of the hand-held dodecahedron are shown in order, each for a few frames with a
camera's noise, as a session. On some of them the hand was outlined loosely by eye, and OpenCV's
GrabCut found its edge. The score is that of `tests.bench.hand_mask`, beside the share of the hand
that is covered, and what is covered besides, as a share of the hand. Other arms, watch, sleeves and
the pen in the hand are not scored.
"""

import argparse
import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.tracking.appearance.hand.finder import HandFinder
from cubeling.tracking.appearance.hand.window import WindowFinder
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Flags, Floats, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.state import CubeState
from cubeling.tracking.tracker.tracker import CubeTracker
from tests.bench.hand_mask import covered
from tests.bench.photographs.dodecahedron import body_model, camera, paths, photograph

OUTLINES = Path(__file__).with_name("hand_outlines.json")
"""Outlines around the hand and around what is not scored, by the number of the photograph [px]."""

TUNED_ON = {1, 4, 9, 14, 20, 27, 33, 38, 47, 54, 62, 70}
"""Photographs that the finder was tuned on; the others were outlined afterwards."""

FRAMES, NOISE, RATE_HZ = 10, 2.0, 30.0
"""Frames for which each photograph is shown, deviation of their noise [levels], and their rate."""

PRINT_SIDE_M = 0.0225
"""Side of the largest square on a face of the dodecahedron around its marker [m]."""

LOOSENESS_PX, GRABCUT_STEPS = 5, 6
"""What is added around the loose outline of a hand, and iterations of GrabCut."""

DESK = np.s_[350:400, 950:1100]
"""Rows and columns of plain desk."""


@dataclass(frozen=True)
class Score:
    """How well the hand on one photograph was found."""

    iou: float
    """Overlap, 0…1."""

    found: float
    """Share of the hand that is covered."""

    besides: float
    """What is covered besides, as a share of the hand."""


class DodecahedronHands(HandFinder):
    """Looks for the hand around a body that is larger than the prints on its faces are."""

    def __init__(self, body: CubeModel) -> None:
        super().__init__(replace(body, edge=PRINT_SIDE_M), camera())
        self._windows = WindowFinder(body, self._projection, self._pattern.corners)


def hand_on(number: int) -> tuple[Flags, Flags]:
    """Return where the hand is on a photograph, and what of it is scored, (H, W) each."""
    picture = photograph(number)
    loose, unscored = (_filled(_outlines()[number][name], picture) for name in ("hand", "unscored"))
    square = np.ones((2 * LOOSENESS_PX + 1,) * 2, np.uint8)
    loose = np.asarray(cv2.dilate(loose, square), np.uint8)
    marks = np.where(loose, cv2.GC_PR_FGD, cv2.GC_BGD).astype(np.uint8)
    # Other skin must not be learned as background.
    picture[(unscored > 0) & (loose == 0)] = np.median(picture[DESK].reshape(-1, 3), axis=0)
    models, no_rectangle = np.zeros((2, 1, 65)), (0, 0, 1, 1)
    mode = cv2.GC_INIT_WITH_MASK
    cv2.grabCut(picture, marks, no_rectangle, models[0], models[1], GRABCUT_STEPS, mode)
    hand = (marks == cv2.GC_PR_FGD).astype(np.uint8)
    opened = cv2.morphologyEx(hand, cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
    return np.asarray(opened > 0), np.asarray(unscored == 0)


@cache
def _outlines() -> dict[int, dict[str, list[list[list[int]]]]]:
    return {int(number): each for number, each in json.loads(OUTLINES.read_text()).items()}


def _filled(outlines: list[list[list[int]]], picture: Image) -> Image:
    filled = np.zeros(picture.shape[:2], np.uint8)
    for outline in outlines:
        cv2.fillPoly(filled, [np.array(outline)], 1)
    return filled


def covers(shuffle: int | None) -> dict[int, tuple[Floats, Flags]]:
    """Return the cover on each outlined photograph, (H, W) 0…1, and where hands are looked for."""
    body, noise, found = body_model()[0], np.random.default_rng(1), {}
    order = np.arange(len(paths()))
    if shuffle is not None:
        np.random.default_rng(shuffle).shuffle(order)
    finder = DodecahedronHands(body)
    for time, number in enumerate(order.tolist()):
        picture, state = photograph(number), _state(body, number)
        for frame in range(FRAMES):
            grain = noise.normal(0.0, NOISE, picture.shape).astype(np.int16)
            shown = np.asarray(cv2.add(picture, grain, dtype=cv2.CV_8U), np.uint8)
            timestamp = (FRAMES * time + frame) / RATE_HZ
            mask = finder.update(shown, replace(state, timestamp=timestamp))
        if number in _outlines() and state.camera_from_cube is not None:
            region = np.zeros(picture.shape[:2], bool)
            region[finder.region(state.camera_from_cube)] = True
            found[number] = covered(mask, picture.shape), region
    return found


def _state(body: CubeModel, number: int) -> CubeState:
    """Return the tracker's state of a photograph, by itself."""
    tracker, picture = CubeTracker(body, camera()), photograph(number)
    for frame in range(2):  # the second is refined
        state = tracker.update(Frame(picture, frame / RATE_HZ, frame))
    return state


def score(cover: Floats, hand: Flags, scored: Flags) -> Score:
    """Compare a cover with the hand, (H, W) each."""
    least, most = np.minimum(cover, hand)[scored].sum(), np.maximum(cover, hand)[scored].sum()
    size = np.count_nonzero(hand & scored)
    return Score(float(least / most), float(least / size), float((most - size) / size))


def main() -> None:
    """Print the score of each photograph, and draw both outlines."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", type=Path, help="picture with found and true outlines")
    parser.add_argument("--shuffle", type=int, help="seed of another order, in which all jumps")
    given = parser.parse_args()
    if not paths():
        raise SystemExit("the photographs are not on this machine")
    table = Table("photograph", "IoU", "found", "besides", "tuned on")
    groups: dict[bool, list[Score]] = {True: [], False: []}
    tiles = []
    for number, (cover, region) in sorted(covers(given.shuffle).items()):
        hand, scored = hand_on(number)
        one, tuned = score(cover, hand, scored & region), number in TUNED_ON
        groups[tuned].append(one)
        cells = (f"{value:.2f}" for value in (one.iou, one.found, one.besides))
        table.add_row(str(number), *cells, "yes" if tuned else "")
        tiles.append(_drawn(photograph(number), cover, hand & scored))
    for tuned, scores in groups.items():
        means = np.mean([(each.iou, each.found, each.besides) for each in scores], axis=0)
        table.add_row("mean", *(f"{mean:.3f}" for mean in means), "yes" if tuned else "")
    Console().print(table)
    if given.output:
        tiles += [np.zeros_like(tiles[0])] * (-len(tiles) % 4)
        rows = [np.hstack(tiles[first : first + 4]) for first in range(0, len(tiles), 4)]
        cv2.imwrite(str(given.output), np.vstack(rows))


def _drawn(picture: Image, cover: Floats, hand: Flags) -> Image:
    """Return the middle of a picture with outlines: what is covered in green, the hand in cyan."""
    for flags, colour in ((hand, (255, 255, 0)), (cover > 0.5, (0, 255, 0))):
        outlines = cv2.findContours(flags.astype(np.uint8), cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, outlines[0], -1, colour, 1)
    return picture[40:460, 350:870]


if __name__ == "__main__":
    main()
