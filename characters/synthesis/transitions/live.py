"""Graphs that play on and on while what is asked of them changes."""

import math
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.blend import mix
from cubeling.characters.motion.inertialization import Inertialization, OffsetDecay
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.graphs.runs import RunningWays
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.characters.synthesis.transitions.playback import GraphPlayer, extrapolate
from cubeling.characters.synthesis.transitions.progressive import TransitionPlanner
from cubeling.characters.synthesis.transitions.stitching import LowPass, StitchedMotion, stitch
from cubeling.characters.synthesis.transitions.transition import Transition

Goals = NDArray[np.bool_]
"""Which frames meet a request, (frames,)."""

OFFSET_S = 0.3
"""Time over which what was shown goes over into a planned transition [s]."""

LIVE_LOW_PASS = LowPass(sigma_frames=3.0, ramp_frames=12)
"""The filter in play; at the defaults of M2.5 the velocity changes 1.8 times as fast as in the
clips."""

_MOST_PARTS = 6  # of a split profile
_SAMPLED_FRAMES = 32  # played frames that can still be sampled


class GraphPlayback(Protocol):
    """Plays a graph, one frame at a time."""

    library: MotionLibrary

    frame: int
    """The frame that is played; with parts, that of the legs."""

    pose: Pose
    """The pose now, with the root at the origin."""

    def advance(self, goals: Goals) -> RootDelta:
        """Go on towards the goals, and return how the root moves on the way."""
        ...

    def start(self, frame: int) -> None:
        """Start again at a frame, whatever was played."""
        ...


class StandardSource:
    """Plays the graph of the whole body; a `GraphPlayback`."""

    def __init__(self, ways: RunningWays, start: int) -> None:
        self.library = ways.graph.library
        self._ways = ways
        self.start(start)

    def start(self, frame: int) -> None:
        """Start again at a frame, whatever was played."""
        self._player = GraphPlayer(self.library, frame)
        self._run = 0  # frames since the last jump
        self.frame = frame
        self.pose = self._player.pose()

    def advance(self, goals: Goals) -> RootDelta:
        """Go on towards the goals, and return how the root moves on the way."""
        onward = natural(self.library, self.frame, goals & self._ways.graph.kept)
        if onward is None:
            onward = self._ways.next(self.frame, self._run, goals)
        self._run = self._run + 1 if onward == self.library.successors[self.frame] else 0
        self.frame = onward
        step = self._player.advance(self.frame)
        self.pose = self._player.pose()
        return step


class PartsSource:
    """Plays the graphs of the parts; a `GraphPlayback`.

    A transition is planned for a frame that comes soon, a costly search a frame, and played until
    all parts have arrived. Where too few frames come, parts without a way that is quickly found
    follow the legs. What was shown goes over into it by a decaying offset.
    """

    def __init__(self, planner: TransitionPlanner, start: int) -> None:
        self.library = planner.graphs.library
        self._planner = planner
        self.start(start)

    def start(self, frame: int) -> None:
        """Start again at a frame, whatever was played."""
        self._planning: _Planning | None = None
        self._planned: StitchedMotion | None = None
        self._time = 0  # in the planned transition
        self._begun = 0  # its time at the request
        self._offset: Inertialization | None = None
        self._drift = OffsetDecay(np.zeros(3), np.zeros(3), OFFSET_S)
        self._step = self.library.steps[frame]
        self.frame = frame
        self.pose = self._before = self.library.poses[frame]

    def advance(self, goals: Goals) -> RootDelta:
        """Go on towards the goals, and return how the root moves on the way."""
        onward = natural(self.library, self.frame, goals & self._planner.graphs.kept)
        if onward is None and (self._planned is None or self._time >= self._planned.arrived):
            onward = self._plan(goals)
        else:
            self._planning = None
        step, pose = self._step_on(onward)
        self._step, self._before, self.pose = step, self.pose, pose
        return RootDelta(*step.tolist())

    def _step_on(self, onward: int | None) -> tuple[Array, Pose]:
        """Go on by one frame, in the planned transition or in the clip."""
        planned = self._planned
        if planned is None:
            step = self.library.steps[self.frame]
            assert onward is not None  # else a transition would have been planned
            self.frame = onward
            return step, self.library.poses[onward]
        spent = (self._time - self._begun) / self.library.rate
        step = planned.steps[self._time] + self._drift.at(spent)
        self._time += 1
        self.frame = int(planned.frames[self._time])
        pose = planned.poses[self._time]
        if self._offset is not None:
            pose = self._offset.apply(pose, spent + 1 / self.library.rate)
        if self._time == len(planned.steps) - 1:
            self._planned = None
        return step, pose

    def _plan(self, goals: Goals) -> int | None:
        """Plan on; return the next frame of the clip, or None if the transition plays now."""
        frames, library = self._ahead(), self.library
        planning = self._planning
        if planning is None or not planning.serves(self.frame, goals):
            planning = _Planning(self._planner, frames[-1], goals)
        planning.advance()
        if self.frame != planning.request:
            self._planning = planning
            return int(library.successors[self.frame])
        self._planning = None
        self._begin(planning.finish())
        return None

    def _ahead(self) -> list[int]:
        """Return this frame and those that come, as many as planning takes, while they are kept."""
        graphs, frames = self._planner.graphs, [self.frame]
        while len(frames) < len(graphs.parts):
            onward = int(self.library.successors[frames[-1]])
            if onward < 0 or not graphs.kept[onward]:
                break
            frames.append(onward)
        return frames

    def _begin(self, transition: Transition) -> None:
        """Play a transition, into which goes over what is shown."""
        planned = stitch(self._planner.graphs, transition, LIVE_LOW_PASS)
        now = planned.before
        onward = extrapolate(self._before, self.pose)
        self._offset = Inertialization.begin(
            (self.pose, onward),
            (planned.poses[now], planned.poses[now + 1]),
            1 / self.library.rate,
            OFFSET_S,
        )
        self._drift = OffsetDecay(self._step - planned.steps[now], np.zeros(3), OFFSET_S)
        self._planned, self._time, self._begun = planned, now, now


