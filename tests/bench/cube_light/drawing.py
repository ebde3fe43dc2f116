"""Draws rooms with one cube, as a camera sees them."""

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.cube.icons import FOLD_GAP_SHARE, ICON_COLOURS, ICON_SHARE, icon_mask
from cubeling.tracking.cube.marker import marker_cells
from cubeling.tracking.cube.model import FACE_AXES, CubeModel, Face
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.synthetic.camera_rays import CameraRays, average_blocks
from tests.bench.cube_light.rooms import RATE, Room

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]

CAMERA = Intrinsics(
    np.array([[905.0, 0, 645.8], [0, 906.0, 355.9], [0, 0, 1]]),
    np.array([-0.11, 0.055, 0.0006, -0.0004, -0.012]),
    (1280, 720),
)
GLARE_PX = (710.0, 662.0)
"""Where the table of the photographs mirrors a lamp."""

PAPER, INK, TEXELS, SAMPLES = 0.82, 0.035, 384, 3
"""Share of the light that paper and ink reflect; texels along a face; rays along a pixel."""

_LINEAR = (np.arange(4096, dtype=np.float32) + 0.5) / 4096
ENCODED = 255 * np.where(_LINEAR < 0.0031308, 12.92 * _LINEAR, 1.055 * _LINEAR ** (1 / 2.4) - 0.055)
"""Values of an sRGB picture for light from 0 to 1."""

SKIN = np.array([0.45, 0.25, 0.17])
"""Share of red, green and blue light that skin reflects."""


class Drawing:
    """Draws rooms with one cube."""

    def __init__(self, cube: CubeModel) -> None:
        self._cube = cube
        self._rays = CameraRays(CAMERA)
        self._textures = {face.name: _albedo(cube, face) for face in cube.faces}
        y, x = np.indices((CAMERA.size[1], CAMERA.size[0]), np.float32)
        away = ((x / CAMERA.size[0] - 0.5) ** 2 + (y / CAMERA.size[0] - 0.28) ** 2) * 4
        random = np.random.default_rng(0)
        # One tile of noise, cropped at random for each picture.
        size = (CAMERA.size[1] + 128, CAMERA.size[0] + 128, 3)
        self._noise = random.standard_normal(size, np.float32)
        self._vignette = (1 - 0.14 * away)[..., None]

    def picture(self, room: Room, index: int, desk: Floats) -> Picture:
        """Photograph a room, (H, W, 3) BGR."""
        seconds = index / RATE
        image = desk.copy()
        self._add_cube(image, room, room.camera_from_cube(seconds), seconds)
        image *= self._vignette * np.float32(room.exposure(seconds))
        values = ENCODED[np.minimum(image * ENCODED.size, ENCODED.size - 1).astype(np.uint16)]
        top, left = np.random.default_rng([room.seed, index, 2]).integers(0, 128, 2)
        height, width = values.shape[:2]
        values += room.noise * self._noise[top : top + height, left : left + width]
        picture = np.asarray(cv2.convertScaleAbs(values), np.uint8)[..., ::-1]
        if room.jpeg:
            stored = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, room.jpeg])[1]
            picture = np.asarray(cv2.imdecode(stored, cv2.IMREAD_COLOR), np.uint8)
        return np.ascontiguousarray(picture)

    def desk(self, room: Room) -> Floats:
        """Draw a table with things on it, in linear RGB."""
        random = np.random.default_rng([room.seed, 3])
        small = random.uniform(0.12, 0.4, (9, 16, 3)).astype(np.float32)
        albedo = cv2.resize(small, CAMERA.size, interpolation=cv2.INTER_CUBIC)
        for _ in range(14):
            x, y, w, h = (random.uniform(0, 1, 4) * (1280, 720, 240, 160)).astype(int).tolist()
            colour = random.uniform(0.03, 0.7, 3).tolist()
            cv2.rectangle(albedo, (x, y), (x + w, y + h), colour, -1)
        return np.asarray(
            albedo * room.irradiance(np.array([0, 1.0, 0]), np.zeros(3), 0.0), np.float32
        )

    def _add_cube(self, image: Floats, room: Room, pose: Array, seconds: float) -> None:
        signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
        corners = self._cube.edge / 2 * signs @ pose[:3, :3].T + pose[:3, 3]
        region = self._rays.region_around(self._rays.pixels(corners), 3)
        rays = self._rays.rays(region, SAMPLES)
        drawn = np.zeros((*rays.shape[:2], 4), np.float32)
        for number, (name, (right, up)) in enumerate(FACE_AXES.items()):
            axes = pose[:3, :3] @ np.array([right, up, np.cross(right, up)], float).T
            centre = pose[:3, 3] + axes[:, 2] * self._cube.edge / 2
            if axes[:, 2] @ centre >= 0:
                continue
            plane = np.column_stack([axes[:, 0], -axes[:, 1], centre])
            flat = rays @ np.linalg.inv(plane)[:, :2].T + np.linalg.inv(plane)[:, 2]
            places = flat[..., :2] / flat[..., 2:] / self._cube.edge  # −½…½
            inside = (np.abs(places) < 0.5).all(axis=-1) & (flat[..., 2] > 0)
            x, y = ((places + 0.5) * TEXELS - 0.5).astype(np.float32).transpose(2, 0, 1)
            albedo = cv2.remap(
                self._textures[name], x, y, cv2.INTER_LINEAR, None, cv2.BORDER_REPLICATE
            )
            table = se3.inverse(room.camera_from_table)
            where = (
                table[:3, :3] @ axes[:, 2],
                table[:3, :3] @ centre + table[:3, 3],
                seconds,
            )
            light = np.broadcast_to(room.irradiance(*where), albedo.shape)
            if room.hand:
                covered, shaded = _hand_on(places, number, seconds, room.seed)
                light = np.where(shaded[..., None], room.irradiance(*where, True), light)
                albedo = np.where(covered[..., None], SKIN, albedo)
            drawn[inside, :3] = (albedo * light)[inside]
            drawn[inside, 3] = 1
        drawn = average_blocks(drawn, SAMPLES)
        part = image[region.index]
        part *= 1 - drawn[..., 3:]
        part += drawn[..., :3]
        # The lens's blur.
        image[region.index] = cv2.GaussianBlur(part, (0, 0), 0.7)


