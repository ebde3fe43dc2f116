"""Rendering of one exposure: cube, hand and shadows over the desk, with camera and sensor."""

import cv2
import numpy as np

from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.synthetic.camera_rays import CameraRays, PixelRegion
from cubeling.tracking.synthetic.choreography import SceneState
from cubeling.tracking.synthetic.desk import desk_texture, draw_objects, render_desk
from cubeling.tracking.synthetic.hand import SyntheticHand, draw_hand, hand_at, hand_region
from cubeling.tracking.synthetic.options import SyntheticOptions
from cubeling.tracking.synthetic.paper_cube import TO_LIGHT, PaperCube
from cubeling.tracking.synthetic.shadow import cast_shadow

MAX_STEP_PX = 0.6
"""Maximum motion of a corner between two samples of one exposure."""

MAX_SHUTTER_SAMPLES = 24
"""Maximum number of samples in time of one exposure."""

STRIP_ROWS = 40
"""Rows of an image that are sensed together: they fit into the processor's cache."""


class ExposureRenderer:
    """Renders the images of one static camera."""

    def __init__(self, camera: CameraRays, cube: PaperCube, options: SyntheticOptions) -> None:
        self._camera = camera
        self._cube = cube
        self._options = options
        self._to_light = camera.camera_from_table[:3, :3] @ (TO_LIGHT / np.linalg.norm(TO_LIGHT))
        self._desk, self._vignette, self._noise = still_parts(camera, options.seed, options.clutter)

    def draw(self, states: list[SceneState], poses: list[Array], index: int, in_air: bool) -> Image:
        """Return the image of one exposure, (H, W, 3) uint8 BGR.

        `states` and `poses` (`camera_from_cube`) are those at times evenly spread over the
        exposure; the middle one is the ground truth of frame `index`, which seeds the noise. A
        cube in the air has no hand and no shadow on the desk.
        """
        image = self._desk.copy()
        options = self._options
        middle = states[len(states) // 2]
        hand = None
        if options.hand and not in_air and middle.grip > 0.01:
            hand = hand_at(middle.table_from_cube[:3, 3], self._cube.cube.edge, middle.grip)
        if options.shadow and not in_air:
            self._passing_shadow(image, index / options.rate)
            if hand is not None:
                self._hand_shadow(image, hand)
            cast_shadow(image, self._camera, self._cube.corners(middle.table_from_cube))
        self._add_cube(image, poses)
        if hand is not None:
            self._add_hand(image, hand, poses[len(poses) // 2])
        image *= self._vignette
        return self._sensor_image(image, index)

    def _add_cube(self, image: Floats, poses: list[Array]) -> None:
        regions = [self._cube.region(pose) for pose in (poses[0], poses[-1])]
        if any(region.empty for region in regions):
            return
        region = _union(regions)
        samples = 4 if len(poses) == 1 else 3 if len(poses) < 6 else 2  # blur hides coarse sampling
        colour, cover = self._cube.draw(region, poses, self._to_light, samples)
        part = image[region.index]
        part *= 1.0 - cover
        part += colour

    def _add_hand(self, image: Floats, hand: SyntheticHand, camera_from_cube: Array) -> None:
        region = hand_region(self._camera, hand)
        if region.empty:
            return
        colour, cover, depth = draw_hand(self._camera, region, hand, self._to_light)
        # The cube hides fingertips behind it.
        behind = depth - self._cube.depth(region, camera_from_cube)
        cover *= 1.0 - np.clip(behind / 0.0015, 0.0, 1.0)
        part = image[region.index]
        part += (colour - part) * in_colours(cover)

    def _hand_shadow(self, image: Floats, hand: SyntheticHand) -> None:
        """Cast the hand's shadow on the desk: wide strokes at low resolution, blurred."""
        coarse = 4
        width, height = (side // coarse for side in self._camera.size)
        dark = np.zeros((height, width), np.float32)
        away = TO_LIGHT / TO_LIGHT[1]
        focal = self._camera.intrinsics.matrix[0, 0]
        for capsule in hand.skin + hand.sleeve[:1]:
            ends = np.linspace(capsule.start, capsule.end, 2)
            foot = ends - away * ends[:, 1:2]
            in_camera = self._camera.from_table(foot)
            if (in_camera[:, 2] < 0.05).any():
                continue
            span = 2 * capsule.radii[0] * focal / in_camera[0, 2] / coarse
            pixels = self._camera.pixels(in_camera) / coarse
            start, end = np.rint(pixels * 16).astype(int).tolist()
            cv2.line(dark, start, end, 1.0, max(1, round(float(span))), cv2.LINE_8, 4)
        height_of_tip = float(hand.skin[0].start[1])
        soft = cv2.GaussianBlur(dark, (0, 0), 2.0 + 45.0 * max(0.0, height_of_tip))
        shade = cv2.resize(1.0 - 0.34 * soft, self._camera.size)
        image *= in_colours(np.asarray(shade, np.float32))

    def _passing_shadow(self, image: Floats, time: float) -> None:
        """Move a wide soft shadow, as of a person, along the near edge."""
        width, height = self._camera.size
        small = np.indices((height // 16 + 1, width // 16 + 1), np.float32) * 16
        x = width * (0.22 + 0.10 * np.sin(0.45 * time + self._options.seed))
        away = ((small[1] - x) / (0.34 * width)) ** 2 + ((small[0] - 1.1 * height) / height) ** 2
        shade = 1.0 - 0.22 * np.exp(-2.2 * away) * (0.75 + 0.25 * np.sin(0.6 * time))
        image *= in_colours(cv2.resize(shade.astype(np.float32), (width, height)))

    def _sensor_image(self, image: Floats, index: int) -> Image:
        options = self._options
        if options.defocus > 0:
            image = np.asarray(cv2.GaussianBlur(image, (0, 0), options.defocus), np.float32)
        random = np.random.default_rng([options.seed, index, 7])
        top, left = random.integers(0, 128, 2)
        width, height = self._camera.size
        tile = self._noise[top : top + height, left : left + width]
        sensed = np.empty(image.shape, np.uint8)
        for row in range(0, height, STRIP_ROWS):
            strip = np.s_[row : row + STRIP_ROWS]
            light = image[strip]
            if options.noise > 0:
                light = light + options.noise * _noise(light, tile[strip])
            sensed[strip] = np.clip(np.rint(light), 0, 255)
        return sensed


def still_parts(camera: CameraRays, seed: int, clutter: bool) -> tuple[Floats, Floats, Floats]:
    """Draw what is the same in all images: desk, vignette, both (H, W, 3), and a tile of noise.

    The tile is cropped at random for each frame: that costs a tenth of fresh noise.
    """
    random = np.random.default_rng(seed)
    desk = render_desk(camera, desk_texture(random, clutter))
    if clutter:
        draw_objects(desk, camera)
    size = (camera.size[1] + 128, camera.size[0] + 128, 3)
    return desk, _vignette(camera), random.standard_normal(size, dtype=np.float32)


def shutter_samples(camera: CameraRays, corners: list[Array]) -> int:
    """Return how many samples an exposure needs for smooth motion blur; an odd number."""
    first, last = (camera.pixels(points) for points in (corners[0], corners[-1]))
    moved = float(np.linalg.norm(last - first, axis=1).max())
    return int(np.clip(np.ceil(moved / MAX_STEP_PX), 1, MAX_SHUTTER_SAMPLES)) | 1


def _union(regions: list[PixelRegion]) -> PixelRegion:
    x, y = min(r.x for r in regions), min(r.y for r in regions)
    right, bottom = max(r.right for r in regions), max(r.bottom for r in regions)
    return PixelRegion(x, y, right - x, bottom - y)


def _noise(image: Floats, normal: Floats) -> Floats:
    """Return the noise in a part of an image from normal noise, (h, w, 3) each.

    Shot noise grows with the square root of the light; the rest is read noise.
    """
    noise = np.maximum(image, 0.0)
    noise *= 0.75 / 128.0
    noise += 0.25
    np.sqrt(noise, out=noise)
    noise *= normal
    return noise


def _vignette(camera: CameraRays) -> Floats:
    width, height = camera.size
    x = np.linspace(-1, 1, width, dtype=np.float32)
    y = np.linspace(-height / width, height / width, height, dtype=np.float32)
    return in_colours(1.0 - 0.14 * (x[None, :] ** 2 + y[:, None] ** 2))


def in_colours(shade: Array | Floats) -> Floats:
    """Return a factor for each channel of an image, (h, w, 3): numpy is slow at repeating one."""
    return np.asarray(cv2.merge([shade] * 3), np.float32)
