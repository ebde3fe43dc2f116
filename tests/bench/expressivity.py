"""What the sliders of expressivity move: `python -m tests.bench.expressivity [CHARACTER …]`.

Every bundled gesture is asked for in BML and played as `cubeling behave` does, with all layers of
the body: once as it is written, and once with a slider at each of its ends.

sliders
    How many gestures a slider at an end changes: some joint by at least 5°, or a wrist by at least
    2 cm of a person of 1.75 m, at some moment. "Greta's" are the parameters of that dialect, in a
    description, at −1 and 1. "no effect" counts the gestures that say so of a slider.
motion
    Peak speed and peak acceleration of the wrists in gestures as they are written: median, 90 % and
    greatest.

Without characters: the bundled human, and models of others in `../shared/data/gltf`, as far as they
are there. Exits with 1 if a slider changes fewer than 50 of 56.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.voice import SilentSource
from cubeling.app.show.blocks import BehaviourOptions
from cubeling.characters import Character
from cubeling.characters.behaviour import (
    GestureCollection,
    SymbolicGesture,
    natural_times,
    without_effect,
)
from cubeling.characters.ik.reaching import UpperBody
from cubeling.characters.skeleton.pose import Array

FOREIGN = ("RobotExpressive", "CesiumMan", "RiggedFigure", "BrainStem")
"""Models of others that have arms."""

DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "gltf"

SLIDERS: Mapping[str, tuple[float, ...]] = {
    "spatial": (-1.0, 1.0),
    "openness": (0.0, 1.0),
    "fluidity": (-1.0, 1.0),
    "bias": (-1.0, 1.0),
    "tension": (-1.0, 1.0),
    "power": (1.0,),
}
"""Ends of each slider that differ from a gesture as it is written."""

GRETA: Mapping[str, tuple[float, ...]] = dict.fromkeys(("FLD", "TEN"), (-1.0, 1.0))
"""The same in the dialect of Greta, for what moved nothing there."""

PERSON_M = 1.75
"""Height of a person, for ways on bodies of any size [m]."""

MIN_TURN_DEG, MIN_WAY = 5.0, 0.02 / PERSON_M
"""What counts as an effect: the turn of a joint, and the way of a wrist ÷ the body's height."""

BAR_SHARE = 50 / 56
"""Least share of gestures that a slider changes."""

RATE_HZ, FINE_RATE_HZ = 15.0, 120.0
"""Frames a second that are compared, and from which accelerations are measured."""

Played = tuple[Array, Array]
"""Rotations of all joints (frames, joints, 4), and places of the wrists over the body's height,
(frames, arms, 3)."""


def play(
    body: Character,
    gesture: SymbolicGesture,
    inner: str = "",
    outer: str = "",
    rate: float = RATE_HZ,
) -> Played:
    """Return how a gesture is performed; `inner` and `outer` are added to its element."""
    player = BehaviourPlayer(body, SilentSource("no voice"), BehaviourOptions())
    player.settle(0.3, rate)
    player.director.accept(
        '<bml id="b" xmlns="http://www.bml-initiative.org/bml/bml-1.0" '
        'xmlns:c="urn:cubeling:behaviour">'
        f'<gesture id="g" lexeme="{gesture.name}" {outer}>{inner}</gesture></bml>'
    )
    wrists = [arm.joints[3] for arm in UpperBody.of(body.skeleton, body.anatomy).arms.values()]
    end = natural_times(gesture).end or 0.0
    turns, places = [], []
    for number in range(int((end + 0.3) * rate)):
        pose = player.update(number / rate).posed.pose
        turns.append(pose.rotations)
        places.append(pose.globals(body.skeleton)[wrists, :3, 3] / body.height)
    return np.array(turns), np.array(places)


def difference(one: Played, other: Played) -> tuple[float, float]:
    """Return the largest turn of a joint [degrees] and way of a wrist between two."""
    cosines = np.abs(np.vecdot(one[0], other[0])).min()
    turn = np.degrees(2.0 * np.arccos(min(float(cosines), 1.0)))
    return float(turn), float(np.linalg.norm(one[1] - other[1], axis=-1).max())


def has_effect(change: tuple[float, float]) -> bool:
    """Return whether a change can be seen."""
    return change[0] >= MIN_TURN_DEG or change[1] >= MIN_WAY


def styles() -> Iterator[tuple[str, float, str, str]]:
    """Yield each slider, its end, and what that adds inside the element and to its attributes."""
    for name, ends in SLIDERS.items():
        for end in ends:
            yield name, end, "", f'c:{name}="{end:g}"'
    for name, ends in GRETA.items():
        for end in ends:
            value = f"<{name}.value>{end:g}</{name}.value>"
            yield f"Greta's {name}", end, f"<description priority='1'>{value}</description>", ""


def peaks(body: Character, gestures: Sequence[SymbolicGesture]) -> Array:
    """Return peak speed and acceleration of the wrists in each gesture, (n, 2).

    They are those of a person of `PERSON_M` [m/s, m/s²].
    """
    found = []
    for gesture in gestures:
        _, places = play(body, gesture, rate=FINE_RATE_HZ)
        speeds = np.diff(places * PERSON_M, axis=0) * FINE_RATE_HZ
        changes = np.diff(speeds, axis=0) * FINE_RATE_HZ
        found.append([np.linalg.norm(each, axis=-1).max() for each in (speeds, changes)])
    return np.array(found)


def main() -> int:
    """Print the tables; return 1 if a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("characters", nargs="*")
    parser.add_argument("--list", action="store_true", help="name what a slider does not change")
    parser.add_argument("--only", nargs="*", help="sliders to look at")
    asked = parser.parse_args()
    foreign = (DATA / f"{name}.glb" for name in FOREIGN)
    names = asked.characters or ["human", *(str(each) for each in foreign if each.exists())]
    gestures = list(GestureCollection.load_bundled())
    bodies = {Path(name).stem: Character.load(name) for name in names}
    said = Counter(name for each in gestures for name in without_effect(each))
    table = Table(
        "slider", "end", "no effect", *bodies, title=f"changed of {len(gestures)} gestures"
    )
    motion = Table("character", "speed m/s", "acceleration m/s²", title="peaks of the wrists")
    counts: dict[tuple[str, float], list[str]] = {}
    least, missing = len(gestures), list[str]()
    for name, body in bodies.items():
        written = {each.name: play(body, each) for each in gestures}
        for slider, end, inner, outer in styles():
            if asked.only and slider not in asked.only:
                continue
            changes = {
                each.name: difference(play(body, each, inner, outer), written[each.name])
                for each in gestures
            }
            without = [each for each, change in changes.items() if not has_effect(change)]
            changed = len(gestures) - len(without)
            counts.setdefault((slider, end), []).append(str(changed))
            least = min(least, changed)
            if without:
                small = ", ".join(
                    f"{each} {changes[each][0]:.1f}° {1e3 * PERSON_M * changes[each][1]:.0f} mm"
                    for each in without
                )
                missing.append(f"{name}, {slider} {end:+g}: {small}")
        found = peaks(body, gestures)
        rows = np.stack([np.median(found, 0), np.quantile(found, 0.9, 0), found.max(0)])
        motion.add_row(name, *("  ".join(f"{each:.2f}" for each in rows[:, k]) for k in (0, 1)))
    for (slider, end), row in counts.items():
        table.add_row(slider, f"{end:+g}", str(said[slider] or ""), *row)
    Console().print(table)
    Console().print(motion)
    if asked.list:
        for line in missing:
            Console().print(line, highlight=False)
    return int(least < BAR_SHARE * len(gestures))


if __name__ == "__main__":
    sys.exit(main())
