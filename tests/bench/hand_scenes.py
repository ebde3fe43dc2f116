"""Pictures of hands of many skins and gloves at the synthetic cube, with the true mask."""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from cubeling.tracking.appearance.colour_space import LINEAR_FROM_SRGB
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array, Floats, Image
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.choreography import UP, Choreography, SceneState
from cubeling.tracking.synthetic.desk import draw_objects, render_desk
from cubeling.tracking.synthetic.exposure import ExposureRenderer, in_colours, shutter_samples
from cubeling.tracking.synthetic.hand import Capsule, SyntheticHand, draw_hand, hand_region
from cubeling.tracking.synthetic.options import SyntheticOptions
from cubeling.tracking.synthetic.paper_cube import PaperCube
from cubeling.tracking.synthetic.source import EYE_M, LOOK_AT_M, look_at, webcam
from tests.bench.desks import desk_picture

SKINS = {
    "Monk 01": "f6ede4",
    "Monk 02": "f3e7db",
    "Monk 03": "f7ead0",
    "Monk 04": "eadaba",
    "Monk 05": "d7bd96",
    "Monk 06": "a07e56",
    "Monk 07": "825c43",
    "Monk 08": "604134",
    "Monk 09": "3a312a",
    "Monk 10": "292420",
}
"""The Monk Skin Tone Scale (Monk, 2019; skintone.google, CC BY 4.0), red, green, blue."""

GLOVES = {"blue nitrile": "3f6fc4", "black wool": "26262b", "yellow rubber": "e6c229"}
"""Colours of gloves, red, green, blue."""

CAMERA_HZ = 30.0
"""Frames a second of a webcam."""

FOREFINGER = slice(5, 8)
"""Its parts in `Hand.skin`, from the root to the tip."""

LIFTS = ((0.0, 0.4), (0.4, 0.8), (0.8, 1.0))
"""How far start and end of each part rise as the finger is lifted, relative to its tip."""

LIFTED_M = np.array([0.0, 0.035, -0.008])
"""How far the tip rises in the table frame, (3,) [m]."""

TAP_S, TAP_TIMES, TAP_HEIGHTS = 0.8, (0.0, 0.24, 0.36, 0.56, 0.68), (0, 0, 1, 1, 0)
"""Time from tap to tap [s], and how high the finger is in the course of it, 0…1."""

RATE_HZ = 8.0
"""The same of a scene that tests go through quickly: cube and hand move four times as far."""


@dataclass(frozen=True)
class HandView:
    """How a hand comes, and under what light and lens it is seen."""

    skin: str
    """Colour of skin or glove, six hexadecimal digits."""

    azimuth_deg: float = 0.0
    """Where the arm comes from, about the vertical: 0 is the far right, negative nearer."""

    seed: int = 1
    """Seed of desk, sensor noise and the texture of the skin."""

    gradient: float = 0.0
    """How much darker the left of the picture is than the right, 0…1."""

    defocus: float = 0.6
    """Standard deviation of the lens blur [px]."""

    texture: float = 0.04
    """Standard deviation of the skin's brightness."""

    gloss: float = 0.5
    """Strength of specular spots, 0…1."""

    hand: bool = True
    """Whether there is a hand at all."""

    exposure: float = 0.0
    """How much more light the camera lets in as the hand comes, as a share: automatic exposure."""

    warmth: float = 0.0
    """How much redder and less blue its picture becomes then, as a share: automatic white
    balance."""

    desk: str = ""
    """What the cube stands on, see `desk_picture`; "" for the wooden desk."""

    tapping: bool = False
    """Whether the forefinger is lifted from the cube and put down again, all the time."""


class HandScene:
    """A cube that a hand takes, turns and slides."""

    def __init__(self, view: HandView, cube: CubeModel, rate_hz: float = RATE_HZ) -> None:
        self.view, self.cube, self.rate_hz = view, cube, rate_hz
        self.options = SyntheticOptions(seed=view.seed, defocus=view.defocus, hand=view.hand)
        self.intrinsics: Intrinsics = webcam(self.options)
        self.camera_from_table = look_at(EYE_M, LOOK_AT_M)
        self._camera = CameraRays(self.intrinsics, self.camera_from_table)
        self._paper = PaperCube(cube, self._camera, view.seed)
        self._renderer = _HandRenderer(self._camera, self._paper, self.options, view)
        random = np.random.default_rng([view.seed, 3])
        x, z, heading = random.uniform((-0.1, -0.05, -45), (0.1, 0.12, 45))
        c = Choreography(cube.edge, x, z, heading).rest(2.6).hold(0.5).turn(60, 0.9)
        c.carry(0.04, 0.05, 0.06, 1.4).turn(-100, 1.2).slide(x, z, 0.8).hold(0.3)
        self._choreography = c
        self.count = round(c.length * rate_hz)
        """Number of frames."""

    def state(self, index: int) -> SceneState:
        """Cube and hand in the middle of a frame's exposure."""
        return self._choreography.at(index / self.rate_hz)

    def truth(self, index: int) -> Array:
        """`camera_from_cube`, (4, 4)."""
        return np.asarray(self.camera_from_table @ self.state(index).table_from_cube)

    def frame(self, index: int) -> tuple[Frame, Floats]:
        """Return a frame, and what the hand covers of each pixel, (H, W) 0…1."""
        time, half = index / self.rate_hz, self.options.blur / 2
        ends = [self._choreography.at(time + shift) for shift in (-half, half)]
        corners = [self._paper.corners(self._posed(state)) for state in ends]
        shifts = np.linspace(-half, half, shutter_samples(self._camera, corners))
        states = [self._choreography.at(time + float(shift)) for shift in shifts]
        poses = [self._posed(state) for state in states]
        self._renderer.lift = float(np.interp(time % TAP_S, TAP_TIMES, TAP_HEIGHTS))
        image = self._renderer.draw(states, poses, index, False)
        grip, view = self.state(index).grip, self.view
        if view.exposure or view.warmth:
            gains = 1 + grip * (view.exposure + view.warmth * np.array([-1, 0, 1]))
            image = np.asarray(cv2.LUT(image, _brightened(gains)), np.uint8)
        return Frame(image, time, index), self._renderer.covered

    def _posed(self, state: SceneState) -> Array:
        return np.asarray(self.camera_from_table @ state.table_from_cube)


