"""Light measured on the paper of a cube, in drawn rooms: `python -m tests.bench.cube_light`.

Each room has a light from a random direction of the upper hemisphere, and light from all around it,
of random colours and strengths. It is drawn in linear light and photographed with vignetting,
noise and sRGB values. The cube is turned in the air for some seconds as by a hand, or rests on the
table. Every second room is measured at the tracker's poses, the others at the true ones.

The ambient ratio is ambient / (ambient + key) of the sum of the colours; its error is a share of
the true one. Certainty is what the meter says. Times are those of `LightMeter.update`, also as a
ratio to OpenCV's detection of markers in the whole frame, in the same run.

Then the photographs of a hand-held dodecahedron in `shared/data`, where they are: there the true
light is not known, but one half of them must explain the other.

Exits with 1 if, over all rooms in which the cube is turned, the median of the direction exceeds
10° or that of the ambient ratio 10 %, or the median time 0.2 ms. In most pictures the meter has
nothing to do: see the mean, too.
"""

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from tests.bench.photographs.dodecahedron import (
    FOLDER,
    SIDE,
    body_model,
    camera,
    photograph,
    reference,
)
from tracking.appearance.light import DEFAULT_UP, LightMeter
from tracking.appearance.light_fit import MeasuredLight, fit_patches
from tracking.appearance.patches import PaperSampler
from tracking.cube.icons import FOLD_GAP_SHARE, ICON_COLOURS, ICON_SHARE, icon_mask
from tracking.cube.marker import marker_cells
from tracking.cube.model import FACE_AXES, CubeModel, Face, aruco_dictionary
from tracking.geometry import se3
from tracking.geometry.frame import Frame
from tracking.geometry.intrinsics import Intrinsics
from tracking.geometry.projection import Projection
from tracking.geometry.state import CubeState
from tracking.synthetic.camera_rays import CameraRays, averaged
from tracking.synthetic.source import look_at
from tracking.tracker.tracker import CubeTracker

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]

MAX_DIRECTION_DEG, MAX_RATIO_ERROR, MAX_MS = 10.0, 0.10, 0.2
RATE, MOVED_S = 30.0, 1.5
"""Frames per second, and when the light moves in some rooms [s]."""

MIDDLE = np.array([0.0, 0.1, 0.0])
"""Middle of the cube's ways, in the table frame [m]."""

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


@dataclass(frozen=True)
class Room:
    """A light, a camera, and what a hand does."""

    seed: int
    """Seed of everything random."""

    to_light: Array
    """Towards the key light, in the table frame, (3,)."""

    key: Array
    """Irradiance of a surface that faces it, linear RGB, (3,)."""

    ambient: Array
    """Irradiance from all around, linear RGB, (3,)."""

    camera_from_table: Array
    """Where the camera is, (4, 4)."""

    resting: bool = False
    """Whether the cube lies on the table."""

    second: Array = field(default_factory=lambda: np.zeros(3))
    """Towards a second light, as long as its strength beside the key light, (3,)."""

    ground: float = 1.0
    """Ambient light on a surface that faces down, beside one that faces up."""

    lamp_m: float = np.inf
    """Distance of the key light from the middle of the cube's ways [m]."""

    moved: Array | None = None
    """Towards the key light after `MOVED_S`, or None where it stays, (3,)."""

    hand: bool = False
    """Whether a hand covers and shades parts of the faces."""

    exposure: Callable[[float], float] = lambda seconds: 1.0
    """Gain of the camera at a time [s]."""

    noise: float = 1.5
    """Noise at middle grey, one standard deviation [grey levels]."""

    jpeg: int = 0
    """Quality of compression, 0 for none."""

    @property
    def ratio(self) -> float:
        """Ambient light, in the mean of up and down, as a share of all."""
        ambient = self.ambient * (1 + self.ground) / 2
        return float(ambient.sum() / (ambient + self.key).sum())

    def at(self, seconds: float) -> Array:
        """Towards the key light at a time, in the table frame, (3,)."""
        late = self.moved is not None and seconds >= MOVED_S
        return self.moved if self.moved is not None and late else self.to_light

    def irradiance(
        self, normal: Array, place: Array, seconds: float, shaded: bool = False
    ) -> Array:
        """Light on a surface, linear RGB, (3,); `normal` and `place` are in the table frame."""
        around = 1 + (self.ground - 1) * (1 - float(normal[1])) / 2
        light = self.ambient * around + max(0.0, float(normal @ self.second)) * self.key
        if shaded:
            return np.asarray(light)
        to_lamp, nearness = self.at(seconds), 1.0
        if np.isfinite(self.lamp_m):
            way = (MIDDLE + to_lamp * self.lamp_m - place) / self.lamp_m
            nearness = 1 / float(way @ way)
            to_lamp = way * np.sqrt(nearness)
        return np.asarray(light + nearness * max(0.0, float(normal @ to_lamp)) * self.key)

    def camera_from_cube(self, seconds: float) -> Array:
        """Pose of the cube at a time, (4, 4)."""
        random = np.random.default_rng([self.seed, 1])
        phases, yaw = random.uniform(0, 2 * np.pi, 6), random.uniform(0, 2 * np.pi)
        place = np.array([random.uniform(-0.08, 0.08), 0.03, random.uniform(-0.05, 0.08)])
        if self.resting:
            yaw = np.pi / 4 + random.uniform(-0.4, 0.4) + np.pi / 2 * random.integers(4)
            return self.camera_from_table @ se3.pose(se3.rotation(np.array([0, yaw, 0])), place)
        waves = np.sin(2 * np.pi * np.array([0.23, 0.31, 0.27, 0.3, 0.25, 0.2]) * seconds + phases)
        way = random.choice([-1.0, 1.0])
        turn = se3.rotation(np.array([0.45 * waves[0], 0, 0.35 * waves[1]])) @ se3.rotation(
            np.array([0, yaw + way * 1.7 * seconds + 0.5 * waves[2], 0])
        )
        place += (0.03 * waves[3], 0.07 + 0.02 * waves[4], 0.03 * waves[5])
        return self.camera_from_table @ se3.pose(turn, place)


