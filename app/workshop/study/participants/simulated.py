"""Simulated participants: they show that a study runs and that its report finds what is there.

They say nothing about people. What they answer is drawn from the shares that a protocol states, or
at random; what they play is a hand that tries the cube's faces and turns on where it helps.
"""

from collections.abc import Callable
from datetime import datetime, timedelta
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.affect import Emotion, Personality
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.table.situation import Situation
from cubeling.app.scenarios import find_scenario, make_scenario
from cubeling.app.workshop.study.participants.study_log import ParticipantLog
from cubeling.app.workshop.study.protocols.goals import GoalWatch, TaskResult
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, Settings, StudyTask
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire
from cubeling.tracking import CubeControls, CubeModel

FRAME_S = 0.1
"""Time between two frames of a simulated task [s]."""

TURN_RATE = 0.45
"""How fast simulated hands turn the cube, in the middle [turns/s]."""

TIP_S, LOOK_S = 1.8, 1.6
"""How long they take to tip the cube, and look at what it does, in the middle [s]."""

BEGIN = datetime(2000, 1, 1, 9)
"""When simulated participants begin: a date on which nobody takes it for a real one."""

AnswerModel = Callable[[np.random.Generator, PlannedStep, Item], Answer]


class SimulatedDesk:
    """Answers and plays by itself; a `StudyDesk`."""

    onset: datetime | None = None

    def __init__(self, protocol: Protocol, number: int) -> None:
        self._now = BEGIN + timedelta(days=number)
        self._rng = np.random.default_rng([protocol.seed, 2_000_003, number])
        self._answer: AnswerModel = at_random
        if protocol.printed:
            module = import_module(f"cubeling.app.workshop.study.bundled.{protocol.printed}")
            self._answer = getattr(module, "simulated_answer", at_random)

    def now(self) -> datetime:
        """Return the virtual time."""
        return self._now

    def tell(self, title: str, text: str) -> None:
        """Read for a while."""
        self._pass(2.0 + len(text) / 20.0)

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Answer by the shares of the protocol."""
        self._pass(float(self._rng.lognormal(1.0, 0.4)))
        return self._answer(self._rng, step, item)

    def play(
        self, step: PlannedStep, task: StudyTask, settings: Settings, log: ParticipantLog
    ) -> tuple[TaskResult, str]:
        """Play with a simulated hand, without a camera."""
        result = simulate_task(task, settings, self._rng)
        self._pass(result.played_s)
        return result, ""

    def thank(self) -> None:
        """Do nothing: simulated participants expect no thanks."""

    def _pass(self, seconds: float) -> None:
        self._now += timedelta(seconds=round(seconds, 3))


def at_random(rng: np.random.Generator, step: PlannedStep, item: Item) -> Answer:
    """Return an answer by the shares of the item, or any with the same chance."""
    if item.kind == "text":
        return None
    if item.kind == "slider":
        return round(float(rng.uniform(item.low, item.high)), 3)
    return pick(rng, item.answers, item.simulated)


def pick(
    rng: np.random.Generator, answers: tuple[Answer, ...], shares: tuple[float, ...] = ()
) -> Answer:
    """Return one of some answers, with chances in proportion to shares; () for equal ones."""
    weights = np.array(shares or [1.0] * len(answers))
    return answers[int(rng.choice(len(answers), p=weights / weights.sum()))]


def simulate_task(task: StudyTask, settings: Settings, rng: np.random.Generator) -> TaskResult:
    """Return how a simulated hand does in a task."""
    kind = find_scenario(task.scenario)
    cube = CubeModel.load(kind.cube)
    scenario = make_scenario(
        task.scenario, cube, turns=settings.turns, personality=settings.personality
    )
    places = Personality.load(settings.personality or kind.personality).label_set.places
    watch = GoalWatch(task.goal, task.limit_s)
    hand = _Hand([face.side for face in cube.faces], rng)
    frame = 0
    while not (watch.reached or watch.time_is_up):
        time = frame * FRAME_S
        controls = hand.controls(time)
        outcome = scenario.update(controls, Situation(), Inputs())
        watch.see("/cube/controls", time, controls)
        watch.see("/character/command", time, outcome.command)
        watch.see("/robot/emotion", time, outcome.emotion)
        hand.look(_distance(task, places, outcome.emotion.emotion), time)
        frame += 1
    return watch.result


def _distance(task: StudyTask, places: Any, emotion: Emotion) -> float:
    """Return how far the emotion is from what the goal asks for; 0 where it asks for another."""
    goal = task.goal
    if goal.value == "mood":
        valence, arousal = places[goal.equals]
        return float(np.hypot(emotion.valence - valence, emotion.arousal - arousal))
    if goal.value in ("valence", "arousal"):
        value = float(getattr(emotion, goal.value))
        low = value if goal.at_least is None else goal.at_least
        high = value if goal.at_most is None else goal.at_most
        return max(low - value, value - high, 0.0)
    return 0.0


class _Hand:
    """Tries one face after the other; where the goal comes nearer, it turns the cube up."""

    def __init__(self, faces: list[str], rng: np.random.Generator) -> None:
        self._rng = rng
        self._faces = [faces[int(index)] for index in rng.permutation(len(faces))]
        self._rate = float(TURN_RATE * rng.lognormal(0.0, 0.25))
        self._tip_s = float(TIP_S * rng.lognormal(0.0, 0.25))
        self._look_s = float(LOOK_S * rng.lognormal(0.0, 0.25))
        self._tries = 0
        self._down_at = self._tip_s
        self._turns = 0.0
        self._turning = False
        self._at_first: float | None = None

    def controls(self, time: float) -> CubeControls:
        """Return what the hand does in a frame [s]."""
        down = time >= self._down_at
        if self._turning:
            self._turns += self._rate * FRAME_S
        position: NDArray[np.float64] = np.zeros(2)
        return CubeControls(
            visible=True,
            top_face=self._faces[self._tries % len(self._faces)] if down else None,
            heading=0.0,
            camera_angle=0.0,
            turns=self._turns,
            resting=down,
            placed=down and time < self._down_at + FRAME_S,
            lifted=not down,
            position=position,
            timestamp=time,
            camera_from_table=np.eye(4),
            placements=self._tries + 1 if down else self._tries,
        )

    def look(self, distance: float, time: float) -> None:
        """See how far the goal is, and go on or try the next face."""
        if time < self._down_at:
            return
        if self._at_first is None:
            self._at_first = distance
        elif time >= self._down_at + self._look_s and not self._turning:
            if distance < self._at_first - 1e-3:
                self._turning = True
            else:
                self._tries += 1
                self._down_at = time + self._tip_s
                self._at_first = None
