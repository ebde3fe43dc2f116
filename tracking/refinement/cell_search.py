"""A cube at rest near an expected pose, found by all cells of its markers, and how sure that is."""

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from cubeling.tracking.cube.faces import FacePlanes
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.image_region import Patch
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.refinement.candidate import Candidate
from cubeling.tracking.refinement.evidence import Evidence
from cubeling.tracking.refinement.footprint import Footprint
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

    proved: bool
    """Whether one of them is found whole, with every cell right, or two in part."""

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
        )


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
        patch = self._footprint.crop(image, start, tone)
        if patch is None:
            return None
        aligned = self._read_aligned(patch, start, read)
        match = self._weigh(patch, aligned) if aligned else None
        if not aligned or not match or not match.found:
            return match
        alike = match.alignment.correlations
        seen = {face for face, share in alike.items() if share > MIN_JOINING}
        if len(seen) > len(aligned.correlations):
            joint = self._aligner.realign(patch, aligned, seen)
            again = self._weigh(patch, joint) if joint else None
            if joint and again and again.evidence.total > match.evidence.total:
                aligned, match = joint, again
        faces = aligned.correlations
        if len(faces) > MAX_FINE_FACES:
            return replace(match, alignment=aligned)
        # What was found coarsely is measured with more samples.
        aligned = self._aligner.realign(patch, aligned, faces, fine=True) or aligned
        match = self._weigh(patch, aligned, fine=True)
        if len(faces) == 1:
            stiff = MEASURED_STIFFNESS
            measured = self._aligner.realign(patch, aligned, faces, fine=True, stiffness=stiff)
            aligned = measured or aligned
        return match and replace(match, alignment=aligned)

    def _weigh(self, patch: Patch, aligned: StillAlignment, fine: bool = False) -> CellMatch | None:
        """Weigh a pose by all faces that it shows."""
        return self._match(self._aligner.realign(patch, aligned, None, steps=1, fine=fine))

    def _read_aligned(
        self, patch: Patch, start: Array, read: Collection[str] | None
    ) -> StillAlignment | None:
        """Align the faces that were read; coarsely first where that fails."""
        found = self._aligner.align(patch, start, read)
        if found and max(found.correlations.values()) > MIN_CORRELATION:
            return found
        blur = COARSE_BLUR_CELLS * self._footprint.pixels_per_cell(start)
        coarse = self._aligner.align(
            patch.smooth(blur), start, read, float(np.hypot(blur, EXPECTED_BLUR_PX))
        )
        again = self._aligner.align(patch, coarse.camera_from_cube, read) if coarse else None
        if again and not (found and found.evidence.total > again.evidence.total):
            return again
        return found

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
        whole = any(alike[face] > MIN_CORRELATION and not aligned.wrong[face] for face in found)
        return CellMatch(
            aligned, found, whole or len(found) > 1, Evidence(blocks, aligned.evidence.bend)
        )


def _is_found(aligned: StillAlignment, face: str) -> bool:
    """Whether a marker is found, whole or in part, and is not another one."""
    alike, inner = aligned.correlations[face], aligned.inner[face]
    if alike > MIN_CORRELATION:
        return inner > MIN_INNER_CORRELATION
    visible, share = aligned.visible[face]
    seen = visible > MIN_VISIBLE_CORRELATION and share > MIN_VISIBLE_SHARE
    return seen and min(alike, inner) > MIN_PARTIAL_CORRELATION