def plain(seed: int) -> Room:
    """White light."""
    random = np.random.default_rng([seed, 0])
    up, around = random.uniform(0.2, 1.0), random.uniform(0, 2 * np.pi)
    flat = np.sqrt(1 - up * up)
    to_light = np.array([flat * np.cos(around), up, flat * np.sin(around)])
    total, share = random.uniform(0.7, 1.1), random.uniform(0.2, 0.8)
    eye = np.array([random.uniform(-0.15, 0.15), random.uniform(0.25, 0.45), 0.5])
    white = np.ones(3)
    camera = look_at(eye, np.array([0.0, 0.05, 0.0]))
    return Room(seed, to_light, total * (1 - share) * white, total * share * white, camera)


def coloured(seed: int) -> Room:
    """A warm lamp and daylight, or the other way round."""
    room = plain(seed)
    colours = np.array([[1.25, 1.0, 0.62], [0.85, 1.0, 1.2]])
    key, ambient = colours[:: (-1) ** seed]
    return replace(room, key=room.key * key, ambient=room.ambient * ambient)


def second_light(seed: int) -> Room:
    """A second light, a quarter as strong, from another side."""
    room = plain(seed)
    other = plain(seed + 1000).to_light
    return replace(room, second=0.25 * other)


def uneven(seed: int) -> Room:
    """A lamp 0.8 m away, and less than half as much ambient light from below as from above."""
    return replace(coloured(seed), ground=0.4, lamp_m=0.8)


def moved(seed: int) -> Room:
    """A lamp that jumps to another direction."""
    return replace(coloured(seed), moved=plain(seed + 2000).to_light)


def hand(seed: int) -> Room:
    """A hand that covers and shades a part of each face, and all of some."""
    return replace(coloured(seed), hand=True)


def automatic(seed: int) -> Room:
    """Exposure that hunts: a third darker and brighter, so that some faces saturate."""
    return replace(coloured(seed), exposure=lambda t: 1.05 + 0.35 * float(np.sin(1.9 * t + seed)))


def poor(seed: int) -> Room:
    """All of it, with strong noise and JPEG of quality 50."""
    room = replace(automatic(seed), hand=True, noise=5.0, jpeg=50)
    return replace(room, second=second_light(seed).second * 0.6)


def resting(seed: int) -> Room:
    """A cube that rests, of which three faces are seen."""
    return replace(coloured(seed), resting=True)


KINDS = (plain, coloured, second_light, uneven, hand, automatic, poor, moved, resting)

OWN_ROWS = (moved, resting)
"""Kinds that the bars do not count."""


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
        drawn = averaged(drawn, SAMPLES)
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


@dataclass(frozen=True)
class Result:
    """How well one room's light was measured."""

    direction_deg: float
    """Angle between the true and the measured direction at the end."""

    ratio: float
    """Error of the ambient ratio, as a share of it."""

    certainty: float
    """What the meter says."""

    first_s: float
    """When the direction was right to 10° for the first time and stayed so for the rest, or inf."""

    seconds: tuple[float, ...]
    """Time of each update."""