def _brightened(gains: Array) -> Image:
    """Return what each value of blue, green and red becomes, (1, 256, 3)."""
    light = np.minimum(LINEAR_FROM_SRGB[:, None] * gains, 1.0)
    values = np.interp(light, LINEAR_FROM_SRGB, np.arange(256.0))
    return np.asarray(np.rint(values), np.uint8)[None]


class _HandRenderer(ExposureRenderer):
    """Draws hands of another skin, from another side, and keeps what they cover."""

    def __init__(
        self, camera: CameraRays, cube: PaperCube, options: SyntheticOptions, view: HandView
    ) -> None:
        super().__init__(camera, cube, options)
        self._view = view
        if view.desk:
            random = np.random.default_rng([view.seed, 17])
            self._desk = render_desk(camera, desk_picture(view.desk, random))
            draw_objects(self._desk, camera)
        self.covered = np.zeros(camera.size[::-1], np.float32)
        self.lift = 0.0
        random = np.random.default_rng([view.seed, 11])
        width, height = camera.size
        self._mottle = np.ones((height, width), np.float32)
        for cell, share in ((24, 0.6), (6, 0.8)):
            grain = random.standard_normal((height // cell, width // cell)).astype(np.float32)
            large = cv2.resize(grain, (width, height), interpolation=cv2.INTER_CUBIC)
            self._mottle += view.texture * share * np.asarray(large, np.float32)
        spots = random.standard_normal((height // 10, width // 10)).astype(np.float32)
        large = cv2.resize(spots, (width, height), interpolation=cv2.INTER_CUBIC)
        self._spots = np.clip(large - 1.7, 0, 1) * 90.0 * view.gloss
        light = np.linspace(1 - view.gradient, 1, width, dtype=np.float32)
        self._light = np.repeat(light[:, None], 3, axis=1)

    def draw(self, states: list[SceneState], poses: list[Array], index: int, in_air: bool) -> Image:
        self.covered = np.zeros_like(self.covered)
        return super().draw(states, poses, index, in_air)

    def _add_hand(self, image: Floats, hand: SyntheticHand, camera_from_cube: Array) -> None:
        at = self._table_position(camera_from_cube)
        if self._view.tapping:
            hand = lifted(hand, self.lift)
        hand = turned(hand, at, self._view.azimuth_deg)
        red, green, blue = bytes.fromhex(self._view.skin)
        hand = replace(hand, skin_bgr=(float(blue), float(green), float(red)))
        region = hand_region(self._camera, hand)
        if region.empty:
            return
        colour, cover, depth = draw_hand(self._camera, region, hand, self._to_light)
        colour = colour * in_colours(self._mottle[region.index])
        colour += in_colours(self._spots[region.index] * (cover > 0.9))
        behind = depth - self._cube.depth(region, camera_from_cube)
        cover = cover * (1.0 - np.clip(behind / 0.0015, 0.0, 1.0))
        part = image[region.index]
        part += (colour - part) * in_colours(cover)
        self.covered[region.index] = cover

    def _table_position(self, camera_from_cube: Array) -> Array:
        return np.asarray((se3.inverse(self._camera.camera_from_table) @ camera_from_cube)[:3, 3])

    def _sensor_image(self, image: Floats, index: int) -> Image:
        return super()._sensor_image(image * self._light, index)


def lifted(hand: SyntheticHand, share: float) -> SyntheticHand:
    """Return the hand with the forefinger lifted by a share, 0…1."""
    finger = [
        replace(
            part, start=part.start + low * share * LIFTED_M, end=part.end + high * share * LIFTED_M
        )
        for part, (low, high) in zip(hand.skin[FOREFINGER], LIFTS, strict=True)
    ]
    skin = list(hand.skin)
    skin[FOREFINGER] = finger
    return replace(hand, skin=tuple(skin))


def turned(hand: SyntheticHand, centre: Array, degrees: float) -> SyntheticHand:
    """Return the hand turned about the vertical through a point of the table frame."""
    turn = se3.rotation(-np.deg2rad(degrees) * UP)

    def part(capsule: Capsule) -> Capsule:
        start, end = (turn @ (point - centre) + centre for point in (capsule.start, capsule.end))
        return replace(capsule, start=start, end=end)

    return replace(
        hand,
        skin=tuple(part(each) for each in hand.skin),
        sleeve=tuple(part(each) for each in hand.sleeve),
    )
