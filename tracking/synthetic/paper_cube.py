"""The printed cube, rendered by intersecting the ray of every sample with the faces' planes."""

import cv2
import numpy as np

from cubeling.tracking.cube.icons import FOLD_GAP_SHARE, ICON_COLOURS, ICON_SHARE, icon_mask, icons
from cubeling.tracking.cube.marker import black_texels, marker_cells
from cubeling.tracking.cube.model import FACE_AXES, CubeModel, Face
from cubeling.tracking.geometry.arrays import Array, Floats
from cubeling.tracking.geometry.projection import MIN_DEPTH
from cubeling.tracking.synthetic.camera_rays import CameraRays, PixelRegion, average_blocks
from cubeling.tracking.synthetic.folding import face_poses

FACE_TEXELS = 640
"""Texels along the edge of a face's texture."""

MIPMAP_LEVELS = 4
"""Number of resolutions of a face, each half of the previous one."""

WHITE, BLACK = 232.0, 26.0
"""Grey levels of paper and toner at full light."""

TO_LIGHT = np.array([-0.42, 0.82, 0.40])
"""Direction towards the lamp, in the table frame."""

AMBIENT_SHARE = 0.60
"""Share of the light that comes from all directions."""

BEND_SHARE = 0.1
"""How far a lens may bend an edge of a face, as a share of its length; more would be cut off."""

_FACE_CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


