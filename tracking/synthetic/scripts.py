"""The motions shown by the synthetic camera, by name."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cubeling.tracking.cube.model import FACE_AXES
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.synthetic.choreography import Choreography, SceneState, minimum_jerk
from cubeling.tracking.synthetic.options import SyntheticOptions

TOP, BOTTOM = (0, 1, 0), (0, -1, 0)
FRONT, BACK = (0, 0, 1), (0, 0, -1)
RIGHT, LEFT = (1, 0, 0), (-1, 0, 0)


@dataclass(frozen=True)
class Script:
    """A cube and its motion."""

    cube: str
    """Name of the bundled cube."""

    length: float
    """Duration [s]."""

    at: Callable[[float], SceneState]
    """Cube and hand at a time [s]."""

    in_air: bool = False
    """Whether the cube is in the air, without a hand; its poses are then in the camera frame."""

    unrelated: bool = False
    """Whether every frame shows an unrelated pose, so that there is no motion between them."""


def follow(edge: float, options: SyntheticOptions) -> Script:
    """Turn to walk, lead the character round, turn to run, lead it round, and rest."""
    c = Choreography(edge)
    c.rest(2.2).turn(90, 1.6).hold(0.3).slide(0.21, 0.09, 2.3, -0.02).hold(0.8)
    c.slide(-0.02, 0.18, 2.2, -0.03).hold(0.7).turn(85, 1.2).slide(-0.24, 0.08, 1.3, -0.04)
    c.hold(0.5).slide(-0.17, -0.14, 1.3, -0.05).hold(0.3).slide(0.20, -0.13, 1.5, -0.04).hold(0.7)
    c.turn(85, 1.3).slide(0.03, 0.05, 2.2, 0.03).hold(0.6).turn(100, 1.5).rest(2.6)
    return _script("locomotion", c)


def sketch(edge: float, options: SyntheticOptions) -> Script:
    """Mark eight points round the desk, put the cube aside, and turn it through all gaits."""
    c = Choreography(edge, -0.20, 0.02).rest(1.4)
    ring = np.deg2rad(np.arange(45, 360, 45))
    for angle in ring:
        c.slide(-0.20 * np.cos(angle), 0.02 - 0.15 * np.sin(angle), 0.95, 0.012).hold(0.6)
    c.carry(0.30, 0.10, 0.09, 2.0).rest(1.0)
    for pause in (4.5, 4.0, 2.5, 2.0):
        c.turn(90, 1.3).rest(pause)
    return _script("locomotion", c)


def companion(edge: float, options: SyntheticOptions) -> Script:
    """Kiss until the robot is happy, shout until it is angry, kiss again, and rest."""
    c = Choreography(edge, 0.06, 0.02).rest(2.4)
    c.tip(FRONT).rest(2.0).turn(180, 1.5).turn(180, 1.5).rest(4.2)
    c.tip(RIGHT).rest(1.6).turn(180, 1.5).turn(180, 1.5).rest(9.6)
    c.tip(FRONT).rest(0.8).turn(180, 1.3).turn(180, 1.3).rest(4.4)
    return _script("companion", c.tip(TOP).rest(2.6))


def reach(edge: float, options: SyntheticOptions) -> Script:
    """Rest until the character has come and fetched things, slide away, rise high, and rest."""
    c = Choreography(edge, 0.03, 0.03).rest(14.4)
    c.hold(0.3).slide(0.11, -0.03, 1.3, 0.02).hold(0.3).rest(4.6)
    return _script("locomotion", c.carry(-0.04, 0.02, 0.19, 8.4).rest(6.4))


def talk(edge: float, options: SyntheticOptions) -> Script:
    """Rest beside the character for a quarter of an hour."""
    return _script("companion", Choreography(edge, 0.06, 0.02).rest(900.0))


def static(edge: float, options: SyntheticOptions) -> Script:
    """Rest in a random position and heading."""
    random = np.random.default_rng(options.seed)
    x, z, heading = random.uniform(-0.15, 0.15), random.uniform(-0.12, 0.15), random.uniform(0, 360)
    return _script("locomotion", Choreography(edge, x, z, heading).rest(2.0))


def turn(edge: float, options: SyntheticOptions) -> Script:
    """Turn once clockwise, and back."""
    c = Choreography(edge).rest(1.0)
    for degrees, pause in ((90, 0.6), (-90, 1.0)):
        for _ in range(4):
            c.turn(degrees, 1.2)
        c.rest(pause)
    return _script("locomotion", c)


def turns(edge: float, options: SyntheticOptions) -> Script:
    """Tip to a kiss, then turn two up, four down, two up: the whole range of the knob."""
    c = Choreography(edge).rest(1.2).tip(FRONT).rest(0.8)
    for count in (2, -4, 2):
        for _ in range(2 * abs(count)):
            c.turn(180 * np.sign(count), 1.0)
        c.rest(0.5)
    return _script("companion", c)


def tip(edge: float, options: SyntheticOptions) -> Script:
    """Rest on every face in turn."""
    c = Choreography(edge).rest(1.4)
    for face in (FRONT, RIGHT, BACK, BOTTOM, LEFT, TOP):
        c.tip(face).rest(1.2)
    return _script("companion", c)


def shake(edge: float, options: SyntheticOptions) -> Script:
    """Rest, shake in the air, and rest again."""
    return _script("locomotion", Choreography(edge).rest(1.4).shake(1.6).rest(1.2))


def sweep(edge: float, options: SyntheticOptions) -> Script:
    """Slide to and fro with the given peak speed."""
    reach = 0.30
    # The peak speed of a minimum-jerk motion is 15/8 of its mean.
    seconds = 1.875 * reach / options.speed
    c = Choreography(edge, -reach / 2, 0.04).rest(1.0)
    for side in (1, -1, 1, -1):
        c.slide(side * reach / 2, 0.04, seconds).hold(0.2)
    return _script("locomotion", c.rest(0.8))


def fingers(edge: float, options: SyntheticOptions) -> Script:
    """Hold the cube all the time, turning and sliding it a little."""
    c = Choreography(edge).rest(1.0).hold(0.8)
    c.turn(60, 1.2).hold(0.4).slide(0.06, 0.05, 1.0).hold(0.4).turn(-100, 1.4).hold(0.6)
    return _script("locomotion", c)


def poses(edge: float, options: SyntheticOptions) -> Script:
    """Show a random pose in every frame, 0.3 to 0.7 m away: for statistics of tracking errors."""

    def at(time: float) -> SceneState:
        index = round(time * options.rate)
        random = np.random.default_rng([options.seed, index])
        focal = 900.0 * options.width / 1280
        distance = random.uniform(0.3, 0.7)
        room = np.array([options.width, options.height]) / 2 - 0.95 * edge * focal / distance - 8
        x, y = random.uniform(-1, 1, 2) * np.maximum(room, 0) * distance / focal
        axis = random.standard_normal(4)
        axis /= np.linalg.norm(axis)
        angle = 2 * np.arccos(np.clip(axis[0], -1, 1))
        turned = axis[1:] / max(float(np.linalg.norm(axis[1:])), 1e-9) * angle
        return SceneState(se3.pose(se3.rotation(turned), np.array([x, y, distance])), 0.0)

    return Script("locomotion", 10.0, at, in_air=True, unrelated=True)


def wave(edge: float, options: SyntheticOptions) -> Script:
    """Wave the cube in front of the camera for 20 s, with stops, as for a calibration."""
    stops = _stops(edge, options)
    move, stop = 0.49, 0.25

    def at(time: float) -> SceneState:
        number, since = divmod(max(time, 0.0), move + stop)
        first = min(int(number), len(stops) - 1)
        second = min(first + 1, len(stops) - 1)
        pose = stops[first]
        step = se3.delta(pose, stops[second]) * minimum_jerk((since - stop) / move)
        tremble = 2 * np.pi * np.array([7.3, 8.9, 10.7]) * time
        step[:3] += 0.0002 * np.sin(tremble)
        step[3:] += np.deg2rad(0.1) * np.sin(tremble[::-1])
        return SceneState(se3.apply_delta(pose, step), 0.0)

    return Script("locomotion", len(stops) * (move + stop), at, in_air=True)


def _stops(edge: float, options: SyntheticOptions) -> list[Array]:
    """Return the poses of `wave`: all faces, tilts, positions and distances."""
    random = np.random.default_rng([options.seed, 5])
    # To and fro in rows from one end of the image to the other and back, so that moves are short.
    rows = [(x * direction, y) for y, direction in ((-1, 1), (0, -1), (1, 1)) for x in (-1, 0, 1)]
    places = np.array([*rows, *rows[::-1], *rows], float)
    focal = 900.0 * options.width / 1280
    half = np.array([options.width, options.height]) / 2
    stops = []
    for number, place in enumerate(places):
        right, up = (np.array(axis, float) for axis in list(FACE_AXES.values())[number % 6])
        # Facing the camera, the face's right, down and inward are the camera's x, y and z.
        square = np.stack([right, -up, -np.cross(right, up)])
        direction = 2 * np.pi * (number / 4 + random.uniform(-0.1, 0.1))
        axis = np.array([np.cos(direction), np.sin(direction), 0.0])
        tilt = np.deg2rad(random.uniform(18, 42)) * axis
        roll = np.array([0.0, 0.0, random.uniform(-0.6, 0.6)])
        distance = random.uniform(0.22, 0.5)
        room = np.maximum(half - 0.8 * edge * focal / distance, 0) * distance / focal
        turn = se3.rotation(tilt) @ se3.rotation(roll) @ square
        stops.append(se3.pose(turn, np.array([*(place * room), distance])))
    return stops


SCRIPTS: dict[str, Callable[[float, SyntheticOptions], Script]] = {
    script.__name__: script
    for script in (
        follow, sketch, companion, reach, talk,
        static, turn, turns, tip, shake, sweep, fingers, poses, wave,
    )
}  # fmt: skip
"""Every script by its name."""


def _script(cube: str, choreography: Choreography) -> Script:
    return Script(cube, choreography.length, choreography.at)
