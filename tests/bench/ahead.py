"""What it would bring to look ahead by the latency: `python -m tests.bench.ahead`.

In the picture, cube, hand and character are equally late, so the character stands right. Only what
it does about the cube could be computed for the moment at which the picture is shown. Here the
scenario `follow` gets the cube's position as predicted for that moment, by the tracker's own
prediction, while a hand leads the character about: that of the bundled recording, and hands that
reach, undershoot, correct themselves and tremble. Its gaze gets the predicted cube, too.
"""

from collections.abc import Iterator
from dataclasses import astuple, dataclass, replace

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import cubeling.app.scenarios as _scenarios  # registers them
from cubeling.app.commands.play.complete import complete_session
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.pipeline.table.obstacles import Obstacles, view_of
from cubeling.app.pipeline.table.situation import SeenCube
from cubeling.app.session import messages
from cubeling.app.session.bundled import bundled_session
from cubeling.app.session.encoding import MESSAGE_TYPES, decode
from cubeling.tracking import CubeState, Intrinsics
from cubeling.tracking.geometry import se3
from cubeling.tracking.synthetic import open_synthetic
from cubeling.tracking.synthetic.choreography import minimum_jerk
from cubeling.tracking.tracker.prediction import Track, TrackedPose

Array = NDArray[np.float64]

del _scenarios

AHEAD_S = (0.0, 0.05, 0.1, 0.15)
"""How far ahead [s]: the latencies of good, usual and slow cameras and computers."""

RATE_HZ = 30.0
MOVING_M_S = 0.1
"""From this speed on the gaze is compared."""

RESTING_M_S = 0.01
"""A cube that is slower rests."""

NOISE = np.repeat((5e-5, 3e-4), 3)
"""Standard deviation of the tracker's poses [m, rad]."""

TREMOR_M, TREMOR_HZ = 2e-4, np.array([6.3, 8.1, 9.7])
"""Amplitude and frequencies of the tremor of a hand that holds a cube."""


def recorded() -> list[CubeState]:
    """Return the states of the bundled recording."""
    topic = "/cube/state"
    with complete_session(bundled_session("follow")) as session:
        return [decode(MESSAGE_TYPES[topic], data) for _, _, data in messages(session, topic)]


def hand(seed: int, turn: float, seconds: float = 40.0) -> list[CubeState]:
    """Return the states of a cube in a hand that reaches to random points with it.

    `turn` is the angle of the cube to the camera, which sets the Speed [rad].
    """
    random = np.random.default_rng(seed)
    times = np.arange(round(seconds * RATE_HZ)) / RATE_HZ
    phases = random.uniform(0, 2 * np.pi, (2, 3))
    tremor = [np.sin(2 * np.pi * TREMOR_HZ * times[:, None] + each).sum(axis=1) for each in phases]
    places = TREMOR_M * np.stack(tremor, axis=1) * (times > 2.5)[:, None]
    now, place = 3.0, np.zeros(2)
    while now < seconds:
        goal = random.uniform((-0.25, -0.15), (0.25, 0.18))
        taken = float(np.linalg.norm(goal - place)) / random.uniform(0.15, 0.6) + 0.15
        reached = place + (goal - place) * random.uniform(0.85, 1.08)
        for start, length, way in (
            (now, taken, reached - place),
            (now + 0.9 * taken, 0.25, goal - reached),
        ):
            places += np.array([minimum_jerk((t - start) / length) for t in times])[:, None] * way
        now, place = now + taken + 0.25 + random.uniform(0.0, 1.5), goal
    source = open_synthetic("follow")
    states, track = [], Track()
    for now, (x, z) in zip(times.tolist(), places, strict=True):
        angle = -turn * min(max(now - 1.5, 0.0), 1.0)
        table = se3.pose(se3.rotation(np.array([0.0, angle, 0.0])), np.array([x, 0.03, z]))
        pose = se3.apply_delta(source.camera_from_table @ table, random.normal(0.0, NOISE))
        covariance = np.diag(NOISE**2)
        velocity, acceleration = track.motion(pose, covariance, now)
        track = track.add(TrackedPose(pose, velocity, covariance, now, acceleration))
        states.append(CubeState(True, pose, velocity, covariance, "image", ("top",), 0.1, now))
    return states


@dataclass(frozen=True)
class Played:
    """What was measured of one run."""

    lag: float
    """Delay of the character's path behind the cube's, at the best correlation [s]."""

    path: float
    """Length of the character's path [m]."""

    error: float
    """Difference of the predicted from the true position, 95th percentile [m]."""

    tremble: float
    """Distance of the predicted from the present position of a cube that rests, median [m]."""

    gaze: float
    """Angle between the character's gaze and the cube in the picture, median [rad]."""