class PaperCube:
    """Renders one cube; `seed` is that of the paper's grain."""

    def __init__(self, cube: CubeModel, camera: CameraRays, seed: int) -> None:
        self.cube = cube
        self.camera = camera
        """What it is seen through; it may be exchanged."""
        self._fold_poses = face_poses(cube)
        self._textures = face_textures(cube, seed)

    def corners(self, camera_from_cube: Array) -> Array:
        """Return the cube's eight corners in the camera frame, (8, 3)."""
        half = self.cube.edge / 2
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return half * signs @ camera_from_cube[:3, :3].T + camera_from_cube[:3, 3]

    def region(self, camera_from_cube: Array) -> PixelRegion:
        """Return the region of the image that the cube covers."""
        corners = self.corners(camera_from_cube)
        if (corners[:, 2] < 0.02).any():
            return PixelRegion(0, 0, 0, 0)
        pixels, margin = self.camera.pixels(corners), 4.0
        if self._fold_poses:  # a face may stand out by some millimetres
            margin += 0.1 * float(np.ptp(pixels, axis=0).max())
        return self.camera.region_around(pixels, margin)

    def depth(self, region: PixelRegion, camera_from_cube: Array) -> Floats:
        """Return the depth of the cube's surface, (h, w) [m]; infinite where there is no cube."""
        x, y = cv2.split(self.camera.rays(region, 1))
        enters = np.zeros(x.shape, np.float32)
        leaves = np.full(x.shape, np.inf, np.float32)
        for axis in range(3):
            for sign in (1.0, -1.0):
                normal = sign * camera_from_cube[:3, axis]
                offset = float(normal @ camera_from_cube[:3, 3]) + self.cube.edge / 2
                across, down, ahead = normal.astype(np.float32)
                slope = across * x + down * y + ahead
                reach = np.float32(offset) / np.where(slope == 0, np.float32(1e-9), slope)
                np.maximum(enters, np.where(slope < 0, reach, 0.0), out=enters)
                np.minimum(leaves, np.where(slope < 0, np.inf, reach), out=leaves)
        return np.where(enters < leaves, enters, np.float32(np.inf))

    def draw(
        self, region: PixelRegion, poses: list[Array], to_light: Array, samples: int
    ) -> tuple[Floats, Floats]:
        """Render a region of the image with `samples`² rays per pixel.

        `poses` are `camera_from_cube` at times spread evenly over the exposure, `to_light` is the
        direction towards the lamp in the camera frame.

        Returns
        -------
        Colour (h, w, 3) BGR, premultiplied; and coverage (h, w, 1), 0…1.
        """
        rays = self.camera.rays(region, samples)
        sums = np.zeros((region.height, region.width, 4), np.float32)
        for pose in poses:
            sums += average_blocks(self._sample(region, rays, pose, to_light, samples), samples)
        sums /= len(poses)
        return sums[..., :3], sums[..., 3:]

    def _sample(
        self, region: PixelRegion, rays: Floats, pose: Array, to_light: Array, samples: int
    ) -> Floats:
        shown = np.zeros((*rays.shape[:2], 4), np.float32)
        for name, (right, up) in FACE_AXES.items():
            axes = pose[:3, :3] @ np.array([right, up, np.cross(right, up)], float).T
            centre = pose[:3, 3] + axes[:, 2] * self.cube.edge / 2
            if name in self._fold_poses:
                turn, place = self._fold_poses[name]
                axes = pose[:3, :3] @ turn @ np.array([right, up, np.cross(right, up)], float).T
                centre = pose[:3, 3] + pose[:3, :3] @ place
            if axes[:, 2] @ centre >= 0:
                continue  # it faces away
            box = self._box(region, axes, centre, samples)
            texture = self._texture(name, centre, samples)
            self._face(shown[box], rays[box], axes, centre, texture, to_light)
        return shown

    def _box(
        self, region: PixelRegion, axes: Array, centre: Array, samples: int
    ) -> tuple[slice, slice]:
        """Return rows and columns of the samples of a region in which a face can be seen."""
        corners = centre + self.cube.edge / 2 * (_FACE_CORNERS @ axes[:, :2].T)
        if corners[:, 2].min() < MIN_DEPTH:
            return np.s_[:, :]
        pixels = self.camera.pixels(corners)
        margin = 2.0 + BEND_SHARE * float(np.ptp(pixels, axis=0).max())
        around = self.camera.region_around(pixels, margin)
        top, left = max(around.y - region.y, 0), max(around.x - region.x, 0)
        bottom, right = max(around.bottom - region.y, 0), max(around.right - region.x, 0)
        return np.s_[samples * top : samples * bottom, samples * left : samples * right]

    def _texture(self, name: str, centre: Array, samples: int) -> Floats:
        """Choose the mipmap level of a face with about one texel per sample.

        A finer level would be undersampled, and its edges would alias.
        """
        focal = self.camera.intrinsics.matrix[0, 0] * samples
        along_edge = focal * self.cube.edge / float(np.linalg.norm(centre))
        level = int(np.clip(np.ceil(np.log2(FACE_TEXELS / along_edge)), 0, MIPMAP_LEVELS - 1))
        return self._textures[name][level]

    def _face(
        self, shown: Floats, rays: Floats, axes: Array, centre: Array, face: Floats, light: Array
    ) -> None:
        """Render one face: texel = homography · ray."""
        plane = np.column_stack([axes[:, 0], -axes[:, 1], centre])
        texels = len(face)
        scale, middle = texels / self.cube.edge, texels / 2 - 0.5
        to_texel = np.array([[scale, 0, middle], [0, scale, middle], [0, 0, 1]])
        matrix = (to_texel @ np.linalg.inv(plane)).astype(np.float32)
        # A row for each coordinate: loops over three values at a time take four times as long.
        flat = matrix[:, :2] @ rays.reshape(-1, 2).T
        flat += matrix[:, 2:]
        with np.errstate(divide="ignore", invalid="ignore"):  # rays parallel to the face
            flat[:2] /= flat[2]
        x, y = flat[:2].reshape(2, *rays.shape[:2])
        end = texels - 0.5
        inside = (x >= -0.5) & (x < end) & (y >= -0.5) & (y < end)
        rows = np.flatnonzero(inside.any(axis=1))
        if not len(rows):
            return
        columns = np.flatnonzero(inside.any(axis=0))
        box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
        seen = cv2.remap(face, x[box], y[box], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        normal = axes[:, 2]
        brightness = AMBIENT_SHARE + (1 - AMBIENT_SHARE) * max(0.0, float(normal @ light))
        seen *= np.array([brightness] * 3 + [1.0], np.float32)
        mask = inside[box]
        cv2.copyTo(seen, mask.view(np.uint8), shown[box])


def face_textures(cube: CubeModel, seed: int) -> dict[str, list[Floats]]:
    """Draw the prints of all faces, each in several resolutions; `seed` is that of the grain."""
    random = np.random.default_rng(seed)
    by_name = {face.name: face for face in cube.faces}
    return {name: _mipmaps(_face_texture(cube, by_name.get(name), random)) for name in FACE_AXES}


def _face_texture(cube: CubeModel, face: Face | None, random: np.random.Generator) -> Floats:
    """Draw the print of a face, (FACE_TEXELS, FACE_TEXELS, 4) BGRA; None is blank paper."""
    grain = random.standard_normal((FACE_TEXELS // 8, FACE_TEXELS // 8)).astype(np.float32)
    paper = (
        cv2.resize(grain, (FACE_TEXELS, FACE_TEXELS), interpolation=cv2.INTER_CUBIC) * 1.2 + WHITE
    )
    tint = np.array([0.985, 0.995, 1.0], np.float32)
    texture = np.asarray(np.asarray(paper)[..., None] * tint, np.float32)
    if face is not None:
        _print_marker(texture, cube, face)
        _print_icons(texture, cube, face)
    # Folded edges look darker: a thin rim.
    rim = max(1, FACE_TEXELS // 160)
    for side in (np.s_[:rim], np.s_[-rim:], np.s_[:, :rim], np.s_[:, -rim:]):
        texture[side] *= 0.90
    opaque = np.ones((FACE_TEXELS, FACE_TEXELS, 1), np.float32)
    return np.concatenate([texture, opaque], axis=2)


def _mipmaps(texture: Floats) -> list[Floats]:
    levels = [texture]
    for level in range(1, MIPMAP_LEVELS):
        size = (FACE_TEXELS >> level, FACE_TEXELS >> level)
        levels.append(cv2.resize(texture, size, interpolation=cv2.INTER_AREA).astype(np.float32))
    return levels


def _print_marker(texture: Floats, cube: CubeModel, face: Face) -> None:
    cells = np.rot90(marker_cells(cube.dictionary, face.marker_id), -(face.roll_deg // 90))
    texture[black_texels(cube, cells, FACE_TEXELS, cube.paper)] = BLACK


def _print_icons(texture: Floats, cube: CubeModel, face: Face) -> None:
    """Print the icon on all four sides, as on the sheet."""
    margin = (cube.edge - cube.marker_size) / 2 / cube.edge * FACE_TEXELS
    size = round(ICON_SHARE * margin)
    if face.icon not in icons() or size < 8:
        return
    ink = np.array(ICON_COLOURS.get(face.icon, (60, 60, 60))[::-1], np.float32)
    mask = icon_mask(face.icon, size).astype(np.float32)[..., None] / 255
    top, left = FACE_TEXELS - round(FOLD_GAP_SHARE * margin) - size, (FACE_TEXELS - size) // 2
    for quarter_turns in range(4):
        part = np.rot90(texture, quarter_turns)[top : top + size, left : left + size]
        part += (ink - part) * mask