class _Planning:
    """A transition that is planned over several frames."""

    def __init__(self, planner: TransitionPlanner, request: int, goals: Goals) -> None:
        self.request = request
        """The frame from which it leaves."""
        self._goals = goals
        self._steps = planner.plan_in_steps(request, goals)
        self._found: Transition | None = None

    def serves(self, frame: int, goals: Goals) -> bool:
        """Return whether it leads from a frame to come, or this one, to the same goals."""
        near = 0 <= self.request - frame < _MOST_PARTS
        return near and np.array_equal(goals, self._goals)

    def advance(self) -> None:
        """Plan on, with one costly search at most, if anything is left."""
        self._take_step(None)

    def finish(self) -> Transition:
        """Return the transition, without the costly searches that are left."""
        while self._found is None:
            self._take_step(True)
        return self._found

    def _take_step(self, ends: bool | None) -> None:
        if self._found is None:
            try:
                self._steps.send(ends)
            except StopIteration as end:
                self._found = end.value


class LiveMotion:
    """A source as a `Motion` whose goals may be changed while it plays.

    It can be sampled at the present time and shortly before, not far behind.
    """

    def __init__(self, source: GraphPlayback, goals: Goals) -> None:
        self.source = source
        self.goals = goals
        """Which frames meet the request, (frames,); may be replaced at any time."""
        self._rate = source.library.rate
        self._place = RootDelta()
        self._frames = {0: (source.pose, self._place)}
        self._newest = 0
        self._tempo = 1.0
        self._since, self._start = 0.0, 0.0  # a time [s], and what it is in frames

    @property
    def duration(self) -> float:
        """Infinite: it goes on for as long as frames come."""
        return math.inf

    def restart(self, frame: int | None = None) -> None:
        """Let time 0 be the newest frame: the motion is entered again, and goes on from there.

        With the number of a frame of the library, it starts again at that one.
        """
        self._since, self._start = 0.0, float(self._newest)
        if frame is not None:
            self.source.start(frame)
            self._frames = {self._newest: (self.source.pose, self._place)}

    def set_tempo(self, tempo: float, time: float) -> None:
        """Play faster or slower from a time on [s]; a step gets no longer by that."""
        self._start, self._since, self._tempo = self._frames_at(time), time, tempo

    def sample(self, time: float) -> Pose:
        """Return the pose at a time [s]."""
        frame, u = self._position(time)
        first, second = self._play(frame)[0], self._play(frame + 1)[0]
        return first if u == 0.0 else mix([first, second], [1.0 - u, u])

    def travel(self, start: float, end: float) -> RootDelta:
        """Return how the root moves over the ground between two times [s]."""
        return self._place_at(start).to(self._place_at(end))

    def _place_at(self, time: float) -> RootDelta:
        frame, u = self._position(time)
        return self._play(frame)[1].interpolate(self._play(frame + 1)[1], u)

    def _position(self, time: float) -> tuple[int, float]:
        at = self._frames_at(time)
        frame = int(at)
        return frame, at - frame

    def _frames_at(self, time: float) -> float:
        return max(self._start + (time - self._since) * self._rate * self._tempo, 0.0)

    def _play(self, frame: int) -> tuple[Pose, RootDelta]:
        """Return pose and place of a frame; play on until it is reached."""
        while self._newest < frame:
            self._place = self._place.then(self.source.advance(self.goals))
            self._newest += 1
            self._frames[self._newest] = self.source.pose, self._place
            self._frames.pop(self._newest - _SAMPLED_FRAMES, None)
        return self._frames[max(frame, min(self._frames))]


def natural(library: MotionLibrary, frame: int, goals: Goals) -> int | None:
    """Return the next frame of the clip if both meet the request, else None."""
    onward = int(library.successors[frame])
    return onward if onward >= 0 and goals[frame] and goals[onward] else None
