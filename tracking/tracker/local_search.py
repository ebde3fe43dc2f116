"""Following the cube from where it should be: by its edges, or by its blurred picture."""

import numpy as np
from numpy.typing import NDArray

from tracking.cube.faces import Faces
from tracking.cube.marker import marker_cells
from tracking.cube.model import CubeModel
from tracking.detection.marker_check import CellReader, Reading
from tracking.geometry.image_region import Patch, Region
from tracking.geometry.projection import NEAREST, Projection
from tracking.refinement.alignment import Alignment
from tracking.refinement.camera_model import CameraHabits
from tracking.refinement.edge_refinement import EdgeRefiner, Refinement
from tracking.refinement.motion_blur_alignment import SweptAligner
from tracking.tracker import prediction
from tracking.tracker.candidate import Candidate
from tracking.tracker.prediction import Track

Array = NDArray[np.float64]

SEEN = 0.55
"""Share of the edges in view that must be found for the edges alone to prove the cube."""

SEEN_FEW = 0.25
"""The same where the markers can be read as well; fingers cover the rest."""

CRISP = 0.65
"""Edges that are duller than this across one direction are blurred in a way that was not told."""

UNSHARP, CROOKED = 0.5, 0.0063
"""Edges of a rigid cube lie within this of their places [px], or within this share of its edge,
whichever is more: a cube folded 1 mm askew does, a cube on a screen seen from aside does not."""

TOLD = 0.6
"""Share of a face's cells that must be as they should for its edges to be called its own."""

READ = 0.95
"""Share of a face's cells that must be as they should for it to count as read."""

LIKE = 0.85
"""Correlation of a blurred picture with the drawn one, from which on it is the cube."""

SURE = 0.95
"""The same where there is no past."""

SURPRISE = 0.07
"""Cells by which a sweep must differ from the expected one for the edges to be measured anew."""

DOUBT, DOUBT_STREAK = 1.5, 0.25
"""By how much edges err more than their residuals tell, at rest, and the streak that doubles it
[cells]. Measured as the coverage that `make bench-tracking` prints."""

COMMON = (0.01, 0.002, 0.005)
"""What all edges err by together: to a side, in size and in lean, at the cube's border [px]."""

DOUBT_SWEPT = (2.5, 5.0)
"""The same for blurred pictures: at no streak, and more for each cell."""

STREAK = 0.6
"""Cells that an edge may cross during the exposure and still be measured as an edge."""

SMEARED = 0.3
"""Cells below which edges of the cube itself are seen."""

SWEEP_SPREAD, FIRST_SPREAD = (0.12, 0.0025, 0.04), (0.35, 0.004, 0.06)
"""What is not known of an expected sweep: a share of it, and [m, rad] besides; the second while the
exposure is not known."""