def _albedo(cube: CubeModel, face: Face) -> Floats:
    """Return the print of a face as shares of reflected RGB, (TEXELS, TEXELS, 3)."""
    margin = (cube.edge - cube.marker_size) / 2 / cube.edge * TEXELS
    texture = np.full((TEXELS, TEXELS, 3), PAPER, np.float32)
    cells = np.rot90(marker_cells(cube.dictionary, face.marker_id), -(face.roll_deg // 90))
    inner = TEXELS - 2 * round(margin)
    ink = cv2.resize(cells.astype(np.uint8), (inner, inner), interpolation=cv2.INTER_NEAREST) > 0
    texture[round(margin) : TEXELS - round(margin), round(margin) : TEXELS - round(margin)][ink] = (
        INK
    )
    if face.icon:
        size = round(ICON_SHARE * margin)
        mask = icon_mask(face.icon, size)[..., None] / 255
        colour = (np.array(ICON_COLOURS[face.icon]) / 255) ** 2.2
        top, left = TEXELS - round(FOLD_GAP_SHARE * margin) - size, (TEXELS - size) // 2
        for turns in range(4):
            part = np.rot90(texture, turns)[top : top + size, left : left + size]
            part += (colour - part) * mask
    return texture


def _hand_on(
    places: Floats, number: int, seconds: float, seed: int
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return where a finger covers a face, and where the hand shades it, for a second or so."""
    random = np.random.default_rng([seed, number, int(seconds / 1.3)])
    angle, cover, shade = random.uniform(-np.pi, np.pi), random.uniform(), random.uniform()
    along = places @ np.array([np.cos(angle), np.sin(angle)], np.float32)
    aside = places @ np.array([-np.sin(angle), np.cos(angle)], np.float32)
    covered = (along > 0.05) & (np.abs(aside) < 0.17) & (cover < 0.6)
    edge = -2.0 if shade < 0.12 else 0.1 if shade < 0.6 else 2.0
    return covered, (along + 0.3 * aside > edge) & ~covered
