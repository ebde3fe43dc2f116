"""Reaching: the character tries to get the cube, and brings it small things when it rests."""

import numpy as np

from cubeling.affect import Personality
from cubeling.app.pipeline.registry import SUMMARIES
from cubeling.app.pipeline.scenario import Inputs, Outcome, ScenarioSettings
from cubeling.app.pipeline.table.props import PosedBody
from cubeling.app.pipeline.table.situation import PLAYER_POSITION, Situation
from cubeling.app.scenarios.follow import gait
from cubeling.app.scenarios.mood import MoodController
from cubeling.app.scenarios.presence import Presence
from cubeling.app.scenarios.reach.behaviour import ReachingBody, ReachScene
from cubeling.app.scenarios.reach.catching import ARRIVED_M, HARD, Catching, Prospect
from cubeling.app.scenarios.reach.gifts import HOMES, Gifts
from cubeling.app.scenarios.reach.hints import Facts, facts_of, hint_of
from cubeling.app.scenarios.reach.places import (
    Point,
    around,
    gap,
    nearest_point_of_cube,
    out_of,
    sides_of_cube,
    way_to,
)
from cubeling.characters import (
    ActionIntent,
    CharacterCommand,
    LocomotionIntent,
    RootDelta,
)
from cubeling.tracking import CubeControls, CubeModel

LOOK_FOR_S = 15.0
"""How long it stays and looks for a cube that is out of sight [s]."""

REST_S = 1.2
"""A cube that has rested for so long gets its things [s]."""

WALK_SPEED, SPEED_PER_M, MAX_SPEED = 2.0, 6.0, 3.0
"""AvatAR's Speed near its goal, by how much it is greater for each metre to go, and at most."""

NO_HANDS_EFFORT = 3.0
"""Effort of a character without hands that is not beside the cube."""

FACING_CUBE = ("touch", "stretch", "point", "clasp")
"""What it does with its front to the cube; else it turns to the player."""

ACTS_IN_PLACE = (
    "watch",
    "touch",
    "cheer",
    "clasp",
    "stretch",
    "shrug",
    "sulk",
    "search",
    "hold",
    "rejoice",
)
"""What it does where it stands; it steps out of a cube that is put down on it."""

ICONS = {
    "watch": "stand", "touch": "reach", "sulk": "wait", "shade": "search", "fetch": "walk",
    "grasp": "take", "put": "give", "hold": "wait", "rejoice": "cheer", "clasp": "take",
}  # fmt: skip
"""The card of what it does, where that has another name."""