def measure(room: Room, cube: CubeModel, drawing: Drawing, frames: int, tracked: bool) -> Result:
    """Show a room to a meter."""
    desk = drawing.desk(room)
    tracker, meter = CubeTracker(cube, CAMERA), LightMeter(cube, CAMERA)
    light: MeasuredLight | None = None
    seconds, errors = [], []
    for index in range(frames):
        picture = drawing.picture(room, index, desk)
        if tracked:
            state = tracker.update(Frame(picture, index / RATE, index))
        else:
            state = _true_state(room, index)
        start = time.perf_counter()
        light = meter.update(picture, state)
        seconds.append(time.perf_counter() - start)
        errors.append(_direction_error(room, light, index / RATE))
    late = np.flatnonzero(np.array(errors) > MAX_DIRECTION_DEG)
    first = 0 if not len(late) else late[-1] + 1
    ratio = 1.0
    if light is not None:
        ratio = float(light.ambient.sum() / (light.ambient + light.key).sum()) / room.ratio - 1
    return Result(
        errors[-1],
        abs(ratio),
        light.certainty if light else 0.0,
        first / RATE if first < frames else np.inf,
        tuple(seconds),
    )


def _true_state(room: Room, index: int) -> CubeState:
    before, pose, after = (room.camera_from_cube((index + n) / RATE) for n in (-0.5, 0, 0.5))
    velocity = se3.delta(before, after) * RATE
    return CubeState(True, pose, velocity, np.zeros((6, 6)), "markers", (), 0.0, index / RATE)


def _direction_error(room: Room, light: MeasuredLight | None, seconds: float) -> float:
    if light is None:
        return 90.0
    return _between_deg(light.to_light, room.camera_from_table[:3, :3] @ room.at(seconds))


@dataclass(frozen=True)
class RealLight:
    """The light in the photographs of the dodecahedron, whose camera stands still."""

    patches: int
    """Faces measured in all pictures."""

    halves_deg: float
    """Angle between the directions that the first and the second half of the pictures give."""

    glare_deg: float
    """Angle to the direction that the glare on the table tells, one lamp of perhaps several."""

    unexplained: float
    """Median difference of a patch from the model of the other half, as a share of the mean."""

    by_constant: float
    """The same from the mean of the other half."""

    certainty: float
    """By all pictures."""


