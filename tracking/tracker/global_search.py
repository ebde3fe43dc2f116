"""The search for a cube anywhere in an image: cheap methods first, thorough ones last.

A search is a picture with a list of trials, which are done one after the other until one of them
decides. A call does as many as its budget allows, and the next call goes on with the same picture.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import cv2
import numpy as np

from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.detection.flat_sheet import lie_flat
from cubeling.tracking.detection.markers import Observation, markers_of
from cubeling.tracking.detection.partly_hidden_markers import PartlyHiddenMarkerDetector
from cubeling.tracking.detection.pose_from_points import CornerPose
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.image_region import Region
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.blur_search import BLUR_DIRECTIONS, BlurSearch
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.cell_search import CellRun, CellSearch
from cubeling.tracking.refinement.edge_search import EdgeSearch
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.refinement.photometry.photometric_fit import Alignment
from cubeling.tracking.tracker.frame_markers import FrameMarkers, Pass
from cubeling.tracking.tracker.marker_poses import MarkerPoses
from cubeling.tracking.tracker.verdict import choose_nearest, is_unambiguous

MIN_HALVED_HEIGHT_PX = 600
"""Images of at least this height are searched at half their size first."""

MIN_SINGLE_HEIGHT_PX = 400
"""Lower images are searched for partly hidden markers at twice their size."""

MAX_NEIGHBOURS, NEIGHBOURHOOD_SIDES = 3, 2.0
"""Around so many markers, the last ones, those of the same cube are searched, within so many of
their sides."""

MAX_SMALL_SHARE = 0.5
"""Where that is more than this share of the picture, the markers are no small ones."""

MAX_CHANGE, BLOCK_PX = 2.0, 16
"""A picture shows the same as before where the mean of no block of so many pixels differs by more
than this [grey levels]: noise does not change it, and whatever moves does."""

BUDGET_PICTURES = 1.5
"""What the trials of one call may cost beside the passes that each call begins with, counted in
pictures that are read: about as many detections by OpenCV."""

SMALL_PICTURE_PX, SMALL_BUDGET_PX = 640 * 480, 2_700_000
"""Pictures of at most so many pixels have this budget instead [px]: several faces at one lean, or
half of what both leans of a lone face take. Comparing cells takes as long as in a large picture: by
the other budget a cube that moves through small pictures has gone before it is found, and with both
leans in one call that takes as long as ten detections."""

CELLS_COST_PX, BLUR_COST_PX = 450_000, 4_000_000
"""What a short step of comparing the cells with the image costs, and aligning a blurred image: as
much as reading so many pixels for partly hidden markers. `make bench-photographs` prints what calls
take."""


@dataclass(frozen=True, eq=False)
class Search:
    """A picture that is searched, in one call or in several."""

    markers: FrameMarkers
    """What is read in the frame that is searched, which need not be the newest."""

    expected: Array | None
    """The predicted pose, (4, 4); None without one."""

    tone: Floats
    """Light for each grey value, (256,)."""

    found: tuple[Candidate, ...] = ()
    """The poses that were found so far, the best first."""

    seen: tuple[Observation, ...] = ()
    """The markers that were read so far."""

    absent: tuple[Observation, ...] = ()
    """Those of them that are others, which only look alike."""

    flat: bool = False
    """Whether its markers lie flat, as on the sheet of the cube before it is folded."""

    trials: "tuple[Trial, ...]" = ()
    """What is still to be tried."""

    half_done: bool = False
    """Whether another lean of what was found has still to be compared."""

    @property
    def frame(self) -> Frame:
        """The frame that is searched."""
        return self.markers.frame

    @property
    def decided(self) -> bool:
        """Whether nothing is left to be tried, or nothing needs to be."""
        if not self.trials or self.flat:
            return True
        return not self.half_done and is_unambiguous(self.found)

    def find(self, poses: Sequence[Candidate]) -> "Search":
        """Add poses; of those that are the same, the better one stays."""
        kept: list[Candidate] = []
        for each in sorted([*self.found, *poses], key=lambda each: each.rank):
            if not any(each.same_pose(better) for better in kept):
                kept.append(each)
        return replace(self, found=tuple(kept))

    def try_first(self, trials: Sequence["Trial"]) -> "Search":
        """Put trials before all others."""
        return replace(self, trials=(*trials, *self.trials))


@dataclass(frozen=True)
class Trial:
    """Something that a search may try, and what it costs."""

    cost: float
    """How many pixels could be read in its time."""

    run: Callable[[Search], Search]
    """Does it, and returns what the search has come to."""


_Start = tuple[CornerPose, CellRun | None]
"""A pose where the cells are compared, and how far that has come."""


class GlobalDetector:
    """Finds one cube without a past: by its markers and `edges`, or by its blurred image."""

    def __init__(
        self,
        cube: CubeModel,
        projection: Projection,
        edges: EdgeSearch,
        cells: CellSearch,
        blur: BlurSearch,
    ) -> None:
        self._cube = cube
        self._footprint = Footprint(cube, projection)
        self._poses = MarkerPoses(cube, projection, edges, cells)
        self._hidden = PartlyHiddenMarkerDetector(cube)
        self._blur = blur

    def search(
        self,
        markers: FrameMarkers,
        expected: Array | None,
        tone: Floats,
        thorough: bool,
        last: Search | None = None,
    ) -> Search:
        """Search a frame for the cube, or go on with the `last` one that is not decided yet.

        What is found at once in the new frame comes first: the quick passes are done in any case.
        `thorough` looks for partly hidden markers too, else others that OpenCV finds with more
        effort are read: each frame has one of the two. `expected` is the predicted pose.
        """
        passes = _passes(markers)
        if last is not None and _show_the_same(last.frame.image, markers.frame.image):
            return self._go_on(last)
        new = Search(markers, expected, tone)
        plans: list[list[Trial]] = []
        for by in passes if last is None else passes[:1]:
            read = markers_of(self._cube, markers.read(self._cube.dictionary, by))
            new, plan = self._try_markers(new, read)
            if new.flat or new.found:
                return new
            # The corners of the later pass are better ones; the others are a second chance.
            plans = [plan, *plans]
        if last is not None:
            return self._go_on(last)
        rest = self._read_hidden if thorough else self._read_others
        trials = [trial for plan in plans for trial in plan]
        # A low image is read at twice its size, with four times the pixels.
        doubled = thorough and len(markers.grey) < MIN_SINGLE_HEIGHT_PX
        cost = markers.grey.size * (4.0 if doubled else 1.0)
        new = new.try_first([*trials, Trial(cost, rest), Trial(0.0, self._try_blur)])
        return self._go_on(new)

    def carry(self, pose: Array, markers: FrameMarkers) -> Array | None:
        """Return where the one marker that is read in a later frame shows a cube, (4, 4).

        It is the lean of that marker that continues a pose, (4, 4); None where that is not clear.
        """
        read = markers_of(self._cube, markers.read(self._cube.dictionary, _passes(markers)[0]))
        alone = read if len(read) == 1 else []
        solutions = [each.camera_from_cube for each in self._poses.solve(alone, pose)]
        nearest = choose_nearest(pose, solutions) if solutions else None
        return None if nearest is None else solutions[nearest]

    def holds(self, search: Search, frame: Frame) -> bool:
        """Whether a later frame shows the same where a search has found the cube."""
        if not search.found:
            return True
        region = self._footprint.region(search.found[0].camera_from_cube)
        if region is None:
            return False
        left, top, right, bottom = region
        before, now = (each.image[top:bottom, left:right] for each in (search.frame, frame))
        return _show_the_same(before, now)

    def _go_on(self, search: Search) -> Search:
        """Try on, at least once, and until the budget is spent."""
        size = search.markers.grey.size
        left = SMALL_BUDGET_PX if size <= SMALL_PICTURE_PX else BUDGET_PICTURES * size
        while not search.decided:
            trial, *others = search.trials
            search = trial.run(replace(search, trials=tuple(others)))
            left -= trial.cost
            if search.trials and search.trials[0].cost > max(left, 0.0):
                break
        return search

    def _try_markers(
        self, search: Search, read: list[Observation], *, crisp: bool = True
    ) -> tuple[Search, list[Trial]]:
        """Take the pose that several faces agree on; else return how to compare the cells.

        `crisp` is whether OpenCV reads the markers. Beside a lone one that it does not read, which
        is covered or blurred, no other face has edges.
        """
        if not read:
            return search, []
        known = {each.face.name for each in search.seen}
        search = replace(search, seen=(*search.seen, *read))
        if lie_flat(read):
            return replace(search, flat=True, found=()), []
        solutions = self._poses.solve(read, search.expected)
        sides = {each.face.side for each in read}
        # A later pass has better corners, but the edges beside a lone marker stay as they were.
        again = len(sides) == 1 and known.issuperset(each.face.name for each in read)
        if len(sides) > 1 or (crisp and not again):
            agreed = self._poses.find_agreed(search.markers.grey, solutions, read, search.tone)
            if agreed is not None:
                return search.find([agreed]), []
        starts: list[_Start] = [(each, None) for each in solutions]
        plan = [self._comparison(starts, read, mirrored=False)] if starts else []
        return search, plan

    def _comparison(
        self, starts: list[_Start], read: list[Observation], *, mirrored: bool
    ) -> Trial:
        run = starts[0][1]
        compare = partial(self._compare_cells, starts, read, mirrored)
        return Trial(CELLS_COST_PX * (run.effort if run else 1), compare)

    def _compare_cells(
        self, starts: list[_Start], read: list[Observation], mirrored: bool, search: Search
    ) -> Search:
        """Take a step to compare the cells at the first of some poses; the others follow.

        After them comes, once, the other lean of a single face, whether or not the corners proposed
        that. None does where several faces agree.
        """
        (first, run), *others = starts
        found = self._poses.compare_cells(search.markers.grey, first, read, search.tone, run)
        if isinstance(found, CellRun):
            ahead = _in_order([(first, found), *others])
            trial = self._comparison(ahead, read, mirrored=mirrored)
            return replace(search, half_done=True).try_first([trial])
        search = search.find(found.candidates)
        if search.found and search.found[0].certain and search.found[0].agreed:
            return replace(search, half_done=False)
        if found.absent:
            return replace(search, half_done=False, absent=(*search.absent, *first.observations))
        if not others and not mirrored:
            others = [(each, None) for each in self._poses.mirror(first, search.found)]
            mirrored = True
        search = replace(search, half_done=bool(others))
        if not others:
            return search
        return search.try_first([self._comparison(others, read, mirrored=mirrored)])

    def _read_others(self, search: Search) -> Search:
        """Read the markers that OpenCV finds with more effort."""
        read = search.markers.read(self._cube.dictionary, "other windows")
        return self._try_more(search, markers_of(self._cube, read), crisp=True)

    def _read_hidden(self, search: Search) -> Search:
        """Read partly hidden markers, in a low image at twice its size at once.

        There the print of a hidden marker has too few pixels a cell.
        """
        grey = search.markers.grey
        small = len(grey) < MIN_SINGLE_HEIGHT_PX
        search = self._try_more(search, self._hidden.detect(grey, doubled=small), crisp=False)
        if small or not search.seen:
            return search
        left, top, right, bottom = region = _around(search.seen, grey)
        area = (right - left) * (bottom - top)
        if area > MAX_SMALL_SHARE * grey.size:
            return search
        closer = Trial(4.0 * area, partial(self._read_small, region))
        # Before the blur, which is the last.
        return replace(search, trials=(*search.trials[:-1], closer, *search.trials[-1:]))

    def _read_small(self, region: Region, search: Search) -> Search:
        if len(search.absent) == len(search.seen):  # it was no marker of the cube, so none is near
            return search
        read = self._hidden.detect(search.markers.grey, region, doubled=True)
        return self._try_more(search, read, crisp=False)

    def _try_more(self, search: Search, read: list[Observation], *, crisp: bool) -> Search:
        """Try markers of a thorough pass, unless their faces were tried and nothing was proved."""
        tried = {each.face.name for each in search.seen}
        hopeless = search.found and not any(each.certain for each in search.found)
        search, plan = self._try_markers(search, read, crisp=crisp)
        if hopeless and tried.issuperset(each.face.name for each in read):
            return search
        return search.try_first(plan)

    def _try_blur(self, search: Search) -> Search:
        """Plan to align the blurred image at poses that rest on corners alone."""
        # A single face that is blurred does not tell its lean.
        starts = tuple(each.camera_from_cube for each in search.found if not each.lone)
        if not starts or any(each.certain for each in search.found):
            return search
        return search.try_first([self._alignment(starts, 0, None, ())])

    def _alignment(
        self,
        starts: tuple[Array, ...],
        direction: int,
        best: Alignment | None,
        found: tuple[Candidate, ...],
    ) -> Trial:
        return Trial(BLUR_COST_PX, partial(self._align_blurred, starts, direction, best, found))

    def _align_blurred(
        self,
        starts: tuple[Array, ...],
        direction: int,
        best: Alignment | None,
        found: tuple[Candidate, ...],
        search: Search,
    ) -> Search:
        """Align the image at the first pose as blurred in one direction; the others follow."""
        patch = self._footprint.crop(search.frame.image, starts[0], search.tone)
        if patch is not None:
            best = self._blur.align_unknown_motion(patch, starts[0], direction, best)
            if direction + 1 < BLUR_DIRECTIONS:
                return search.try_first([self._alignment(starts, direction + 1, best, found)])
            candidate = self._blur.candidate(patch, best) if best else None
            found = (*found, candidate) if candidate else found
        if len(starts) > 1:
            return search.try_first([self._alignment(starts[1:], 0, None, found)])
        # Where no blur explains the image, the corners are still the best guess.
        return replace(search, found=found or search.found)


def _passes(markers: FrameMarkers) -> tuple[Pass, ...]:
    """Return the quick passes over an image; small ones skip that at half size."""
    passes: tuple[Pass, ...] = ("half size", "first window")
    return passes[len(markers.grey) < MIN_HALVED_HEIGHT_PX :]


def _in_order(starts: list[_Start]) -> list[_Start]:
    """Order poses whose cells are compared: all are weighed before the best one is measured.

    One at which other faces are seen comes first, as it may end the search.
    """

    def order(start: _Start) -> tuple[int, float]:
        run = start[1]
        if run is None:
            return 1, 0.0
        if run.step in ("measure", "weigh measured") and run.match:
            return 3, -run.match.evidence.total
        return 2 * (run.alone and run.step == "align"), 0.0

    return sorted(starts, key=order)


def _show_the_same(before: Image, now: Image) -> bool:
    """Whether two images, (H, W, 3), differ by no more than their noise."""
    size = tuple(max(1, side // BLOCK_PX) for side in before.shape[1::-1])
    old, new = (
        cv2.resize(each[..., 1], size, interpolation=cv2.INTER_AREA).astype(np.float32)
        for each in (before, now)
    )
    return bool(np.abs(new - old).max() <= MAX_CHANGE)


def _around(seen: Sequence[Observation], grey: Image) -> Region:
    """Return the region around the latest markers in which their cube lies."""
    corners = np.concatenate([each.corners for each in seen[-MAX_NEIGHBOURS:]])
    reach = NEIGHBOURHOOD_SIDES * max(each.size for each in seen[-MAX_NEIGHBOURS:])
    left, top = np.maximum(corners.min(axis=0) - reach, 0).astype(int).tolist()
    right, bottom = np.minimum(corners.max(axis=0) + reach, grey.shape[::-1]).astype(int).tolist()
    return left, top, right, bottom
