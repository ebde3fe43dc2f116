"""A cube at rest near an expected pose, found by all cells of its markers, and how sure that is."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel, side_of
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.evidence import Evidence
from cubeling.tracking.refinement.footprint import Footprint
from cubeling.tracking.refinement.photometry.marker_images import DrawnMarkers
from cubeling.tracking.refinement.photometry.placed_samples import MIN_FACING_COSINE
from cubeling.tracking.refinement.photometry.still_alignment import (
    EXPECTED_BLUR_PX,
    MEASURED_STIFFNESS,
    StillAligner,
    StillAlignment,
)

MIN_CORRELATION = 0.85
"""Correlation of a marker with the image from which on it is found."""

MIN_VISIBLE_CORRELATION, MIN_VISIBLE_SHARE = 0.93, 0.55
"""The same for the visible part of a covered marker, and the least such part. It proves nothing
alone: a part of a marker is like many things."""

MIN_INNER_CORRELATION, MIN_PARTIAL_CORRELATION = 0.7, 0.45
"""Correlation of the cells inside the border of a whole marker, which tell it from others, and of
all and of these of a covered one."""

MIN_SPEAKING = 0.6
"""Correlation from which on a marker that is not found speaks for the pose, too: little at first.
White paper and clutter fit any marker by chance."""

MISSING_CORRELATION, MISSING_EVIDENCE = 0.4, 4.0
"""Below that correlation a marker in view speaks against the pose, in full from this one down, and
how much one or more of them do: twice the logarithm of how seldom a hand covers faces."""

MAX_FINE_FACES = 2
"""More faces than this determine a pose well enough with few samples."""

MIN_LOCKED = 0.7
"""Correlation from which on an alignment has found its place, and blur would lead nowhere else."""

MIN_JOINING = 0.3
"""Correlation from which on another face may join the alignment."""

MIN_SEEN_COSINE = 0.35
"""Cosine of the viewing angle from which on a marker that is not found is missing."""

COARSE_BLUR_CELLS = 0.45
"""Blur of image and rendering with which a pose is searched that is off by up to a cell [cells]."""


@dataclass(frozen=True)
class CellMatch:
    """A pose at which the cells match the image, and the evidence for it."""

    alignment: StillAlignment
    """Pose that the cells of the match agree on, and how well."""

    found: tuple[str, ...]
    """Names of the faces that are found there."""

    whole: tuple[str, ...]
    """Those of them of which every cell is right."""

    proved: bool
    """Whether one of them is found whole, or two in part."""

    evidence: Evidence
    """How much the image speaks for the pose: by faces that are found, less those missing."""

    @property
    def candidate(self) -> Candidate:
        """The pose as a candidate."""
        aligned = self.alignment
        return Candidate(
            camera_from_cube=aligned.camera_from_cube,
            covariance=aligned.covariance,
            source="markers",
            faces=self.found,
            error=np.nan,
            residual=aligned.residual,
            certain=self.proved,
            evidence=self.evidence,
            blur=aligned.blur,
            # The other lean of a face shows none of its neighbours' cells where they are.
            agreed=len(set(map(side_of, self.whole))) > 1,
        )


Step = Literal[
    "look", "align", "align coarsely", "weigh", "join", "weigh joined", "measure", "weigh measured",
    "flatten", "",
]  # fmt: skip
"""A step of a search; "" after the last one."""

EFFORT = {
    "align": 2, "align coarsely": 5, "join": 2, "measure": 2, "weigh measured": 3, "flatten": 2,
}  # fmt: skip
"""How many times as long as the others some steps take."""


@dataclass(frozen=True, eq=False)
class CellRun:
    """A search as far as it has come."""

    patch: Patch | None
    """The image around the cube, in light; None where that is not in view."""

    start: Array
    """The pose where it began, (4, 4)."""

    read: Collection[str] | None
    """As in `CellSearch.search`."""

    step: Step
    """What `CellSearch.advance` does next; "" where nothing is left."""

    aligned: StillAlignment | None = None
    """The pose that the faces that are compared agree on."""

    match: CellMatch | None = None
    """What `CellSearch.search` returns, as far as it is known."""

    markers: DrawnMarkers | None = None
    """What was rendered at the pose where it began."""

    exact: bool = False
    """As in `CellSearch.begin`."""

    joined: StillAlignment | None = None
    """The pose that other faces, which are seen as well, agree on too; still to be weighed."""

    alone: bool = False
    """Whether it has looked for other faces than those that were read, and sees none."""

    @property
    def effort(self) -> int:
        """How long the next step takes, in the time of the shortest."""
        return EFFORT.get(self.step, 1)

    @property
    def done(self) -> bool:
        """Whether the result is final."""
        return not self.step

    def end_if_known(self) -> "CellRun":
        """End it where so many faces determine the pose that more samples tell little."""
        if self.aligned and self.match and len(self.aligned.correlations) > MAX_FINE_FACES:
            return replace(self, match=replace(self.match, alignment=self.aligned), step="")
        return self


class CellSearch:
    """Searches one cube seen by one camera."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._aligner = StillAligner(cube, projection)
        self._footprint = Footprint(cube, projection)
        self._faces = FacePlanes(cube)

    def search(
        self, image: Image, start: Array, tone: Floats, read: Collection[str] | None = None
    ) -> CellMatch | None:
        """Align the cube in an image, (H, W) grey or (H, W, 3) BGR, near a pose.

        `tone` is the light for each grey value, (256,), `read` names the faces whose markers were
        read; the others join in afterwards, where they are seen. None compares all from the start.
        """
        run = self.begin(image, start, tone, read)
        while not run.done:
            run = self.advance(run)
        return run.match

    def begin(
        self,
        image: Image,
        start: Array,
        tone: Floats,
        read: Collection[str] | None,
        *,
        exact: bool = False,
    ) -> CellRun:
        """Begin a `search`, which `advance` carries on until it is done.

        `exact` is whether the start rests on the corners of markers, and is not off by a cell.
        """
        patch = self._footprint.crop(image, start, tone)
        if patch is None:
            return CellRun(None, start, read, "")
        alone = read is None or self._in_view(start) <= set(read)
        return CellRun(patch, start, read, "align" if alone else "look", exact=exact)

    def advance(self, run: CellRun) -> CellRun:
        """Take the next step of a search."""
        if run.step == "look":
            return self._look(run)
        if run.step == "align":
            return self._align(run)
        if run.step == "align coarsely":
            return self._align_coarsely(run)
        if run.step == "weigh":
            return self._weigh_all(run)
        if run.step == "join":
            return self._join(run)
        if run.step == "weigh joined":
            return self._weigh_joined(run)
        if run.step == "measure":
            return self._measure(run)
        return self._weigh_measured(run) if run.step == "weigh measured" else self._flatten(run)

    def _look(self, run: CellRun) -> CellRun:
        """Look which other faces are seen where the search begins: these are aligned at once."""
        assert run.patch is not None
        assert run.read is not None
        seen = self._aligner.align(run.patch, run.start, steps=1)
        if seen is None:
            return replace(run, step="align")
        cosines = dict(zip(self._faces.names, self._faces.cosines(run.start), strict=True))
        joining = {
            face
            for face, share in seen.correlations.items()
            if share > MIN_SPEAKING and cosines[face] > MIN_SEEN_COSINE
        }
        alone = joining <= set(run.read)
        read = {*run.read, *joining}
        # Where many faces are seen, the look was a first step towards them.
        start = seen.camera_from_cube if len(joining) > MAX_FINE_FACES else run.start
        return replace(run, start=start, read=read, markers=seen.markers, alone=alone, step="align")

    def _align(self, run: CellRun) -> CellRun:
        """Align the faces that were read, or seen at once."""
        assert run.patch is not None
        found = self._aligner.align(run.patch, run.start, run.read, markers=run.markers)
        good = found and max(found.correlations.values()) > MIN_LOCKED
        if not good and run.exact:
            return replace(run, step="")
        return replace(run, aligned=found, step="weigh" if good else "align coarsely")

    def _align_coarsely(self, run: CellRun) -> CellRun:
        """Align with blur first, from a start that may be too far off for the other way."""
        found, patch, read = run.aligned, run.patch, run.read
        assert patch is not None
        blur = COARSE_BLUR_CELLS * self._footprint.pixels_per_cell(run.start)
        coarse = self._aligner.align(
            patch.smooth(blur), run.start, read, float(np.hypot(blur, EXPECTED_BLUR_PX))
        )
        again = self._aligner.align(patch, coarse.camera_from_cube, read) if coarse else None
        if again and not (found and found.evidence.total > again.evidence.total):
            found = again
        return replace(run, aligned=found, step="weigh" if found else "")

    def _weigh_all(self, run: CellRun) -> CellRun:
        """Weigh the pose by all faces in view; others that are seen may join it."""
        patch, aligned = run.patch, run.aligned
        assert patch is not None
        assert aligned is not None
        # Beside many faces, one that is seen from the side, and cannot be missing, tells nothing.
        many = len(aligned.correlations) > MAX_FINE_FACES
        in_view = self._in_view(
            aligned.camera_from_cube, MIN_SEEN_COSINE if many else MIN_FACING_COSINE
        )
        compared = in_view <= set(aligned.correlations)
        match = self._match(aligned) if compared else self._weigh(patch, aligned)
        if not match or not match.found:
            return replace(run, match=match, step="")
        # The markers that are drawn to weigh them need not be drawn again.
        aligned = replace(aligned, markers=match.alignment.markers)
        # With many faces the pose is known; others would cost more than they tell.
        joins = MAX_FINE_FACES >= len(aligned.correlations) < len(_faces_to_add(match))
        if not (joins or match.proved):
            # More samples do not make a likeness a proof.
            return replace(run, match=replace(match, alignment=aligned), step="")
        return replace(
            run, aligned=aligned, match=match, step="join" if joins else "measure"
        ).end_if_known()

    def _join(self, run: CellRun) -> CellRun:
        """Align all faces that are seen."""
        patch, aligned, match = run.patch, run.aligned, run.match
        assert patch is not None
        assert aligned is not None
        assert match is not None
        joined = self._aligner.realign(patch, aligned, _faces_to_add(match))
        return replace(run, joined=joined, step="weigh joined" if joined else "measure")

    def _weigh_joined(self, run: CellRun) -> CellRun:
        """Take the pose of all faces that are seen, where that explains more."""
        patch, joined, match = run.patch, run.joined, run.match
        assert patch is not None
        assert joined is not None
        assert match is not None
        again = self._weigh(patch, joined)
        if again and again.evidence.total > match.evidence.total:
            run = replace(run, aligned=joined, match=again)
        return replace(run, step="measure").end_if_known()

    def _measure(self, run: CellRun) -> CellRun:
        """Measure with more samples what was found coarsely."""
        patch, aligned = run.patch, run.aligned
        assert patch is not None
        assert aligned is not None
        measured = self._aligner.realign(patch, aligned, aligned.correlations, fine=True)
        return replace(run, aligned=measured or aligned, step="weigh measured")

    def _weigh_measured(self, run: CellRun) -> CellRun:
        """Weigh the measured pose with as many samples."""
        patch, aligned = run.patch, run.aligned
        assert patch is not None
        assert aligned is not None
        match = self._weigh(patch, aligned, fine=True)
        if len(aligned.correlations) == 1:
            return replace(run, match=match, step="flatten")
        return replace(run, match=match and replace(match, alignment=aligned), step="")

    def _flatten(self, run: CellRun) -> CellRun:
        """Measure a single face once more, with flatter paper."""
        patch, aligned, match = run.patch, run.aligned, run.match
        assert patch is not None
        assert aligned is not None
        measured = self._aligner.realign(
            patch, aligned, aligned.correlations, fine=True, stiffness=MEASURED_STIFFNESS
        )
        match = match and replace(match, alignment=measured or aligned)
        return replace(run, match=match, step="")

    def _weigh(self, patch: Patch, aligned: StillAlignment, fine: bool = False) -> CellMatch | None:
        """Weigh a pose by all faces that it shows."""
        return self._match(self._aligner.realign(patch, aligned, None, steps=1, fine=fine))

    def _in_view(self, camera_from_cube: Array, min_cosine: float = MIN_FACING_COSINE) -> set[str]:
        """Return the names of the faces that may be compared at a pose, (4, 4)."""
        facing = self._faces.faces_towards(camera_from_cube, min_cosine)
        return {self._faces.names[number] for number in facing}

    def _match(self, aligned: StillAlignment | None) -> CellMatch | None:
        if aligned is None:
            return None
        cosines = self._faces.cosines(aligned.camera_from_cube)
        alike = aligned.correlations
        found = tuple(face for face in alike if _is_found(aligned, face))
        blocks, missing = aligned.evidence.blocks.copy(), np.zeros(len(cosines))
        for row, face in enumerate(self._faces.names):
            if face in found or face not in alike:
                continue
            if cosines[row] > MIN_SEEN_COSINE:
                absent = (MIN_SPEAKING - alike[face]) / (MIN_SPEAKING - MISSING_CORRELATION)
                missing[row] = np.clip(absent, 0, 1)
            share = (alike[face] - MIN_SPEAKING) / (MIN_CORRELATION - MIN_SPEAKING)
            blocks[row] *= np.clip(share, 0, 1)
        if missing.any():
            against = missing * missing.max() / missing.sum()
            blocks -= MISSING_EVIDENCE / blocks.shape[1] * against[:, None]
        whole = tuple(
            face for face in found if alike[face] > MIN_CORRELATION and not aligned.wrong[face]
        )
        proved = bool(whole) or len(found) > 1
        return CellMatch(aligned, found, whole, proved, Evidence(blocks, aligned.evidence.bend))


def _faces_to_add(match: CellMatch) -> set[str]:
    """Return the faces that are alike enough to join the alignment."""
    return {face for face, share in match.alignment.correlations.items() if share > MIN_JOINING}


def _is_found(aligned: StillAlignment, face: str) -> bool:
    """Whether a marker is found, whole or in part, and is not another one."""
    alike, inner = aligned.correlations[face], aligned.inner[face]
    if alike > MIN_CORRELATION:
        return inner > MIN_INNER_CORRELATION
    visible, share = aligned.visible[face]
    seen = visible > MIN_VISIBLE_CORRELATION and share > MIN_VISIBLE_SHARE
    return seen and min(alike, inner) > MIN_PARTIAL_CORRELATION