def real_light() -> RealLight:
    """Measure the light in photographs that we did not make."""
    body, body_from_cube = body_model()
    # The faces are pentagons: only a little of the margin is sure to be paper.
    cube = replace(body, edge=1.2 * SIDE)
    sampler = PaperSampler(cube, camera())
    found = [
        sampler.measure(photograph(number), pose @ body_from_cube)
        for number, pose in reference().camera_from_body.items()
    ]
    halves = [found[: len(found) // 2], found[len(found) // 2 :]]
    normals, values = (
        [np.concatenate([getattr(p, name) for p in half]) for half in halves]
        for name in ("normals", "irradiance")
    )
    lights = [
        fit_patches(n, v, np.ones(len(n)), DEFAULT_UP) for n, v in zip(normals, values, strict=True)
    ]
    whole = fit_patches(
        np.concatenate(normals), np.concatenate(values), np.ones(sum(map(len, values))), DEFAULT_UP
    )
    errors, constants = [], []
    for one, other in ((0, 1), (1, 0)):
        light = lights[one]
        model = light.ambient + np.maximum(normals[other] @ light.to_light, 0)[:, None] * light.key
        errors.append(np.abs((values[other] - model).mean(axis=1)))
        constants.append(np.abs((values[other] - values[one].mean(axis=0)).mean(axis=1)))
    mean = float(np.concatenate(values).mean())
    return RealLight(
        len(np.concatenate(normals)),
        _between_deg(lights[0].to_light, lights[1].to_light),
        _between_deg(whole.to_light, glare()),
        float(np.median(np.concatenate(errors))) / mean,
        float(np.median(np.concatenate(constants))) / mean,
        whole.certainty,
    )


def glare() -> Array:
    """Direction to the lamp that the table of the photographs mirrors, by hand-picked pixels, (3,).

    The table's normal follows from the vanishing points of the sheet of paper on it.
    """
    corners = np.array([(549, 314), (772, 314), (811, 456), (544, 456)], float)
    a, b, c, d = np.c_[Projection(camera()).rays(corners), np.ones(4)]
    along = np.cross(np.cross(a, b), np.cross(d, c)), np.cross(np.cross(a, d), np.cross(b, c))
    up = np.cross(*along)
    up *= -np.sign(up[1]) / np.linalg.norm(up)
    sight = np.append(Projection(camera()).rays(np.array([GLARE_PX], float))[0], 1.0)
    sight /= np.linalg.norm(sight)
    return np.asarray(sight - 2 * (sight @ up) * up)


def _between_deg(a: Array, b: Array) -> float:
    return float(np.rad2deg(np.arccos(np.clip(a @ b, -1, 1))))


def detection_s(picture: Picture, cube: CubeModel) -> float:
    """Return the median time of OpenCV's detection of markers in a whole frame [s]."""
    detector = cv2.aruco.ArucoDetector(aruco_dictionary(cube.dictionary))
    seconds = []
    for _ in range(15):
        start = time.perf_counter()
        detector.detectMarkers(picture)
        seconds.append(time.perf_counter() - start)
    return float(np.median(seconds))


def _row(title: str, results: list[Result]) -> tuple[str, ...]:
    directions, ratios = ([getattr(r, n) for r in results] for n in ("direction_deg", "ratio"))
    firsts = np.sort([r.first_s for r in results])
    return (
        title,
        str(len(results)),
        f"{np.median(directions):.1f}",
        f"{np.quantile(directions, 0.9):.1f}",
        f"{100 * np.median(ratios):.1f}",
        f"{100 * np.quantile(ratios, 0.9):.1f}",
        f"{np.median([r.certainty for r in results]):.2f}",
        f"{firsts[len(firsts) // 2]:.1f}",
    )


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rooms", type=int, default=8, help="of each kind")
    parser.add_argument("--seconds", type=float, default=4.0, help="of each room")
    parser.add_argument("--kinds", nargs="*", default=[kind.__name__ for kind in KINDS])
    parser.add_argument("--picture", help="write a sheet with a picture of each kind, as PNG")
    arguments = parser.parse_args()
    cube = CubeModel.load("locomotion")
    drawing = Drawing(cube)
    kinds = [kind for kind in KINDS if kind.__name__ in arguments.kinds]
    if arguments.picture:
        shown = [kind(4) for kind in kinds]
        sheet = [cv2.resize(drawing.picture(r, 40, drawing.desk(r)), (640, 360)) for r in shown]
        cv2.imwrite(arguments.picture, np.concatenate(sheet))
    table = Table(title="Light on a cube's paper against the truth")
    columns = ("room", "rooms", "°", "° 90 %", "ratio %", "90 %", "certainty", "right after s")
    for column in columns:
        table.add_column(column, justify="left" if column == "room" else "right")
    turned: list[Result] = []
    seconds: list[float] = []
    frames = round(arguments.seconds * RATE)
    for kind in kinds:
        results = [
            measure(kind(seed), cube, drawing, frames, tracked=seed % 2 == 0)
            for seed in range(1, arguments.rooms + 1)
        ]
        seconds += [s for result in results for s in result.seconds]
        table.add_row(*_row(kind.__name__.replace("_", " "), results))
        if kind not in OWN_ROWS:
            turned += results
    if turned:
        table.add_section()
        table.add_row(*_row("all that are turned", turned), style="bold")
    room = plain(1)
    detection = detection_s(drawing.picture(room, 0, drawing.desk(room)), cube)
    median, mean = 1000 * np.median(seconds), 1000 * np.mean(seconds)
    console = Console(width=110)
    console.print(table)
    console.print(
        f"update: median {median:.3f} ms, mean {mean:.3f} ms, 95 % "
        f"{1000 * np.quantile(seconds, 0.95):.3f} ms; detection in the whole frame "
        f"{1000 * detection:.1f} ms: ratio {median / 1000 / detection:.3f}, "
        f"of the mean {mean / 1000 / detection:.3f}"
    )
    if FOLDER.is_dir():
        real = real_light()
        console.print(
            f"photographs of a dodecahedron (not ours, no true light): {real.patches} patches, "
            f"certainty {real.certainty:.2f}; halves of the pictures agree to "
            f"{real.halves_deg:.1f}°; {real.glare_deg:.1f}° from the lamp mirrored by the table; "
            f"patches are {100 * real.unexplained:.1f} % off the model of the other half, "
            f"{100 * real.by_constant:.1f} % off its mean"
        )
    good = median <= MAX_MS
    if turned:
        good &= np.median([r.direction_deg for r in turned]) <= MAX_DIRECTION_DEG
        good &= np.median([r.ratio for r in turned]) <= MAX_RATIO_ERROR
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
