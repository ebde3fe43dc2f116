"""A character that walks by motion matching."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from cubeling.characters.control.command import CharacterCommand, LocomotionIntent
from cubeling.characters.control.controllers.actions import (
    WEIGHT_LAG_S,
    ActionMotion,
    Actions,
    next_action,
)
from cubeling.characters.control.controllers.controller import ControllerFrame
from cubeling.characters.control.controllers.own_takes import standing_take, walking_take
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.control.controllers.walk import (
    NOT_ACTIONS,
    TURN_END_RAD,
    TURN_START_RAD,
    WalkController,
)
from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import IDLE_SPEED, RUN_SPEED, TOP_SPEED
from cubeling.characters.locomotion.steering import ARRIVAL_DISTANCE_M, has_arrived
from cubeling.characters.model.character import Character
from cubeling.characters.model.motion_library import mirror_or_none
from cubeling.characters.model.standing import idle_clip
from cubeling.characters.motion.balance import MAX_UNLEANED_M_S2
from cubeling.characters.motion.contacts import find_contacts
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.motion.state_machine import StateMachine
from cubeling.characters.skeleton.feet import find_feet
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import interpolate, low_pass
from cubeling.characters.synthesis.matching.database import MotionDatabase
from cubeling.characters.synthesis.matching.matched_motion import MatchedMotion
from cubeling.characters.synthesis.matching.prediction import Impulse, Wish, predict

SPEED_KNOTS = (IDLE_SPEED, 1.0, 2.0, RUN_SPEED, 3.5, 4.0, TOP_SPEED)
"""AvatAR's parameter Speed at the knots, in its own numbers."""

PACE_KNOTS = (0.38, 0.51, 0.78, 1.26, 1.66, 1.9, 2.4)
"""The same over the ground, as the bundled human has them [body heights/s]."""

MEASURING_LAG_S = 0.1
"""Time constant of the measured speed and turning rate."""

STANDING_PACE = 0.08
"""A root slower than this stands [body heights/s]."""

MAX_ADJUSTED_RAD, ADJUSTMENT_LAG_S, ADJUSTMENT_RATE = math.radians(30), 0.5, 0.35
"""A walker turns by a smaller error of its heading itself: with this time constant [s], and no
faster than this [rad/s]."""

SUDDEN_SPEED, SUDDEN_TURN_RAD = 0.2, math.radians(30)
"""A wish that changes by more is answered at once [body heights/s, rad]."""


