"""Several characters on the table for minutes: `python -m tests.campaigns.cast [--minutes 10]`.

Five characters (`--cast`) live through random drives of the cube, in all scenarios in turn, on
virtual time and without pictures. It prints, by pair of characters, how deep a vertex of one is in
the other's skin at worst, and in which share of the frames that is more than 2 mm; and for each
character the longest time for which no joint of it moved. Arms count.

A vertex is in a body if the triangles of its skin wind round it; its depth is the way to the
nearest vertex of that skin, so depths of less than half an edge of a triangle are too large.

Exits with 1 if a number is not finite, if a character is frozen for more than 0.5 s, if the state
grows by more than a tenth after the first minute, or if one is in another by more than 2 mm.
`--unaware` plays characters that do not know of one another, to compare with.
"""

import argparse
import itertools
import sys
from collections import defaultdict

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.cast.cast import Cast
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.step import ReplayInputs
from cubeling.app.scenarios import find_scenario
from cubeling.app.session.bundled import RECORDED_SCENARIOS
from cubeling.characters import Character, Obstacle, PosedCharacter
from cubeling.tracking import CubeModel, Frame
from tests.bench.keep_clear import DRIVE_S, Surface, drive

Array = NDArray[np.float64]

CAST = "human,vleo,human,robot"
"""Those beside the scenario's own character."""

MAX_DEPTH_M, MAX_FROZEN_S, MAX_GROWTH = 0.002, 0.5, 1.1

EVERY = 3
"""Which of the frames are looked at for bodies in one another."""

BLOCK = 64
"""Vertices that are compared with all triangles at once."""


class Skin(Surface):
    """The triangles of a character, skinned."""

    def __init__(self, character: Character) -> None:
        super().__init__(character)
        first, triangles = 0, []
        for mesh in character.meshes:
            triangles.append(mesh.triangles.astype(np.intp) + first)
            first += len(mesh.positions)
        self.triangles = np.concatenate(triangles)

    def placed(self, posed: PosedCharacter) -> Array:
        """Return the vertices on the table, (n, 3) [m]."""
        joints = posed.pose.globals(self.character.skeleton)
        return self.points(posed.table_from_character @ joints)


def depth(points: Array, other: Array, triangles: NDArray[np.intp]) -> float:
    """Return how deep the deepest of points (n, 3) is in a skin of vertices (m, 3) [m]."""
    low, high = other.min(axis=0), other.max(axis=0)
    near = points[((points > low) & (points < high)).all(axis=1)]
    inside = near[winding(near, other[triangles]) != 0]
    return max((float(np.linalg.norm(other - each, axis=1).min()) for each in inside), default=0.0)


def winding(points: Array, corners: Array) -> NDArray[np.int_]:
    """Return how often triangles (m, 3, 3) wind round points (n, 3): 0 is outside.

    It is counted along a ray upwards from each point.

    >>> corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> tetrahedron = corner[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    >>> points = np.array([[0.2, 0.1, 0.3], [1.0, 1.0, 1.0], [0.2, -1.0, 0.3]])
    >>> winding(points, tetrahedron).tolist()
    [1, 0, 0]
    """
    found = np.zeros(len(points), int)
    if not len(points):
        return found
    above = corners[(corners[:, :, 1] > points[:, 1].min()).any(axis=1)]
    low, high = above.min(axis=1)[:, [0, 2]], above.max(axis=1)[:, [0, 2]]
    beside = (low < points[:, [0, 2]].max(axis=0)).all(axis=1)
    beside &= (high > points[:, [0, 2]].min(axis=0)).all(axis=1)
    above, low, high = above[beside], low[beside], high[beside]
    for start in range(0, len(points), BLOCK):
        flat = points[start : start + BLOCK, None, [0, 2]]
        row, face = np.nonzero(((low < flat) & (flat < high)).all(axis=2))
        point, (a, b, c) = points[start + row], above[face].transpose(1, 0, 2)
        whole = _area(a, b, c)
        shares = np.stack([_area(point, b, c), _area(a, point, c), _area(a, b, point)], axis=1)
        shares /= np.where(whole == 0.0, np.inf, whole)[:, None]
        height = (shares * np.stack([a[:, 1], b[:, 1], c[:, 1]], axis=1)).sum(axis=1)
        hit = (shares > 0.0).all(axis=1) & (height > point[:, 1])
        np.add.at(found, start + row[hit], np.sign(whole[hit]).astype(int))
    return found


def _area(a: Array, b: Array, c: Array) -> Array:
    """Return twice the areas of triangles as seen from below, (n,): positive if they face up."""
    one, two = b - a, c - a
    return np.asarray(one[:, 2] * two[:, 0] - one[:, 0] * two[:, 2])


