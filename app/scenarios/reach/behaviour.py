"""What hands, head and eyes do while a character reaches for the cube or carries a thing."""

import math
from dataclasses import dataclass

import numpy as np

from cubeling.app.pipeline.table.props import GRIP, PosedBody, Side
from cubeling.app.scenarios.reach.intents import Ongoing, bundled_gesture, gesture_times
from cubeling.app.scenarios.reach.places import Point, in_front, look_about
from cubeling.characters.behaviour import (
    BehaviourIntent,
    GazeIntent,
    GestureExpressivity,
    GestureIntent,
    HeadIntent,
    ReachIntent,
    StrokeTimes,
    Times,
)

REACH_S, LOOK_S = 0.6, 0.25
"""Time in which a hand, and the eyes, come to a place [s]."""

GLANCE_S = 1.2
"""How long it looks in each direction for a cube that is out of sight [s]."""

SHAKE_S, SHAKES = 1.5, 3
"""Time in which it shakes its head, and how many times [s]."""

CARRY_LEFT, CARRY_UP, CARRY_AHEAD = 0.15, 0.53, 0.19
"""Where a hand carries a thing: to its side, up and ahead, in body heights."""

OVER_CUBE = np.array([0.0, 0.05, 0.0])
"""Where it looks that holds the cube, from its middle [m]."""

GESTURES = {
    "cheer": "CHEER",
    "rejoice": "CHEER",
    "shrug": "SHRUG",
    "shade": "SHADE_EYES",
    "search": "SHADE_EYES",
}
"""The gesture that belongs to what it does."""

HELD_GESTURES = ("shade", "search")
"""What it does with a gesture that is held for as long as it does so."""


@dataclass(frozen=True)
class ReachScene:
    """Where everything is that hands and eyes are for."""

    doing: str
    """What the character does."""

    cube: Point
    """The cube's centre, (3,) in the table frame [m]."""

    touch: Point
    """The point of it that is nearest, (3,) [m]."""

    effort: float
    """How hard that is to reach."""

    goal: Point | None
    """Foot of the thing that it fetches, or of the place for it, (3,) [m]; None for neither."""

    stand: Point | None
    """Where to go for that, (3,) [m]; None to stay."""

    held: bool
    """Whether it has a thing in its hand."""

    hand: Side
    """The hand that takes things, and carries them."""

    sides: tuple[tuple[Point, Point], tuple[Point, Point]]
    """The left and the right side of the cube: its middle [m], and the way out of it there."""


class ReachingBody:
    """Makes the `BehaviourIntent` of each frame, with times that last from frame to frame."""

    def __init__(self) -> None:
        self._reaches: Ongoing[ReachIntent] = Ongoing()
        self._second_reaches: Ongoing[ReachIntent] = Ongoing()
        self._gestures: Ongoing[GestureIntent] = Ongoing()
        self._heads: Ongoing[HeadIntent] = Ongoing()
        self._gazes: Ongoing[GazeIntent] = Ongoing()

    def update(
        self, now: float, scene: ReachScene | None, body: PosedBody | None
    ) -> BehaviourIntent | None:
        """Return what a frame asks of the body; without a scene it comes to rest."""
        clasps = scene is not None and scene.doing == "clasp"
        first = _reach(now, scene, body) if scene and body else None
        second = _clasp(now, scene, "right") if scene and clasps else None
        intent = BehaviourIntent(
            gestures=self._gestures.update(now, _gesture(now, scene) if scene else None),
            reaches=(
                *self._reaches.update(now, first),
                *self._second_reaches.update(now, second),
            ),
            heads=self._heads.update(now, _shake(now, scene) if scene else None),
            gazes=self._gazes.update(now, _gaze(now, scene, body) if scene and body else None),
        )
        return None if intent == BehaviourIntent() else intent


def _reach(now: float, scene: ReachScene, body: PosedBody) -> ReachIntent | None:
    doing, times = scene.doing, Times(now, now + REACH_S)
    if doing == "touch":
        power = min(max(scene.effort, 0.0), 1.0)
        style = GestureExpressivity(power=power)
        return ReachIntent("touch", scene.touch, times, "touch", expressivity=style)
    if doing == "stretch":
        style = GestureExpressivity(openness=0.8, power=1.0)
        return ReachIntent("stretch", scene.touch, times, "reach", expressivity=style)
    if doing == "clasp":
        return _clasp(now, scene, "left")
    if doing == "point":
        return ReachIntent("point", scene.cube, times, "point")
    if doing in ("grasp", "put") and scene.goal is not None:
        return ReachIntent(doing, scene.goal + GRIP, times, "grasp", scene.hand)
    if scene.held:
        side = 1.0 if scene.hand == "left" else -1.0
        place = in_front(body, side * CARRY_LEFT, CARRY_UP, CARRY_AHEAD)
        return ReachIntent("carry", place, times, "grasp", scene.hand)
    return None


def _clasp(now: float, scene: ReachScene, hand: Side) -> ReachIntent:
    """Return a hand flat against its side of the cube."""
    place, out = scene.sides[hand == "right"]
    times = Times(now, now + REACH_S)
    return ReachIntent(f"clasp {hand}", place, times, "hold", hand, palm=-out)


def _gesture(now: float, scene: ReachScene) -> GestureIntent | None:
    if scene.doing not in GESTURES:
        return None
    name = GESTURES[scene.doing]
    gesture = bundled_gesture(name)
    held = scene.doing in HELD_GESTURES
    times = gesture_times(gesture, now, math.inf if held else None)
    hand: Side = "left" if scene.held and scene.hand == "right" else "right"
    return GestureIntent(name, gesture, times, hand)


def _shake(now: float, scene: ReachScene) -> HeadIntent | None:
    if scene.doing != "shrug":
        return None
    end = now + SHAKE_S
    times = StrokeTimes(now, now + 0.2, end - 0.2, end, now + 0.2, now + 0.4, end - 0.2)
    return HeadIntent("shake", "SHAKE", times, repeats=SHAKES)


def _gaze(now: float, scene: ReachScene, body: PosedBody) -> GazeIntent | None:
    times = Times(now, now + LOOK_S)
    if scene.doing == "search":
        number = int(now / GLANCE_S)
        return GazeIntent(f"about {number}", look_about(body, number), times, "SHOULDER")
    if scene.doing in ("fetch", "grasp", "put") and scene.goal is not None:
        return GazeIntent("thing", scene.goal + GRIP, times, "HEAD")
    if scene.doing in ("touch", "stretch", "point", "come", "shade", "hold"):
        return GazeIntent("cube", scene.cube, times, "HEAD")
    if scene.doing == "clasp":  # to its top, or the face would be hidden behind the hair
        return GazeIntent("cube", scene.cube + OVER_CUBE, times, "HEAD")
    return None