class Reach:
    """The character reaches for the cube: gladly, with effort, or in vain, as far as it is.

    When the cube rests, it brings small things to it, one after the other. A shaken cube lets
    them hop home. A cube that is out of sight or held up high makes it shade its eyes.
    """

    name = "reach"
    summary = SUMMARIES["reach"]
    cube = "locomotion"
    roles: tuple[str, ...] = ()
    character = "human"
    personality = "lively"
    start = RootDelta(-0.14, 0.03, 0.0)
    kept_free = tuple(HOMES.values())
    has_intensity = False
    adjustable = ("personality",)

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._edge = cube.edge
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence(LOOK_FOR_S)
        self._catching = Catching()
        self._gifts = Gifts(cube.edge)
        self._hands = ReachingBody()
        self._cube: Point | None = None  # where it was seen last, (4, 4)
        self._rested_since: float | None = None

    def adjust(self, settings: ScenarioSettings) -> None:
        """Play on with other settings."""
        self._mood.adjust(settings.personality or Personality.load(self.personality))

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame; see `Scenario.update`."""
        now, body = controls.timestamp, situation.body
        if inputs.clear:
            self._mood.reset()
        visible = self._presence.update(controls)
        if situation.cube is not None:
            self._cube = situation.cube
            self._gifts.lay_out(situation.cube[:3, 3], situation.view)
            self._gifts.make_way(situation.cube[:3, 3], now)
        if inputs.clear or controls.shaken:
            self._gifts.scatter(body, now)
        events: tuple[str, ...] = ()
        scene: ReachScene | None = None
        facts: Facts | None = None
        if visible and body is not None and self._cube is not None:
            scene, facts, events = self._decide(controls, situation, body, self._cube)
        going = LocomotionIntent(facing=PLAYER_POSITION, exact=True)
        if scene is not None and body is not None:
            going = _next_place(scene, body, situation.walks, self._edge)
        stands = ActionIntent("idle") if going.target is None else None
        behaviour = self._hands.update(now, scene, body)
        command = CharacterCommand(now, going, stands, visible=visible, behaviour=behaviour)
        emotion = self._mood.update(
            controls, "idle", speed=going.speed, events=(*events, *inputs.events)
        )
        doing = "watch" if scene is None else scene.doing
        icon = gait(going.speed, situation.walks) if going.speed else ICONS.get(doing, doing)
        if controls.position is None:
            hint = "Put the cube on the table" if controls.visible else "Show me the cube"
        else:
            hint = hint_of(facts or Facts(doing))
        return Outcome(command, emotion, hint, icon, events=events, things=self._gifts.things(now))

    def _decide(
        self, controls: CubeControls, situation: Situation, body: PosedBody, cube: Point
    ) -> tuple[ReachScene, Facts, tuple[str, ...]]:
        """Return what it does, with what and why, and what has just happened."""
        prospect = _prospect(controls, situation, body, cube, self._edge)
        events: tuple[str, ...] = ()
        self._gifts.end_pauses(prospect.now)
        if self._gifts.busy:
            self._catching.look(prospect)
        else:
            events = self._catching.update(prospect)
        free = body.has_hands and self._is_free(controls)
        gifts, centre = self._gifts, prospect.cube
        stand = gifts.stand_point(body.place, centre, body.parts.stand)
        there = stand is not None and gap(body.place, stand, 0.0) <= ARRIVED_M
        events += gifts.update(prospect.now, centre, body, free=free, there=there)
        doing = self._next_act(free)
        facts = facts_of(doing, prospect, self._catching, self._edge, gifts.named)
        scene = ReachScene(
            doing=doing,
            cube=centre,
            touch=prospect.touch,
            effort=prospect.effort,
            goal=gifts.goal(centre),
            stand=stand if doing in ("fetch", "carry") else None,
            held=bool(gifts.held),
            hand=gifts.hand,
            sides=sides_of_cube(cube, self._edge, body.beside(centre, 0.0)[:3, 0]),
        )
        return scene, facts, events

    def _is_free(self, controls: CubeControls) -> bool:
        """Whether it has time for the things: the cube rests, and it has one or is content."""
        rests = controls.visible and controls.resting
        if not rests:
            self._rested_since = None
        elif self._rested_since is None:
            self._rested_since = controls.timestamp
        if self._rested_since is None or controls.timestamp - self._rested_since < REST_S:
            return False
        return self._gifts.busy or self._catching.content

    def _next_act(self, free: bool) -> str:
        """Return what it does: the cube out of sight goes first, then things, then the cube."""
        if self._catching.doing == "search":
            return "search"
        if free and self._gifts.doing != "wait":
            return self._gifts.doing
        return "hold" if self._gifts.held else self._catching.doing


def _prospect(
    controls: CubeControls, situation: Situation, body: PosedBody, cube: Point, edge: float
) -> Prospect:
    """Return what the character knows about the cube at its last place, (4, 4)."""
    touch = nearest_point_of_cube(cube, edge, body.chest)
    away = gap(body.place, touch, body.parts.stand)
    effort = body.effort(touch)
    if not body.has_hands:  # it is content to be there
        near = away <= ARRIVED_M and cube[1, 3] < body.height
        effort = 0.0 if near else NO_HANDS_EFFORT
    touching = not body.has_hands or body.hand_distance(touch) < body.parts.touching
    aloft = bool(cube[1, 3] > edge)  # more than half of it above where it would rest
    beside = body.beside(cube[:3, 3], _clasp_distance(body, edge))
    sides = sides_of_cube(cube, edge, beside[:3, 0])
    claspable = aloft and len(body.parts.hands) > 1 and effort <= HARD
    claspable = claspable and max(body.effort(each, beside) for each, _ in sides) <= HARD
    return Prospect(
        now=controls.timestamp,
        seen=situation.cube is not None,
        cube=cube[:3, 3],
        touch=touch,
        effort=effort,
        gap=away,
        height=float(cube[1, 3]) / body.height,
        touching=touching,
        claspable=claspable,
    )


def _clasp_distance(body: PosedBody, edge: float) -> float:
    """Return how far from the middle of a cube it stands that it holds with both hands [m]."""
    return edge / 2 + body.parts.stand


def _next_place(scene: ReachScene, body: PosedBody, walks: bool, edge: float) -> LocomotionIntent:
    """Return where to go, or where to turn to."""
    here = body.place
    if scene.stand is not None:
        target = around(here, way_to(here, scene.stand, 0.0, walks=walks), scene.cube)
    elif scene.doing == "come":
        target = way_to(here, scene.touch, body.parts.stand, walks=walks)
    elif scene.doing == "clasp" and gap(here, scene.cube, close := _clasp_distance(body, edge)):
        target = way_to(here, scene.cube, close, walks=walks)
    elif scene.doing in ACTS_IN_PLACE and (aside := out_of(here, scene.cube, edge)) is not None:
        target = way_to(here, aside, 0.0, walks=walks)
    else:
        facing = PLAYER_POSITION
        if scene.doing in ("grasp", "put") and scene.goal is not None:
            facing = scene.goal[[0, 2]]
        elif scene.doing in FACING_CUBE:
            facing = scene.cube[[0, 2]]
        return LocomotionIntent(facing=facing, exact=True)
    speed = WALK_SPEED + SPEED_PER_M * float(np.linalg.norm(target - here[[0, 2]]))
    return LocomotionIntent(min(speed, MAX_SPEED), target, exact=True)