class StrangersCast(Cast):
    """A cast whose members are in nobody's way."""

    def _bodies(self, number: int) -> tuple[Obstacle, ...]:
        return ()


class Unaware(Playground):
    """A playground whose characters are not told of one another."""

    def play(self, *given: object, **named: object) -> None:
        """Start a scenario with members that are in nobody's way."""
        super().play(*given, **named)  # type: ignore[arg-type]
        self.cast = StrangersCast(self.cast.members)


class Watch:
    """What is seen of a cast, frame by frame."""

    def __init__(self, names: list[str], characters: list[Character]) -> None:
        skins: dict[str, Skin] = {}
        self._names = names
        self._skins = [skins.setdefault(each.name, Skin(each)) for each in characters]
        self.depths: defaultdict[tuple[str, str], list[float]] = defaultdict(list)
        self.still: dict[str, float] = dict.fromkeys(names, 0.0)
        """The longest time without a movement, by name [s]."""
        self._before: list[Array | None] = [None] * len(names)
        self._since = [0.0] * len(names)

    def forget(self) -> None:
        """Begin with another sequence."""
        self._before = [None] * len(self._names)

    def add(self, poses: list[PosedCharacter], now: float, *, looks: bool) -> None:
        """Watch one frame; with `looks` for bodies in one another too."""
        for number, posed in enumerate(poses):
            flat = np.concatenate(
                [posed.pose.rotations.ravel(), posed.table_from_character.ravel()]
            )
            if not np.isfinite(flat).all():
                raise SystemExit(f"{self._names[number]} has a number that is not finite at {now}")
            before = self._before[number]
            if before is None or not posed.visible or not np.array_equal(flat, before):
                self._since[number] = now
            self._before[number] = flat
            name = self._names[number]
            self.still[name] = max(self.still[name], now - self._since[number])
        if not looks:
            return
        seen = {at: each for at, each in enumerate(poses) if each.visible}
        points = {at: self._skins[at].placed(each) for at, each in seen.items()}
        for one, two in itertools.combinations(seen, 2):
            deep = max(
                depth(points[a], points[b], self._skins[b].triangles)
                for a, b in ((one, two), (two, one))
            )
            self.depths[self._names[one], self._names[two]].append(deep)


def main() -> int:
    """Play, print the tables and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--cast", default=CAST)
    parser.add_argument("--unaware", action="store_true", help="they do not know of one another")
    given = parser.parse_args()
    others = [Character.load(name) for name in given.cast.split(",")]
    kind = Unaware if given.unaware else Playground
    watches: dict[str, Watch] = {}
    sizes: list[int] = []
    drives = max(round(60.0 * given.minutes / DRIVE_S), 1)
    scenarios = list(RECORDED_SCENARIOS)
    for number in range(drives):
        scenario = scenarios[number % len(scenarios)]
        take = drive(number, scenario, CubeModel.load(find_scenario(scenario).cube).edge)
        playground = kind(scenario, take.intrinsics, others=others)
        members = playground.cast.members
        watch = watches.setdefault(
            playground.character.name,
            Watch([each.name for each in members], [each.character for each in members]),
        )
        watch.forget()
        width, height = take.intrinsics.size
        image = np.zeros((height, width, 3), np.uint8)
        for index, state in enumerate(take.states):
            frame = Frame(image, state.timestamp, index)
            step = playground.step(frame, replay=ReplayInputs(state=state), drawn=False)
            poses = [step.posed, *(each.posed for each in step.others)]
            watch.add(poses, state.timestamp, looks=index % EVERY == 0)
        sizes.append(len(playground.checkpoint()._data))
    return report(list(watches.values()), sizes, drives * DRIVE_S / 60.0)


def report(watches: list[Watch], sizes: list[int], minutes: float) -> int:
    """Print the tables and return an exit code."""
    console, failed = Console(highlight=False, soft_wrap=True), False
    table = Table("pair", "deepest", "> 2 mm")
    for watch in watches:
        for (one, two), depths in watch.depths.items():
            deep = np.array(depths)
            failed |= bool(deep.max() > MAX_DEPTH_M)
            share = float((deep > MAX_DEPTH_M).mean())
            table.add_row(f"{one}, {two}", f"{1e3 * deep.max():.1f} mm", f"{share:.2%}")
    console.print(table)
    frozen = max(max(each.still.values()) for each in watches)
    console.print(f"{minutes:.1f} minutes; longest without a movement: {frozen:.2f} s")
    failed |= frozen > MAX_FROZEN_S
    first = max(sizes[: len(RECORDED_SCENARIOS)])
    console.print(f"state: at most {first} bytes in the first drives, {max(sizes)} in all")
    failed |= max(sizes) > MAX_GROWTH * first
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
