"""A character that walks and runs by a motion graph: of its whole body, or of its parts."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import numpy as np

from cubeling.characters.control.command import CharacterCommand
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.control.controllers.walk import NOT_ACTIONS, WalkController
from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import IDLE_SPEED
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M, STANDSTILL, SteeringOutput
from cubeling.characters.model.character import Character
from cubeling.characters.model.motion_library import library_of
from cubeling.characters.motion.balance import MAX_UNLEANED_M_S2
from cubeling.characters.motion.motion import Motion, RootDelta
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.retargeting.retarget import retarget
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.smoothing import low_pass
from cubeling.characters.synthesis.archive import skeleton_identity
from cubeling.characters.synthesis.behaviours import STANDING_M_S, Behaviours
from cubeling.characters.synthesis.graphs.building import analyse, part_graphs, standard_graph
from cubeling.characters.synthesis.graphs.graph import EdgeCosts, MotionGraph
from cubeling.characters.synthesis.graphs.runs import RunningWays
from cubeling.characters.synthesis.graphs.search import CostToGo
from cubeling.characters.synthesis.graphs.storage import StoredGraph, load_graph
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.live import (
    GraphPlayback,
    LiveMotion,
    PartsSource,
    StandardSource,
)
from cubeling.characters.synthesis.transitions.progressive import TransitionPlanner

YAW_RATE_PER_ANGULAR = -1.5
"""Yaw rate [rad/s] for each radian of Angular, as the clips of the bundled characters turn."""

TEMPO_LIMITS = (0.85, 1.15)
"""By how much a clip may be slowed down or sped up to the speed that is asked for."""

MAX_BEND_RAD_S, MAX_WIDE_BEND_RAD_S = 0.5, 1.5
"""By how much the root may turn besides what the clip turns, towards the target [rad/s]; the second
where the graph does not turn by itself to both sides."""

MAX_RAISED_HEIGHTS = 0.02
"""A foot this far above where its clip has it is not held on the ground [body heights]."""

BEND_LAG_S, TEMPO_LAG_S = 0.2, 0.3
"""Time constants of that turn, and of the tempo [s]."""


class GraphController(WalkController):
    """Plays a character by a motion graph; a `CharacterController`.

    Where to go and how fast is steered as for the movement tree. The frames that come nearest to
    the speed and yaw rate asked for are the goals of the graph; what is left over is made up by
    tempo and by a slight bend of the way. Actions are clips of the character, as elsewhere; where
    no frame of the graph stands, so is standing.
    """

    def __init__(
        self,
        character: Character,
        scale: float,
        place: RootDelta | None,
        behaviours: Behaviours,
        source: GraphPlayback,
        to_stand: CostToGo,
    ) -> None:
        super().__init__(character, scale, place)
        self._behaviours = behaviours
        self._behaviour = behaviours.nearest(0.0, 0.0)
        self._live = LiveMotion(source, behaviours.goals(self._behaviour))
        states: dict[str, Motion] = {"move": self._live, **self._actions}
        self._stands_itself = float(behaviours.means[:, 0].min()) >= STANDING_M_S
        if self._stands_itself:
            states["idle"] = character.clips.get("idle", character.clips["Walk"])
        self._machine = StateMachine(states, "idle" if self._stands_itself else "move")
        library = source.library
        rest = library.skeleton.rest.globals(library.skeleton)[:, :3, 3]
        self._from_rest = np.linalg.norm(library.positions - rest, axis=-1).mean(1)
        rates = behaviours.means[:, 1]
        turns = min(float(rates.max()), -float(rates.min())) > MAX_BEND_RAD_S
        self._max_bend = MAX_BEND_RAD_S if turns else MAX_WIDE_BEND_RAD_S
        self._bend, self._tempo = 0.0, 1.0
        self._to_stand = to_stand
        self._strides_m = np.hypot(*library.steps[:, :2].T)
        self._braking = False
        self._height = character.height
        self._balls = [foot[-1] for foot in find_feet(library.skeleton)]

    @property
    def library(self) -> MotionLibrary:
        """The motions that the graph is made of."""
        return self._live.source.library

    def steer(
        self, course: SteeringOutput, elapsed: float, action: str = "idle", weight: float = 0.0
    ) -> ControllerFrame:
        """Advance by a time [s] on a course and return what is played; see `WalkController`."""
        state = "move"
        if course.speed == 0.0 and (action in self._actions or self._stands_itself):
            state = action
        frame = super().steer(course, elapsed, state, weight)
        turned = RootDelta(yaw=self._bend * elapsed)
        self.place = self.place.then(turned)
        return replace(frame, place=self.place)

    def _course(self, command: CharacterCommand) -> SteeringOutput:
        """Return where to go; it begins to stop where its way to a standing frame ends in time."""
        course, going = super()._course(command), command.locomotion
        if self._stands_itself:
            # It has no steps to turn in place with.
            return course if course.stride > 0.0 else STANDSTILL
        source = self._live.source
        if self._stands():
            self._braking = False
        elif course.speed > 0.0 and going is not None and going.target is not None and going.stop:
            x, z = (float(value) for value in going.target)
            left = math.hypot(x - self.place.x, z - self.place.z)
            way = float(self._strides_m[self._to_stand.path(source.frame)].sum()) * self._scale
            ahead = abs(self.place.bearing(x, z)) < math.pi / 2
            self._braking = self._braking or (ahead and left < way + ARRIVAL_DISTANCE_M / 2)
        return STANDSTILL if self._braking else course

    def _stands(self) -> bool:
        """Return whether it stands, and is to stand."""
        if self._stands_itself:
            return self._machine.state == "idle"
        stands = self._behaviours.means[self._behaviour, 0] < STANDING_M_S
        return bool(stands and self._live.goals[self._live.source.frame])

    def _play(self, steered: SteeringOutput, state: str, weight: float, now: float) -> None:
        if state in self._actions:
            self._play_action(self._actions[state], weight, now, self._machine.state == state)
        elif state == "move":
            self._request(steered, now)
        self._machine.request(state, now, begin=self._set_off if state == "move" else None)

    def _set_off(self) -> None:
        """Begin to move: who stood by a clip of his own sets off where the graph has no start."""
        goals = np.flatnonzero(self._live.goals)
        self._live.restart(
            int(goals[self._from_rest[goals].argmin()]) if self._stands_itself else None
        )

    def _request(self, steered: SteeringOutput, now: float) -> None:
        """Choose the goals, the tempo and the bend for what is asked for."""
        going = steered.speed > IDLE_SPEED
        speed = self.gaits.pace(steered.speed) * steered.stride if going else 0.0
        yaw_rate = YAW_RATE_PER_ANGULAR * steered.angular if speed else 0.0
        self._behaviour = self._behaviours.nearest(speed, yaw_rate, self._behaviour)
        self._live.goals = self._behaviours.goals(self._behaviour)
        own_speed, own_yaw_rate = self._behaviours.means[self._behaviour].tolist()
        moving = min(speed, own_speed) > STANDING_M_S
        tempo = tempo_towards(speed / own_speed) if moving else 1.0
        elapsed = self._time - now
        self._tempo = low_pass(self._tempo, tempo, elapsed, TEMPO_LAG_S)
        if self._machine.state == "move":
            self._live.set_tempo(self._tempo, now - self._machine.entered)
        missing = yaw_rate - own_yaw_rate * tempo if moving else 0.0
        most = min(self._max_bend, MAX_UNLEANED_M_S2 / max(own_speed * tempo, STANDING_M_S))
        asked = min(max(missing, -most), most)
        self._bend = low_pass(self._bend, asked, elapsed, BEND_LAG_S)

    def _frame(self, steered: SteeringOutput, going: bool) -> ControllerFrame:
        """Return what is played now; it stands when its clip does."""
        frame = super()._frame(steered, going)
        return replace(frame, standing=frame.state == "idle" and self._stands())

    def _feet_down(self) -> list[bool] | None:
        """Return which feet the motion has on the ground."""
        if self._machine.state != "move":
            return super()._feet_down()
        source = self._live.source
        if not self._feet:
            return None
        # While a jump passes over, a foot may still be in the air that stands in the new clip.
        shown = source.pose.globals(source.library.skeleton)[self._balls, 1, 3]
        raised = shown - source.library.positions[source.frame, self._balls, 1]
        near = raised < MAX_RAISED_HEIGHTS * self._height
        down: list[bool] = (source.library.contacts[source.frame] & near).tolist()
        return down


def graph_factory(
    kind: str, character: Character, motions: Sequence[str]
) -> Callable[[Character, float, RootDelta | None], GraphController]:
    """Prepare the graph controller of a kind for a character; see `ControllerChoice`.

    Parameters
    ----------
    kind
        "graph" for the graph of the whole body, "parts" for the graphs of its parts.
    character
        Whom it is to play.
    motions
        One file of `cubeling motions build`, or motions, see `read_motions`; without any, the
        walking and running clips of the character.

    Raises
    ------
    CharacterError
        If the character does not walk, or the file cannot be read or does not fit it.
    """
    if not WalkController.suits(character):
        raise CharacterError(
            f"{character.name}: a motion graph needs a character that walks; leave out --controller"
        )
    files = [Path(name) for name in motions if name.endswith(".graph")]
    if files and len(motions) > 1:
        raise CharacterError(f"{', '.join(motions)}: give one .graph file alone, or only motions")
    if files:
        stored = fit_graph(load_graph(files[0]), character)
    else:
        own = [clip for name, clip in character.clips.items() if name in OWN_CLIPS]
        clips = read_motions(motions, character) if motions else own
        stored = analyse(library_of(clips, character))
    behaviours, make_source, to_stand = SOURCES[kind](stored)

    def make(character: Character, scale: float, place: RootDelta | None) -> GraphController:
        return GraphController(character, scale, place, behaviours, make_source(), to_stand)

    return make


def tempo_towards(ratio: float) -> float:
    """Return the tempo for a speed that is a multiple of the clip's own.

    What no tempo within `TEMPO_LIMITS` reaches is not tried: a run in slow motion is no walk.

    >>> [tempo_towards(ratio) for ratio in (0.9, 1.1, 0.4, 3.0)]
    [0.9, 1.1, 1.0, 1.0]
    """
    low, high = TEMPO_LIMITS
    if ratio < low:
        return min(2 * low - ratio, 1.0)  # continuous: it goes back to the clip's own tempo
    return ratio if ratio < high else max(2 * high - ratio, 1.0)


OWN_CLIPS = ("idle", *NOT_ACTIONS)
"""The clips of a character that its own graph is made of."""


def fit_graph(stored: StoredGraph, character: Character) -> StoredGraph:
    """Return a graph on the skeleton of a character; its clips are retargeted if they must be.

    Raises
    ------
    CharacterError
        If the bodies differ too much.
    """
    library = stored.library
    if skeleton_identity(library.skeleton) == skeleton_identity(character.skeleton):
        return stored
    clips = [
        retarget(
            library.as_clip(name),
            library.skeleton,
            library.anatomy,
            character.skeleton,
            character.anatomy,
            meshes=character.meshes,
        )
        for name in library.names
    ]
    moved = MotionLibrary.of(clips, character.skeleton, character.anatomy, library.rate)
    if not np.array_equal(moved.starts, library.starts):
        raise CharacterError(f"{character.name}: its clips have other frames than the graph")
    return replace(stored, library=moved)


MIN_RUN_S = 0.12
"""Time for which a clip is played after a jump, if it goes on [s]: while the jump passes over."""

LIVE_COSTS = EdgeCosts(per_frame=0.02, jump=0.1, most_jumps=4, balance=0.3)
"""What edges cost in play: to wait for a tenth of a second is as dear as a good jump."""


Playable: TypeAlias = tuple[Behaviours, Callable[[], GraphPlayback], CostToGo]
"""What a graph can do, what makes a source that plays it, and its ways to standing."""


def _standard(stored: StoredGraph) -> Playable:
    graph = standard_graph(stored, LIVE_COSTS)
    behaviours = Behaviours.of(stored.library, graph.kept)
    to_stand = _prepare(graph, behaviours)
    start = _standing_frame(behaviours)
    ways = RunningWays(graph, round(MIN_RUN_S * graph.library.rate))
    for number in range(len(behaviours.means)):
        ways.prepare(behaviours.goals(number))
    return behaviours, lambda: StandardSource(ways, start), to_stand


def _parts(stored: StoredGraph) -> Playable:
    graphs = part_graphs(stored, LIVE_COSTS)
    if not graphs.kept.any():
        raise CharacterError(
            "the graphs of the parts have no frame in common; raise the threshold or add clips"
        )
    behaviours = Behaviours.of(stored.library, graphs.kept)
    planner = TransitionPlanner(graphs, standard_graph(stored, LIVE_COSTS))
    planner.prepare()
    to_stand = _prepare(graphs.graphs[0], behaviours)
    start = _standing_frame(behaviours)
    return behaviours, lambda: PartsSource(planner, start), to_stand


def _prepare(graph: MotionGraph, behaviours: Behaviours) -> CostToGo:
    """Find the shortest paths to every behaviour, so that no frame of play has to.

    Returns those to standing.
    """
    for number in range(len(behaviours.means)):
        graph.to_go(behaviours.goals(number))
    return graph.to_go(behaviours.goals(behaviours.nearest(0.0, 0.0)))


def _standing_frame(behaviours: Behaviours) -> int:
    """Return a frame of the behaviour that is nearest to standing."""
    return int(np.argmax(behaviours.goals(behaviours.nearest(0.0, 0.0))))


SOURCES: dict[str, Callable[[StoredGraph], Playable]] = {
    "graph": _standard,
    "parts": _parts,
}
"""What plays a stored graph, by the name of the controller."""
