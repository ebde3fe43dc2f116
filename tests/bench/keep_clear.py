"""How well characters keep out of the cube, and in sight: `python -m tests.bench.keep_clear`.

It plays the bundled recordings with the poses of the cube that the tracker finds in them, and
random drives with true poses, in all scenarios: with characters that know of the cube, and with
ones that do not. The hand is that of the synthetic camera, whose place is known. Two players drive
side by side, without hands; for them there is no bar.

depth, > 2 mm
    How deep the deepest skinned vertex of the character is in the cube, and the share of frames in
    which that is more than 2 mm. Arms do not count while they reach.
hidden, and by hand
    Share of frames in which the cube hides more than half of the character's surface from the
    camera, and in which cube, hand and sleeve do together.
beside
    Share of frames in which more than half of it is beside the picture.
in hand
    Share of frames in which a vertex is in the hand or the sleeve by more than 2 mm.
step
    Greatest way of its root from one frame to the next.

Exits with 1 if a vertex of a character that knows of the cube is in it by more than 2 mm in any
frame, or if the cube hides it in more than 10 % of the frames of a row.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.commands.play.complete import complete_session
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import ReplayInputs, Step
from cubeling.app.pipeline.table.obstacles import Obstacles
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionFile
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.session.encoding import decode
from cubeling.characters import Character, Obstacle
from cubeling.characters.body.capsules import segment_distances
from cubeling.characters.body.extreme_vertices import SkinnedPoints
from cubeling.characters.skeleton.masks import subtree
from cubeling.tracking import CubeControls, CubeModel, CubeState, Frame, Intrinsics, open_source
from cubeling.tracking.synthetic import SyntheticOptions, open_synthetic
from cubeling.tracking.synthetic.choreography import Choreography, SceneState
from cubeling.tracking.synthetic.hand import hand_at
from cubeling.tracking.synthetic.source import EYE_M, LOOK_AT_M, look_at, webcam

Array = NDArray[np.float64]

RATE, DRIVES, DRIVE_S = 30.0, 100, 12.0
"""Frames a second, and number and length [s] of the random drives."""

PAIRS, PLAYERS_CUBES, PLAYERS_REACH_M = 20, ("companion", "companion-2"), 0.11
"""Number of drives of two players, their cubes, and how far from the middle of its half of the
table each stays [m]."""

MAX_DEPTH_M, MAX_HIDDEN = 0.002, 0.10
"""The bars: how deep a vertex may be in the cube, and how often that may hide the character."""

NEAR_M = 0.12
"""A cube whose centre is further from every joint than this touches no vertex [m]."""

SAMPLES, EVERY = 150, 3
"""Points of the surface by which it is told how much is hidden, and which of the frames are."""

VARIANCE = np.diag([1e-4**2] * 3 + [1e-3**2] * 3)
"""Of a true pose, as the tracker states it for a cube on the table [m², rad²]."""

HEADINGS = ("depth", "> 2 mm", "hidden", "and by hand", "beside", "in hand", "step")

TABLE = look_at(EYE_M, LOOK_AT_M)
"""`camera_from_table` of the synthetic camera."""


class _NoObstacles(Obstacles):
    def update(
        self, state: CubeState, controls: CubeControls, *, from_left: bool = False
    ) -> tuple[Obstacle, ...]:
        return ()


class Unaware(Playground):
    """A playground whose characters are not told of the cube."""

    def play(self, *given: object, **named: object) -> None:
        """Start a scenario without obstacles."""
        super().play(*given, **named)  # type: ignore[arg-type]
        self.players[0].obstacles = _NoObstacles(self.cube.edge)


class Surface:
    """The vertices of a character, skinned."""

    def __init__(self, character: Character) -> None:
        self.character = character
        rows, random = len(character.skeleton), np.random.default_rng(1)
        self._parts = [
            (SkinnedPoints(m.positions, m.joints.astype(np.uint32), m.weights, rows), m)
            for m in character.meshes
        ]
        tops = [arm.joints[1] for arm in character.upper_body.arms.values()]
        arms = [joint for top in tops for joint in subtree(character.skeleton, top)]
        movers = np.concatenate([mesh.movers for mesh in character.meshes])
        self.is_arm = np.isin(movers, arms)
        areas = np.concatenate([_vertex_areas(m.positions, m.triangles) for m in character.meshes])
        self.samples = random.choice(len(areas), SAMPLES, p=areas / areas.sum())

    def points(self, joints: Array) -> Array:
        """Return all vertices, (n, 3), for placements of the joints (joints, 4, 4)."""
        return np.concatenate(
            [
                part.skin((joints @ mesh.inverse_bind)[:, :3].astype(np.float32))
                for part, mesh in self._parts
            ]
        )


def _vertex_areas(positions: NDArray[np.float32], triangles: NDArray[np.uint32]) -> Array:
    """Return the area of the triangles about each vertex, (vertices,)."""
    a, b, c = (positions[triangles[:, each]] for each in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    found = np.zeros(len(positions))
    for each in range(3):
        np.add.at(found, triangles[:, each], areas)
    return found


@dataclass
class Measure:
    """What is seen of characters in sequences of steps."""

    depths: list[float] = field(default_factory=list)
    """Of the deepest vertex in each frame [m]; 0 for none."""

    hidden: list[bool] = field(default_factory=list)
    """Whether the cube mostly hides the character."""

    covered: list[bool] = field(default_factory=list)
    """Whether the cube and the hand do."""

    beside: list[bool] = field(default_factory=list)
    """Whether the character is mostly beside the picture."""

    in_hand: list[bool] = field(default_factory=list)
    """Whether a vertex is in the hand."""

    steps: list[float] = field(default_factory=list)
    """Ways from frame to frame [m]."""

    last: Array | None = None

    def add(
        self, step: Step, surface: Surface, camera: Intrinsics, edge: float, hand: Array
    ) -> None:
        """Measure one step; `hand` is that of `capsules`."""
        here = step.posed.table_from_character[[0, 2], 3]
        if self.last is not None:
            self.steps.append(float(np.linalg.norm(here - self.last)))
        self.last = here
        pose, table = step.state.camera_from_cube, step.controls.camera_from_table
        if pose is None or table is None or not step.posed.visible or step.interior is not None:
            return
        posed = step.posed
        joints = posed.pose.globals(surface.character.skeleton)
        joints = table @ posed.table_from_character @ joints
        near = np.linalg.norm(joints[:, :3, 3] - pose[:3, 3], axis=1).min() < NEAR_M
        looks = len(self.depths) % EVERY == 0
        points = surface.points(joints) if near or looks else np.zeros((0, 3))
        reaches = step.command.behaviour is not None and bool(step.command.behaviour.reaches)
        body = ~surface.is_arm if reaches else np.full(len(surface.is_arm), True)
        self.depths.append(_depth(points[body], pose, edge) if near else 0.0)
        if not looks:
            return
        seen = points[surface.samples]
        by_cube = _behind_cube(seen, pose, edge)
        self.hidden.append(bool(by_cube.mean() > 0.5))
        by_hand = _hidden_by_hand(seen, hand)
        self.covered.append(bool((by_cube | by_hand).mean() > 0.5))
        self.beside.append(bool(_beside(seen, camera).mean() > 0.5))
        inside = _gaps(seen[body[surface.samples]], hand).min(initial=1.0) < -MAX_DEPTH_M
        self.in_hand.append(bool(inside))

    def row(self, name: str, kind: str) -> tuple[str, ...]:
        """Return the row of the table."""
        deep = np.array(self.depths) > MAX_DEPTH_M
        shares = (deep, self.hidden, self.covered, self.beside, self.in_hand)
        return (
            name,
            kind,
            f"{1e3 * max(self.depths):.1f} mm",
            *(f"{np.mean(each):.2%}" for each in shares),
            f"{1e3 * max(self.steps):.1f} mm",
        )

    @property
    def passes(self) -> bool:
        """Whether it is within the bars."""
        return max(self.depths) <= MAX_DEPTH_M and float(np.mean(self.hidden)) <= MAX_HIDDEN


def _depth(points: Array, pose: Array, edge: float) -> float:
    """Return how deep the deepest of points (n, 3) is in a cube at a pose, (4, 4) [m]."""
    inside = np.abs((points - pose[:3, 3]) @ pose[:3, :3]).max(axis=1)
    return max(edge / 2 - float(inside.min()), 0.0)


def _behind_cube(points: Array, pose: Array, edge: float) -> NDArray[np.bool_]:
    """Return which of points (n, 3) a cube at a pose hides from the camera, or encloses."""
    start, way = -pose[:3, 3] @ pose[:3, :3], points @ pose[:3, :3]
    one, other = (-edge / 2 - start) / way, (edge / 2 - start) / way
    first, last = np.minimum(one, other).max(axis=1), np.maximum(one, other).min(axis=1)
    return np.asarray((first < last) & (first < 1.0))


def _beside(points: Array, camera: Intrinsics) -> NDArray[np.bool_]:
    """Return which of points (n, 3) are not in the picture."""
    pixels = (points @ camera.matrix.T)[:, :2] / points[:, 2:]
    return np.asarray(((pixels < 0.0) | (pixels > camera.size)).any(axis=1))


def capsules(state: SceneState, edge: float) -> Array:
    """Return the hand at a time as capsules in the camera frame, (n, 7): two ends and a radius."""
    if state.grip <= 0.0:
        return np.zeros((0, 7))
    hand = hand_at(state.table_from_cube[:3, 3], edge, state.grip)
    rows = [
        np.concatenate([TABLE[:3, :3] @ end + TABLE[:3, 3] for end in (each.start, each.end)])
        for each in hand.skin + hand.sleeve
    ]
    radii = [min(each.radii) for each in hand.skin + hand.sleeve]
    return np.column_stack([np.array(rows), radii])


def _gaps(points: Array, hand: Array) -> Array:
    """Return how far points (n, 3) are from capsules (m, 7), (n, m) [m]; negative inside."""
    start, way = hand[:, :3], hand[:, 3:6] - hand[:, :3]
    offsets = points[:, None] - start
    along = np.clip(np.einsum("nmk,mk->nm", offsets, way) / (way * way).sum(axis=1), 0.0, 1.0)
    nearest = offsets - along[..., None] * way
    return np.asarray(np.sqrt((nearest * nearest).sum(axis=-1)) - hand[:, 6])


def _hidden_by_hand(points: Array, hand: Array) -> NDArray[np.bool_]:
    """Return which of points (n, 3) in the camera frame capsules (m, 7) hide."""
    a, b = np.zeros((len(points), 1, 3)), np.broadcast_to(points[:, None], (len(points), 1, 3))
    apart = segment_distances(a, b, hand[None, :, :3], hand[None, :, 3:6])
    return np.asarray((apart < hand[:, 6]).any(axis=1))


@dataclass(frozen=True)
class Take:
    """One sequence of cube states, to be played."""

    scenario: str

    intrinsics: Intrinsics

    states: Sequence[CubeState]

    scene: Callable[[float], SceneState]
    """The true cube and hand at a time [s]."""


def recorded(path: Path) -> Take:
    """Return what the tracker finds in a session that was made with the synthetic camera."""
    with complete_session(path) as complete, SessionFile(complete) as session:
        states = [decode(CubeState, each) for _, _, each in session.messages("/cube/state")]
        with open_source(str(path)) as source:
            intrinsics = intrinsics_for(source.intrinsics, source.size)
        name = session.info.options.scenario
    script = open_synthetic(name)
    return Take(name, intrinsics, states, lambda time: script.state(round(time * script.rate)))


def drive(
    number: int, scenario: str, edge: float, middle: float = 0.0, reach: float = 0.22
) -> Take:
    """Return a random drive: the cube slides, turns, tips, is carried, held, and rests.

    It is within a `reach` to both sides of the `middle` of its part of the table [m].
    """
    random = np.random.default_rng(number)

    def place() -> tuple[float, float]:
        x, z = random.uniform(middle - reach, middle + reach), random.uniform(-0.16, 0.20)
        return float(x), float(z)

    c = Choreography(edge, *place()).rest(1.5)
    while c.length < DRIVE_S:
        kind = random.choice(["slide", "slide", "slide", "carry", "turn", "tip", "hold", "rest"])
        if kind == "slide":
            bend = float(random.uniform(-0.04, 0.04))
            c.slide(*place(), float(random.uniform(0.8, 2.4)), bend)
        elif kind == "carry":
            c.carry(*place(), float(random.uniform(0.05, 0.22)), float(random.uniform(1.6, 4.0)))
        elif kind == "turn":
            c.turn(float(random.uniform(-180, 180)), float(random.uniform(0.8, 1.8)))
        elif kind == "tip":
            c.tip(((0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0))[int(random.integers(4))])
        else:
            getattr(c, kind)(float(random.uniform(0.4, 2.5)))
    states = []
    before: Array | None = None
    for time in np.arange(0.0, DRIVE_S, 1 / RATE).tolist():
        pose = np.asarray(TABLE @ c.at(time).table_from_cube)
        velocity = np.zeros(6)
        if before is not None:
            velocity[:3] = (pose[:3, 3] - before[:3, 3]) * RATE
        before = pose
        states.append(CubeState(True, pose, velocity, VARIANCE, "markers", (), 0.1, time))
    return Take(scenario, webcam(SyntheticOptions(width=160, height=90)), states, c.at)


def play(take: Take, kind: type[Playground], who: Surface, measure: Measure) -> None:
    """Play a take, and measure the character in it."""
    playground = kind(take.scenario, take.intrinsics, character=who.character)
    measure.last = None
    width, height = take.intrinsics.size
    image = np.zeros((height, width, 3), np.uint8)
    edge = playground.cube.edge
    for index, state in enumerate(take.states):
        frame = Frame(image, state.timestamp, index)
        step = playground.step(frame, replay=ReplayInputs(state=state), drawn=False)
        hand = capsules(take.scene(state.timestamp), edge)
        measure.add(step, who, take.intrinsics, edge, hand)


def play_two(takes: tuple[Take, Take], who: Surface, measures: tuple[Measure, Measure]) -> None:
    """Play the takes of two players side by side, and measure the character of each."""
    cubes = [CubeModel.load(name) for name in PLAYERS_CUBES]
    scenario, camera = takes[0].scenario, takes[0].intrinsics
    playground = Playground(
        scenario, camera, cube=cubes[0], others=[who.character], further_cubes=cubes[1:]
    )
    image = np.zeros((*camera.size[::-1], 3), np.uint8)
    for measure in measures:
        measure.last = None
    topic = f"/cubes/{playground.players[1].name}/state"
    for index, states in enumerate(zip(*(each.states for each in takes), strict=True)):
        replay = ReplayInputs(state=states[0], further={topic: states[1]})
        step = playground.step(Frame(image, states[0].timestamp, index), None, replay, drawn=False)
        other = step.others[0]
        second = replace(step, state=states[1], outcome=other.outcome, posed=other.posed)
        for seen, cube, measure in zip((step, second), cubes, measures, strict=True):
            measure.add(seen, who, camera, cube.edge, np.zeros((0, 7)))


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("sessions", nargs="*", type=Path, help="left out, the bundled recordings")
    parser.add_argument("--drives", type=int, default=DRIVES, help="number of random drives")
    parser.add_argument("--pairs", type=int, default=PAIRS, help="number of drives of two players")
    parser.add_argument("--on", action="store_true", help="only with characters that know of it")
    given = parser.parse_args()
    paths = given.sessions or [bundled_session(name) for name in RECORDED_SCENARIOS]
    rows: list[tuple[str, list[Take]]] = [(path.stem, [recorded(path)]) for path in paths]
    for number, scenario in enumerate(RECORDED_SCENARIOS):
        cube = CubeModel.load(find_scenario(scenario).cube)
        numbers = range(number, given.drives, len(RECORDED_SCENARIOS))
        takes = [drive(each, scenario, cube.edge) for each in numbers]
        rows.append((f"{len(takes)} drives of {scenario}", takes))
    console, failed = Console(highlight=False, soft_wrap=True), False
    console.print(_line("what", "", *HEADINGS))
    surfaces: dict[str, Surface] = {}
    for name, takes in rows:
        for kind in ((Playground,) if given.on else (Unaware, Playground)) if takes else ():
            measure = Measure()
            for take in takes:
                who = find_scenario(take.scenario).character
                if who not in surfaces:
                    surfaces[who] = Surface(Character.load(who))
                play(take, kind, surfaces[who], measure)
            # At once: the whole takes a quarter of an hour.
            console.print(_line(*measure.row(name, "on" if kind is Playground else "off")))
            failed |= kind is Playground and not measure.passes
    body, measures = Surface(Character.load("vleo")), (Measure(), Measure())
    for number in range(given.pairs):
        left, right = (
            drive(2 * number + side, "companion", 0.06, x, PLAYERS_REACH_M)
            for side, x in enumerate((-PLAYERS_REACH_M, PLAYERS_REACH_M))
        )
        play_two((left, right), body, measures)
    for player, measure in zip(("first", "second"), measures if given.pairs else (), strict=False):
        console.print(_line(*measure.row(f"{given.pairs} drives, {player} of 2", "on")))
    return int(failed)


def _line(name: str, kind: str, *values: str) -> str:
    return f"{name:24}{kind:4}" + "".join(f"{each:>13}" for each in values)


if __name__ == "__main__":
    sys.exit(main())