class Follower:
    """Finds the cube again near where it should be."""

    def __init__(self, cube: CubeModel, projection: Projection) -> None:
        self._projection = projection
        self.camera = CameraHabits()
        self.refiner = EdgeRefiner(cube, projection)
        self.aligner = SweptAligner(cube, projection)
        self.reader = CellReader(cube, projection)
        signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        self._hull = np.array(signs, np.float64) * cube.edge / 2
        self._faces = Faces(cube)
        self._half = cube.edge / 2
        cells = len(marker_cells(cube.dictionary, cube.faces[0].marker_id))
        self._cell = cube.marker_size / cells

    def follow(self, image: NDArray[np.uint8], track: Track, timestamp: float) -> Candidate | None:
        """Look where the past says that the cube should be; None where it is not found there."""
        last = track.recent(timestamp)
        if last is None:
            return None
        expected = prediction.predicted(last, timestamp)
        region = self.region(expected)
        if region is None:
            return None
        patch = Patch.of(image, region, self.camera.tone)
        sweep = prediction.velocity_at(last, timestamp) * self.camera.exposure
        if self.streak(expected, sweep) < STREAK:
            found = self._sharp(patch, expected, sweep, track, timestamp)
            if found is not None:
                self._study(patch, found, track, timestamp)
                return found
        aligned = self._aligned(patch, expected, sweep)
        if aligned is None:
            return None
        self._learn(
            aligned,
            track.motion(aligned.camera_from_cube, aligned.covariance[:6, :6], timestamp)[0],
        )
        return self._finished(patch, aligned)

    def _finished(self, patch: Patch, aligned: Alignment) -> Candidate | None:
        """Refine an alignment on its edges; where they are not smeared they must be right."""
        streak = self.streak(aligned.camera_from_cube, aligned.sweep)
        if streak < STREAK:
            found = self.by_edges(patch, aligned.camera_from_cube, aligned.sweep)
            if found is not None or streak < SMEARED:
                return found
        return self._blurred(aligned)

    def _sharp(
        self, patch: Patch, expected: Array, sweep: Array, track: Track, timestamp: float
    ) -> Candidate | None:
        """Refine on edges; once more where the cube turns out to move otherwise than expected."""
        found = self.by_edges(patch, expected, sweep)
        if found is None:
            return None
        pose = found.camera_from_cube
        moved = track.motion(pose, found.covariance, timestamp)[0] * self.camera.exposure
        if self.streak(pose, moved) > STREAK:
            return None
        if self.streak(pose, moved - sweep) < SURPRISE:
            return found
        return self.by_edges(patch, pose, moved) or found

    def _study(self, patch: Patch, found: Candidate, track: Track, timestamp: float) -> None:
        """Take the time to learn what camera this is from a cube that is blurred a little."""
        if not self.camera.curious:
            return
        pose = found.camera_from_cube
        velocity = track.motion(pose, found.covariance, timestamp)[0]
        sweep = velocity * self.camera.exposure
        if not self.camera.tells(self.streak(pose, sweep), self._pixels_per_cell(pose)):
            return
        self.camera.lessons += 1
        aligned = self._aligned(patch, pose, sweep, coarse=False)
        if aligned is not None:
            self._learn(aligned, velocity)

    def _learn(self, aligned: Alignment, velocity: Array) -> None:
        pose = aligned.camera_from_cube
        streak = self.streak(pose, aligned.sweep)
        if aligned.likeness >= SURE:
            self.camera.learn(aligned, velocity, streak, self._pixels_per_cell(pose))

    def other(self, candidate: Candidate) -> Array:
        """Return the mirrored pose of a single face, (4, 4), not refined."""
        face = self._faces.names.index(candidate.faces[0])
        return self._faces.mirrored(candidate.camera_from_cube, face)

    def mirrored(self, patch: Patch, candidate: Candidate) -> Candidate | None:
        """Refine the other pose that a single face could have; None where there is no such pose.

        Seen from afar, a square that leans towards the camera looks like one that leans away.
        """
        return self.by_edges(patch, self.other(candidate), None)

    def by_edges(self, patch: Patch, start: Array, sweep: Array | None) -> Candidate | None:
        """Refine a pose on the edges, and take it if they prove that this is the cube."""
        found = self.refiner.refine(patch, start, sweep)
        if found is None or found.support < SEEN_FEW:
            return None
        reading = self.reader.read(patch, found.camera_from_cube)
        if not (self.rigid(found) and _proves(found, reading)):
            return None
        return Candidate(
            camera_from_cube=found.camera_from_cube,
            covariance=self.doubted(found, sweep),
            source="markers" if reading.best >= READ else "image",
            faces=tuple(
                face
                for face, share in found.shares.items()
                if share > SEEN_FEW and reading.agreement.get(face, 1.0) > TOLD
            ),
            error=found.residual,
            residual=found.residual / found.support,
            certain=True,
            lines=found.lines,
        )

    def unblurred(self, patch: Patch, start: Array) -> Candidate | None:
        """Align a cube without a past, whose corners alone were read: it may move any way.

        A way and its reverse blur alike, so half of all directions will do.
        """
        best: Alignment | None = None
        prior = np.repeat([1.5 * self._cell, 0.15], 3)
        for angle in np.arange(4) * np.pi / 4:
            sweep = self._cell * np.array([np.cos(angle), np.sin(angle), 0, 0, 0, 0])
            found = self.aligner.align(patch, start, sweep, prior)
            surer = found and found.likeness > max(SURE, best.likeness if best else 0.0)
            if found and surer and _shown(found):
                best = found
        return self._finished(patch, best) if best else None

    def proved(self, patch: Patch, found: Refinement) -> bool:
        """Whether edges and cells at a pose prove that this is the cube."""
        return self.rigid(found) and _proves(found, self.reader.read(patch, found.camera_from_cube))

    def rigid(self, found: Refinement) -> bool:
        """Whether the edges lie as those of one rigid cube do, and not as on a picture of one."""
        distance = float(found.camera_from_cube[2, 3])
        pixel = distance / float(self._projection.matrix[0, 0])
        return found.residual < max(UNSHARP, CROOKED * 2 * self._half / pixel)

    def _aligned(
        self, patch: Patch, expected: Array, sweep: Array, coarse: bool | None = None
    ) -> Alignment | None:
        """Align the picture of a moving cube: finely, and coarsely first where that fails."""
        share, shift, turn = SWEEP_SPREAD if self.camera.exposure_known else FIRST_SPREAD
        spread = share * np.repeat([np.linalg.norm(sweep[:3]), np.linalg.norm(sweep[3:])], 3)
        prior = np.hypot(spread, np.repeat([shift, turn], 3))
        found = None
        if not coarse:
            found = self.aligner.align(patch, expected, sweep, prior, coarse=False)
        if coarse is None and not (found and found.weakest > SURE):
            again = self.aligner.align(patch, expected, sweep, prior)
            if again and not (found and found.likeness > again.likeness):
                found = again
        return found if found and _shown(found) else None

    def doubted(self, found: Refinement, sweep: Array | None) -> Array:
        """Covariance of a pose on edges, (6, 6), with what no residual shows.

        Lens, paper and light put all edges a little beside their places together: to the side, in
        size, and in lean.
        """
        pose = found.camera_from_cube
        streak = self.streak(pose, sweep) if sweep is not None else 0.0
        distance = float(pose[2, 3])
        pixel = distance / float(self._projection.matrix[0, 0])
        side, size, lean = np.array(COMMON) * pixel
        size, lean = size * distance / self._half, lean / self._half
        floor = np.square([side, side, size, lean, lean, lean])
        raised = found.covariance * DOUBT * (1 + (streak / DOUBT_STREAK) ** 2)
        return np.asarray(raised + np.diag(floor), np.float64)

    def _blurred(self, aligned: Alignment) -> Candidate:
        faces = tuple(face for face, share in aligned.shares.items() if share > LIKE)
        streak = self.streak(aligned.camera_from_cube, aligned.sweep)
        return Candidate(
            camera_from_cube=aligned.camera_from_cube,
            covariance=aligned.covariance[:6, :6] * (DOUBT_SWEPT[0] + DOUBT_SWEPT[1] * streak),
            source="image",
            faces=faces,
            error=float("nan"),
            residual=aligned.residual,
            certain=True,
            sweep=aligned.sweep,
        )

    def _pixels_per_cell(self, camera_from_cube: Array) -> float:
        return self._cell * float(self._projection.matrix[0, 0]) / float(camera_from_cube[2, 3])

    def streak(self, camera_from_cube: Array, sweep: Array) -> float:
        """How many cells an edge crosses at most while the shutter is open."""
        across = float(np.linalg.norm(sweep[:3])) + self._half * float(np.linalg.norm(sweep[3:]))
        return across / self._cell

    def region(self, expected: Array) -> Region | None:
        """Surround the predicted cube, with room for a hand's acceleration."""
        points = self._hull @ expected[:3, :3].T + expected[:3, 3]
        if points[:, 2].min() < NEAREST:
            return None
        pixels = self._projection.pixels(points)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        margin = 0.15 * float((high - low).max()) + 12
        width, height = self._projection.size
        left, top = max(0, int(low[0] - margin)), max(0, int(low[1] - margin))
        right, bottom = (
            min(width, int(high[0] + margin + 1)),
            min(height, int(high[1] + margin + 1)),
        )
        if right - left < 32 or bottom - top < 32:
            return None
        return left, top, right, bottom


def _shown(aligned: Alignment) -> bool:
    """Whether a blurred picture shows the cube: all faces are like it, or two are beyond doubt."""
    if aligned.weakest > LIKE:
        return True
    sure = sum(share > SURE for share in aligned.shares.values())
    return aligned.likeness > LIKE and sure >= 2


def _proves(found: Refinement, reading: Reading) -> bool:
    if found.crisp < CRISP:
        return False
    if min(found.support, found.inner) > SEEN and reading.best > 0.6:
        return True
    return reading.best >= READ or (found.support > SEEN and reading.best > 0.75)