class MatchingController:
    """Plays a character by motion matching; a `CharacterController`.

    The root moves as the recordings do. Actions are the character's own clips.
    """

    walks = True

    def __init__(
        self,
        character: Character,
        scale: float,
        place: RootDelta | None,
        database: MotionDatabase | None = None,
    ) -> None:
        self.database = database or prepare_database(character)
        self.place = place or RootDelta()
        """Where it stands on the table [m] and faces [rad]."""
        self._scale, self._height = scale, character.height
        self.motion = MatchedMotion(self.database, self.database.stillest)
        """What is matched."""
        self._actions = Actions(character, NOT_ACTIONS)
        self._machine = StateMachine({"idle": self.motion}, "idle", others=self._actions)
        self._skeleton = character.skeleton
        self._contacts: dict[str, list[list[bool]]] = {}
        self._time = self._weight = 0.0
        self._finished = ""
        self._impulse = Impulse()
        self._pace_now = self._turn_rate = 0.0  # over the ground [m/s], to the left [rad/s]
        self._answered: tuple[float, float] = (0.0, 0.0)
        self._arrived = self._turning = False

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that it knows, besides standing, walking and running."""
        return tuple(self._actions)

    def update(
        self, command: CharacterCommand, elapsed: float, tempo: float = 1.0
    ) -> ControllerFrame:
        """Advance by a time [s] under a command and return what is played."""
        action, self._finished = next_action(
            self._machine, self._actions, command.action, self._finished, self._time
        )
        now, self._time = self._time, self._time + elapsed
        wish = Wish() if action != "idle" else self._wish(command)
        self._play(action, command.weight, now)
        if action == "idle":
            self._match(wish, now - self._machine.entered, elapsed)
        step = self._machine.travel(now, self._time)
        self.place = self.place.then(step.scale(self._scale))
        if elapsed > 0.0:
            pace, rate = step.z / elapsed, step.yaw / elapsed
            self._pace_now = low_pass(self._pace_now, pace, elapsed, MEASURING_LAG_S)
            self._turn_rate = low_pass(self._turn_rate, rate, elapsed, MEASURING_LAG_S)
        return self._frame(wish)

    def _frame(self, wish: Wish) -> ControllerFrame:
        """Return what is played now."""
        state, spent = self._machine.state, self._time - self._machine.entered
        pace = self._pace_now / self._height
        speed = interpolate(pace, PACE_KNOTS, SPEED_KNOTS)
        going = state == "idle" and pace > STANDING_PACE and not self._turning
        action = self._actions.get(state)
        if going:
            state = "run" if speed > RUN_SPEED else "walk"
        return ControllerFrame(
            self._machine.sample(self._time),
            state,
            self.place,
            speed=speed if going else 0.0,
            angular=-self._turn_rate if going else 0.0,
            weight=self._weight if action else 0.0,
            acting=action is not None,
            shows_emotion=action is not None and action.shows_emotion,
            feet_down=self._feet_down(spent),
            standing=not going and wish.speed == 0.0 and action is None,
        )

    def _feet_down(self, spent: float) -> list[bool]:
        """Return which feet what is played has on the ground."""
        action = self._actions.get(self._machine.state)
        if action is None:
            return self.database.feet_down(self.motion.legs(spent))
        state, phase = self._machine.state, action.phase(spent)
        if state not in self._contacts:
            feet = find_feet(self._skeleton)
            self._contacts[state] = find_contacts(action.clip, self._skeleton, feet).tolist()
        contacts = self._contacts[state]
        frame = int((phase if phase == 1.0 else phase % 1.0) * (len(contacts) - 1))
        down: list[bool] = contacts[frame]
        return down

    def _wish(self, command: CharacterCommand) -> Wish:
        """Return where to go, in metres of the character, or which way to face."""
        going = command.locomotion or LocomotionIntent()
        if command.activity == "move" and going.target is not None:
            x, z = map(float, going.target)
            away = math.hypot(x - self.place.x, z - self.place.z)
            self._arrived = going.stop and has_arrived(away, self._arrived)
            if not self._arrived and away > 0.0:
                self._turning = False
                stop = ARRIVAL_DISTANCE_M / self._scale if going.stop else math.inf
                return Wish(self._pace(going.speed), self._to_character(x, z), stop)
        if going.facing is None:
            self._turning = False
            return Wish()
        x, z = map(float, going.facing)
        error = abs(self.place.bearing(x, z))
        self._turning = error > (TURN_END_RAD if self._turning else TURN_START_RAD)
        return Wish(0.0, self._to_character(x, z)) if self._turning else Wish()

    def _to_character(self, x: float, z: float) -> tuple[float, float]:
        return x / self._scale, z / self._scale

    def _pace(self, speed: float) -> float:
        """Return the speed over the ground of a Speed [m/s], of those that the clips have."""
        paces = self.database.paces
        asked = interpolate(speed, SPEED_KNOTS, PACE_KNOTS) * self._height
        after = min(int(np.searchsorted(paces, asked)), len(paces) - 1)
        nearest = min(paces[max(after - 1, 0)], paces[after], key=lambda pace: abs(pace - asked))
        return float(nearest)

    def _match(self, wish: Wish, time: float, elapsed: float) -> None:
        """Search for frames that suit a wish better, and turn a little where none fits exactly."""
        here = RootDelta(self.place.x / self._scale, self.place.z / self._scale, self.place.yaw)
        impulse = self._impulse
        self._impulse, _ = impulse.advance(here, wish, self._height, elapsed)
        error = 0.0 if wish.target is None else here.bearing(*wish.target)

        def ahead() -> Mapping[str, Array]:
            self._answered = wish.speed, error + here.yaw
            return predict(here, impulse, wish, self._height)

        speed, way = self._answered
        sudden = abs(wish.speed - speed) > SUDDEN_SPEED * self._height
        sudden |= abs(math.remainder(error + here.yaw - way, math.tau)) > SUDDEN_TURN_RAD
        self.motion.match(time, ahead, sudden)
        if self._pace_now > STANDING_PACE * self._height and abs(error) < MAX_ADJUSTED_RAD:
            most = min(ADJUSTMENT_RATE, MAX_UNLEANED_M_S2 / self._pace_now) * elapsed
            turn = min(max(error - low_pass(error, 0.0, elapsed, ADJUSTMENT_LAG_S), -most), most)
            self.place = self.place._replace(yaw=self.place.yaw + turn)

    def _play(self, action: str, weight: float, now: float) -> None:
        """Enter an action, or go on with it at another intensity; or go back to matching."""
        weight = min(max(weight, -1.0), 1.0)
        playing: ActionMotion | None = self._actions.get(action)
        if playing is not None and action != self._machine.state:
            self._weight = weight
            playing.begin(weight)
        elif playing is not None:
            self._weight = low_pass(self._weight, weight, self._time - now, WEIGHT_LAG_S)
            playing.set_weight(self._weight, now - self._machine.entered)
        begin = (lambda: self.motion.restart(self.database.stillest)) if playing is None else None
        self._machine.request(action, now, begin=begin)


def prepare_database(character: Character, motions: Sequence[str] = ()) -> MotionDatabase:
    """Return the database of motions for a character; without motions, of its own clips.

    Each clip is added with left and right exchanged, if the character is symmetric. Standing and
    turning in place are the character's own, as recordings of walking lack them.

    Raises
    ------
    CharacterError
        If the character or a motion does not suit.
    """
    walks = WalkController.suits(character)
    if not walks and not motions:
        raise CharacterError(
            f"{character.name}: has no walk of its own for the controller 'matching'; name "
            "recordings of walking with --motions, or choose the controller 'tree'"
        )
    mirror = mirror_or_none(character)
    clips = read_motions(motions, character)
    for side in (1.0,) if mirror else (1.0, -1.0):
        if not motions:
            clips.append(walking_take(character, side))
        if walks:
            clips.append(standing_take(character, side))
    idle = character.clips.get(idle_clip(character.clips) or "")
    if idle is not None and idle.root_motion and idle.cycle.length < STANDING_PACE:
        clips.append(idle)
    return MotionDatabase.of(clips, character.skeleton, character.anatomy, mirror)


def matching_factory(
    character: Character, motions: Sequence[str]
) -> "Callable[[Character, float, RootDelta | None], MatchingController]":
    """Prepare motion matching for a character; see `prepare_database`."""
    return partial(MatchingController, database=prepare_database(character, motions))