def play(states: list[CubeState], ahead: float) -> Played:
    """Let the character follow a cube that is predicted so far ahead [s]."""
    frames = list(_frames(states, ahead))
    character, cube, target = (np.array([each[i] for each in frames]) for i in range(3))
    gazes = np.array([each[3] for each in frames])
    steps = round(ahead * RATE_HZ)
    error = np.linalg.norm(target[: len(target) - steps] - cube[steps:], axis=1)
    speed = np.linalg.norm(np.gradient(cube, 1 / RATE_HZ, axis=0), axis=1)
    walked = np.linalg.norm(np.diff(character, axis=0), axis=1)
    seen = gazes[speed > MOVING_M_S]
    return Played(
        _lag(character, cube),
        float(walked.sum()),
        float(np.percentile(error, 95)),
        float(np.median(np.linalg.norm(target - cube, axis=1)[speed < RESTING_M_S])),
        float(np.median(seen)),
    )


def _frames(states: list[CubeState], ahead: float) -> Iterator[tuple[Array, Array, Array, float]]:
    """Yield character, cube and its predicted position on the table [m], and the gaze's error."""
    playground = Playground("follow", Intrinsics.guess((1280, 720)), look="cube")
    skeleton, eye = playground.character.skeleton, playground.character.anatomy.joint("leftEye")
    rest = skeleton.rest.globals(skeleton)[eye, :3, :3]
    track, obstacles = Track(), Obstacles(playground.cube.edge)
    for state in states:
        pose = state.camera_from_cube
        if state.visible and pose is not None:
            velocity, acceleration = track.motion(pose, state.covariance, state.timestamp)
            past = TrackedPose(pose, velocity, state.covariance, state.timestamp, acceleration)
            track = track.add(past)
        controls = playground.players[0].gesture(state)
        expected = track.predict(state.timestamp + ahead)
        if controls.camera_from_table is None or expected is None or pose is None:
            continue
        table = se3.inverse(controls.camera_from_table)
        soon = replace(controls, position=(table @ expected.camera_from_cube)[[0, 2], 3])
        predicted = replace(state, camera_from_cube=expected.camera_from_cube)
        cast, inputs = playground.cast, [Inputs()]
        seen = [SeenCube(predicted, soon)]
        decisions = cast.decide(seen, inputs)
        things, view = obstacles.update(predicted, soon), view_of(soon, playground.sight.lens)
        cast.perform(seen, decisions, inputs, things, view, ReplayInputs())
        posed = cast.lead.posed
        assert posed is not None
        placed = posed.table_from_character @ posed.pose.globals(skeleton)[eye]
        looking = placed[:3, :3] @ rest.T @ (0.0, 0.0, 1.0)
        way = (table @ pose)[:3, 3] - placed[:3, 3]
        cosine = looking @ way / np.linalg.norm(looking) / np.linalg.norm(way)
        assert controls.position is not None
        assert soon.position is not None
        character = posed.table_from_character[[0, 2], 3]
        yield character, controls.position, soon.position, float(np.arccos(np.clip(cosine, -1, 1)))


def _lag(character: Array, cube: Array) -> float:
    """Return the delay at which the paths correlate best [s]."""
    times = np.arange(len(cube)) / RATE_HZ
    best, found = -np.inf, 0.0
    for delay in np.arange(0.0, 2.5, 0.01).tolist():
        later = np.stack([np.interp(times - delay, times, axis) for axis in cube.T], axis=1)
        a, b = (
            each[times > delay] - each[times > delay].mean(axis=0) for each in (character, later)
        )
        correlation = float((a * b).sum() / np.sqrt((a * a).sum() * (b * b).sum()))
        if correlation > best:
            best, found = correlation, delay
    return found


def main() -> None:
    """Print the table: means over the hands."""
    hands = [recorded()]
    hands += [hand(seed, np.deg2rad(angle)) for seed in (0, 1) for angle in (90, 170)]
    table = Table("ahead ms", title=f"follow, mean of {len(hands)} hands")
    columns = (
        "character behind ms",
        "it walks m",
        "position off mm, 95 %",
        "at rest mm",
        "gaze off °",
    )
    for column in columns:
        table.add_column(column, justify="right")
    for ahead in AHEAD_S:
        runs = [astuple(play(states, ahead)) for states in hands]
        lag, path, error, tremble, gaze = np.mean(runs, axis=0).tolist()
        table.add_row(
            f"{1e3 * ahead:.0f}",
            f"{1e3 * lag:.0f}",
            f"{path:.2f}",
            f"{1e3 * error:.0f}",
            f"{1e3 * tremble:.2f}",
            f"{np.rad2deg(gaze):.1f}",
        )
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
